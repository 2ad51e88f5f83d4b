"""Robots in motion."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._commands import Commands, each, listed, seconds, whole
from ._tables import Quantity, part, plain
from .errors import InputError, MotionError
from .loads import Loads
from .reaching import in_si, positive
from .solution import Contact, contacts_of

if TYPE_CHECKING:
    from .case import Case
    from .robot import Damping

__all__ = ["Linearized", "Modes", "Motion", "Simulation", "State"]

Array = npt.NDArray[np.float64]
Course = Union[Quantity, "Sequence[Sequence[Quantity]]", "npt.NDArray[Any]", Callable[[float], float]]
"""A quantity over time: constant, rows of a time in s and a value with straight lines between them (a time that is there twice
makes a jump), or a function of the time in s, which is taken at the steps."""
Courses = Union[Mapping[str, Course], Sequence[Union[Course, None]]]
"""One for each cable or motor in order, None for one that keeps its command; or by their names."""
LoadsOverTime = Sequence["tuple[Loads | Mapping[str, Any], Course]"]

_STEP = 0.01


@dataclass(frozen=True, eq=False, repr=False)
class Motion:
    """How a robot moved: arrays with a row for each state. Positions and orientations are those of the nodes in the world.

    Examples
    --------
    >>> import whipcord
    >>> case = whipcord.load("examples/released-arm.toml")
    >>> motion = case.simulate("0.3 s")
    >>> motion.position.shape[0], motion.tension.shape
    (31, (31, 2))
    >>> bool(abs(motion.energy["defect"]).max() < 0.05 * motion.energy["dissipated"][-1])
    True
    """

    time: Array
    """(N,) times in s."""
    arc_length: Array
    """(n,) arc lengths of the nodes in m."""
    position: Array
    """(N, n, 3) positions of the nodes in m."""
    orientation: Array
    """(N, n, 4) quaternions (w, x, y, z) of the nodes."""
    velocity: Array
    """(N, n, 6) velocities of the nodes in their own frames: m/s, then rad/s."""
    strain: Array
    """(N, q, 6) strains at the two points of each element: of translation, then curvatures in 1/m."""
    tension: Array
    """(N, c) tensions of the cables in N."""
    length: Array
    """(N, c) lengths of the cables inside the robot in m."""
    slack: Array
    """(N, c) by how much in m a cable is longer than its path."""
    passage_tensions: tuple[Array, ...]
    """Of each cable (N, p) tensions of its passages from the base on in N, as they acted in the last step: between two holes, or along a part of its curve. Without
    passages where no cable has friction."""
    lengths_beyond: tuple[Array, ...]
    """Of each cable (N, p) unstretched lengths in m beyond the near holes of its passages, which stay what they are where it sticks; a motion goes on from them."""
    motor_output: Array
    """(N, m) motion of the spool or drive of each motor, behind gear and backlash, in rad or m."""
    motor_position: Array
    """(N, m) angles in rad or travels in m of the motors, before their gears; of motors without inertia these are the commands."""
    motor_velocity: Array
    """(N, m) their rates in rad/s or m/s."""
    motor_effort: Array
    """(N, m) torques in N·m or forces in N, those of the position loops, or what holds the cables of motors without inertia."""
    motor_integral: Array
    """(N, m) integrals of the errors of the position loops over time in rad·s or m·s."""
    energy: Mapping[str, Array]
    """(N,) energies in J: ``kinetic``, ``elastic``, ``gravity``, of ``motors`` with inertia and in the ``stretch`` of their cables and drives; what the
    other ``cables``, the position loops (``control``), ``loads``, ``base`` and obstacles (``contacts``, negative where impacts and friction take energy) have
    given and damping has taken (``dissipated``) since the start; and what the integration has added, ``defect``."""
    contacts: tuple[tuple[Contact, ...], ...]
    """N times the places where the robot touches obstacles."""
    cables: tuple[str, ...]
    """Names of the cables."""
    motors: tuple[str, ...]
    """Names of the motors."""
    steps: int
    """Steps that were taken."""
    parts: int
    """Parts into which they were divided."""
    frictionless_parts: int
    """Parts of these, of a few millionths of a second, in which contacts slid without friction, since the part had no answer with it."""
    iterations: int
    """Iterations of all steps."""
    estimated_error: float
    """The greatest error of a step in m, as estimated; 0 where no tolerance was given."""
    ok: bool = True
    """Whether the motion is there to its end; if not it belongs to a :class:`whipcord.errors.MotionError`."""

    @property
    def tip(self) -> Array:
        """(N, 3) positions of the tip in m."""
        return self.position[:, -1]

    def __len__(self) -> int:
        return len(self.time)

    def _columns(self) -> dict[str, npt.NDArray[Any]]:
        """The columns of motion.csv of the command, without units in their names."""
        columns: dict[str, npt.NDArray[Any]] = {"t": self.time}
        columns |= {f"tip_{axis}": self.tip[:, k].copy() for k, axis in enumerate("xyz")}
        columns |= {f"tip_q{axis}": self.orientation[:, -1, k].copy() for k, axis in enumerate("wxyz")}
        columns["tip_speed"] = np.linalg.norm(self.velocity[:, -1, :3], axis=1)
        for k, name in enumerate(self.cables):
            for what, values in (("tension", self.tension), ("length", self.length), ("slack", self.slack)):
                columns[f"{what}:{name}"] = values[:, k].copy()
        for k, name in enumerate(self.motors):
            of_motor = (("position", self.motor_position), ("rate", self.motor_velocity), ("effort", self.motor_effort))
            for what, values in of_motor:
                columns[f"{what}:{name}"] = values[:, k].copy()
        columns["contact_force"] = np.array([sum(of.force or 0.0 for of in touching) for touching in self.contacts])
        return columns | dict(self.energy)

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` with a line for each state: time, tip, its speed, the cables and the energies; SI."""
        from .export import to_pandas

        return to_pandas(self._columns())

    def to_polars(self) -> Any:
        """A ``polars.DataFrame`` with the same lines."""
        from .export import to_polars

        return to_polars(self._columns())

    def to_arrow(self) -> Any:
        """A ``pyarrow.Table`` with the same lines."""
        from .export import to_arrow

        return to_arrow(self._columns())

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes the same lines as CSV.

        Parameters
        ----------
        path
            The file, which is replaced if it exists.
        """
        from .export import to_csv

        to_csv(self._columns(), path)

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Writes the same lines as Parquet (needs the package pyarrow).

        Parameters
        ----------
        path
            The file, which is replaced if it exists.
        """
        from .export import to_parquet

        to_parquet(self._columns(), path)

    def __repr__(self) -> str:
        end = self.time[-1] if len(self) else 0.0
        return f"<Motion of {end:.4g} s: {len(self)} states, {self.steps} steps>"


@dataclass(frozen=True, eq=False, repr=False)
class State:
    """A robot at a time of its motion; the arrays are those of :class:`Motion` without their rows."""

    time: float
    """Time in s."""
    position: Array
    """(n, 3) positions of the nodes in m."""
    orientation: Array
    """(n, 4) quaternions (w, x, y, z) of the nodes."""
    velocity: Array
    """(n, 6) velocities of the nodes in their own frames: m/s, then rad/s."""
    strain: Array
    """(q, 6) strains at the two points of each element."""
    tension: Array
    """(c,) tensions of the cables in N."""
    length: Array
    """(c,) lengths of the cables inside the robot in m."""
    slack: Array
    """(c,) by how much in m a cable is longer than its path."""
    passage_tensions: tuple[Array, ...]
    """Of each cable (p,) tensions of its passages in N."""
    lengths_beyond: tuple[Array, ...]
    """Of each cable (p,) unstretched lengths in m beyond the near holes of its passages."""
    motor_output: Array
    """(m,) motion of the spool or drive of each motor in rad or m."""
    motor_position: Array
    """(m,) angles in rad or travels in m of the motors, before their gears."""
    motor_velocity: Array
    """(m,) their rates in rad/s or m/s."""
    motor_effort: Array
    """(m,) torques in N·m or forces in N."""
    motor_integral: Array
    """(m,) integrals of the errors of the position loops over time."""
    energy: Mapping[str, float]
    """Energies in J, as of :class:`Motion`."""
    contacts: tuple[Contact, ...]
    """The places where the robot touches obstacles."""
    _inner: _core.SimulationState = field(repr=False)

    @property
    def tip(self) -> Array:
        """(3,) position of the tip in m."""
        tip: Array = self.position[-1]
        return tip

    def __repr__(self) -> str:
        return f"<State at {self.time:.6g} s>"


@dataclass(frozen=True, eq=False, repr=False)
class Modes:
    """Natural vibrations about an equilibrium, from the lowest frequency on.

    Examples
    --------
    >>> import whipcord
    >>> modes = whipcord.load("examples/released-arm.toml").modes(4)
    >>> modes.frequency.shape, modes.displacement.shape[2]
    ((4,), 3)
    >>> bool((modes.damped_frequency < modes.frequency).all())
    True
    """

    frequency: Array
    """(k,) frequencies in Hz without damping; NaN where the equilibrium is unstable in this shape."""
    damped_frequency: Array
    """(k,) frequencies in Hz with damping; NaN as well where the damping is critical or more."""
    damping_ratio: Array
    """(k,) damping ratios, 1 where the damping is critical."""
    squared_angular_frequency: Array
    """(k,) squares of the angular frequencies in rad²/s²; negative where the equilibrium is unstable."""
    energy: Array
    """(k, 4) shares of the kinetic energy along x, y and z of the world, and of the rotations."""
    displacement: Array
    """(k, n, 3) displacements of the nodes in m along the axes of the world, for a modal mass of 1 kg·m²."""
    rotation: Array
    """(k, n, 3) rotations of the nodes in rad in the same scale."""
    arc_length: Array
    """(n,) arc lengths of the nodes in m."""
    position: Array
    """(n, 3) positions of the nodes in the equilibrium in m."""
    orientation: Array
    """(n, 4) quaternions (w, x, y, z) of the nodes there."""

    def __len__(self) -> int:
        return len(self.frequency)

    def __repr__(self) -> str:
        shown = ", ".join(f"{value:.4g}" for value in self.frequency[:4])
        return f"<Modes: {shown}{', ...' if len(self) > 4 else ''} Hz>"


@dataclass(frozen=True, eq=False, repr=False)
class Linearized:
    """The motion linearised about a state: ẋ ≈ f + A (x − x₀) + B (τ − τ₀), with the tensions τ of all cables. The state x holds six
    velocities of each node but the one at the base, in its own frame, and then six strains of each of the two points of each element. With
    a free base the displacement of the base comes before them, and the velocities begin with its own."""

    a: Array
    """(s, s) A, in 1/s for components of one unit."""
    b: Array
    """(s, c) B, by tensions in N."""
    rate: Array
    """(s,) f, the rate at the state."""

    def __repr__(self) -> str:
        return f"<Linearized: {self.b.shape[0]} states, {self.b.shape[1]} inputs>"


class Simulation:
    """A robot in motion, taken forward step by step.

    Parameters
    ----------
    case
        Robot, loads and base, and the commands to start from. What ``[motion]`` of its file says holds, too: its commands stay in
        force until :meth:`step` gets others.
    model, method, tolerance, initial, elements, damping, drag, base, tension, shortening, motors, loads
        As for :meth:`whipcord.Case.simulate`; commands are values or rows of times and values.

    Examples
    --------
    An arm that is pulled by a controller at its tip's height:

    >>> import whipcord
    >>> case = whipcord.load("examples/released-arm.toml")
    >>> simulation = Simulation(case, initial="rest")
    >>> for _ in range(20):
    ...     simulation.step("5 ms", tension=[2.0, 0.0])
    >>> bool(simulation.tip[0] > 0.01), round(simulation.time, 9)
    (True, 0.1)
    >>> kept = simulation.state
    >>> simulation.step("5 ms", loads=whipcord.Loads(tip_force=[0, "0.1 N", 0]))
    >>> simulation.restore(kept)
    >>> round(simulation.time, 9)
    0.1
    """

    def __init__(
        self,
        case: Case,
        *,
        model: Literal["cosserat", "cosserat-disks"] | None = None,
        method: str | None = None,
        tolerance: Quantity | None = None,
        initial: str | State | Motion | None = None,
        elements: int | None = None,
        damping: Damping | Mapping[str, Any] | Quantity | None = None,
        drag: Mapping[str, Quantity] | Quantity | None = None,
        base: Mapping[str, Any] | None = None,
        tension: Courses | None = None,
        shortening: Courses | None = None,
        motors: Courses | None = None,
        loads: LoadsOverTime | None = None,
    ) -> None:
        setup = setup_of(
            case,
            model=model,
            method=method,
            tolerance=tolerance,
            initial=initial,
            elements=elements,
            damping=damping,
            drag=drag,
            base=base,
            tension=tension,
            shortening=shortening,
            motors=motors,
            loads=loads,
        )
        self._case, self._inner = case, _core.Simulation(setup)
        self._arc_length: Array = self._inner.arc_length()
        self._loads: Loads | None = None
        self._read: State | None = None

    def step(
        self,
        dt: Quantity,
        *,
        tension: Commands | None = None,
        shortening: Commands | None = None,
        motors: Commands | None = None,
        loads: Loads | None = None,
    ) -> None:
        """Takes a step.

        Parameters
        ----------
        dt
            Its length in s.
        tension
            (c,) tension of each cable in N from now on; None for a cable that keeps its command.
        shortening
            (c,) shortening of each cable in m from now on, likewise.
        motors
            (m,) angle in rad or travel in m of each motor from now on, likewise.
        loads
            Forces and moments from now on, in place of those of the case. Gravity and masses stay those of the case. Point
            loads act on the nearest node.

        Raises
        ------
        MotionError
            Where the equations of the step are not solved. The state is then that before the step.
        """
        length = in_si(dt, "dt", "time")
        tensions, shortenings = listed(tension, "tension"), listed(shortening, "shortening")
        if loads is not None and loads is not self._loads:
            tables = {**self._case._tables, "loads": part(loads, Loads, "loads"), "motion": None}
            self._inner.set_loads(_core.Setup.of_tables(tables, "loads"))
            self._loads = loads
        self._inner.step(length, tensions, shortenings, listed(motors, "motors"))
        self._read = None

    @property
    def state(self) -> State:
        """The state, which can be kept to go on from."""
        if self._read is None:
            values = self._inner.read()
            energy = {name: float(value[0]) for name, value in values.pop("energy").items()}
            time = float(values.pop("time")[0])
            (contacts,) = map(contacts_of, values.pop("contacts"))
            passages, beyond = (
                tuple(of[0] for of in values.pop(name)) for name in ("passage_tensions", "lengths_beyond")
            )
            rows = {name: value[0] for name, value in values.items()}
            self._read = State(
                time=time,
                energy=energy,
                contacts=contacts,
                passage_tensions=passages,
                lengths_beyond=beyond,
                _inner=self._inner.state(),
                **rows,
            )
        return self._read

    def restore(self, state: State) -> None:
        """Goes on from a state of a simulation of the same robot, with its commands; the loads stay.

        Parameters
        ----------
        state
            The state.
        """
        if not isinstance(state, State):
            raise InputError(f"state must be a State, but is {state!r}", path="state")
        self._inner.restore(state._inner)
        self._read = None

    @property
    def time(self) -> float:
        """Time in s."""
        return self._inner.time

    @property
    def arc_length(self) -> Array:
        """(n,) arc lengths of the nodes in m."""
        return self._arc_length

    @property
    def position(self) -> Array:
        """(n, 3) positions of the nodes in m."""
        return self.state.position

    @property
    def orientation(self) -> Array:
        """(n, 4) quaternions (w, x, y, z) of the nodes."""
        return self.state.orientation

    @property
    def velocity(self) -> Array:
        """(n, 6) velocities of the nodes in their own frames: m/s, then rad/s."""
        return self.state.velocity

    @property
    def tip(self) -> Array:
        """(3,) position of the tip in m."""
        return self.state.tip

    @property
    def tension(self) -> Array:
        """(c,) tensions of the cables in N."""
        return self.state.tension

    @property
    def length(self) -> Array:
        """(c,) lengths of the cables inside the robot in m."""
        return self.state.length

    @property
    def slack(self) -> Array:
        """(c,) by how much in m a cable is longer than its path."""
        return self.state.slack

    @property
    def energy(self) -> Mapping[str, float]:
        """Energies in J, as of :class:`Motion`."""
        return self.state.energy

    @property
    def method(self) -> str:
        """The method of the last step: those with cables that are driven by their lengths, and those in contact, are taken by ``"robust"``."""
        return self._inner.method

    @property
    def momentum(self) -> Array:
        """(3,) linear momentum in kg·m/s in the world."""
        return np.array(self._inner.momentum())

    @property
    def angular_momentum(self) -> Array:
        """(3,) angular momentum in kg·m²/s about the origin of the world."""
        return np.array(self._inner.angular_momentum())

    @property
    def base_wrench(self) -> Array:
        """(6,) force in N and moment in N·m about the base that the base exerts on robot and cables, in the world."""
        return np.array(self._inner.base_wrench())

    def modes(self, count: int = 6) -> Modes:
        """Natural vibrations about the state, which should be an equilibrium: its velocities are ignored. What touches an obstacle
        goes on to touch it, and stays at its place where there is friction. A robot whose base is free has six of frequency 0.

        Parameters
        ----------
        count
            How many, from the lowest frequency on.
        """
        return Modes(**self._inner.modes(_count(count)))

    def linearize(self) -> Linearized:
        """The motion linearised about the state. What touches an obstacle goes on to touch it, sticking or sliding as it does."""
        return Linearized(**self._inner.linearize())

    def __repr__(self) -> str:
        return f"<Simulation of {self._case.title!r} at {self.time:.6g} s>"


def simulate(
    case: Case,
    duration: Quantity | None,
    timeout: float | None,
    **options: Any,
) -> Motion:
    """See :meth:`whipcord.Case.simulate`."""
    setup = setup_of(case, duration=duration, **options)
    values, failed = _core.simulate(setup, seconds(timeout))
    names = tuple(cable.name for cable in case.robot.cables)
    motors = tuple(motor.name for motor in case.robot.motors)
    values["contacts"] = tuple(map(contacts_of, values["contacts"]))
    for name in ("passage_tensions", "lengths_beyond"):
        values[name] = tuple(values[name])
    motion = Motion(cables=names, motors=motors, ok=failed is None, **values)
    if failed is None:
        return motion
    if isinstance(failed, MotionError):
        failed.motion = motion
    raise failed


def modes(case: Case, count: int, time: Quantity | None, model: str | None) -> Modes:
    """See :meth:`whipcord.Case.modes`."""
    at = None if time is None else in_si(time, "time", "time")
    setup = case._setup if model is None else setup_of(case, model=model)
    return Modes(**_core.modes(setup, _count(count), at))


def step_length(dt: Quantity) -> float:
    """The length of a step in s."""
    step = positive(dt, "dt", "time")
    if step is None:
        raise InputError("dt must be a time", path="dt")
    return step


def _count(count: int) -> int:
    number = whole(count, "count")
    if not 1 <= number <= 200:
        raise InputError(f"count must be from 1 to 200, but is {count!r}", path="count")
    return number


def setup_of(
    case: Case,
    *,
    duration: Quantity | None = None,
    step: Quantity | None = None,
    every: Quantity | None = None,
    model: str | None = None,
    method: str | None = None,
    tolerance: Quantity | None = None,
    initial: str | State | Motion | None = None,
    elements: int | None = None,
    damping: Damping | Mapping[str, Any] | Quantity | None = None,
    drag: Mapping[str, Quantity] | Quantity | None = None,
    base: Mapping[str, Any] | None = None,
    tension: Courses | None = None,
    shortening: Courses | None = None,
    motors: Courses | None = None,
    loads: LoadsOverTime | None = None,
) -> _core.Setup:
    """The case with another motion than its file has."""
    tables = dict(case._tables)
    motion = dict(tables.get("motion", {}))
    given = {
        "duration": positive(duration, "duration", "time"),
        "step": positive(step, "step", "time"),
        "model": model,
        "method": method,
        "tolerance": positive(tolerance, "tolerance", "length"),
        "initial": initial if initial is None or isinstance(initial, str) else _kept(initial),
        "elements": None if elements is None else whole(elements, "elements"),
        "drag": {"across": drag, "along": drag} if isinstance(drag, (str, int, float)) else drag,
    }
    motion |= {name: value for name, value in given.items() if value is not None}
    output = positive(every, "every", "time")
    if output is not None:
        motion["output"] = {"every": output}
    if damping is not None:
        table = plain(damping) if not isinstance(damping, (str, int, float)) else {"time": damping}
        tables["backbone"] = {**tables["backbone"], "damping": table}
    times = _Times(motion)
    commands = list(motion.get("commands", ()))
    for courses, key in ((tension, "tension"), (shortening, "shortening"), (motors, "motors")):
        for name, course in _by_name(case, courses, key):
            kind = "motor" if key == "motors" else "cable"
            commands = [entry for entry in commands if entry.get(kind) != name]
            value = times.of(course, f"{key}: {name}")
            commands.append({kind: name, _key(case, name) if key == "motors" else key: value})
    if commands:
        motion["commands"] = commands
    if base is not None:
        motion["base"] = {
            key: value if isinstance(value, (str, bool)) else [times.of(of, f"base: {key}") for of in value]
            for key, value in plain(base).items()
        }
    if loads is not None:
        motion["loads"] = [_load(entry, k, times) for k, entry in enumerate(loads)]
    if motion:
        tables["motion"] = motion
    return _core.Setup.of_tables(tables, "simulate")


def _kept(initial: State | Motion) -> dict[str, Any]:
    """``[motion.initial]`` of a state, or of the last one of a motion."""
    if not isinstance(initial, (State, Motion)):
        message = f"initial must be 'equilibrium', 'rest', the path of a motion in JSON, a State or a Motion, but is {initial!r}"
        raise InputError(message, path="initial")
    last: Any = (lambda rows: rows[-1]) if isinstance(initial, Motion) else (lambda rows: rows)
    table = {
        "strains": last(initial.strain).tolist(),
        "velocities": last(initial.velocity).tolist(),
        "tensions": last(initial.tension).tolist(),
        "motor_outputs": last(initial.motor_output).tolist(),
        "motors": np.column_stack(
            [last(values) for values in (initial.motor_position, initial.motor_velocity, initial.motor_integral)]
        ).tolist(),
    }
    for name in ("passage_tensions", "lengths_beyond"):
        of_cables = [last(values).tolist() for values in getattr(initial, name)]
        table[name] = of_cables if any(of_cables) else []
    return {key: values for key, values in table.items() if values}


def _by_name(case: Case, courses: Courses | None, key: str) -> list[tuple[str, Course]]:
    """The courses with the names of their cables or motors."""
    if courses is None:
        return []
    parts: Sequence[Any] = case.robot.motors if key == "motors" else case.robot.cables
    names = [part.name for part in parts]
    if isinstance(courses, Mapping):
        for name in courses:
            if name not in names:
                kind = "motor" if key == "motors" else "cable"
                raise InputError(f"there is no {kind} {name!r}: the robot has {', '.join(names)}", path=key)
        return list(courses.items())
    if callable(courses):
        courses = [courses]
    return [(name, of) for name, of in zip(names, each(courses, parts, key)) if of is not None]  # type: ignore[arg-type]


def _key(case: Case, name: str) -> str:
    """What the command of a motor is called."""
    spool = next(motor for motor in case.robot.motors if motor.name == name)
    return "angle" if "spool_radius" in plain(spool) else "travel"


def _load(entry: Any, k: int, times: _Times) -> dict[str, Any]:
    """An entry of ``[[motion.loads]]``."""
    if not isinstance(entry, (tuple, list)) or len(entry) != 2:
        raise InputError(
            f"loads[{k}] must be a pair of loads and their factor over time, but is {entry!r}", path="loads"
        )
    factor = times.of(entry[1], f"loads[{k}]")
    rows = factor if isinstance(factor, list) else [[0.0, factor]]
    return {**part(entry[0], Loads, f"loads[{k}]"), "factor": rows}


class _Times:
    """The times of the steps, at which functions are taken."""

    def __init__(self, motion: Mapping[str, Any]) -> None:
        self._motion = motion

    def of(self, course: Course, name: str) -> Any:
        """A course as a robot file has it: a value, or rows of times and values."""
        if callable(course):
            times = self._grid(name)
            values = [float(course(time)) for time in times]
            if not np.isfinite(values).all():
                raise InputError(f"{name}: the function must give finite numbers", path=name)
            return [[time, value] for time, value in zip(times, values)]
        if isinstance(course, (str, int, float, np.number)):
            return course if isinstance(course, str) else float(course)
        rows = course.tolist() if isinstance(course, np.ndarray) else course
        if not all(isinstance(row, (tuple, list, np.ndarray)) and len(row) == 2 for row in rows):
            message = (
                f"{name}: a course over time is a value, rows of a time and a value, or a function, but is {course!r}"
            )
            raise InputError(message, path=name)
        return [[item if isinstance(item, str) else float(item) for item in row] for row in rows]

    def _grid(self, name: str) -> list[float]:
        duration = self._motion.get("duration")
        if duration is None:
            message = f"{name}: a function of the time needs a duration; a Simulation takes the commands of each step"
            raise InputError(message, path=name)
        step = min(self._motion.get("step", _STEP), duration)
        every = self._motion.get("output", {}).get("every")
        interval = min(every if every is not None else step, duration)
        intervals = max(math.ceil(duration / interval - 1e-9), 1)
        if every is None:
            interval = duration / intervals
        inside = max(math.ceil(interval / step - 1e-9), 1)
        return [interval * (k / inside) for k in range(intervals * inside + 1)]
