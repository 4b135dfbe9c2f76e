"""A model fitted to the rig runs of a campaign."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from . import _html, _native
from ._named import Array, ComplexArray


@dataclass(frozen=True, eq=False)
class Ratio:
    """A measured ratio of two signals, such as a transmissibility, with that of the fitted model."""

    run: str
    #: ``fit`` or ``held_out``.
    role: str
    #: Such as ``pad_to_body``.
    channel: str
    #: Whether the fit used it.
    fitted: bool
    #: Hz: (lines,).
    frequency: Array
    #: (lines,).
    measured: ComplexArray
    #: (lines,).
    modelled: ComplexArray
    #: Variance of the measured ratio by noise over its squared magnitude: (lines,).
    relative_variance: Array


@dataclass(frozen=True, eq=False)
class Fit:
    """The result of a fit. `details` is the complete result as in docs/json.md."""

    campaign: str
    model: str
    #: Parameters by name, SI, without those that follow another one: ``model.matrices(fit.values)`` gives the fitted model.
    values: dict[str, float]
    #: Standard errors by name, SI, of the parameters that have one.
    stderr: dict[str, float]
    #: ``"lower"`` or ``"upper"`` for each parameter at an end of its range.
    at_bound: dict[str, str]
    #: Names of the fitted parameters that have a standard error, in the order of `covariance`.
    free: list[str]
    #: Covariance of the parameters in `free`, SI: (free, free).
    covariance: Array = field(repr=False)
    #: Sum of the squared weighted residuals, at the fitted values and at the start values.
    cost: float
    start_cost: float
    converged: bool
    #: Why the search stopped.
    stopped: str
    evaluations: int
    #: Fit percentages of each channel of each run: ``fit_magnitude`` and ``fit_phase``, 100 for no error.
    channels: list[dict[str, Any]] = field(repr=False)
    notices: list[str]
    #: The measured and modelled ratios.
    ratios: list[Ratio] = field(repr=False)
    #: Magnitudes of the first run: measured, with the start values and fitted.
    figure: _html.Figure = field(repr=False)
    details: dict[str, Any] = field(repr=False)

    def _repr_html_(self) -> str:
        rows = (
            (name, own["value"], own["stderr"], own["unit"], own["start"], self.at_bound.get(name, ""))
            for name, own in self.details["parameters"].items()
        )
        parameters = _html.table(["parameter", "value", "standard error", "unit", "start", "at bound"], rows)
        keys = ("name", "run", "role", "fit_magnitude", "fit_phase")
        channels = _html.table(
            ["channel", "run", "role", "magnitude %", "phase %"], ([own[key] for key in keys] for own in self.channels)
        )
        ended = "converged" if self.converged else "did not converge"
        return _html.titled(self.model, f"fitted to {self.campaign}: {ended}, {self.stopped}", parameters, channels)


def fit(
    campaign: str | os.PathLike[str],
    *,
    model: str | None = None,
    starts: int | None = None,
    channels: Sequence[str] = (),
    free: Sequence[str] = (),
    fix: Sequence[str] = (),
) -> Fit:
    """Fit a linear model to the sweeps and time histories of a campaign.

    Sweeps are compared as transmissibilities. If the campaign has time histories and no sweep to fit, these are fitted sample by sample unless
    ``channels`` names some; the ratios of the result are then only compared.

    Parameters
    ----------
    campaign
        Folder with a campaign.toml.
    model
        Name or path of a model that replaces the campaign's.
    starts
        Number of searches, 1 to 10 000. The first starts from the campaign's start values, the others from points in its ranges.
    channels
        The channels to fit, such as ``pad_to_wheel``; by default those across the model's force elements.
    free, fix
        Parameters to fit in addition, or to keep at their start values.

    Raises
    ------
    qcar.CampaignError
        With every mistake: file, place, what was found, what was expected, and the remedy.
    """
    if starts is not None and not 1 <= starts <= 10_000:
        raise _native.ParameterError(f"`starts` is {starts}; expected 1 to 10000 searches")
    text, ratios, correlations, figure = _native.fit_campaign(
        campaign, model, starts, _names(channels), _names(free), _names(fix)
    )
    found = json.loads(text)
    parameters: dict[str, dict[str, Any]] = found["parameters"]
    stderr = {name: own["stderr"] for name, own in parameters.items() if own["stderr"] is not None}
    return Fit(
        campaign=found["campaign"],
        model=found["model"],
        values={name: own["value"] for name, own in parameters.items() if own["tied_to"] is None},
        stderr=stderr,
        at_bound={name: own["at_bound"] for name, own in parameters.items() if own["at_bound"]},
        free=list(stderr),
        covariance=_covariance(stderr, correlations),
        cost=found["cost"],
        start_cost=found["start_cost"],
        converged=found["converged"],
        stopped=found["stopped"],
        evaluations=found["evaluations"],
        channels=found["channels"],
        notices=found["notices"],
        ratios=[Ratio(*own) for own in ratios],
        figure=_html.Figure(figure),
        details=found,
    )


def _names(of: Sequence[str]) -> list[str]:
    return [of] if isinstance(of, str) else list(of)


def _covariance(stderr: dict[str, float], correlations: list[tuple[str, str, float]]) -> Array:
    place = {name: nth for nth, name in enumerate(stderr)}
    correlation = np.eye(len(stderr))
    for first, second, value in correlations:
        if first in place and second in place:
            a, b = place[first], place[second]
            correlation[a, b] = correlation[b, a] = value
    errors = np.array(list(stderr.values()))
    return correlation * np.outer(errors, errors)
