"""How far models are from a table of measurements, without a fit."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from . import _core, models
from ._commands import whole
from ._packages import needed
from .case import Case
from .errors import InputError
from .models import ModelLike
from .warning import WhipcordWarning

__all__ = ["CaseScore", "Measures", "ModelScore", "RowScore", "Score", "score"]


@dataclass(frozen=True)
class Measures:
    """What sums up errors."""

    rms: float
    """Root mean square over all markers that are not on the base."""
    median: float
    """Median over the rows."""
    percentile_95: float
    """The least error that 95 % of the rows do not exceed."""
    worst: float
    """The greatest error of a row."""


@dataclass(frozen=True)
class RowScore:
    """A model on one row."""

    row: int
    """The row, from 1."""
    line: int | None
    """Its line in the table of commands."""
    key: str | None
    """Its key there."""
    status: str
    """``"solved"``, ``"least-squares"`` (cable lengths that contradict each other), ``"unstable"``, ``"failed"`` or ``"not compared"``."""
    down_weighted: bool
    """Whether the row counts less in the rigid motion of the measurement, as it is far off."""
    reason: str | None
    """Why there is no answer."""
    error: float | None
    """Root mean square distance in m over the markers of the row."""
    angle: float | None
    """Angle in rad between the measured and the computed orientation of a tracked body."""
    length_misses: Sequence[Mapping[str, Any]]
    """Cables whose lengths contradict each other, each with its name, ``cable``, and how much longer than commanded it is in m, ``excess``."""


@dataclass(frozen=True)
class ModelScore:
    """A model on rows of measurements."""

    model: str
    """The model."""
    rows: int
    """Rows in which something was measured."""
    compared: int
    """Rows that are compared."""
    refused: int
    """Rows of robots that the model does not take."""
    failed: int
    """Rows without an answer."""
    unstable: int
    """Rows whose answer is unstable."""
    over_determined: int
    """Rows whose cable lengths contradict each other, which are met in the least-squares sense."""
    down_weighted: int
    """Rows that count less in the rigid motion of the measurement, as they are far off, like jumps of a tracker."""
    greatest_miss: Mapping[str, Any] | None
    """The cable that misses its length most in these rows: file, row (from 1), cable, and excess in m."""
    markers: int
    """Markers that are compared."""
    distance: Measures | None
    """Distances in m."""
    relative: Measures | None
    """Distances as parts of the length of the backbone."""
    angle: Measures | None
    """Angles in rad."""
    worst_row: Mapping[str, Any] | None
    """File, row (from 1), line, key and error in m of the worst row."""
    reasons: tuple[tuple[str, int], ...]
    """Why rows have no answer, and how many of them, the most frequent first."""
    motion: Mapping[str, Any] | None = None
    """Of one case: the position in m and the orientation (w, x, y, z) of the rigid motion that brings the measurement onto the
    model, where ``registration`` asks for it."""
    rows_scored: tuple[RowScore, ...] = ()
    """Of one case: all rows."""


@dataclass(frozen=True)
class CaseScore:
    """All models on one case."""

    file: str
    """Its file, or its number where it has none."""
    title: str
    """Its title."""
    length: float
    """Length of the backbone in m."""
    rows: int
    """Rows in which something was measured."""
    each: str
    """``"independent"``, or ``"in order"`` where rows are steps."""
    registration: str | None
    """How the measurement was moved."""
    models: tuple[ModelScore, ...]
    """One for each model."""


@dataclass(frozen=True, eq=False)
class Score:
    """Models on all rows of all cases."""

    models: tuple[ModelScore, ...]
    """Each over all cases."""
    cases: tuple[CaseScore, ...]
    """All models on each case."""
    warnings: tuple[WhipcordWarning, ...]
    """Such as that of a single cable whose zero or angle explains much of the error of the best model."""
    _scored: _core.Scored = field(repr=False)

    def __iter__(self) -> Iterator[ModelScore]:
        return iter(self.models)

    def __len__(self) -> int:
        return len(self.models)

    def __getitem__(self, model: str) -> ModelScore:
        """A model over all cases."""
        for of in self.models:
            if of.model == model:
                return of
        raise KeyError(model)

    @property
    def best(self) -> ModelScore | None:
        """The model with the least root mean square error; None where no row is compared."""
        compared = [of for of in self.models if of.distance is not None]
        return min(compared, key=lambda of: of.distance.rms if of.distance else 0.0, default=None)

    def to_json(self, *, rows: bool = False) -> str:
        """What ``whipcord score --json`` prints.

        Parameters
        ----------
        rows
            Whether with every row, as ``--rows``.
        """
        return self._scored.json(bool(rows))

    def report(self, folder: str | os.PathLike[str], *, figures: bool = True) -> str:
        """Writes a report in HTML with figures and CSV to a folder, as ``whipcord score --out``; returns its path.

        Parameters
        ----------
        folder
            The folder, which is made if it is missing.
        figures
            Whether with pictures.
        """
        return str(self._scored.report(os.fspath(folder), bool(figures)))

    def _columns(self) -> dict[str, list[Any]]:
        rows = [
            (case.file, of.model, row) for case in self.cases for of in case.models for row in of.rows_scored
        ]
        names = ("row", "line", "key", "status", "error", "angle", "reason")
        columns: dict[str, list[Any]] = {"file": [file for file, _, _ in rows]}
        columns["model"] = [model for _, model, _ in rows]
        return columns | {name: [getattr(row, name) for _, _, row in rows] for name in names}

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` with one line for each row of each model; errors in m, angles in rad."""
        return needed("pandas").DataFrame(self._columns())

    def to_polars(self) -> Any:
        """A ``polars.DataFrame`` with one line for each row of each model; errors in m, angles in rad."""
        return needed("polars").DataFrame(self._columns())

    def __repr__(self) -> str:
        lines = [f"<Score of {sum(case.rows for case in self.cases)} rows"]
        for of in self.models:
            if of.distance is None:
                reason = of.reasons[0][0] if of.reasons else "nothing is compared"
                lines.append(f"  {of.model:<15} {reason}")
                continue
            millimetres = [1e3 * value for value in (of.distance.rms, of.distance.median, of.distance.worst)]
            rms, median, worst = (f"{value:.3f}" for value in millimetres)
            left = f", {of.failed} failed" if of.failed else ""
            lines.append(f"  {of.model:<15} RMS {rms} mm, median {median} mm, worst {worst} mm{left}")
        return "\n".join(lines) + ">"


def score(
    cases: Case | Sequence[Case],
    *,
    by: Sequence[ModelLike] = models.NAMES,
    threads: int | None = None,
    timeout: float | None = None,
) -> Score:
    """How far models are from what was measured in all rows of one or several cases, without a fit.

    Rows of a table of commands are steps of a case; those of one that places its measurement by ``registration`` are all moved by one
    rigid motion.

    Parameters
    ----------
    cases
        Cases, each with what was measured in space.
    by
        The models; all of them by default. A model that does not take a case says why.
    threads
        Threads that solve; as many as there are processors by default. The results are the same for any number.
    timeout
        Seconds after which all of it is ended.

    Raises
    ------
    InputError
        For cases without measurements in space.
    WhipcordTimeout
        Where the time limit was reached.

    Examples
    --------
    >>> import whipcord
    >>> case = whipcord.load("examples/motor-log/arm.toml")
    >>> found = score(case, by=["cosserat-disks", "constant-curvature"])
    >>> found["cosserat-disks"].compared
    62
    >>> found.best.model
    'cosserat-disks'
    """
    listed = [cases] if isinstance(cases, Case) else list(cases)
    for i, case in enumerate(listed):
        if not isinstance(case, Case):
            raise InputError(f"cases[{i}] must be a Case, but is {case!r}", path=f"cases[{i}]")
    if isinstance(by, str) or not isinstance(by, Iterable):
        raise InputError(f"by must be a list of models, but is {by!r}", path="by")
    chosen = [models.core(model, timeout=timeout) for model in by]
    workers = None if threads is None else whole(threads, "threads")
    if workers is not None and workers < 1:
        raise InputError(f"threads must be at least 1, but is {threads}", path="threads")
    scored = _core.score([case._setup for case in listed], chosen, workers)
    said = json.loads(scored.json(True))
    return Score(
        tuple(_of_model(one) for one in said["models"]),
        tuple(
            CaseScore(**{**one, "models": tuple(_of_model(of) for of in one["models"])})
            for one in said["files"]
        ),
        tuple(WhipcordWarning(one["code"], one["message"], one["help"]) for one in said["warnings"]),
        scored,
    )


def _of_model(said: dict[str, Any]) -> ModelScore:
    measures = {
        name: None if said[name] is None else Measures(**said[name]) for name in ("distance", "relative", "angle")
    }
    reasons = tuple((one["reason"], one["rows"]) for one in said["reasons"])
    rows = tuple(RowScore(**row) for row in said.get("rows_scored", ()))
    return ModelScore(**{**said, **measures, "reasons": reasons, "rows_scored": rows})
