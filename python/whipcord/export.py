"""Answers as tables of other packages, by their own constructors."""

from __future__ import annotations

import csv
import io
import os
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ._files import write
from ._packages import needed

if TYPE_CHECKING:
    from .batch import Batch
    from .solution import Solution

Columns = dict[str, npt.NDArray[Any]]


def _frames(position: npt.NDArray[Any], orientation: npt.NDArray[Any]) -> Columns:
    names = ("x", "y", "z", "qw", "qx", "qy", "qz")
    values = np.concatenate([position.reshape(-1, 3), orientation.reshape(-1, 4)], axis=1)
    return {name: values[:, i].copy() for i, name in enumerate(names)}


def solution_columns(solution: Solution) -> Columns:
    """One line for each station; SI, as the CSV of the command line."""
    frames = _frames(solution.position, solution.orientation)
    return {"arc_length": solution.arc_length, **frames}


def batch_columns(batch: Batch) -> Columns:
    """One line for each station of each row, with its number, whether it has an answer, whether that is unstable, why
    there is none (an empty text where there is), and tensions."""
    rows, stations, _ = batch.position.shape
    columns: Columns = {
        "row": np.repeat(np.arange(rows), stations),
        "ok": np.repeat(batch.ok, stations),
        "unstable": np.repeat(batch.unstable, stations),
        "error": np.repeat(_reasons(batch), stations),
        "arc_length": np.tile(batch.arc_length, rows),
    }
    columns.update(_frames(batch.position, batch.orientation))
    for i, cable in enumerate(batch.case.robot.cables):
        columns[f"tension:{cable.name}"] = np.repeat(batch.tension[:, i], stations)
        columns[f"length:{cable.name}"] = np.repeat(batch.length[:, i], stations)
    return columns


def _reasons(batch: Batch) -> npt.NDArray[np.object_]:
    return np.array([reason or "" for reason in batch.reasons], dtype=np.object_)


def to_pandas(columns: Columns) -> Any:
    """A ``pandas.DataFrame``."""
    return needed("pandas").DataFrame(columns)


def to_polars(columns: Columns) -> Any:
    """A ``polars.DataFrame``."""
    # A column of Python objects would be one of texts only as a list.
    plain = {name: of.tolist() if of.dtype == np.object_ else of for name, of in columns.items()}
    return needed("polars").DataFrame(plain)


def to_arrow(columns: Columns) -> Any:
    """A ``pyarrow.Table``."""
    return needed("pyarrow").table(columns)


def to_csv(columns: Columns, path: str | os.PathLike[str]) -> None:
    """Writes a CSV file; its numbers are read back to the last bit."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(column.tolist() for column in columns.values())))
    write(path, text.getvalue())


def to_parquet(columns: Columns, path: str | os.PathLike[str]) -> None:
    """Writes a Parquet file."""
    needed("pyarrow.parquet").write_table(to_arrow(columns), os.fspath(path))


UNITS = {"position": "m", "orientation": "1", "tension": "N", "length": "m", "arc_length": "m"}
AXES = {"axis": ["x", "y", "z"], "component": ["w", "x", "y", "z"]}


def _with_units(variables: dict[str, Any], coords: dict[str, Any], attrs: dict[str, str]) -> Any:
    data = needed("xarray").Dataset(variables, coords=coords, attrs=attrs)
    for name, unit in UNITS.items():
        data[name].attrs["units"] = unit
    return data


def solution_to_xarray(solution: Solution) -> Any:
    """An ``xarray.Dataset``."""
    cables = [cable.name for cable in solution.cables]
    return _with_units(
        {
            "position": (("station", "axis"), solution.position),
            "orientation": (("station", "component"), solution.orientation),
            "tension": ("cable", solution.tension),
            "length": ("cable", solution.length),
        },
        coords={"arc_length": ("station", solution.arc_length), "cable": cables, **AXES},
        attrs={"model": solution.model, "title": solution.case.title},
    )


def batch_to_xarray(batch: Batch) -> Any:
    """An ``xarray.Dataset``."""
    cables = [cable.name for cable in batch.case.robot.cables]
    return _with_units(
        {
            "position": (("row", "station", "axis"), batch.position),
            "orientation": (("row", "station", "component"), batch.orientation),
            "tension": (("row", "cable"), batch.tension),
            "length": (("row", "cable"), batch.length),
            "ok": ("row", batch.ok),
            "unstable": ("row", batch.unstable),
            "error": ("row", _reasons(batch)),
        },
        coords={"arc_length": ("station", batch.arc_length), "cable": cables, **AXES},
        attrs={"model": batch.model, "title": batch.case.title},
    )
