"""Data sets of many shapes of a robot."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from .errors import InputError

__all__ = ["Sweep"]

Vary = Mapping[str, "str | Sequence[float | str]"]


@dataclass(frozen=True, eq=False, repr=False)
class Sweep:
    """A data set on disk, or a shard of one: a manifest, and parts as Parquet files.

    Examples
    --------
    >>> import tempfile, whipcord
    >>> case = whipcord.load("examples/three-cable-segment.toml")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     made = case.sweep({"cables.a.tension": "0 N:3 N:4"}, folder)
    ...     made.rows, made.failed, made.manifest["rows"], [path.name for path in made.files]
    (4, 0, 4, ['part-000000.parquet'])
    """

    folder: Path
    """The folder of the data set."""
    rows: int
    """Rows of this shard."""
    parts: int
    """Parts of this shard."""
    kept_parts: int
    """Parts that were there already."""
    failed: int
    """New rows without an answer."""
    unstable: int
    """New rows whose equilibrium is unstable, where stability was asked for."""
    first_failure: tuple[int, str] | None
    """Number of the first of the new rows without an answer, and why."""
    all_rows: int
    """Rows of the whole data set."""
    all_parts: int
    """Parts of the whole data set."""
    columns: tuple[str, ...]
    """Names of the columns."""

    @property
    def files(self) -> list[Path]:
        """All parts that are in the folder."""
        return sorted(self.folder.glob("part-*.parquet"))

    @property
    def manifest(self) -> dict[str, Any]:
        """What the data set is of, and how it was made."""
        found: dict[str, Any] = json.loads((self.folder / "manifest.json").read_text(encoding="utf-8"))
        return found

    def __repr__(self) -> str:
        return f"<Sweep of {self.rows} rows in {self.parts} parts: {self.folder}>"


def asked(
    vary: Vary | None,
    table: Mapping[str, npt.ArrayLike] | None,
    samples: int | None,
    sampling: str,
    seed: int,
    outputs: str | Sequence[str],
    rows_per_part: int | None,
) -> dict[str, Any]:
    """What the extension module is asked."""
    if vary is not None and table is not None:
        raise InputError("give vary or table, not both", path="table")
    if table is not None and samples is not None:
        raise InputError("a table has its own rows: leave samples out", path="samples")
    for name, value, least in (("samples", samples, 1), ("seed", seed, 0), ("rows_per_part", rows_per_part, 1)):
        if value is not None and not least <= value < 2**64:
            raise InputError(f"{name} must be a whole number from {least}, but is {value}", path=name)
    axes = []
    for path, values in (vary or {}).items():
        text = values if isinstance(values, str) else ",".join(str(value) for value in values)
        axes.append(f"{path}={text}")
    return {
        "vary": axes,
        "table": None if table is None else columns(table),
        "samples": samples,
        "sampling": sampling,
        "seed": seed,
        "outputs": [outputs] if isinstance(outputs, str) else list(outputs),
        "rows_per_part": rows_per_part,
    }


def columns(table: Mapping[str, npt.ArrayLike]) -> tuple[list[tuple[str, str]], list[float]]:
    """Paths and units of the columns of a table, and its values row by row."""
    names = []
    for name in table:
        path, _, unit = name.partition("[")
        names.append((path.strip(), unit.strip().rstrip("]").strip()))
    arrays = [np.atleast_1d(np.asarray(values, dtype=np.float64)) for values in table.values()]
    if any(array.ndim != 1 or array.shape != arrays[0].shape for array in arrays):
        raise InputError("the columns of the table must be lists of numbers of one length", path="table")
    rows = np.column_stack(arrays) if arrays else np.zeros((0, 0))
    if not np.isfinite(rows).all():
        raise InputError("the table has a value that is not finite", path="table")
    return names, rows.ravel().tolist()


def sweep(
    setup: _core.Setup,
    model: _core.Model,
    question: dict[str, Any],
    out: str | os.PathLike[str],
    shard: tuple[int, int],
    resume: bool,
) -> Sweep:
    """Makes the data set."""
    number, count = shard
    if not 0 <= number < count:
        raise InputError(f"there is no shard {number} of {count}: they count from 0", path="shard")
    values = _core.sweep(setup, model, question, os.fspath(out), (number, count), resume)
    names = tuple(values.pop("columns"))
    return Sweep(folder=Path(out), columns=names, **values)
