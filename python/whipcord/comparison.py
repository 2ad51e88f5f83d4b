"""Do the models agree with each other, and with what was measured?"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core, models
from ._packages import needed
from .benchmarking import Benchmark, benchmark
from .case import Case
from .errors import InputError, WhipcordError
from .models import ModelLike
from .solution import Solution

__all__ = ["Comparison", "Distances", "Run", "compare"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Distances:
    """An answer beside what was measured in space after the last step."""

    disk: tuple[int | None, ...]
    """Numbers of the disks, from 1, whose centres the markers are; None for other markers."""
    at_base: tuple[bool, ...]
    """Whether each does not move with the robot."""
    measured: Array
    """(k, 3) where each was measured, in m, after the measurement was moved."""
    model: Array
    """(k, 3) where the model has it."""
    rms: float | None
    """RMS distance in m over the markers that are not at the base; None where there are none."""
    motion: tuple[Array, Array] | None
    """The (3,) translation in m and the (4,) quaternion (w, x, y, z) by which the measurement was moved."""

    @classmethod
    def _of(cls, given: tuple[Any, ...]) -> Distances:
        rms, kinds, measured, model, motion = given
        disk, at_base = tuple(disk for disk, _ in kinds), tuple(at_base for _, at_base in kinds)
        moved = None if motion is None else (np.array(motion[0]), np.array(motion[1]))
        return cls(disk, at_base, measured, model, rms, moved)


@dataclass(frozen=True, eq=False)
class Run:
    """One model on a case."""

    model: str
    """Its name."""
    solution: Solution | None
    """Its answer."""
    error: WhipcordError | None
    """Or why it has none."""
    distance: float | None
    """RMS distance in m over the disks, without the base disk, to the first model that has an answer."""
    distance_to_measured: float | None
    """RMS distance in m to the markers that were measured, without those on the base."""
    measured: Distances | InputError | None = None
    """Where they were, moved onto the model where ``registration`` asks for it, or why that cannot be told; None where
    nothing was measured in space."""

    @property
    def unstable(self) -> bool:
        """Whether the robot leaves this shape at the slightest disturbance."""
        return self.solution is not None and self.solution.diagnostics.unstable


class Comparison:
    """A case as each model answers it.

    Examples
    --------
    >>> import whipcord
    >>> case = whipcord.load("examples/table1/case-3.toml")
    >>> comparison = compare(case)
    >>> [run.model for run in comparison][:3]
    ['cosserat', 'cosserat-disks', 'four-bar']
    >>> bool(comparison["cosserat-disks"].distance < 0.004)
    True
    >>> print(compare(case, by=["cosserat", "four-bar"]).benchmark.verdict[2].text)  # doctest: +ELLIPSIS
    four-bar, ...
    """

    case: Case
    """The case."""
    runs: tuple[Run, ...]
    """One for each model."""
    reference: str
    """What the benchmark measures errors against."""

    def __init__(self, case: Case, runs: Sequence[Run], reference: str = "trusted") -> None:
        self.case, self.runs, self.reference = case, tuple(runs), reference

    @cached_property
    def benchmark(self) -> Benchmark:
        """How far each of these models, by its name and with its variants, is from the reference, how long it takes,
        and which to use for what; it is tried when it is first asked for."""
        names = list(dict.fromkeys(run.model for run in self.runs))
        return benchmark(self.case, by=names, reference=self.reference)

    @property
    def solutions(self) -> dict[str, Solution]:
        """The answers by the names of their models."""
        return {run.model: run.solution for run in self.runs if run.solution is not None}

    def __iter__(self) -> Iterator[Run]:
        return iter(self.runs)

    def __len__(self) -> int:
        return len(self.runs)

    def __getitem__(self, model: str) -> Run:
        for run in self.runs:
            if run.model == model:
                return run
        raise KeyError(model)

    def _columns(self) -> dict[str, list[Any]]:
        nowhere = np.full(3, np.nan)
        tips = [nowhere if run.solution is None else run.solution.tip for run in self.runs]
        return {
            "model": [run.model for run in self.runs],
            **{axis: [float(tip[i]) for tip in tips] for i, axis in enumerate("xyz")},
            "distance": [_number(run.distance) for run in self.runs],
            "distance_to_measured": [_number(run.distance_to_measured) for run in self.runs],
            "unstable": [run.unstable for run in self.runs],
            "error": [None if run.error is None else str(run.error) for run in self.runs],
        }

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` with one line for each model; lengths in m, NaN where there is none."""
        return needed("pandas").DataFrame(self._columns()).set_index("model")

    def to_polars(self) -> Any:
        """A ``polars.DataFrame`` with one line for each model; lengths in m, NaN where there is none."""
        return needed("polars").DataFrame(self._columns())

    def plot(self, **options: Any) -> Any:
        """Draws the answers; see :func:`whipcord.plot.compare`."""
        from . import plot

        return plot.compare(*self.solutions.values(), **options)

    def __repr__(self) -> str:
        lines = [f"<Comparison of {self.case.title!r}"]
        for run in self.runs:
            if run.solution is None:
                lines.append(f"  {run.model:<15} {run.error}")
                continue
            x, y, z = (1e3 * run.solution.tip).tolist()
            apart = "" if run.distance is None else f", {1e3 * run.distance:.3f} mm from the first"
            unstable = ", unstable" if run.unstable else ""
            lines.append(f"  {run.model:<15} tip ({x:.2f}, {y:.2f}, {z:.2f}) mm{apart}{unstable}")
        return "\n".join(lines) + ">"


def compare(case: Case, *, by: Sequence[ModelLike] = models.NAMES, reference: str = "trusted") -> Comparison:
    """Solves a case with every model, each driven by what it is driven by.

    A model that does not take the case is a run with its error.

    Parameters
    ----------
    case
        The case.
    by
        The models; all of them by default.
    reference
        What :attr:`Comparison.benchmark` measures errors against, as for :func:`whipcord.benchmark`.

    Raises
    ------
    InputError
        For models that there are not.
    """
    if not isinstance(case, Case):
        raise InputError(f"case must be a Case, but is {case!r}", path="case")
    if isinstance(by, str) or not isinstance(by, Iterable):
        raise InputError(f"by must be a list of models, but is {by!r}", path="by")
    for model in by:
        models.core(model)
    runs: list[Run] = []
    first: Solution | None = None
    for model in by:
        try:
            solution = case.solve(model=model)
        except WhipcordError as error:
            runs.append(Run(_name(model), None, error, None, None))
            continue
        distance = None if first is None else solution.rms_distance(first)
        first = first or solution
        measured = _to_measured(solution)
        rms = measured.rms if isinstance(measured, Distances) else None
        runs.append(Run(_name(model), solution, None, distance, rms, measured))
    return Comparison(case, runs, reference)


def _number(value: float | None) -> float:
    return float("nan") if value is None else value


def _name(model: ModelLike) -> str:
    return model if isinstance(model, str) else models.core(model).kind


def _to_measured(solution: Solution) -> Distances | InputError | None:
    try:
        found = _core.distances(solution.case._setup, solution._answer)
    except InputError as error:
        return error
    return None if found is None else Distances._of(found)
