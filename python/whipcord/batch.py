"""Many answers at once, as arrays."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._commands import whole
from ._packages import needed
from .errors import InputError, SolveError

if TYPE_CHECKING:
    from .case import Case

__all__ = ["Batch", "Gradients"]

Array = npt.NDArray[np.float64]


DIAGNOSTICS = ("iterations", "residual", "stability", "discretization_error", "steps", "stability_lost_at")


class _Kept:
    """What is known of the rows, of a batch that was pickled."""

    ok: npt.NDArray[np.bool_]
    failed: npt.NDArray[np.int64]
    stable: npt.NDArray[np.bool_]
    unstable: npt.NDArray[np.bool_]

    def __init__(self, outcomes: _core.Outcomes | _Kept) -> None:
        self.ok, self.failed = outcomes.ok, outcomes.failed
        self.stable, self.unstable = outcomes.stable, outcomes.unstable
        self._diagnostics = {name: outcomes.diagnostic(name) for name in DIAGNOSTICS}
        self._errors = {row: outcomes.error(row) for row in outcomes.failed.tolist()}

    def diagnostic(self, name: str) -> Array:
        return self._diagnostics[name]

    def error(self, row: int) -> SolveError | InputError | None:
        return self._errors.get(row)

    def __len__(self) -> int:
        return len(self.ok)


class _Rows:
    """How each row of a batch went."""

    _outcomes: _core.Outcomes | _Kept

    def __getstate__(self) -> dict[str, Any]:
        return {**vars(self), "_outcomes": _Kept(self._outcomes)}

    @cached_property
    def ok(self) -> npt.NDArray[np.bool_]:
        """(N,) whether a row has an answer."""
        return self._outcomes.ok

    @property
    def failed(self) -> npt.NDArray[np.int64]:
        """Numbers of the rows without an answer, from 0."""
        return self._outcomes.failed

    def error(self, row: int) -> SolveError | InputError | None:
        """Why a row has no answer; None where it has one.

        Parameters
        ----------
        row
            Number of the row from 0, or from the end where it is negative.
        """
        return self._outcomes.error(range(len(self))[row])

    def raise_for_failed(self) -> None:
        """Raises the error of the first row without an answer, if there is one."""
        failed = self.failed
        if failed.size:
            error = self.error(int(failed[0]))
            assert error is not None
            raise error

    def __len__(self) -> int:
        return len(self._outcomes)


class Batch(_Rows):
    """The answers to a batch. A row without an answer holds NaN in every array: look at :attr:`ok` and
    :meth:`error`. A row whose answer is an unstable equilibrium is ``ok``: look at :attr:`unstable`.

    Examples
    --------
    >>> import whipcord
    >>> case = whipcord.load("examples/table1/case-3.toml")
    >>> batch = case.solve_batch([[2.0], [1e6], [3.0]])
    >>> batch.ok.tolist()
    [True, False, True]
    >>> type(batch.error(1)).__name__
    'SectionFoldsError'
    >>> batch.position[batch.ok].shape
    (2, 10, 3)
    >>> bool(np.isnan(batch.position[1]).all()), int(batch.unstable.sum())
    (True, 0)
    """

    case: Case
    """The case that the rows have in common."""
    model: str
    """Name of the model."""
    arc_length: Array
    """(n,) arc lengths of the stations in m."""
    position: Array
    """(N, n, 3) positions in m; NaN in rows without an answer, as in all arrays."""
    orientation: Array
    """(N, n, 4) quaternions (w, x, y, z)."""
    tension: Array
    """(N, c) tensions of the cables in N; zero from a model that knows no forces."""
    length: Array
    """(N, c) lengths of the cables inside the robot in m."""

    def __init__(
        self, case: Case, model: _core.Model, arrays: tuple[Array, Array, Array, Array, _core.Outcomes]
    ) -> None:
        self.case, self.model = case, model.kind
        self.arc_length = case._setup.stations(model)
        self.position, self.orientation, self.tension, self.length, self._outcomes = arrays

    @cached_property
    def stable(self) -> npt.NDArray[np.bool_]:
        """(N,) whether a row has an answer that is known to be a stable equilibrium. Rows that are neither
        ``stable`` nor ``unstable`` have no answer, or a model or load for which stability is not known."""
        return self._outcomes.stable

    @cached_property
    def unstable(self) -> npt.NDArray[np.bool_]:
        """(N,) whether a row has an answer that is known to be an unstable equilibrium, which the robot leaves at
        the slightest disturbance. Such a row is ``ok``: the solver has converged."""
        return self._outcomes.unstable

    @property
    def reasons(self) -> list[str | None]:
        """For each row why it has no answer, in words; None where it has one."""
        words: list[str | None] = [None] * len(self)
        for row in self.failed.tolist():
            words[row] = str(self.error(row))
        return words

    @property
    def tip(self) -> Array:
        """(N, 3) positions of the last station in m: of the tip, where the stations reach it."""
        tip: Array = self.position[:, -1]
        return tip

    def diagnostic(self, name: str) -> Array:
        """(N,) one diagnostic of every row: ``iterations``, ``residual``, ``stability``,
        ``discretization_error``, ``steps`` or ``stability_lost_at``; NaN where there is none.

        Parameters
        ----------
        name
            Which of them.
        """
        if name not in DIAGNOSTICS:
            message = f"there is no diagnostic `{name}`: choose {', '.join(DIAGNOSTICS)}"
            raise InputError(message, path="name")
        return self._outcomes.diagnostic(name)

    def to_xarray(self) -> Any:
        """An ``xarray.Dataset`` with the dimensions row, station and cable."""
        from .export import batch_to_xarray

        return batch_to_xarray(self)

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` with one line for each station of each row: its number, whether it is ``ok`` and
        ``unstable``, why it has no answer, the frame, tensions and lengths; NaN where there is no answer."""
        from .export import batch_columns, to_pandas

        return to_pandas(batch_columns(self))

    def to_polars(self) -> Any:
        """A ``polars.DataFrame`` with one line for each station of each row."""
        from .export import batch_columns, to_polars

        return to_polars(batch_columns(self))

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes one line for each station of each row as CSV, with the columns of :meth:`to_pandas`.

        Parameters
        ----------
        path
            The file, which is replaced if it exists.
        """
        from .export import batch_columns, to_csv

        to_csv(batch_columns(self), path)

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Writes one line for each station of each row as Parquet (needs the package pyarrow).

        Parameters
        ----------
        path
            The file, which is replaced if it exists.
        """
        from .export import batch_columns, to_parquet

        to_parquet(batch_columns(self), path)

    def __repr__(self) -> str:
        rows, stations, _ = self.position.shape
        unstable = int(self.unstable.sum())
        left = f", {unstable} unstable" if unstable else ""
        return f"<Batch of {rows} rows by {self.model}: {stations} stations, {len(self.failed)} failed{left}>"


class Gradients(_Rows):
    """Gradients of one scalar for each row; zero in rows without an answer, so that a sum over rows leaves them out."""

    commands: Array
    """(N, c) by the tension or shortening of each cable, or (N, m) by the command of each motor."""
    parameters: Array
    """(N, p) by each parameter that was asked for."""

    def __init__(self, commands: Array, parameters: Array, outcomes: _core.Outcomes) -> None:
        self.commands, self.parameters, self._outcomes = commands, parameters, outcomes

    def __repr__(self) -> str:
        return f"<Gradients of {len(self)} rows: {len(self.failed)} failed>"


def numbers(values: npt.ArrayLike, name: str, shape: str, dimensions: int) -> Array:
    try:
        array = np.asarray(values)
        if array.dtype.kind not in "fiu":
            raise ValueError(f"numbers of the type {array.dtype}")
        array = np.ascontiguousarray(array, dtype=np.float64)
    except (TypeError, ValueError) as error:
        message = f"{name} must be an array of numbers of the shape {shape}, but is {error}"
        raise InputError(message, path=name) from None
    if array.ndim != dimensions:
        message = f"{name} must have the shape {shape}, but has {array.shape}"
        raise InputError(message, path=name)
    return array


def _rows(
    case: Case,
    tension: npt.ArrayLike | None,
    shortening: npt.ArrayLike | None,
    motors: npt.ArrayLike | None,
) -> tuple[Array, str]:
    """The commands of the rows, and what they are."""
    all_kinds = {"tension": tension, "shortening": shortening, "motors": motors}
    given = {name: values for name, values in all_kinds.items() if values is not None}
    if not given:
        raise InputError("give tensions, shortenings or commands of motors", path="tension")
    if len(given) > 1:
        first, second, *_ = given
        message = (
            f"{first} and {second} are both given, and a batch is driven by one of them: "
            f"leave out {second} to drive by {first}, or {first} to drive by {second}"
        )
        raise InputError(message, path=second)
    ((name, values),) = given.items()
    driven, kind = (case.robot.motors, "motor") if name == "motors" else (case.robot.cables, "cable")
    shape = f"(N, {len(driven)}), one column for each {kind}"
    array = numbers(values, name, shape, 2)
    if array.shape[1] != len(driven):
        names = ", ".join(each.name for each in driven)
        message = f"{name} must have the shape {shape}{f' ({names})' if names else ''}, but has {array.shape}"
        raise InputError(message, path=name)
    return array, name


@contextmanager
def _bar(rows: int, show: bool) -> Iterator[Callable[[int], None] | None]:
    if not show:
        yield None
        return
    with needed("tqdm.auto").tqdm(total=rows, unit=" shapes", unit_scale=True) as bar:

        def update(done: int) -> None:
            bar.update(done - bar.n)

        yield update
        bar.update(rows - bar.n)


def _threads(threads: int | None) -> int | None:
    if threads is None:
        return None
    count = whole(threads, "threads")
    if count < 1:
        raise InputError(f"threads must be at least 1, but is {threads}", path="threads")
    return count


def solve_batch(
    case: Case,
    model: _core.Model,
    tension: npt.ArrayLike | None,
    shortening: npt.ArrayLike | None,
    motors: npt.ArrayLike | None,
    threads: int | None,
    path: bool,
    progress: bool,
) -> Batch:
    """See :meth:`whipcord.Case.solve_batch`."""
    values, driven_by = _rows(case, tension, shortening, motors)
    with _bar(len(values), progress) as update:
        arrays = _core.solve_batch(case._setup, model, values, driven_by, _threads(threads), path, update)
    return Batch(case, model, arrays)


def solve_setups(
    setups: list[_core.Setup], model: _core.Model, threads: int | None, progress: bool
) -> list[_core.Solution | SolveError | InputError]:
    """See :func:`whipcord.solve_cases`."""
    with _bar(len(setups), progress) as update:
        return _core.solve_cases(setups, model, _threads(threads), update)


def pull_back_batch(
    case: Case,
    model: _core.Model,
    tension: npt.ArrayLike | None,
    shortening: npt.ArrayLike | None,
    motors: npt.ArrayLike | None,
    parameters: list[str],
    weights: tuple[npt.ArrayLike | None, ...],
    threads: int | None,
    progress: bool,
) -> Gradients:
    """See :meth:`whipcord.Case.pull_back_batch`."""
    values, driven_by = _rows(case, tension, shortening, motors)
    rows, cables = len(values), len(case.robot.cables)
    stations = len(case._setup.stations(model))
    shapes = [
        ("position", (rows, stations, 3)),
        ("rotation", (rows, stations, 3)),
        ("cable_tension", (rows, cables)),
        ("cable_length", (rows, cables)),
    ]
    given: list[Array | None] = []
    for (name, shape), weight in zip(shapes, weights):
        if weight is None:
            given.append(None)
            continue
        array = numbers(weight, name, str(shape), len(shape))
        if array.shape != shape:
            message = f"{name} must have the shape {shape}, but has {array.shape}"
            raise InputError(message, path=name)
        given.append(array)
    with _bar(rows, progress) as update:
        commands, by_parameters, outcomes = _core.pull_back_batch(
            case._setup, model, values, driven_by, parameters, _threads(threads), update, *given
        )
    return Gradients(commands, by_parameters, outcomes)
