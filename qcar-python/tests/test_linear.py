"""Matrices, Jacobians, responses and modes, judged by closed forms, finite differences, SciPy and NumPy."""

import numpy as np
import pytest
import scipy.integrate
import scipy.signal

import qcar

#: Of the quarter car.
VALUES = {"m_corner": 450.0, "m_wheel": 37.0, "k_wheel_z": 21e3, "c_wheel_z": 1300.0, "k_tire": 190e3, "c_tire": 120.0}


def place(of, name):
    return [own.name for own in of].index(name)


def test_matrices_of_the_quarter_car_are_those_of_a_textbook(quarter_car):
    A, B, _, _ = quarter_car.matrices(VALUES)
    body, wheel = VALUES["m_corner"] - VALUES["m_wheel"], VALUES["m_wheel"]
    k, c, kt, ct = (VALUES[name] for name in ("k_wheel_z", "c_wheel_z", "k_tire", "c_tire"))
    z_body, z_wheel, v_body, v_wheel = (
        place(quarter_car.states, name) for name in ("z_body", "z_wheel", "vz_body", "vz_wheel")
    )
    expected = np.zeros((4, 4))
    expected[z_body, v_body] = expected[z_wheel, v_wheel] = 1.0
    expected[v_body, [z_body, z_wheel, v_body, v_wheel]] = np.array([-k, k, -c, c]) / body
    expected[v_wheel, [z_body, z_wheel, v_body, v_wheel]] = np.array([k, -k - kt, c, -c - ct]) / wheel
    # The same sums in another order.
    np.testing.assert_allclose(A, expected, rtol=1e-14, atol=1e-12)
    assert B[v_wheel, place(quarter_car.inputs, "z_pad")] == pytest.approx(kt / wheel, rel=1e-14)


def test_matrices_go_where_scipy_wants_them(quarter_car):
    system = scipy.signal.StateSpace(*quarter_car.matrices(VALUES))
    assert system.A.shape == (4, 4) and system.D.shape == (len(quarter_car.outputs), len(quarter_car.inputs))


def test_derivatives_of_matrices_are_their_difference_quotients(axle_d, axle_d_values):
    slopes = axle_d.jacobians(axle_d_values)
    for name, value in axle_d_values.items():
        # Central differences: their error is h² of a rational function in which a parameter is a factor of order one.
        step = 1e-5 * value
        above, below = (axle_d.matrices({**axle_d_values, name: value + h}) for h in (step, -step))
        for own, high, low in zip(slopes, above, below):
            scale = np.max(np.abs(high)) / value
            np.testing.assert_allclose(own[name], (high - low) / (2 * step), rtol=1e-6, atol=1e-9 * scale)


def test_a_parameter_moves_those_that_follow_it(axle_d, axle_d_values):
    tied = [own for own in axle_d.parameters if own.same_as]
    assert tied, "axle_d has tied parameters"
    slopes = axle_d.jacobians(axle_d_values)
    assert all(own.name not in slopes.dA for own in tied)
    apart = axle_d.jacobians({**axle_d_values, tied[0].name: axle_d_values[tied[0].same_as]})
    together = apart.dA[tied[0].name] + apart.dA[tied[0].same_as]
    np.testing.assert_allclose(slopes.dA[tied[0].same_as], together, rtol=1e-13, atol=1e-12)


def excited(model, excitation, omega):
    """What each input is under a harmonic excitation of size 1."""
    power = {"": 0, "_rate": 1, "_acceleration": 2}
    u = np.zeros((len(model.inputs), omega.size), dtype=complex)
    for row, own in enumerate(model.inputs):
        if own.excitation == excitation.name and own.axis == excitation.axis:
            kind = own.kind.removeprefix(excitation.kind) if own.kind != "force" else ""
            u[row] = (1j * omega) ** power[kind]
    return u


@pytest.mark.parametrize("name", ["quarter_car", "axle_d"])
def test_responses_are_those_that_solving_the_matrices_gives(name, axle_d_values):
    model = qcar.Model(name)
    values = VALUES if name == "quarter_car" else axle_d_values
    frequencies = np.geomspace(0.5, 60.0, 40)
    response = model.frf(frequencies, values)
    assert response.shape == (40, len(model.outputs), len(model.excitations))
    A, B, C, D = model.matrices(values)
    omega = 2 * np.pi * frequencies
    for column, excitation in enumerate(model.excitations):
        u = excited(model, excitation, omega)
        states = np.linalg.solve(1j * omega[:, None, None] * np.eye(len(A)) - A, (B @ u).T[:, :, None])
        total = (C @ states)[:, :, 0] + (D @ u).T
        # Both lose a few digits near lightly damped resonances.
        scale = np.max(np.abs(total), axis=0) + 1e-30
        np.testing.assert_allclose(response[:, :, column] / scale, total / scale, atol=1e-11)


@pytest.mark.filterwarnings("ignore::scipy.signal.BadCoefficients")
def test_the_response_to_a_force_is_that_of_scipy(quarter_car):
    frequencies = np.geomspace(0.5, 60.0, 40)
    response = quarter_car.frf(frequencies, VALUES)
    A, B, C, D = quarter_car.matrices(VALUES)
    force, column = place(quarter_car.inputs, "f_wheel_z"), place(quarter_car.excitations, "f_wheel_z")
    for output in range(len(quarter_car.outputs)):
        one = scipy.signal.StateSpace(A, B[:, [force]], C[[output]], D[[output]][:, [force]])
        _, gain = scipy.signal.freqresp(one, 2 * np.pi * frequencies)
        # SciPy goes through coefficients of polynomials, which costs it digits.
        np.testing.assert_allclose(response[:, output, column], gain, rtol=1e-7)


def test_ratios_are_those_of_responses(axle_d, axle_d_values):
    frequencies = np.array([0.8, 4.0, 17.0])
    ratios, slopes = axle_d.ratios(frequencies, axle_d_values, jacobian=True)
    assert ratios.shape == (3, len(axle_d.channels)) == slopes["k_tire"].shape
    response = axle_d.frf(frequencies, axle_d_values)[:, :, place(axle_d.excitations, "pad")]
    acceleration = {own.location: response[:, row] for row, own in enumerate(axle_d.outputs) if own.axis == "z"}
    acceleration["pad"] = -((2 * np.pi * frequencies) ** 2)
    vertical = [(column, name) for column, name in enumerate(axle_d.channels) if not name.endswith("_x")]
    assert len(vertical) > 3
    for column, name in vertical:
        below, above = name.split("_to_")
        np.testing.assert_allclose(ratios[:, column], acceleration[above] / acceleration[below], rtol=1e-12)
    step = 1.0
    moved = [axle_d.ratios(frequencies, {**axle_d_values, "k_tire": axle_d_values["k_tire"] + h}) for h in (step, -step)]
    np.testing.assert_allclose(slopes["k_tire"], (moved[0] - moved[1]) / (2 * step), rtol=1e-5, atol=1e-12)
    two = axle_d.ratios(frequencies, {**axle_d_values, "k_tire": [2e5, axle_d_values["k_tire"]]})
    np.testing.assert_array_equal(two[1], ratios)


def test_derivatives_of_responses_are_their_difference_quotients(axle_d, axle_d_values):
    frequencies = [0.7, 3.0, 11.0, 35.0]
    response, slopes = axle_d.frf(frequencies, axle_d_values, jacobian=True)
    np.testing.assert_array_equal(response, axle_d.frf(frequencies, axle_d_values))
    for name, value in axle_d_values.items():
        step = 1e-5 * value
        above, below = (axle_d.frf(frequencies, {**axle_d_values, name: value + h}) for h in (step, -step))
        scale = np.max(np.abs(response), axis=(0,)) / value
        difference = np.abs(slopes[name] - (above - below) / (2 * step))
        assert np.all(difference <= 1e-6 * np.abs(slopes[name]) + 1e-8 * scale), name


def test_modes_are_the_eigenvalues_of_a(axle_d, axle_d_values):
    modes = axle_d.modes(axle_d_values)
    roots = np.linalg.eigvals(axle_d.matrices(axle_d_values).A)
    expected = sorted(abs(root) for root in roots if root.imag > 1e-6 * abs(root) and abs(root) > 0.1)
    np.testing.assert_allclose([2 * np.pi * mode.frequency for mode in modes], expected, rtol=1e-9)
    for mode in modes:
        assert max(abs(part) for part in mode.shape.values()) == pytest.approx(1.0)


def test_rates_and_outputs_of_a_linear_model_are_those_of_its_matrices(axle_d, axle_d_values):
    random = np.random.default_rng(5)
    x, u = random.normal(size=(7, len(axle_d.states))), random.normal(size=len(axle_d.inputs))
    A, B, C, D = axle_d.matrices(axle_d_values)
    rates, outputs = axle_d.derivative(x, u, axle_d_values), axle_d.output(x, u, axle_d_values)
    # Sums of some large terms in another order.
    for found, expected in ((rates, x @ A.T + B @ u), (outputs, x @ C.T + D @ u)):
        np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-12 * np.max(np.abs(expected)))
    np.testing.assert_array_equal(rates[3], axle_d.derivative(x[3], u, axle_d_values))


def hardening() -> qcar.Model:
    """One mass on a spring that hardens."""
    return qcar.Model.from_text(
        """
        axle hard { "A spring that hardens"
            direction z {
                road pad;
                mass body = m;
                link spring: body - pad { force = k*s + h*s*s*s; }
            }
            param m: kg = 2 kg "Mass"; param k: N/m = 50 "Stiffness"; param h: N/m^3 = 4e4 "Hardening";
        }
        """
    )


def test_scipy_integrates_a_nonlinear_model():
    model, start = hardening(), [0.02, 0.0]
    solved = scipy.integrate.solve_ivp(lambda _, x: model.derivative(x), (0, 3), start, rtol=1e-9, atol=1e-12)
    z, v = solved.y[place(model.states, "z_body")], solved.y[place(model.states, "vz_body")]
    energy = 0.5 * 2.0 * v**2 + 0.5 * 50.0 * z**2 + 0.25 * 4e4 * z**4
    # Nothing damps it.
    np.testing.assert_allclose(energy, energy[0], rtol=1e-6)
    assert np.ptp(z) > 0.03


def test_a_nonlinear_model_is_linearised_where_it_is_told():
    model = hardening()
    assert not model.linear
    at_rest, bent = model.matrices(), model.matrices(x=[0.01, 0.0])
    row, column = place(model.states, "vz_body"), place(model.states, "z_body")
    assert at_rest.A[row, column] == pytest.approx(-25.0)
    assert bent.A[row, column] == pytest.approx(-(50.0 + 3 * 4e4 * 0.01**2) / 2.0)
    assert model.jacobians(x=[0.01, 0.0]).dA["h"][row, column] == pytest.approx(-3 * 0.01**2 / 2.0)
