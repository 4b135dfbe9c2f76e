"""Rides, judged by SciPy's integration of A and B, and by what must hold of any ride."""

import numpy as np
import pytest
import scipy.integrate

import qcar

VEHICLE = {"r_tire": 0.32, "static_tire_def": 0.02, "static_tire_load": 4400.0}


def hump(height, length, begin, step=0.01):
    """A long smooth hump with a continuous curvature: (x, z, dz/dx)."""
    x = np.arange(0.0, begin + length + 20.0, step)
    phase = np.clip((x - begin) / length, 0.0, 1.0)
    z = height * np.sin(np.pi * phase) ** 4
    slope = height * 4 * np.sin(np.pi * phase) ** 3 * np.cos(np.pi * phase) * np.pi / length
    return x, z, slope


def test_a_ride_over_a_long_hump_is_the_linear_model(quarter_car):
    speed, rate, duration = 6.0, 500.0, 2.5
    x, z, slope = hump(0.03, 6.0, 2.0)
    params = {"k_tire": 200e3, "c_tire": 0.0}
    # A point below the wheel's centre: the road is the model's input.
    ride = qcar.ride(
        quarter_car, params, vehicle={**VEHICLE, "static_tire_load": 200e3 * 0.02, "static_tire_def": 0.02},
        speed=speed, road=(x, z), duration=duration, sample_rate=rate, variant="vertical", tolerance=1e-8,
    )
    A, B, C, D = quarter_car.matrices(params)
    pad = [own.name for own in quarter_car.inputs].index("z_pad")
    road = lambda t: np.interp(speed * t, x, z)  # noqa: E731
    solved = scipy.integrate.solve_ivp(
        lambda t, state: A @ state + B[:, pad] * road(t), (0, duration), np.zeros(len(A)), "DOP853", ride.time,
        rtol=1e-9, atol=1e-12, max_step=2e-3,
    )
    signals = C @ solved.y + np.outer(D[:, pad], road(ride.time))
    for row, own in enumerate(quarter_car.outputs):
        if own.kind != "acceleration":
            continue
        scale = np.max(np.abs(signals[row]))
        assert scale > 0.1, own.name
        # The tyre is steeper than its static stiffness by what its geometry bends, and chords stand for the hump.
        np.testing.assert_allclose(ride.outputs[own.name], signals[row], atol=5e-3 * scale, err_msg=own.name)


def test_a_cleat_shakes_the_wheel_first_and_is_forgotten(axle_d, axle_d_values):
    ride = qcar.ride(axle_d, axle_d_values, vehicle=VEHICLE, height=0.02, speed=8.0, duration=3.0)
    wheel = ride.accelerations["wheel", "z"]
    assert wheel is ride.outputs["z_wheel_acceleration"]
    felt = ride.time[np.argmax(np.abs(wheel) > 0.1 * np.max(np.abs(wheel)))]
    # 1.5 m of flat road, less at most half of a contact patch of 0.23 m and what a tyre reaches ahead over a step of 2 cm.
    assert (1.5 - 0.25) / 8.0 < felt < 1.5 / 8.0
    before = wheel[ride.time < felt - 0.03]
    assert np.max(np.abs(before)) < 1e-3 * np.max(np.abs(wheel))
    impact = (ride.time >= felt) & (ride.time < felt + 0.1)
    assert ride.peak["z_wheel_acceleration"] == pytest.approx(np.max(np.abs(wheel[impact])), rel=1e-12)
    shake = (ride.time >= felt + 0.1) & (ride.time < felt + 1.1)
    root_mean_square = np.sqrt(np.mean(wheel[shake] ** 2))
    # One sample more or less at either end.
    assert ride.after_shake["z_wheel_acceleration"] == pytest.approx(root_mean_square, rel=1e-2)
    assert np.max(np.abs(wheel[-100:])) < 0.05 * np.max(np.abs(wheel))
    assert "z_wheel_acceleration" in ride._repr_html_()


def test_the_tyre_carries_its_load_and_leaves_the_ground(quarter_car):
    ride = qcar.ride(quarter_car, vehicle=VEHICLE, height=0.06, speed=12.0)
    assert ride.tire_force_z[0] == pytest.approx(4400.0, rel=1e-6)
    assert ride.lift_offs[0] and np.any(ride.tire_force_z == 0.0) and np.any(ride.contact_area == 0.0)


def test_facts_of_the_vehicle_come_from_a_campaign(campaigns):
    folder = campaigns / "axle_c_study"
    model = qcar.Model("axle_c")
    params = qcar.read_parameters(folder, model)
    by_path = qcar.ride(model, params, vehicle=folder, height=0.01, speed=8.0)
    facts = {"r_tire": 0.315, "static_tire_load": 3927.9, "static_tire_def": 0.0183}
    by_hand = qcar.ride(model, params, vehicle=facts, height=0.01, speed=8.0)
    np.testing.assert_array_equal(by_path.tire_force_z, by_hand.tire_force_z)
    assert qcar.read_vehicle(folder)["m_corner"] == 400.4


def test_what_the_vehicle_says_of_parameters_holds_where_nobody_else_gives_them(axle_d, axle_d_values):
    own = {name: value for name, value in axle_d_values.items() if name not in VEHICLE}
    assert len(own) < len(axle_d_values)
    by_vehicle = qcar.ride(axle_d, own, vehicle=VEHICLE, height=0.02, speed=8.0)
    by_hand = qcar.ride(axle_d, axle_d_values, vehicle=VEHICLE, height=0.02, speed=8.0)
    other = qcar.ride(axle_d, {**own, "static_tire_load": 0.0}, vehicle=VEHICLE, height=0.02, speed=8.0)
    np.testing.assert_array_equal(by_vehicle.tire_force_x, by_hand.tire_force_x)
    assert not np.array_equal(by_vehicle.tire_force_x, other.tire_force_x)
    with pytest.raises(qcar.ParameterError, match="r_tyre"):
        qcar.ride(axle_d, own, vehicle={**VEHICLE, "r_tyre": 0.3}, height=0.02, speed=8.0)


def test_a_ride_without_a_bump_has_no_peak(quarter_car):
    flat = qcar.ride(quarter_car, vehicle=VEHICLE, road=([0.0, 20.0], [0.0, 0.0]), speed=8.0)
    assert all(np.max(np.abs(signal)) < 1e-6 for signal in flat.outputs.values())
