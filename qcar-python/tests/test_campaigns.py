"""Fits, simulations and searches of campaigns."""

import numpy as np
import pytest

import qcar


@pytest.fixture(scope="module")
def fitted(campaigns):
    return qcar.fit(campaigns / "axle_a_rig")


def test_a_fit_finds_what_the_campaign_was_made_with(fitted, campaigns):
    tomllib = pytest.importorskip("tomllib", reason="Python before 3.11 reads no TOML: the truth is passed over")
    truth = tomllib.loads((campaigns / "axle_a_rig" / "truth.toml").read_text())["parameters"]
    assert fitted.converged and fitted.cost < fitted.start_cost
    for name, error in fitted.stderr.items():
        own = truth[name]
        value = own["value"] if isinstance(own, dict) else own
        assert abs(fitted.values[name] - value) < 4 * error, name


def test_a_fit_shows_its_ratios_and_errors(fitted):
    model = qcar.Model(fitted.model)
    assert {ratio.role for ratio in fitted.ratios} == {"fit", "held_out"}
    pad = [own.name for own in model.excitations].index("pad")
    outputs = [own.name for own in model.outputs]
    for ratio in fitted.ratios:
        assert ratio.measured.shape == ratio.modelled.shape == ratio.frequency.shape
        above, below = ratio.channel.split("_to_")[::-1]
        response = model.frf(ratio.frequency, fitted.values)[:, :, pad]
        of = lambda mass: response[:, outputs.index(f"z_{mass}_acceleration")]  # noqa: E731
        lower = -((2 * np.pi * ratio.frequency) ** 2) if below == "pad" else of(below)
        np.testing.assert_allclose(ratio.modelled, of(above) / lower, rtol=1e-9)
    np.testing.assert_allclose(np.sqrt(np.diag(fitted.covariance)), [fitted.stderr[name] for name in fitted.free])
    assert np.min(np.linalg.eigvalsh(fitted.covariance / np.outer(*2 * [list(fitted.stderr.values())]))) > -1e-9
    assert fitted.figure._repr_svg_().startswith("<svg") and "axle_a fitted to axle_a_rig" in fitted.figure.svg
    assert "standard error" in fitted._repr_html_() and "pad_to_" in fitted._repr_html_()


def test_choices_of_a_fit(campaigns):
    fixed = qcar.fit(campaigns / "axle_a_rig", fix="c_tire", channels=["pad_to_wheel"], starts=2)
    assert "c_tire" not in fixed.stderr and fixed.details["starts"] == 2
    assert {ratio.channel for ratio in fixed.ratios if ratio.fitted} == {"pad_to_wheel"}


def test_time_histories_alone_are_fitted_sample_by_sample(campaigns):
    fitted = qcar.fit(campaigns / "emps")
    # No transmissibility depends on an offset.
    assert "f_offset" in fitted.stderr and fitted.converged


def test_a_simulation_holds_its_runs_against_the_measurement(fitted, campaigns):
    at_start = qcar.simulate(campaigns / "axle_a_rig")
    after = qcar.simulate(campaigns / "axle_a_rig", fitted.values)
    assert after.runs and len(after.histories) >= len({own["run"] for own in after.runs})
    error = lambda of: np.median([abs(own["after_shake_error"]) for own in of.runs])  # noqa: E731
    assert error(after) < error(at_start)
    assert at_start.at_start and "peak error" in after._repr_html_()
    history = next(iter(after.histories.values()))
    assert all(signal.shape == history.time.shape for signal in history.signals.values())
    replayed = next(own for own in after.records)
    signals = after.histories[replayed["run"].removesuffix(".gz").removesuffix(".csv").split("/")[-1]].signals
    name = f"{replayed['channel']}_{replayed['quantity']}"
    measured, simulated = signals[f"{name}_measured"], signals[f"{name}_simulated"]
    nrms = np.sqrt(np.mean((simulated - measured) ** 2)) / np.std(measured)
    assert replayed["nrms"] == pytest.approx(nrms, rel=1e-9)


@pytest.fixture(scope="module")
def verdict(campaigns):
    return qcar.discover(campaigns / "axle_c_study")


def test_a_search_finds_what_is_missing_and_gives_the_model(verdict, campaigns):
    assert verdict.verdict == "found" and [own["name"] for own in verdict.effects] == ["suspended_mass"]
    assert verdict.gap["held_out"]["after"] < 1.2 < verdict.gap["held_out"]["before"]
    assert verdict.details["verdict"] == "found" and "suspended_mass" in verdict.text
    model = qcar.Model.from_text(verdict.model_text)
    assert "m_pwt" in {own.name for own in model.parameters}
    assert np.all(np.isfinite(model.matrices(verdict.values).A))
    assert "suspended_mass" in verdict._repr_html_() and verdict.figure.svg.startswith("<svg")
