"""Many motions of a robot at once, and their gradients."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from . import _core
from ._commands import whole
from ._tables import Quantity
from .errors import InputError, WhipcordError
from .simulating import LoadsOverTime, Motion, State, setup_of, step_length

if TYPE_CHECKING:
    from .case import Case
    from .robot import Damping

__all__ = ["MotionBatch", "MotionChange", "MotionGradient", "Motions"]

Array = npt.NDArray[np.float64]
Actuation = Literal["tension", "shortening", "motors"]


@dataclass(frozen=True, eq=False, repr=False)
class MotionBatch:
    """Motions: arrays with the leading dimensions of the commands, and a row for each state, the first of them at the start."""

    time: Array
    """(N + 1,) times in s."""
    arc_length: Array
    """(n,) arc lengths of the nodes in m."""
    position: Array
    """(..., N + 1, n, 3) positions of the nodes in m, in the world."""
    orientation: Array
    """(..., N + 1, n, 4) quaternions (w, x, y, z) of the nodes."""
    velocity: Array
    """(..., N + 1, n, 6) velocities of the nodes in their own frames, in m/s and rad/s."""
    strain: Array
    """(..., N + 1, q, 6) strains at the two points of each element, of translation and in 1/m."""
    tension: Array
    """(..., N + 1, c) tensions of the cables in N."""
    length: Array
    """(..., N + 1, c) lengths of the cables inside the robot in m."""
    ok: npt.NDArray[np.bool_]
    """(...) whether there is a motion; the others are NaN where there is none."""
    errors: Mapping[tuple[int, ...], WhipcordError]
    """Why there is none, by the index of each."""

    @property
    def tip(self) -> Array:
        """(..., N + 1, 3) positions of the tip in m."""
        return self.position[..., -1, :]

    def __repr__(self) -> str:
        count = int(self.ok.size)
        return f"<MotionBatch of {count} motions, {len(self.time) - 1} steps; {count - int(self.ok.sum())} failed>"


@dataclass(frozen=True, eq=False, repr=False)
class MotionGradient:
    """Derivatives of a number of each motion."""

    command: Array
    """(..., N, c) by the command of each cable, or (..., N, m) of each motor, in each step."""
    stiffness: Array
    """(...) by a factor on the stiffness of the backbone, the equilibrium that the motion starts from included. An equilibrium with taut cables that have friction, or in
    contact with an obstacle, is held, since it depends on the way to it."""
    damping: Array
    """(...) by a factor on its damping."""
    mass: Array
    """(...) by a factor on all masses, and on their weight."""
    one_sided: npt.NDArray[np.bool_]
    """(..., N) steps whose derivatives are those of one side, where a cable with friction is between sticking and sliding in a hole, or a contact
    between two of open, sticking and sliding."""

    def __repr__(self) -> str:
        return f"<MotionGradient by commands {self.command.shape}>"


@dataclass(frozen=True, eq=False, repr=False)
class MotionChange:
    """What each motion changes by along a direction, with a row for each state."""

    position: Array
    """(..., N + 1, n, 3) of the positions of the nodes in m, in the world."""
    turn: Array
    """(..., N + 1, n, 3) turns of the nodes in rad about the axes of the world."""
    velocity: Array
    """(..., N + 1, n, 6) of the velocities of the nodes in their own frames."""
    strain: Array
    """(..., N + 1, q, 6) of the strains."""
    one_sided: npt.NDArray[np.bool_]
    """(..., N) steps whose changes are those of one side, as in :class:`MotionGradient`."""

    @property
    def tip(self) -> Array:
        """(..., N + 1, 3) of the position of the tip in m."""
        return self.position[..., -1, :]

    def __repr__(self) -> str:
        return f"<MotionChange of positions {self.position.shape}>"


class Motions:
    """How a robot moves as a function of its commands, which are constant in each step: many motions at once, on all cores, and their gradients.

    Gradients are those of the computed motion, by the transposed equations of its steps, not by differences (:doc:`/theory/motion`):
    :meth:`pull_back` for one number and all commands, :meth:`push_forward` for one direction and all that moves. They hold with friction of cables, while the robot
    touches obstacles and through impacts; only what grazes an obstacle has none.
    :class:`whipcord.jax.Motions` and ``whipcord.torch.Motions`` are the same as differentiable functions.

    Parameters
    ----------
    case
        Robot, loads and base, and the commands of the equilibrium to start from. What ``[motion]`` of its file says holds, too.
    dt
        Length of a step in s.
    actuation
        ``"tension"`` in N, ``"shortening"`` in m, or ``"motors"`` in rad or m: what the commands are.
    method
        ``"accurate"``, ``"energy"`` or ``"robust"``; steps with cables that are driven by their lengths are taken by ``"robust"``.
    model, initial, elements, damping, drag, base, loads
        As for :meth:`whipcord.Case.simulate`; courses over time are values or rows.

    Examples
    --------
    The tensions that bring the tip 30 mm to the side within a tenth of a second, by descent along the gradient:

    >>> import numpy as np
    >>> import whipcord
    >>> case = whipcord.load("examples/released-arm.toml")
    >>> motions = Motions(case, "5 ms", initial="rest")
    >>> tension = np.full((20, 2), 0.5)
    >>> for _ in range(20):
    ...     motion = motions(tension)
    ...     seed = np.zeros_like(motion.position)
    ...     seed[-1, -1, 0] = motion.tip[-1, 0] - 0.03
    ...     gradient = motions.pull_back(tension, position=seed).command
    ...     tension = np.maximum(tension - 5000 * gradient, 0)
    >>> bool(abs(motion.tip[-1, 0] - 0.03) < 1e-6)
    True
    """

    def __init__(
        self,
        case: Case,
        dt: Quantity,
        *,
        actuation: Actuation = "tension",
        model: Literal["cosserat", "cosserat-disks"] | None = None,
        method: str | None = None,
        initial: str | State | Motion | None = None,
        elements: int | None = None,
        damping: Damping | Mapping[str, Any] | Quantity | None = None,
        drag: Mapping[str, Quantity] | Quantity | None = None,
        base: Mapping[str, Any] | None = None,
        loads: LoadsOverTime | None = None,
    ) -> None:
        if actuation not in ("tension", "shortening", "motors"):
            message = f"actuation must be 'tension', 'shortening' or 'motors', but is {actuation!r}"
            raise InputError(message, path="actuation")
        step = step_length(dt)
        setup = setup_of(
            case,
            model=model,
            method=method,
            initial=initial,
            elements=elements,
            damping=damping,
            drag=drag,
            base=base,
            loads=loads,
        )
        self._dt, self._actuation, self._inner = step, actuation, _core.Motions(setup, step)
        self._width = len(case.robot.motors) if actuation == "motors" else len(case.robot.cables)
        self._points, self._cables = self._inner.sizes()
        self._arc_length: Array = self._inner.arc_length()

    @property
    def arc_length(self) -> Array:
        """(n,) arc lengths of the nodes in m."""
        return self._arc_length

    def __call__(
        self,
        commands: npt.ArrayLike,
        *,
        threads: int | None = None,
        on_failure: Literal["raise", "flag"] = "raise",
    ) -> MotionBatch:
        """Simulates.

        Parameters
        ----------
        commands
            (..., N, c) command of each cable in each step, or (..., N, m) of each motor, in SI; NaN for one that keeps its own command.
        threads
            How many threads; by default as many as there are cores.
        on_failure
            ``"raise"`` the error of the first motion that fails, or ``"flag"`` the motions that do in ``ok``.
        """
        values, lead = self._flat(commands)
        found, failed = self._inner.run(self._actuation, values, _threads(threads))
        if failed and on_failure == "raise":
            raise failed[0][1]
        ok = np.ones(len(values), dtype=np.bool_)
        ok[[row for row, _ in failed]] = False
        errors = {tuple(int(i) for i in np.unravel_index(row, lead)) if lead else (): error for row, error in failed}
        steps = values.shape[1]
        return MotionBatch(
            time=self._dt * np.arange(steps + 1),
            arc_length=self._arc_length,
            ok=ok.reshape(lead),
            errors=errors,
            **{name: value.reshape((*lead, *value.shape[1:])) for name, value in found.items()},
        )

    def pull_back(
        self,
        commands: npt.ArrayLike,
        *,
        position: npt.ArrayLike | None = None,
        velocity: npt.ArrayLike | None = None,
        strain: npt.ArrayLike | None = None,
        threads: int | None = None,
        on_failure: Literal["raise", "flag"] = "raise",
    ) -> MotionGradient:
        """Derivatives of a number of each motion, from its derivatives by the motion: the vector-Jacobian product.

        Parameters
        ----------
        commands
            As for a call.
        position
            (..., N + 1, n, 3) derivatives by the positions of the nodes; zero by default.
        velocity
            (..., N + 1, n, 6) derivatives by their velocities.
        strain
            (..., N + 1, q, 6) derivatives by the strains.
        threads
            How many threads; by default as many as there are cores.
        on_failure
            ``"raise"`` the error of the first motion that fails, or give it zeros where it is ``"flag"``.
        """
        values, lead = self._flat(commands)
        rows, states, nodes = len(values), values.shape[1] + 1, len(self._arc_length)

        def seed(given: npt.ArrayLike | None, name: str, *inner: int) -> Array:
            shape = (*lead, states, *inner)
            if given is None:
                return np.zeros((rows, states, *inner))
            array = np.asarray(given, dtype=np.float64)
            if array.shape != shape:
                raise InputError(f"{name} must have the shape {shape}, but has {array.shape}", path=name)
            return np.ascontiguousarray(array.reshape(rows, states, *inner))

        found, failed = self._inner.gradient(
            self._actuation,
            values,
            seed(position, "position", nodes, 3),
            seed(velocity, "velocity", nodes, 6),
            seed(strain, "strain", self._points, 6),
            _threads(threads),
        )
        if failed and on_failure == "raise":
            raise failed[0][1]
        return MotionGradient(**{name: value.reshape((*lead, *value.shape[1:])) for name, value in found.items()})

    def push_forward(
        self,
        commands: npt.ArrayLike,
        *,
        command: npt.ArrayLike | None = None,
        stiffness: npt.ArrayLike = 0.0,
        damping: npt.ArrayLike = 0.0,
        mass: npt.ArrayLike = 0.0,
        threads: int | None = None,
        on_failure: Literal["raise", "flag"] = "raise",
    ) -> MotionChange:
        """What each motion changes by along a direction: the Jacobian-vector product, of which :meth:`pull_back` is the transpose.

        Parameters
        ----------
        commands
            As for a call.
        command
            (..., N, c) or (..., N, m) changes of the commands; zero by default.
        stiffness
            (...) change of a factor on the stiffness of the backbone.
        damping
            (...) change of a factor on its damping.
        mass
            (...) change of a factor on all masses.
        threads
            How many threads; by default as many as there are cores.
        on_failure
            ``"raise"`` the error of the first motion that fails, or give it zeros where it is ``"flag"``.
        """
        values, lead = self._flat(commands)
        changes = np.zeros_like(values)
        if command is not None:
            given = np.asarray(command, dtype=np.float64)
            shape = (*lead, *values.shape[1:])
            if given.shape != shape:
                raise InputError(f"command must have the shape {shape}, but has {given.shape}", path="command")
            changes = np.ascontiguousarray(given.reshape(values.shape))
        factors = [np.broadcast_to(np.asarray(of, dtype=np.float64), lead).ravel() for of in (stiffness, damping, mass)]
        direction = np.ascontiguousarray(np.stack(factors, axis=-1))
        found, failed = self._inner.tangent(self._actuation, values, changes, direction, _threads(threads))
        if failed and on_failure == "raise":
            raise failed[0][1]
        return MotionChange(**{name: value.reshape((*lead, *value.shape[1:])) for name, value in found.items()})

    def _flat(self, commands: npt.ArrayLike) -> tuple[Array, tuple[int, ...]]:
        """Commands as rows of motions, and the leading dimensions."""
        array = np.asarray(commands, dtype=np.float64)
        if array.ndim < 2 or array.shape[-1] != self._width:
            what = "motor" if self._actuation == "motors" else "cable"
            message = (
                f"commands must have the shape (..., N, {self._width}): steps, and one for each {what}; "
                f"but they have {array.shape}"
            )
            raise InputError(message, path="commands")
        lead = array.shape[:-2]
        rows = int(np.prod(lead))
        return np.ascontiguousarray(array.reshape(rows, *array.shape[-2:])), lead

    def shapes(self, steps: int) -> tuple[tuple[int, ...], ...]:
        """Shapes of position, velocity, strain, tension and length of a motion.

        Parameters
        ----------
        steps
            Number of its steps.
        """
        states, nodes = steps + 1, len(self._arc_length)
        return (
            (states, nodes, 3),
            (states, nodes, 6),
            (states, self._points, 6),
            (states, self._cables),
            (states, self._cables),
        )

    def __repr__(self) -> str:
        return f"<Motions by {self._actuation} in steps of {self._dt:g} s>"


def _threads(threads: int | None) -> int | None:
    if threads is None:
        return None
    number = whole(threads, "threads")
    if number < 1:
        raise InputError(f"threads must be 1 or more, but is {threads!r}", path="threads")
    return number
