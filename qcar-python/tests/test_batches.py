"""Many parameter sets at once give the bits of each alone."""

import numpy as np
import pytest

SETS = 130


@pytest.fixture(scope="module")
def batch(axle_d, axle_d_values):
    random = np.random.default_rng(3)
    return {name: value * random.uniform(0.9, 1.1, SETS) for name, value in axle_d_values.items()}


def alone(batch, nth):
    return {name: value[nth] for name, value in batch.items()}


def test_matrices(axle_d, batch):
    together = axle_d.matrices(batch)
    assert together.A.shape == (SETS, len(axle_d.states), len(axle_d.states))
    for nth in range(SETS):
        for many, one in zip(together, axle_d.matrices(alone(batch, nth))):
            np.testing.assert_array_equal(many[nth], one)


def test_jacobians(axle_d, batch):
    together = axle_d.jacobians(batch)
    for nth in (0, 64, SETS - 1):
        for many, one in zip(together, axle_d.jacobians(alone(batch, nth))):
            for name in one:
                np.testing.assert_array_equal(many[name][nth], one[name])


def test_responses(axle_d, batch):
    frequencies = np.linspace(1.0, 30.0, 17)
    together, slopes = axle_d.frf(frequencies, batch, jacobian=True)
    assert together.shape == (SETS, 17, len(axle_d.outputs), len(axle_d.excitations))
    for nth in (0, 1, SETS - 1):
        one, own = axle_d.frf(frequencies, alone(batch, nth), jacobian=True)
        np.testing.assert_array_equal(together[nth], one)
        for name in own:
            np.testing.assert_array_equal(slopes[name][nth], own[name])


def test_rides(quarter_car):
    vehicle = {"r_tire": 0.32, "static_tire_def": 0.02, "static_tire_load": 4400.0}
    heights, speeds = np.array([[0.01], [0.02]]), np.array([5.0, 8.0, 11.0])
    import qcar

    together = qcar.ride(quarter_car, vehicle=vehicle, height=heights, speed=speeds)
    assert together.tire_force_z.shape == (2, 3, together.time.size)
    for row in range(2):
        for column in range(3):
            one = qcar.ride(quarter_car, vehicle=vehicle, height=heights[row, 0], speed=speeds[column])
            assert one.tire_force_z.shape == one.time.shape
            np.testing.assert_array_equal(together.tire_force_z[row, column], one.tire_force_z)
            for name in one.outputs:
                np.testing.assert_array_equal(together.outputs[name][row, column], one.outputs[name])
                np.testing.assert_array_equal(together.peak[name][row, column], one.peak[name])


def test_shapes_of_batches(quarter_car):
    grid = quarter_car.matrices({"k_tire": np.linspace(1e5, 3e5, 4)[:, None], "m_wheel": [30.0, 40.0, 50.0]})
    assert grid.A.shape == (4, 3, 4, 4)
    values = quarter_car.values({"k_tire": np.linspace(1e5, 3e5, 4)[:, None], "m_wheel": [30.0, 40.0, 50.0]})
    assert values.shape == (4, 3, len(quarter_car.parameters))
    np.testing.assert_array_equal(quarter_car.matrices(values).A, grid.A)
    assert quarter_car.matrices({"k_tire": []}).A.shape == (0, 4, 4)
    assert quarter_car.frf(1.0, {"k_tire": []}).shape[0] == 0
