"""What a model lacks."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from typing import Any

from . import _html, _native


@dataclass(frozen=True, eq=False)
class Verdict:
    """What a search has found, as docs/json.md describes it."""

    #: ``none``: noise explains the residuals; ``found``: `effects` explain it; ``class``: one of several; ``unknown``.
    verdict: str
    probability: float | None
    #: Each with ``name``, ``at``, ``form``, ``parameters``, ``stderr``, ``units`` and ``evidence``.
    effects: list[dict[str, Any]]
    #: The most probable sets of effects.
    candidates: list[dict[str, Any]] = field(repr=False)
    #: ``fit`` and ``held_out``: residuals over their uncertainty, ``before`` and ``after``; 1 is noise.
    gap: dict[str, dict[str, float]]
    #: Where something would explain what the model leaves.
    places: list[dict[str, Any]] = field(repr=False)
    notices: list[str]
    #: The text of the model with the effects in it, for ``qcar.Model.from_text``; ``None`` where none was found.
    model_text: str | None = field(repr=False)
    #: The values of all parameters with all that was found, SI.
    values: dict[str, float] = field(repr=False)
    #: The answer in words.
    text: str = field(repr=False)
    #: What is left of each sensor over frequency, before and after.
    figure: _html.Figure = field(repr=False)
    #: All of it.
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
    """Find the effect that a campaign shows and its model lacks.

    Fits the model to the runs with the role ``fit``, tries the effects of the catalogue wherever they apply, and judges them on the
    runs that are ``held_out``.

    Parameters
    ----------
    campaign
        Folder with a campaign.toml.
    model
        Name or path, in place of the campaign's model.

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
