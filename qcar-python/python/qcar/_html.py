"""Results as HTML, for notebooks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from html import escape
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._model import Model


@dataclass(frozen=True)
class Figure:
    """A figure that a notebook shows as the value of a cell."""

    svg: str = field(repr=False)

    def _repr_svg_(self) -> str:
        return self.svg


def number(value: float | None, digits: int = 5) -> str:
    """A number with few digits; an empty text for ``None``."""
    return "" if value is None else f"{value:.{digits}g}"


def table(headings: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """A table whose cells are text or numbers."""
    head = "".join(f"<th>{escape(heading)}</th>" for heading in headings)
    body = "".join("<tr>" + "".join(map(_cell, row)) + "</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cell(content: Any) -> str:
    if content is None or isinstance(content, (int, float)):
        return f'<td style="text-align:right">{number(content)}</td>'
    return f'<td style="text-align:left">{escape(str(content))}</td>'


def titled(title: str, sentence: str, *parts: str) -> str:
    """A heading, a sentence, and a body."""
    return f"<div><b>{escape(title)}</b> {escape(sentence)}{''.join(parts)}</div>"


def model(of: Model) -> str:
    """A model's parameters, states, inputs and outputs."""
    rows = (
        (own.name, _default(own.default, own.same_as), own.unit, _range(own.range), own.doc) for own in of.parameters
    )
    parameters = table(["parameter", "default", "unit", "range", "what it is"], rows)
    kinds = {
        "states": [own.name for own in of.states],
        "inputs": [own.name for own in of.inputs],
        "outputs": [own.name for own in of.outputs],
    }
    lists = table(["", "names"], ((kind, ", ".join(names)) for kind, names in kinds.items()))
    return titled(of.name, of.doc, parameters, lists)


def _default(value: float | None, same_as: str | None) -> float | str | None:
    return f"as {same_as}" if same_as else value


def _range(of: tuple[float, float] | None) -> str:
    return f"{number(of[0])} to {number(of[1])}" if of else ""
