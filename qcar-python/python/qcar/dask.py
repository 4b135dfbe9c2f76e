"""Rides of a large design on a cluster of Dask workers, with the same bits as on one machine.

A design is divided into parts, each of which is a task. If a worker is lost, another repeats its tasks. Workers need the
package ``qcar``. Each ride uses one thread, and a worker uses all cores; set ``RAYON_NUM_THREADS`` if several workers share a
machine.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ._ensemble import Design, Vehicle, _cut, columns
from ._ensemble import ride_metrics as here
from ._model import Model
from ._named import Array
from ._ride import _facts

if TYPE_CHECKING:
    from distributed import Client, Future

#: How often a task is repeated whose worker fails.
RETRIES = 5


def ride_metrics(
    client: Client,
    model: Model,
    design: Design,
    *,
    vehicle: Vehicle,
    rows: int = 2000,
    out: str | os.PathLike[str] | None = None,
    **options: Any,
) -> dict[str, Array] | list[Path]:
    """`qcar.ride_metrics` on a cluster.

    Parameters
    ----------
    client
        A client of ``distributed``.
    model, design, vehicle, options
        As in `qcar.ride_metrics`.
    rows
        Number of rows of the design in one task.
    out
        A folder that all workers can reach. Each part is written there as a Parquet file, which appears only when complete; parts that
        exist are not computed again, so an interrupted run can be continued. This needs ``pyarrow``.

    Returns
    -------
    columns or files
        The columns, or with `out` the files of all parts in the order of the design.
    """
    gather: Any = client.gather
    parts = gather(submit(client, model, design, vehicle=vehicle, rows=rows, out=out, **options))
    if out is not None:
        return [Path(part) for part in parts]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def submit(
    client: Client,
    model: Model,
    design: Design,
    *,
    vehicle: Vehicle,
    rows: int = 2000,
    out: str | os.PathLike[str] | None = None,
    **options: Any,
) -> Sequence[Future[Any]]:
    """Submits the tasks of `ride_metrics`: a future for each part, in the order of the design."""
    table = columns(design)
    count = len(next(iter(table.values())))
    facts = _facts(vehicle, model)
    folder = None if out is None else os.path.abspath(out)
    return [
        client.submit(
            _part, model, _cut(table, begin, begin + rows), facts, options, folder, number,
            pure=False, retries=RETRIES, key=f"qcar-rides-{number}-{os.urandom(4).hex()}",
        )
        for number, begin in enumerate(range(0, count, rows))
    ]  # fmt: skip


def _part(
    model: Model, rows: Mapping[str, Array], facts: dict[str, float], options: dict[str, Any], out: str | None, number: int
) -> dict[str, Array] | str:
    """Computes one part of a design on a worker: its columns, or the file to which they are written."""
    if out is None:
        return here(model, rows, vehicle=facts, **options)
    file = Path(out) / f"part-{number:06}.parquet"
    if not file.exists():
        _write(file, here(model, rows, vehicle=facts, **options))
    return str(file)


def _write(file: Path, table: Mapping[str, Array]) -> None:
    """Writes under a temporary name first, so that a file with its final name is complete."""
    import pyarrow
    import pyarrow.parquet

    file.parent.mkdir(parents=True, exist_ok=True)
    unfinished = file.with_name(f"{file.name}.{os.getpid()}.part")
    pyarrow.parquet.write_table(pyarrow.table(dict(table)), unfinished)
    os.replace(unfinished, file)
