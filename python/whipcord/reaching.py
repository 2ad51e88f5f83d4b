"""Commands that bring a robot to a target."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._tables import Quantity, Table, part
from .batch import _bar, numbers
from .errors import InputError
from .solution import Solution

if TYPE_CHECKING:
    from .case import Case

__all__ = ["Followed", "Jump", "Limits", "ReachBatch", "Reached"]

Array = npt.NDArray[np.float64]
PoseLike = Union[Mapping[str, Any], "tuple[Any, Any]", "list[Any]"]
"""A position and a quaternion (w, x, y, z), or a dict with the entries of ``[target.pose]``."""


@dataclass(frozen=True, init=False, repr=False)
class Limits(Table):
    """What no cable may exceed, as ``[limits]`` of a robot file has it.

    Parameters
    ----------
    tension
        Least and greatest tension of each cable in N. The least is the pretension that keeps the cables taut.
    shortening
        Least and greatest shortening of each cable in m, or texts in ``%`` of its initial length.
    rate
        Greatest rate of the shortening in m/s, or a text such as ``"2 N/s"`` where tensions are commanded.

    Examples
    --------
    >>> Limits(tension=["0.2 N", "20 N"], rate="5 mm/s")
    Limits(tension=(0.2, 20.0), rate=0.005)
    """

    _name: ClassVar[str] = "limits"

    tension: tuple[float, float] | None = None
    shortening: tuple[Quantity, Quantity] | None = None
    rate: Quantity | None = None

    def __init__(
        self,
        *,
        tension: Sequence[Quantity] | None = None,
        shortening: Sequence[Quantity] | None = None,
        rate: Quantity | None = None,
    ) -> None:
        self._set(tension=tension, shortening=shortening, rate=rate)


@dataclass(frozen=True, eq=False, repr=False)
class Reached:
    """The answer to one target. It is ``ok`` only where the target is reached; else it has the nearest commands that were found."""

    status: str
    """``"reached"``; ``"nearest"``, not reached from any start, which is no proof; ``"unreachable_proven"``; or
    ``"undecided"``."""
    solution: Solution
    """The shape under the commands, from a solve from rest."""
    command: Array
    """(a,) the commands that were sought: N, m or rad."""
    actuators: tuple[tuple[str, str], ...]
    """What each of them commands: ``"tension"``, ``"shortening"`` or ``"motor"``, and the name of the cable or motor."""
    motors: tuple[float | None, ...]
    """Angle in rad or travel in m of each motor, where it has a command."""
    error: float
    """Distance from the target in m; of a shape the largest of its points."""
    error_angle: float
    """Angle from the target in rad; 0 for a target without a direction."""
    lower_bound: float | None
    """No commands within the limits bring the tip nearer to the target than this, in m, where that is proven."""
    no_proof: str | None
    """Why there is no proof, where one was asked for."""
    active_limits: tuple[str, ...]
    """The limits that the answer meets, in words."""
    null_space: Array
    """(k, a) directions of the commands that do not move what the target is for."""
    starts: int
    """Starts of the iteration."""
    solves: int
    """Solves of the model."""

    @property
    def ok(self) -> bool:
        """Whether the target is reached."""
        return self.status == "reached"

    @property
    def case(self) -> Case:
        """The case with these commands."""
        return self.solution.case

    @property
    def tension(self) -> Array:
        """(c,) tension of each cable in N."""
        return self.solution.tension

    @property
    def length(self) -> Array:
        """(c,) length of each cable inside the robot in m."""
        return self.solution.length

    def __repr__(self) -> str:
        return f"<Reached: {self.status}, {1e3 * self.error:.4g} mm from the target, {self.solves} solves>"


@dataclass(frozen=True, eq=False, repr=False)
class ReachBatch:
    """The answers to many targets. Where a target is not reached the commands and shapes are NaN, unless the nearest
    were asked for; ``status``, ``error`` and ``lower_bound`` are there all the same."""

    status: npt.NDArray[np.str_]
    """(N,) status of each row, as of :class:`Reached`; ``"failed"`` where there is no answer."""
    reasons: list[str | None]
    """For each row why there is no answer, in words."""
    command: Array
    """(N, a) the commands that were sought: N, m or rad."""
    actuators: tuple[tuple[str, str], ...]
    """What each of them commands, and the name of the cable or motor."""
    tension: Array
    """(N, c) tensions of the cables in N."""
    length: Array
    """(N, c) lengths of the cables inside the robot in m."""
    motors: Array
    """(N, m) angles in rad or travels in m of the motors; NaN of a motor without a command."""
    position: Array
    """(N, n, 3) positions of the disks in m."""
    orientation: Array
    """(N, n, 4) quaternions (w, x, y, z) of the disks."""
    error: Array
    """(N,) distance from the target in m."""
    error_angle: Array
    """(N,) angle from the target in rad."""
    lower_bound: Array
    """(N,) distances in m that no commands within the limits fall below; NaN where none is proven."""
    solves: npt.NDArray[np.int64]
    """(N,) solves of the model."""

    @property
    def ok(self) -> npt.NDArray[np.bool_]:
        """(N,) whether the target of a row is reached."""
        found: npt.NDArray[np.bool_] = self.status == "reached"
        return found

    def __len__(self) -> int:
        return len(self.status)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {len(self)} targets: {int(self.ok.sum())} reached>"


@dataclass(frozen=True)
class Jump:
    """A place of a path where the robot does not move smoothly."""

    point: int
    """The point that it leads to, from 0."""
    kind: str
    """``"commands"``: the commands are not near to those before. ``"shape"``: the robot snaps into another shape."""
    distance: float
    """By how much the disk that moves most is elsewhere than was foretold, in m."""


@dataclass(frozen=True, eq=False, repr=False)
class Followed(ReachBatch):
    """The answers along a path."""

    time: Array = field(default_factory=lambda: np.empty(0))
    """(N,) times of the points in s."""
    jumps: tuple[Jump, ...] = ()
    """Places where the robot does not move smoothly."""


def asked(
    by: str | None,
    starts: int,
    prove: bool,
    tolerance: Quantity | None,
    tolerance_angle: Quantity | None,
    atlas: str | os.PathLike[str] | None = None,
) -> dict[str, Any]:
    """What the extension module takes."""
    if starts < 0:
        raise InputError(f"starts must not be negative, but is {starts}", path="starts")
    return {
        "by": by,
        "starts": min(starts, 20_000),
        "prove": prove,
        "atlas": None if atlas is None else os.fspath(atlas),
        "tolerance": positive(tolerance, "tolerance", "length"),
        "tolerance_angle": positive(tolerance_angle, "tolerance_angle", "angle"),
    }


def in_si(value: Quantity, name: str, dimension: str) -> float:
    """A number in SI, from a number or a text with a unit."""
    number = _core.parse_quantity(value, dimension) if isinstance(value, str) else value
    if isinstance(number, bool) or not isinstance(number, (int, float, np.number)) or not np.isfinite(number):
        raise InputError(f"{name} must be a finite number or a text with a unit, but is {value!r}", path=name)
    return float(number)


def positive(value: Quantity | None, name: str, dimension: str) -> float | None:
    """A number greater than zero in SI, where one is given."""
    if value is None:
        return None
    number = in_si(value, name, dimension)
    if not number > 0:
        raise InputError(f"{name} must be greater than zero, but is {value!r}", path=name)
    return number


def with_goal(
    case: Case,
    target: Mapping[str, Any] | None,
    limits: Limits | Mapping[str, Any] | None,
    least: str | None,
    clearance: Quantity | None,
) -> _core.Setup:
    """The case with another target, limits and preferences than its file has."""
    prefer = {"least": least, "clearance": clearance}
    prefer = {key: value for key, value in prefer.items() if value is not None}
    if target is None and limits is None and not prefer:
        return case._setup
    tables = dict(case._tables)
    if target is not None:
        tables["target"] = target
    if limits is not None:
        tables["limits"] = part(limits, Limits, "limits")
    if prefer:
        tables["prefer"] = {**tables.get("prefer", {}), **prefer}
    changed = _core.Setup.of_tables(tables, "reach")
    return case._setup.beside_goal(changed)


def target_of(
    tip: Sequence[Quantity] | npt.ArrayLike | None,
    pose: PoseLike | None,
    axis: npt.ArrayLike | None,
) -> dict[str, Any] | None:
    """The table ``[target]``; None where nothing is given."""
    table: dict[str, Any] = {}
    if tip is not None:
        table["tip"] = _list(tip, "tip")
    if axis is not None:
        table["axis"] = _list(axis, "axis")
    if pose is not None:
        if isinstance(pose, Mapping):
            table["pose"] = dict(pose)
        elif isinstance(pose, (tuple, list)) and len(pose) == 2:
            position, orientation = pose
            table["pose"] = {
                "position": _list(position, "pose"),
                "orientation": _list(orientation, "pose"),
            }
        else:
            message = f"pose must be a position and a quaternion, or a dict of them, but is {pose!r}"
            raise InputError(message, path="pose")
    return table or None


def _list(values: Any, name: str) -> list[Any]:
    if isinstance(values, str) or not hasattr(values, "__len__"):
        raise InputError(f"{name} must be a list of numbers, but is {values!r}", path=name)
    return [float(value) if isinstance(value, np.number) else value for value in values]


def shape_of(shape: npt.ArrayLike | None, disks: int) -> list[tuple[int, list[float]]] | None:
    """The disks that have a point, and their points."""
    if shape is None:
        return None
    points = numbers(shape, "shape", f"({disks}, 3)", 2)
    if points.shape != (disks, 3):
        message = f"shape must have the shape ({disks}, 3), one point for each disk, but has {points.shape}"
        raise InputError(message, path="shape")
    given = [k for k in range(disks) if not np.isnan(points[k]).all()]
    return [(k, points[k].tolist()) for k in given]


def reached(case: Case, model: _core.Model, found: tuple[_core.Solution, dict[str, Any]]) -> Reached:
    answer, values = found
    lists = ("actuators", "motors", "active_limits")
    fields: dict[str, Any] = {key: tuple(value) if key in lists else value for key, value in values.items()}
    return Reached(solution=Solution._of(case, model, answer, None), **fields)


def _arrays(values: dict[str, Any]) -> dict[str, Any]:
    status = np.array(values.pop("status"), dtype=np.str_)
    return {
        "status": status,
        "reasons": values.pop("reason"),
        "actuators": tuple(values.pop("actuators")),
        **values,
    }


def reach_batch(
    setup: _core.Setup,
    model: _core.Model,
    asked: dict[str, Any],
    targets: npt.ArrayLike,
    threads: int | None,
    nearest: bool,
    progress: bool,
) -> ReachBatch:
    rows = numbers(targets, "targets", "(N, 3) or (N, 7)", 2)
    with _bar(len(rows), progress) as report:
        values = _core.reach_batch(setup, model, asked, rows, threads, nearest, report)
    return ReachBatch(**_arrays(values))


def follow(
    setup: _core.Setup,
    model: _core.Model,
    asked: dict[str, Any],
    path: npt.ArrayLike | None,
    time: npt.ArrayLike | None,
    nearest: bool,
) -> Followed:
    rows = None if path is None else numbers(path, "path", "(N, 3) or (N, 7)", 2)
    if (path is None) != (time is None):
        raise InputError("path and time belong together: give both, or neither", path="time")
    times = [] if time is None else numbers(time, "time", "(N,)", 1).tolist()
    values = _core.follow(setup, model, asked, rows, times, nearest)
    jumps = tuple(Jump(*jump) for jump in values.pop("jumps"))
    times_of_points = values.pop("time")
    return Followed(**_arrays(values), time=times_of_points, jumps=jumps)
