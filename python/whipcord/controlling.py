"""Commands for a robot in motion, cycle by cycle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._tables import Quantity
from .errors import InputError
from .reaching import in_si, positive, shape_of
from .solution import Solution

if TYPE_CHECKING:
    from .case import Case

__all__ = ["Controller", "Cycle", "Estimator"]

Array = npt.NDArray[np.float64]
Point = Union["Sequence[Quantity]", npt.ArrayLike]


@dataclass(frozen=True)
class Estimator:
    """How much a controller believes of model and measurement, as standard deviations. What is not given is chosen by the
    length of the robot.

    Examples
    --------
    >>> Estimator(position="0.2 mm", force="0.5 N").force
    0.5
    """

    position: Quantity | None = None
    """Of a measured position in m; by default 1e-3 of the length."""
    angle: Quantity | None = None
    """Of a measured direction in rad; by default 0.003."""
    bias: float | None = None
    """Of the error of a command, as a part of the command that bends the robot by half a turn; by default 0.05."""
    force: Quantity | None = None
    """Of the unknown force on the tip in N; by default 0.1."""
    memory: Quantity | None = None
    """Time in s in which estimates are forgotten of which nothing is measured; by default 5."""

    def __post_init__(self) -> None:
        units = {"position": "length", "angle": "angle", "force": "force", "memory": "time"}
        for name, dimension in units.items():
            object.__setattr__(self, name, positive(getattr(self, name), name, dimension))
        if self.bias is not None and not self.bias > 0:
            raise InputError(f"bias must be greater than zero, but is {self.bias!r}", path="bias")


@dataclass(frozen=True, eq=False, repr=False)
class Cycle:
    """What a cycle of a controller gives. Jacobian, compliance and rates are those of the estimated robot before the new
    commands, for controllers that predict."""

    command: Array
    """(a,) the commands to send: N, m or rad."""
    solution: Solution
    """The shape of the estimated robot before these commands."""
    error: float
    """Distance of the estimated robot from the target in m, before these commands; of a shape the largest of its points."""
    error_angle: float
    """Angle from the target in rad; 0 for a target without a direction."""
    jacobian: Array
    """(6, a) translation and rotation of the tip in the world, by each command; by what a spool turns of a motor."""
    compliance: Array
    """(6, 3) translation in m/N and rotation in rad/N of the tip, by a force on it along x, y and z of the base, with the commands
    held."""
    tension_by_command: Array
    """(c, a) change of the tension of each cable in N, by each command."""
    length_by_command: Array
    """(c, a) change of the length of each cable inside the robot in m, by each command."""
    bias: Array
    """(a,) estimated error of each command: what the robot does is what the model does under command and bias."""
    bias_deviation: Array
    """(a,) standard deviation of the bias."""
    force: Array
    """(3,) estimated force on the tip in N along x, y and z of the base, beside the loads of the case."""
    force_deviation: Array
    """(3,) standard deviation of the force in N."""
    active_limits: tuple[str, ...]
    """The limits that hold the commands back, in words."""

    @property
    def tip(self) -> Array:
        """(3,) position of the tip of the estimated robot in m."""
        return self.solution.tip

    def __repr__(self) -> str:
        return f"<Cycle: {1e3 * self.error:.4g} mm from the target>"


class Controller:
    """Follows a target that moves, within the limits of commands, rates and tensions; made by
    :meth:`whipcord.Case.controller`.

    Each cycle solves the model at the commands in force, corrects an estimate of biases of the commands and of a force on the tip by
    the measurement, and solves one quadratic programme for the new commands (:doc:`/theory/inverse`).

    Examples
    --------
    A robot that is softer than its model, and follows a point by measurements of its tip:

    >>> import whipcord
    >>> model = whipcord.load("examples/two-segment-arm.toml")
    >>> backbone = model.robot.backbone.replace(young_modulus=0.9 * model.robot.backbone.young_modulus)
    >>> robot = model.replace(robot=model.robot.replace(backbone=backbone))
    >>> goal = model.solve().tip
    >>> controller = model.controller(period=0.02, limits={"tension": ["0.2 N", "40 N"]})
    >>> tip = robot.solve().tip
    >>> before = np.linalg.norm(tip - goal)
    >>> for _ in range(100):
    ...     cycle = controller.step(tip=goal, measured_tip=tip)
    ...     tip = robot.solve(tension=cycle.command).tip
    >>> bool(np.linalg.norm(tip - goal) < 0.05 * before)
    True
    """

    def __init__(self, case: Case, model: _core.Model, inner: _core.Controller, disks: int) -> None:
        self._case, self._model, self._inner, self._disks = case, model, inner, disks

    @property
    def actuators(self) -> tuple[tuple[str, str], ...]:
        """What each command is for: ``"tension"``, ``"shortening"`` or ``"motor"``, and the name of the cable or motor."""
        return tuple(self._inner.actuators)

    def step(
        self,
        *,
        tip: Point | None = None,
        pose: tuple[Any, Any] | None = None,
        axis: npt.ArrayLike | None = None,
        shape: npt.ArrayLike | None = None,
        measured_tip: Point | None = None,
        measured_pose: tuple[Any, Any] | None = None,
        measured_shape: npt.ArrayLike | None = None,
    ) -> Cycle:
        """One cycle: the commands that lead towards the target.

        Parameters
        ----------
        tip
            (3,) point for the tip in m, or texts with units.
        pose
            Position and orientation of the tip: a point and a quaternion (w, x, y, z).
        axis
            (3,) direction of the backbone at the tip, of any length; alone or with `tip`.
        shape
            (n, 3) points for the disks in m; a row of NaN for a disk that may be anywhere.
        measured_tip
            (3,) where the tip was seen under the commands in force, in m.
        measured_pose
            Position and orientation of the tip, as they were seen.
        measured_shape
            (n, 3) where the disks were seen in m; a row of NaN for a disk that was not.

        Returns
        -------
        Cycle
            With the commands to send now. If the solve fails an exception is raised, and the commands in force stay.
        """
        target = _aim(self._disks, "target", tip, pose, axis, shape)
        if target is None:
            raise InputError("there is no target: give tip, pose, axis or shape", path="target")
        measured = _aim(self._disks, "measured", measured_tip, measured_pose, None, measured_shape)
        answer, values = self._inner.cycle(target, measured)
        limits = tuple(values.pop("active_limits"))
        solution = Solution._of(self._case, self._model, answer, None)
        return Cycle(solution=solution, active_limits=limits, **values)

    def __repr__(self) -> str:
        return f"<Controller of {len(self.actuators)} commands>"


def _aim(
    disks: int,
    name: str,
    tip: Point | None,
    pose: tuple[Any, Any] | None,
    axis: npt.ArrayLike | None,
    shape: npt.ArrayLike | None,
) -> dict[str, Any] | None:
    """A target or a measurement as the extension module takes it."""
    given = [each for each in (tip if axis is None else axis, pose, shape) if each is not None]
    if (pose is not None or shape is not None) and tip is not None and axis is not None:
        given.append(tip)
    if len(given) > 1:
        raise InputError(f"several are given for one {name}: give tip, pose, axis or shape", path=name)
    if tip is None and not given:
        return None
    position, orientation = (tip, None)
    if pose is not None:
        if isinstance(pose, Mapping) or not isinstance(pose, (tuple, list)) or len(pose) != 2:
            raise InputError(f"a pose must be a point and a quaternion, but is {pose!r}", path=name)
        position, orientation = pose
    return {
        "tip": None if position is None else _numbers(position, name, 3, "length"),
        "orientation": None if orientation is None else _numbers(orientation, name, 4, None),
        "axis": None if axis is None else _numbers(axis, name, 3, None),
        "shape": shape_of(shape, disks),
    }


def _numbers(values: Any, name: str, count: int, dimension: str | None) -> list[float]:
    if isinstance(values, str) or not hasattr(values, "__len__") or len(values) != count:
        raise InputError(f"{name}: {count} numbers are needed, but are {values!r}", path=name)
    return [in_si(value, name, dimension) if dimension else float(value) for value in values]


def options(
    period: Quantity, gain: float | None, damping: float | None, estimator: Estimator | bool | None
) -> dict[str, Any]:
    """What the extension module takes."""
    seconds = positive(period, "period", "time")
    of = estimator if isinstance(estimator, Estimator) else Estimator()
    return {
        "period": seconds,
        "gain": None if gain is None else float(gain),
        "damping": None if damping is None else float(damping),
        "estimates": estimator is not False,
        **{name: getattr(of, name) for name in ("position", "angle", "bias", "force", "memory")},
    }
