"""Do the models agree with each other, and with what was measured?"""

from __future__ import annotations

import time
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
from .errors import InputError, WhipcordError, WhipcordTimeout
from .models import ModelLike
from .solution import Solution
from .warning import WhipcordWarning, distinct, listed, tell

__all__ = ["Comparison", "Distances", "Run", "compare"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Distances:
    """The answers to all steps beside what was measured in space."""

    disk: tuple[int | None, ...]
    """Numbers of the disks, from 1, whose centres the markers are; None for other markers."""
    at_base: tuple[bool, ...]
    """Whether each does not move with the robot."""
    step: tuple[int, ...]
    """The step in which each was measured, from 1."""
    arc_length: Array
    """(k,) where on the backbone each is, in m."""
    measured: Array
    """(k, 3) where each was measured, in m, after the measurement was moved."""
    model: Array
    """(k, 3) where the model has it."""
    rms: float | None
    """RMS distance in m over the markers of all steps that are not at the base; None where there are none."""
    motion: tuple[Array, Array] | None
    """The (3,) translation in m and the (4,) quaternion (w, x, y, z) by which the measurement was moved."""
    down_weighted: tuple[int, ...]
    """Places in these arrays of the markers that count less in this motion, as they are far off, like jumps of a tracker."""

    @classmethod
    def _of(cls, given: tuple[Any, ...]) -> Distances:
        rms, kinds, measured, model, motion, lowered = given
        disk, at_base, step, places = zip(*kinds)
        moved = None if motion is None else (np.array(motion[0]), np.array(motion[1]))
        return cls(disk, at_base, step, np.array(places), measured, model, rms, moved, tuple(lowered))

    @property
    def steps(self) -> int:
        """In how many steps a marker was measured that is not at the base."""
        return len({step for step, at_base in zip(self.step, self.at_base) if not at_base})

    @property
    def points(self) -> int:
        """Over how many markers the RMS distance is, each counted once in each step."""
        return sum(not at_base for at_base in self.at_base)


@dataclass(frozen=True, eq=False)
class Run:
    """One model on a case."""

    model: str
    """Its name."""
    solution: Solution | None
    """Its answer, after the last step."""
    error: WhipcordError | None
    """Or why it has none."""
    distance: float | None
    """RMS distance in m over the disks, without the base disk, and all steps to the first model that has an answer."""
    distance_to_measured: float | None
    """RMS distance in m to the markers that were measured in all steps, without those on the base."""
    measured: Distances | InputError | None = None
    """Where they were, moved onto the model where ``registration`` asks for it, or why that cannot be told; None where
    nothing was measured in space."""
    steps: tuple[Solution, ...] = ()
    """The answers to all steps, the last one included."""

    @property
    def stable(self) -> bool | None:
        """Whether the answers to all steps are stable; None where there is none, or that is not known of one."""
        answers = self.steps or (() if self.solution is None else (self.solution,))
        verdicts = [solution.stable for solution in answers]
        if False in verdicts:
            return False
        return None if None in verdicts or not verdicts else True

    @property
    def unstable(self) -> bool:
        """Whether the robot leaves the shape of one of the steps at the slightest disturbance."""
        return self.stable is False

    @property
    def why_not_measured(self) -> str | None:
        """Why there is no distance to a measurement; None where there is one."""
        if self.distance_to_measured is not None:
            return None
        if self.error is not None:
            return str(self.error)
        if isinstance(self.measured, InputError):
            return str(self.measured)
        if self.measured is None:
            return "nothing was measured in space"
        return "only markers on the base were measured"


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
    >>> print(compare(case, by=["cosserat", "four-bar"]).benchmark.recommendation[2].text)  # doctest: +ELLIPSIS
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
        """How far each of these models, by its name and with its presets, is from the reference, how long it takes,
        and which to use for what; it is tried when it is first asked for."""
        names = list(dict.fromkeys(run.model for run in self.runs))
        return benchmark(self.case, by=names, reference=self.reference)

    @property
    def solutions(self) -> dict[str, Solution]:
        """The answers by the names of their models."""
        return {run.model: run.solution for run in self.runs if run.solution is not None}

    @cached_property
    def warnings(self) -> list[WhipcordWarning]:
        """Warnings about the answers, each kind once, and whether the spacing of the disks of a soft body
        changes them."""
        found = [warning for solution in self.solutions.values() for warning in solution.warnings]
        disks = self.solutions.get("cosserat-disks")
        if disks is not None:
            found += listed(self.case._setup.spacing_warnings(disks._model, disks._answer))
        return distinct(found)

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
            "measured_steps": [
                run.measured.steps if isinstance(run.measured, Distances) else 0 for run in self.runs
            ],
            "measured_points": [
                run.measured.points if isinstance(run.measured, Distances) else 0 for run in self.runs
            ],
            "not_measured": [run.why_not_measured for run in self.runs],
            "unstable": [run.unstable for run in self.runs],
            "stable": [run.stable for run in self.runs],
            "error": [None if run.error is None else str(run.error) for run in self.runs],
        }

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` with one line for each model; lengths in m, NaN where there is none."""
        return needed("pandas").DataFrame(self._columns()).set_index("model")

    def to_polars(self) -> Any:
        """A ``polars.DataFrame`` with one line for each model; lengths in m, NaN where there is none."""
        return needed("polars").DataFrame(self._columns())

    def plot(self, **options: Any) -> Any:
        """Draws the answers; see :func:`whipcord.plot.compare`.

        Parameters
        ----------
        options
            As for :func:`whipcord.plot.compare`.
        """
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
            lines.append(
                f"  {run.model:<15} tip ({x:.2f}, {y:.2f}, {z:.2f}) mm{apart}{_beside(run)}{unstable}"
            )
        return "\n".join(lines) + ">"


def compare(
    case: Case,
    *,
    by: Sequence[ModelLike] = models.NAMES,
    reference: str = "trusted",
    timeout: float | None = None,
) -> Comparison:
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
    timeout
        Seconds after which the whole comparison is ended; by default as long as it takes.

    Raises
    ------
    WhipcordTimeout
        Where the time limit was reached.
    InputError
        For models that there are not.
    """
    if not isinstance(case, Case):
        raise InputError(f"case must be a Case, but is {case!r}", path="case")
    if isinstance(by, str) or not isinstance(by, Iterable):
        raise InputError(f"by must be a list of models, but is {by!r}", path="by")
    for model in by:
        models.core(model, timeout=timeout)
    ends = None if timeout is None else time.monotonic() + float(timeout)
    runs: list[Run] = []
    first: list[Solution] | None = None
    for model in by:
        try:
            left = _left(ends, model)
            steps = case.solve_steps(model=model, timeout=left) if case.steps else [case._solve(model, left)]
        except WhipcordTimeout:
            raise
        except WhipcordError as error:
            runs.append(Run(_name(model), None, error, None, None))
            continue
        distance = None if first is None else _distance(steps, first)
        first = first or steps
        measured = _to_measured(case, steps)
        rms = measured.rms if isinstance(measured, Distances) else None
        runs.append(Run(_name(model), steps[-1], None, distance, rms, measured, tuple(steps)))
    comparison = Comparison(case, runs, reference)
    tell(comparison.warnings)
    return comparison


def _left(ends: float | None, model: ModelLike) -> float | None:
    """The seconds that a model has, of a comparison that ends then."""
    if ends is None:
        return None
    left = ends - time.monotonic()
    if left > 0:
        return left
    error = WhipcordTimeout(
        "the time limit was reached (timeout): it was over before the solve by "
        f"{_name(model)} began; give it more time, or ask for less"
    )
    error.last_load = None
    raise error


def _number(value: float | None) -> float:
    return float("nan") if value is None else value


def _name(model: ModelLike) -> str:
    return model if isinstance(model, str) else models.core(model).kind


def _distance(steps: list[Solution], others: list[Solution]) -> float:
    """The root mean square over all steps."""
    if len(steps) == 1:
        return steps[0].rms_distance(others[0])
    apart = [mine.rms_distance(other) for mine, other in zip(steps, others)]
    return float(np.sqrt(np.mean(np.square(apart))))


def _beside(run: Run) -> str:
    if run.measured is None:
        return ""
    if run.distance_to_measured is None or isinstance(run.measured, InputError):
        return f", no distance to the measurement: {run.why_not_measured}"
    steps, points = run.measured.steps, run.measured.points
    over = f"{points} point{'' if points == 1 else 's'} in {steps} step{'' if steps == 1 else 's'}"
    return f", {1e3 * run.distance_to_measured:.3f} mm from the measurement over {over}"


def _to_measured(case: Case, steps: list[Solution]) -> Distances | InputError | None:
    try:
        found = _core.distances(case._setup, [solution._answer for solution in steps])
    except InputError as error:
        return error
    return None if found is None else Distances._of(found)
