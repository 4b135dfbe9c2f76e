"""Metrics of a ride for each row of a design, without the records of the rides."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _native
from ._model import Model
from ._named import Array
from ._ride import Ride, ride

#: Number of rides whose records are in memory at the same time.
AT_ONCE = 256

#: Columns that a design may have in addition to the parameters of the model.
DRIVEN = ("speed", "height")

Design = Mapping[str, npt.ArrayLike]
Vehicle = Mapping[str, float] | str | os.PathLike[str]


def columns(design: Design) -> dict[str, Array]:
    """A design whose columns all have one length; a number applies to all rows.

    Raises
    ------
    qcar.ParameterError
        Columns of different lengths, or no columns.
    """
    try:
        arrays = np.broadcast_arrays(*(np.asarray(own, dtype=float) for own in design.values()))
    except (TypeError, ValueError) as error:
        shapes = ", ".join(f"{name} {np.shape(own)}" for name, own in design.items())
        raise _native.ParameterError(f"columns of a design have one length, found {shapes}: {error}") from None
    if not arrays or arrays[0].ndim != 1:
        raise _native.ParameterError("a design has columns of one length, one row for each ride")
    return {name: np.array(own) for name, own in zip(design, arrays)}


def ride_metrics(model: Model, design: Design, *, vehicle: Vehicle, **options: Any) -> dict[str, Array]:
    """Simulate one ride for each row of a design.

    Parameters
    ----------
    model
        A model whose tyre rolls.
    design
        Columns by name: parameters of the model, ``speed`` (m/s) and ``height`` (of the cleat, m); a number applies to all rows.
    vehicle, options
        As in `qcar.ride`; `speed` and `height` may be given here if they are the same for all.

    Returns
    -------
    columns
        Each (rows,), SI: the columns of the design; for each output ``peak_<output>`` and ``after_shake_<output>``;
        ``static_deflection``; ``lift_offs``, how often the tyre has left the ground. A row has the same bits as a single ride.
    """
    table = columns(design)
    rows = len(next(iter(table.values())))
    parts = [_metrics(model, _cut(table, at, at + AT_ONCE), vehicle, options) for at in range(0, rows, AT_ONCE)]
    return {**table, **{name: np.concatenate([part[name] for part in parts]) for name in (parts[0] if parts else {})}}


def _cut(table: Mapping[str, Array], begin: int, end: int) -> dict[str, Array]:
    return {name: column[begin:end] for name, column in table.items()}


def _metrics(model: Model, rows: dict[str, Array], vehicle: Vehicle, options: dict[str, Any]) -> dict[str, Array]:
    driven = {name: rows[name] for name in DRIVEN if name in rows}
    params = {name: column for name, column in rows.items() if name not in DRIVEN}
    done: Ride = ride(model, params, vehicle=vehicle, **{**options, **driven})
    return {
        **{f"peak_{name}": value for name, value in done.peak.items()},
        **{f"after_shake_{name}": value for name, value in done.after_shake.items()},
        "static_deflection": done.static_deflection,
        "lift_offs": np.array([len(own) for own in done.lift_offs], dtype=float),
    }
