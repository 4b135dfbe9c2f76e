"""Rides over a road, and simulations of the runs of a campaign."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _html, _native
from ._model import Model, Parameters
from ._named import Array

#: Vehicle data that a rolling tyre needs.
FACTS = ("r_tire", "static_tire_def", "static_tire_load")


@dataclass(frozen=True, eq=False)
class Ride:
    """One ride, or a batch of rides whose axes come first."""

    #: s: (samples,).
    time: Array
    #: Every output of the model by its name, SI: (..., samples).
    outputs: dict[str, Array]
    #: Accelerations by mass and axis, such as ``("wheel", "z")``, m/s²: (..., samples). The same arrays as in `outputs`.
    accelerations: dict[tuple[str, str], Array]
    #: Force of the tyre on the wheel, N: (..., samples); zero while the tyre is in the air.
    tire_force_z: Array
    tire_force_x: Array
    #: Area of the tyre's contact, m²: (..., samples).
    contact_area: Array
    #: Largest magnitude within 0.1 s after the wheel reaches the obstacle, by output: (...,). NaN if it reaches none.
    peak: dict[str, Array]
    #: RMS value in the second after that, or to the end of the record, by output: (...,).
    after_shake: dict[str, Array]
    #: Deflection of the tyre before the obstacle, m: (...,).
    static_deflection: Array
    #: Times at which the tyre left the ground, s, for each ride in the order of the batch.
    lift_offs: list[list[float]] = field(repr=False)

    def _repr_html_(self) -> str:
        rides = self.static_deflection.size
        rows = ((name, *_span(self.peak[name]), *_span(self.after_shake[name])) for name in self.outputs)
        heads = ["output", "peak, least", "largest", "after-shake, least", "largest"]
        sentence = f"{rides} of {self.time.size} samples to {self.time[-1]:.3g} s"
        return _html.titled("rides", sentence, _html.table(heads, rows))


def _span(of: Array) -> tuple[float, float]:
    return float(np.min(of)), float(np.max(of))


def ride(
    model: Model,
    params: Parameters = None,
    *,
    vehicle: Mapping[str, float] | str | os.PathLike[str],
    speed: npt.ArrayLike,
    height: npt.ArrayLike | None = None,
    descent: float = 0.4,
    blend: float = 0.17,
    run_in: float = 1.5,
    road: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
    duration: float = 1.5,
    sample_rate: float = 1000.0,
    variant: str = "complete",
    tolerance: float = 1e-6,
) -> Ride:
    """Drive a model at constant speed over a cleat, or over any road.

    Parameters
    ----------
    model, params
        A model whose tyre rolls, and its parameter values.
    vehicle
        Radius ``r_tire`` (m) of the tyre, and its deflection ``static_tire_def`` (m) and load ``static_tire_load`` (N) at rest; or a
        campaign or parameter file with these. Its values of other parameters apply where `params` has none.
    speed
        m/s.
    height
        Height of the cleat's step, m.
    descent, blend
        Lengths of the straight part of the cleat after its step, and of its return to the flat road, m.
    run_in
        Length of the flat road before the cleat, m. At t = 0 the wheel is over its beginning.
    road
        Corners of a profile instead of a cleat: x and z in m, x never decreasing; two corners at one x are a step. Beyond
        it the road is flat.
    duration, sample_rate
        s and Hz; ``round(duration * sample_rate)`` samples, the first at t = 0, after a linear-phase anti-alias filter.
    variant
        ``"complete"``; ``"locked"``: all masses move along the road at constant speed; ``"vertical"``: locked, with a tyre
        in point contact, whose road is the height below the wheel's centre.
    tolerance
        Relative tolerance of the time steps.

    `params`, `speed` and `height` may be arrays that broadcast against each other: a ride for each entry, in parallel, with the
    same bits as a single ride.

    Raises
    ------
    qcar.ParameterError, qcar.SimulationError
    """
    if (height is None) == (road is None):
        raise _native.ParameterError("a ride is over a cleat of a `height` or over a `road`: give one of them")
    if not 0 < tolerance < 1:
        raise _native.ParameterError(f"`tolerance` is {tolerance}; expected a number between 0 and 1, such as 1e-6")
    facts = _facts(vehicle, model)
    p, _, batch = model._resolve(_with_facts(params, facts, model))
    heights = np.asarray(0.0 if height is None else height, dtype=float)
    speeds = np.asarray(speed, dtype=float)
    try:
        shape = np.broadcast_shapes(batch, heights.shape, speeds.shape)
    except ValueError:
        raise _native.ParameterError(
            f"params {batch}, height {heights.shape} and speed {speeds.shape} do not broadcast against each other"
        ) from None
    setup = {
        "vehicle": {name: value for name, value in facts.items() if name in FACTS},
        "variant": variant,
        "road": None if road is None else _corners(road),
        "cleat": [float(descent), float(blend), float(run_in)],
        "sample_rate": float(sample_rate),
        "samples": _samples(duration, sample_rate),
        "tolerance": float(tolerance),
    }
    every = np.broadcast_to(p.reshape(*batch, p.shape[-1]), (*shape, p.shape[-1])).reshape(-1, p.shape[-1])
    height_of_each, speed_of_each = (np.array(np.broadcast_to(own, shape)).reshape(-1) for own in (heights, speeds))
    return _ride(model, shape, setup, model._native.rides(np.array(every), height_of_each, speed_of_each, setup))


def _ride(model: Model, shape: tuple[int, ...], setup: dict[str, Any], found: tuple[Any, ...]) -> Ride:
    outputs, tyre, peak, after_shake, deflection, lift_offs = found
    samples = setup["samples"]
    signals = {own.name: outputs[:, place].reshape(*shape, samples) for place, own in enumerate(model.outputs)}
    moves = (own for own in model.outputs if own.kind == "acceleration")
    force_z, force_x, area = (tyre[:, place].reshape(*shape, samples) for place in range(3))
    return Ride(
        time=np.arange(samples) / setup["sample_rate"],
        outputs=signals,
        accelerations={(own.location, own.axis): signals[own.name] for own in moves},
        tire_force_z=force_z,
        tire_force_x=force_x,
        contact_area=area,
        peak={own.name: peak[:, place].reshape(shape) for place, own in enumerate(model.outputs)},
        after_shake={own.name: after_shake[:, place].reshape(shape) for place, own in enumerate(model.outputs)},
        static_deflection=deflection.reshape(shape),
        lift_offs=lift_offs,
    )


def _samples(duration: float, sample_rate: float) -> int:
    samples = duration * sample_rate
    if not np.isfinite(samples) or samples < 1 or samples > 1e9:
        raise _native.ParameterError(
            f"a duration of {duration} s at {sample_rate} Hz has {samples} samples; expected 1 to 1e9"
        )
    return round(samples)


def _facts(vehicle: Mapping[str, float] | str | os.PathLike[str], model: Model) -> dict[str, float]:
    """Data of a vehicle: of its tyre, and parameters of the model."""
    known = {*FACTS, *(own.name for own in model.parameters)}
    facts = vehicle if isinstance(vehicle, Mapping) else read_vehicle(vehicle)
    unknown = sorted(set(facts) - known)
    if unknown and isinstance(vehicle, Mapping):
        raise _native.ParameterError(
            f"`vehicle` has {', '.join(FACTS)} and parameters of `{model.name}`, found {', '.join(unknown)}"
        )
    return {name: float(value) for name, value in facts.items() if name in known}


def _with_facts(params: Parameters, facts: dict[str, float], model: Model) -> Parameters:
    """Parameters by name, completed by the data of the vehicle; an array already has all of them."""
    if params is not None and not isinstance(params, Mapping):
        return params
    names = {own.name for own in model.parameters}
    return {**{name: value for name, value in facts.items() if name in names}, **(params or {})}


def _corners(road: tuple[npt.ArrayLike, npt.ArrayLike]) -> list[list[float]]:
    try:
        x, z = (np.asarray(own, dtype=float) for own in road)
    except (TypeError, ValueError):
        raise _native.ParameterError("`road` is a pair of x and z, in m") from None
    if x.ndim != 1 or x.shape != z.shape:
        raise _native.ParameterError(f"`road` is a pair of rows of one length, found {x.shape} and {z.shape}")
    return [[float(own), float(height)] for own, height in zip(x, z)]


def read_vehicle(path: str | os.PathLike[str]) -> dict[str, float]:
    """The vehicle data, SI, of a campaign or parameter file."""
    return _native.read_values(path)[1]


def read_parameters(path: str | os.PathLike[str], model: Model) -> dict[str, float]:
    """The values of a model's parameters, SI, from a campaign, a parameter file or a fit's results, without those that it lacks."""
    values = _native.read_values(path)[0]
    return {own.name: values[own.name] for own in model.parameters if own.name in values}


@dataclass(frozen=True, eq=False)
class History:
    """The signals of a run over time."""

    #: s: (samples,).
    time: Array
    #: By channel, SI: (samples,). For a sweep or time history each sensor has two: ``..._measured`` and ``..._simulated``.
    signals: dict[str, Array]
    units: dict[str, str]


@dataclass(frozen=True, eq=False)
class Simulation:
    """The runs of a campaign, simulated and compared with the measurements."""

    campaign: str
    model: str
    #: Parameters that should be fitted but still have the campaign's start values.
    at_start: list[str]
    #: One for each cleat run, mass and axis: peaks, after-shakes and their relative errors (docs/json.md).
    runs: list[dict[str, Any]]
    #: Median and worst of these errors, by ``mass_axis``; ``None`` without a cleat run.
    summary: dict[str, Any] | None
    #: One for each sweep or time history and sensor: root mean squares, and ``nrms``.
    records: list[dict[str, Any]]
    notices: list[str]
    #: Signals by the name of the run.
    histories: dict[str, History] = field(repr=False)

    def _repr_html_(self) -> str:
        errors = ("peak_error", "after_shake_error")
        rows = ([own[key] for key in ("run", "role", "mass", "axis")] + [_percent(own[key]) for key in errors] for own in self.runs)
        runs = _html.table(["run", "role", "mass", "axis", "peak error %", "after-shake error %"], rows)
        others = ((own["run"], own["role"], own["channel"], own["quantity"], _percent(own["nrms"])) for own in self.records)
        records = _html.table(["run", "role", "channel", "quantity", "NRMS %"], others)
        shown = (runs if self.runs else "") + (records if self.records else "")
        return _html.titled(self.campaign, f"simulated by {self.model}", shown)


def _percent(part: float | None) -> float | None:
    return None if part is None else 100.0 * part


def simulate(
    campaign: str | os.PathLike[str],
    params: Mapping[str, float] | str | os.PathLike[str] | None = None,
    *,
    model: str | None = None,
    variant: str = "complete",
) -> Simulation:
    """Simulate the cleat runs, sweeps and time histories of a campaign, and compare them with the measurement.

    Parameters
    ----------
    campaign
        Folder with a campaign.toml.
    params
        Values that replace the campaign's start values: by name in SI, or a parameter file.
    model
        Name or path of a model that replaces the campaign's.
    variant
        As in `ride`, for cleat runs.

    Raises
    ------
    qcar.CampaignError
    """
    file = None if params is None or isinstance(params, Mapping) else params
    values = [(name, float(value)) for name, value in params.items()] if isinstance(params, Mapping) else []
    text, histories = _native.simulate_campaign(campaign, model, file, values, variant)
    found = json.loads(text)
    runs = {
        name: History(time, {own: samples for own, _, samples in signals}, {own: unit for own, unit, _ in signals})
        for name, time, signals in histories
    }
    return Simulation(histories=runs, **found)
