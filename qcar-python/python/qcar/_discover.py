"""The search for effects that a model lacks."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from typing import Any

from . import _html, _native


@dataclass(frozen=True, eq=False)
class Verdict:
    """The result of a search; docs/json.md describes it."""

    #: ``none``: noise explains the residuals; ``found``: `effects` explain them; ``class``: one of several does; ``unknown``.
    verdict: str
    probability: float | None
    #: The effects found, each with ``name``, ``at``, ``form``, ``parameters``, ``stderr``, ``units`` and ``evidence``.
    effects: list[dict[str, Any]]
    #: The most probable sets of effects.
    candidates: list[dict[str, Any]] = field(repr=False)
    #: RMS residual of the ``fit`` and ``held_out`` runs in standard deviations, ``before`` and ``after``; noise alone gives 1.
    gap: dict[str, dict[str, float]]
    #: Places at which a change of the model would explain the residuals.
    places: list[dict[str, Any]] = field(repr=False)
    notices: list[str]
    #: The text of the model with the effects, for ``qcar.Model.from_text``; ``None`` if none was found.
    model_text: str | None = field(repr=False)
    #: The values of all parameters, including those of the effects, SI.
    values: dict[str, float] = field(repr=False)
    #: The answer in words.
    text: str = field(repr=False)
    #: The residual of each sensor over frequency, before and after.
    figure: _html.Figure = field(repr=False)
    #: The complete result, as in docs/json.md.
    details: dict[str, Any] = field(repr=False)

    def _repr_html_(self) -> str:
        rows = (
            (own["name"], own["at"], name, value, own["stderr"][name], own["units"].get(name, ""))
            for own in self.effects
            for name, value in own["parameters"].items()
        )
        effects = _html.table(["effect", "at", "parameter", "value", "standard error", "unit"], rows)
        gaps = ((name, own["before"], own["after"]) for name, own in self.gap.items())
        gap = _html.table(["residual in sd", "before", "after"], gaps)
        return _html.titled(self.verdict, _sentence(self.probability), effects if self.effects else "", gap)


def _sentence(probability: float | None) -> str:
    return "" if probability is None else f"with probability {probability:.3g}"


def discover(campaign: str | os.PathLike[str], *, model: str | None = None) -> Verdict:
    """Find the effects that a campaign shows and its model lacks.

    Fits the model to the runs with the role ``fit``, tries the effects of the catalogue wherever they apply, and
    checks them on the runs with the role ``held_out``.

    Parameters
    ----------
    campaign
        Folder with a campaign.toml.
    model
        Name or path of a model that replaces the campaign's.

    Raises
    ------
    qcar.CampaignError
    """
    text, model_text, values, words, figure = _native.discover_in_campaign(campaign, model)
    found = json.loads(text)
    return Verdict(
        verdict=found["verdict"],
        probability=found["probability"],
        effects=found["effects"],
        candidates=found["candidates"],
        gap=found["gap"],
        places=found["places"],
        notices=found["notices"],
        model_text=model_text,
        values=dict(values),
        text=words,
        figure=_html.Figure(figure),
        details=found,
    )
