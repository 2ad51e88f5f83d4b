"""The answer: where the robot is."""

from __future__ import annotations

import html
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._files import write
from ._html import picture
from .errors import InputError
from .viewing import HEIGHT, Viewer, offered, view
from .warning import WhipcordWarning, listed

if TYPE_CHECKING:
    from .case import Case
    from .robot import Robot

__all__ = [
    "Branches",
    "CableState",
    "CriticalPoint",
    "Diagnostics",
    "Equilibrium",
    "Shape",
    "Solution",
    "Contact",
]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Shape:
    """Frames along the backbone, in the world."""

    arc_length: Array
    """(n,) arc lengths on the undeformed backbone in m."""
    position: Array
    """(n, 3) positions in m."""
    orientation: Array
    """(n, 4) quaternions (w, x, y, z)."""

    @property
    def rotation(self) -> Array:
        """(n, 3, 3) rotation matrices; their columns are the axes of the cross-sections."""
        return rotation(self.orientation)


def rotation(orientation: Array) -> Array:
    """(..., 3, 3) rotation matrices of (..., 4) unit quaternions (w, x, y, z)."""
    w, x, y, z = np.moveaxis(orientation, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


@dataclass(frozen=True)
class CableState:
    """What became of one cable."""

    name: str
    """Its name."""
    tension: float | None
    """In N, below the base where it varies; None from a model that knows no forces."""
    length: float
    """Length of its path inside the robot in m. A slack cable is longer."""
    initial_length: float
    """Length of that path before actuation in m."""
    slack: bool
    """Whether it hangs loose."""
    span_tensions: tuple[float, ...]
    """Tension in N in each span between two disks; empty where friction does not make it vary."""
    slip_states: tuple[str, ...]
    """``"sticks"``, ``"pulled"`` or ``"released"`` in the hole of each disk; empty without friction."""

    @property
    def shortening(self) -> float:
        """Initial minus present length in m."""
        return self.initial_length - self.length


@dataclass(frozen=True)
class MotorState:
    """What a motor was told, and what it holds."""

    name: str
    """Its name."""
    angle: float | None = None
    """Its command in rad; None where its cables were commanded themselves, and of a linear drive."""
    travel: float | None = None
    """Command of a linear drive in m, likewise."""
    torque: float | None = None
    """In N·m, what holds the tensions of its cables without losses in the gear; None from a model that knows no
    forces, and of a linear drive."""
    force: float | None = None
    """Force of a linear drive in N, likewise."""
    utilization: float | None = None
    """How much of its limit that is; above 1 the motor cannot hold the answer. None without a limit."""


@dataclass(frozen=True, eq=False)
class Contact:
    """A place where the robot touches an obstacle."""

    obstacle: str
    """Name of the obstacle."""
    part: str
    """``"backbone"`` or ``"disk"``: what touches it."""
    disk: int | None
    """Number of the disk, from 0 at the base; None where the backbone touches."""
    arc_length: float
    """Arc length of the cross-section that touches, in m."""
    point: Array
    """(3,) the place in m, in the world."""
    normal: Array
    """(3,) unit normal out of the obstacle."""
    force: float | None
    """With how much the obstacle pushes the robot along the normal, in N; None from a model that knows no
    forces."""
    friction: Array | None
    """(3,) force along the surface with which friction holds the robot back, in N; zero where the obstacle
    does not rub, None from a model that knows no forces."""
    sticks: bool
    """Whether friction keeps it from sliding."""
    gap: float
    """Distance between robot and obstacle in m; negative where they overlap by a remainder of the iteration."""


def contacts_of(touching: Iterable[Mapping[str, Any]]) -> tuple[Contact, ...]:
    """Contacts from their values by name."""
    return tuple(
        Contact(
            **{
                **touch,
                "point": np.array(touch["point"]),
                "normal": np.array(touch["normal"]),
                "friction": None if touch["friction"] is None else np.array(touch["friction"]),
            }
        )
        for touch in touching
    )


@dataclass(frozen=True)
class Grasp:
    """What the robot exerts on an obstacle that it touches, all contacts together."""

    obstacle: str
    """Name of the obstacle."""
    contacts: int
    """How many contacts there are."""
    sliding: int
    """How many of them slide, or are about to; without friction all of them are free to."""
    normal_force: float | None
    """Sum of the normal forces in N: how hard the robot presses; None from a model that knows no forces."""
    force: Array | None
    """(3,) force on the obstacle in N, in the world; None from a model that knows no forces."""
    moment: Array | None
    """(3,) moment on the obstacle in N·m, about the origin of the obstacle's frame; None from a model that knows no
    forces."""
    slip_margin: float | None
    """One minus the force along the surface over the greatest that friction can hold, of the contact that is nearest to
    sliding: 0 where one slides. None without friction, and from a model that knows no forces."""


@dataclass(frozen=True, eq=False)
class ObjectContact:
    """A place where a movable object touches an obstacle, or another object."""

    obstacle: str
    """Name of what it touches."""
    point: Array
    """(3,) the place in m, in the world."""
    normal: Array
    """(3,) unit normal towards the object."""
    force: float
    """With how much the object is pushed along the normal, in N."""
    friction: Array
    """(3,) force along the surface on the object in N."""
    sticks: bool
    """Whether friction keeps it from sliding."""
    gap: float
    """Distance in m; negative where they overlap by a remainder of the iteration."""


@dataclass(frozen=True, eq=False)
class ObjectState:
    """A movable object in equilibrium with the robot and the obstacles."""

    obstacle: str
    """Its name."""
    position: Array
    """(3,) origin of its frame in m, in the world."""
    orientation: Array
    """(4,) quaternion (w, x, y, z) from its frame to the world."""
    center_of_mass: Array
    """(3,) in m, in the world."""
    load: Array
    """(6,) its weight and its own force in N and its moment in N·m at its centre of mass, in the world."""
    imbalance: Array
    """(6,) the sum of its load and of all contact forces, about its centre of mass: a remainder of the iteration."""
    slip_margin: float | None
    """As that of a grasp, of all contacts of the object."""
    contacts: tuple[ObjectContact, ...]
    """Where it touches other obstacles than the robot."""


@dataclass(frozen=True)
class CableOverlap:
    """A taut cable that passes through an obstacle: the deepest place in one span between two disks. Cables have no contact
    there, so that the answer leaves out what the obstacle would push the cable with."""

    cable: str
    """Name of the cable."""
    obstacle: str
    """Name of the obstacle."""
    span: int
    """The span between two disks, from 0 at the base."""
    arc_length: float
    """Arc length of the deepest place in m."""
    point: Array
    """(3,) the deepest place in m, in the world."""
    normal: Array
    """(3,) unit normal out of the obstacle, in the world."""
    depth: float
    """How deep it is inside the obstacle, in m."""
    force: float | None
    """The force in N that the cable would press the obstacle with if its holes stayed where they are. None from a model that
    knows no forces, and of a cable that does not run straight between disks."""


@dataclass(frozen=True)
class Diagnostics:
    """How an answer was obtained."""

    iterations: int
    """Newton iterations of the global problem; 0 where there was none to solve."""
    residual: float
    """What is left of the equations, relative to their scale."""
    stability: float | None
    """Least eigenvalue of the tangent stiffness relative to the bare rod's: 1 without load, 0 where the
    robot buckles, negative at an unstable equilibrium. None where it is not known, and for a stable equilibrium
    under loads of a model without ``stability="eigenvalue"``."""
    stability_absent: str | None
    """Why it is not known whether the answer is stable: ``"not-asked"``, ``"no-energy"``, ``"followers"``, ``"dead-moments"``, ``"sliding"``, ``"touching"`` or
    ``"undetermined"``."""
    discretization_error: float | None
    """Estimated error of the positions in m; None where the steps were prescribed."""
    steps: int
    """Integration steps, or sections, from base to tip."""
    stability_lost_at: float | None
    """Fraction of the loads at which the robot left the shape it had; None where it did not."""
    length_misses: list[tuple[str, float]]
    """Cables whose prescribed lengths contradict each other, and how much longer each is in this least-squares answer, in m; empty where
    the lengths are met."""
    unstable: bool
    """Whether the robot leaves this shape at the slightest disturbance."""
    stable: bool | None
    """Whether it does not; None where that is not known, for the reason in `stability_absent`."""


class Solution:
    """A converged answer. Arrays are read-only; copy one to change it.

    Examples
    --------
    >>> import whipcord
    >>> solution = whipcord.load("examples/table1/case-3.toml").solve()
    >>> solution.position.shape, solution.orientation.shape
    ((10, 3), (10, 4))
    >>> bool(np.allclose(solution.tip, [0.04683, 0.07670, 0.14335], atol=1e-4))
    True
    >>> solution.cables[0].slack
    False
    """

    _case: Case
    _model: _core.Model
    _answer: _core.Solution
    _warm: bool

    @classmethod
    def _of(cls, case: Case, model: _core.Model, answer: _core.Solution, start: Solution | None) -> Solution:
        self = cls.__new__(cls)
        self._case, self._model, self._answer, self._warm = case, model, answer, start is not None
        return self

    @cached_property
    def case(self) -> Case:
        """The case that this answers, with the commands that were given."""
        return self._case._answered(self._answer)

    @property
    def robot(self) -> Robot:
        """The robot."""
        return self._case.robot

    @property
    def model(self) -> str:
        """Name of the model."""
        return self._answer.model

    @cached_property
    def position(self) -> Array:
        """(n, 3) positions of the stations in m, in the world."""
        return self._answer.position

    @cached_property
    def orientation(self) -> Array:
        """(n, 4) quaternions (w, x, y, z) of the stations."""
        return self._answer.orientation

    @cached_property
    def arc_length(self) -> Array:
        """(n,) arc lengths of the stations in m."""
        return self._answer.arc_length

    @cached_property
    def plastic_curvature(self) -> Array:
        """(n, 2) plastic curvature in 1/m about x and y of the sections: what friction against bending holds at the stations;
        no rows without such friction."""
        return self._answer.plastic_curvature

    @cached_property
    def rotation(self) -> Array:
        """(n, 3, 3) rotation matrices of the stations."""
        return rotation(self.orientation)

    @cached_property
    def disks(self) -> Shape:
        """The frames of the disks, base disk first."""
        core = self._answer
        return Shape(core.disk_arc_length, core.disk_position, core.disk_orientation)

    @property
    def tip(self) -> Array:
        """(3,) position of the tip in m."""
        tip: Array = self.disks.position[-1]
        return tip

    @property
    def bend(self) -> float:
        """Angle in rad by which the tip's tangent leans from that of the base, from 0 to π."""
        return self._answer.bend[0]

    @property
    def bend_direction(self) -> float:
        """Where it leans to, in rad from x towards y, as the base sees it."""
        return self._answer.bend[1]

    @cached_property
    def cables(self) -> tuple[CableState, ...]:
        """What became of each cable."""
        return tuple(
            CableState(
                **{
                    **state,
                    "span_tensions": tuple(state["span_tensions"]),
                    "slip_states": tuple(state["slip_states"]),
                }
            )
            for state in self._answer.cables
        )

    @cached_property
    def motors(self) -> tuple[MotorState, ...]:
        """What each motor was told and holds.

        Examples
        --------
        >>> import whipcord
        >>> from whipcord import Case, Motor
        >>> rod = whipcord.load("examples/table1/case-3.toml").robot
        >>> spool = Motor(name="bend", cables=[rod.cables[0].name], spool_radius="10 mm")
        >>> case = Case(rod.replace(motors=[spool]), motors=["45 deg"])
        >>> (bend,) = case.solve().motors
        >>> f"{bend.name}: {bend.torque:.4f} N·m at {bend.angle:.4f} rad"
        'bend: 0.0293 N·m at 0.7854 rad'
        """
        return tuple(MotorState(**state) for state in self._case._setup.motors(self._answer))

    @cached_property
    def tension(self) -> Array:
        """(c,) tensions of the cables in N; NaN from a model that knows no forces."""
        known = [np.nan if cable.tension is None else cable.tension for cable in self.cables]
        return np.array(known, dtype=np.float64)

    @cached_property
    def length(self) -> Array:
        """(c,) lengths of the cables inside the robot in m."""
        return np.array([cable.length for cable in self.cables], dtype=np.float64)

    @property
    def base_wrench(self) -> Array | None:
        """(6,) force in N and moment in N·m that rod and cables exert on the base, in its frame; None from
        a model that knows no forces."""
        wrench = self._answer.base_wrench
        return None if wrench is None else np.array(wrench)

    @cached_property
    def contacts(self) -> tuple[Contact, ...]:
        """Where the robot touches the obstacles of its case."""
        return contacts_of(self._answer.contacts)

    @cached_property
    def grasps(self) -> tuple[Grasp, ...]:
        """What the robot exerts on each obstacle that it touches.

        Examples
        --------
        >>> import whipcord
        >>> finger = whipcord.load("examples/contact/gripping-finger.toml")
        >>> (ball,) = finger.solve().grasps
        >>> f"{ball.contacts} contacts press the {ball.obstacle} with {ball.normal_force:.1f} N"
        '3 contacts press the ball with 5.5 N'
        """

        def array(values: list[float] | None) -> Array | None:
            return None if values is None else np.array(values)

        return tuple(
            Grasp(**{**grasp, "force": array(grasp["force"]), "moment": array(grasp["moment"])})
            for grasp in self._answer.grasps
        )

    @cached_property
    def cable_overlaps(self) -> tuple[CableOverlap, ...]:
        """The cables that pass through obstacles between disks, where they have no contact: by cable, span and obstacle.

        Examples
        --------
        >>> import whipcord
        >>> finger = whipcord.load("examples/contact/gripping-finger.toml")
        >>> finger.solve(model="cosserat-disks").cable_overlaps
        ()
        """
        return tuple(
            CableOverlap(**{**overlap, "point": np.array(overlap["point"]), "normal": np.array(overlap["normal"])})
            for overlap in self._case._setup.cable_overlaps(self._answer)
        )

    @cached_property
    def objects(self) -> tuple[ObjectState, ...]:
        """The movable objects of its case, where they are in equilibrium."""

        def arrays(values: dict[str, Any], *keys: str) -> dict[str, Any]:
            return {**values, **{key: np.array(values[key]) for key in keys}}

        def state(of: dict[str, Any]) -> ObjectState:
            touching = [arrays(touch, "point", "normal", "friction") for touch in of["contacts"]]
            known = arrays(of, "position", "orientation", "center_of_mass", "load", "imbalance")
            return ObjectState(**{**known, "contacts": tuple(ObjectContact(**touch) for touch in touching)})

        return tuple(state(of) for of in self._answer.objects)

    @cached_property
    def diagnostics(self) -> Diagnostics:
        """How it was obtained."""
        return Diagnostics(**self._answer.diagnostics)

    @property
    def stable(self) -> bool | None:
        """Whether it is a stable equilibrium. False: the robot leaves this shape at the slightest disturbance. None:
        not known, for the reason in ``diagnostics.stability_absent``."""
        return self.diagnostics.stable

    @property
    def warnings(self) -> list[WhipcordWarning]:
        """Warnings about the answer, such as an unstable equilibrium, a shape that passes through itself or
        a large strain."""
        return listed(self._case._setup.answer_warnings(self._answer))

    def cable_paths(self) -> tuple[Array, ...]:
        """(m, 3) points of each cable in m: at the stations as far as it goes, or in the holes of the disks
        where the model has it run straight between them."""
        return tuple(self._case._setup.cable_paths(self._answer))

    def rms_distance(self, other: Solution) -> float:
        """Root mean square in m of the distances of the disks of two answers, without the base disk.

        Parameters
        ----------
        other
            An answer for a robot with as many disks.
        """
        if not isinstance(other, Solution):
            raise InputError(f"other must be a Solution, but is {other!r}", path="other")
        mine, others = len(self.disks.position), len(other.disks.position)
        if mine != others:
            message = f"a robot with {mine} disks has no distance to one with {others}"
            raise InputError(message, path="other")
        return self._answer.rms_distance(other._answer)

    def report(self) -> str:
        """How this was solved, as a robot file: solved again, it gives the same numbers.

        >>> import whipcord
        >>> solution = whipcord.load("examples/table1/case-3.toml").solve(tension=[2.0])
        >>> again = whipcord.Case.from_toml(solution.report()).solve()
        >>> bool((again.position == solution.position).all())
        True
        """
        of = self.diagnostics
        plain = {"kind": self.model, "stability": True}
        given = {k: v for k, v in self._model.arguments.items() if v is not None}
        asked = {k: v for k, v in given.items() if plain.get(k) != v}
        lines = [
            f"whipcord {_core.VERSION}, model {self.model}",
            ", ".join(f"{key} {value}" for key, value in asked.items()) or "default options",
            "started from a neighbouring solution" if self._warm else "started cold",
            f"{of.steps} steps, {of.iterations} iterations, residual {of.residual:.3g}",
        ]
        if of.discretization_error is not None:
            lines.append(f"estimated error {of.discretization_error:.3g} m")
        if of.stability is not None:
            lines.append(f"stability {of.stability:.6g}" + (", unstable" if of.unstable else ""))
        elif of.stable is not None:
            lines.append("stable" if of.stable else "unstable")
        x, y, z = self.tip.tolist()
        lines.append(f"tip ({x!r}, {y!r}, {z!r}) m")
        comments = "".join(f"# {line}\n" for line in lines)
        return f"{comments}\n{self.case.to_toml()}"

    def plot(self, **options: Any) -> Any:
        """Draws the robot; see :func:`whipcord.plot.solution`.

        Parameters
        ----------
        options
            As for :func:`whipcord.plot.solution`.
        """
        from . import plot

        return plot.solution(self, **options)

    def view(self, *, open: bool | None = None, height: int = HEIGHT) -> Viewer:
        """Shows it in the browser, as :meth:`Case.view` does: the page begins with this model, under the commands and loads
        that this answers.

        Parameters
        ----------
        open
            Whether a tab of the browser is opened: by default, except in a notebook.
        height
            Height of the page in a notebook, in px.
        """
        shown = self.case._of(self._case._setup.as_driven(self._answer, self._model))
        return view(shown.to_toml(), model=offered(self._model), open=open, height=height)

    def svg(self, *, width: float = 980.0, title: str | None = None) -> str:
        """The picture that ``whipcord solve --plot`` draws, as SVG: in space and in three views.

        Parameters
        ----------
        width
            Width of the picture in px.
        title
            Its title; by default that of the case.
        """
        return _core.svg(self.case._setup, [(self.model, self._answer)], width, title)

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` with one line for each station: arc_length, x, y, z, qw, qx, qy, qz."""
        from .export import solution_columns, to_pandas

        return to_pandas(solution_columns(self))

    def to_polars(self) -> Any:
        """A ``polars.DataFrame`` with one line for each station."""
        from .export import solution_columns, to_polars

        return to_polars(solution_columns(self))

    def to_xarray(self) -> Any:
        """An ``xarray.Dataset`` with the dimensions station and cable."""
        from .export import solution_to_xarray

        return solution_to_xarray(self)

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes the shape as the CSV of ``whipcord solve --csv``.

        Parameters
        ----------
        path
            The file, which is replaced if it exists.
        """
        write(path, self._answer.csv())

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Writes one line for each station as Parquet (needs the package pyarrow).

        Parameters
        ----------
        path
            The file, which is replaced if it exists.
        """
        from .export import solution_columns, to_parquet

        to_parquet(solution_columns(self), path)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Solution) and self._answer.state() == other._answer.state()

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return (_unpickled, (self.case, self._answer.state(), self._model.arguments, self._warm))

    def __repr__(self) -> str:
        x, y, z = (1e3 * self.tip).tolist()
        unstable = ", unstable" if self.diagnostics.unstable else ""
        return (
            f"<Solution by {self.model}: tip ({x:.3f}, {y:.3f}, {z:.3f}) mm, "
            f"{len(self.position)} stations{unstable}>"
        )

    def _repr_html_(self) -> str:
        return picture(self.svg(width=620.0), f"<p>{html.escape(repr(self))}</p>")


def begun(start: Solution | None) -> _core.Solution | None:
    """What to start from."""
    if start is None or isinstance(start, Solution):
        return None if start is None else start._answer
    raise InputError(f"start must be a Solution, but is {start!r}", path="start")


def _unpickled(case: Case, state: tuple[Any, ...], arguments: dict[str, Any], warm: bool) -> Solution:
    model = _core.Model(**arguments)
    solution = Solution._of(case, model, _core.Solution.from_state(case._setup, state), None)
    solution._warm = warm
    return solution


@dataclass(frozen=True)
class Equilibrium:
    """An equilibrium under all of the load."""

    branch: int | None
    """Number of its branch; 0 is the path from no load."""
    stable: bool | None
    """Whether the robot stays in it; None where there is no telling."""
    solution: Solution
    """The shape."""


@dataclass(frozen=True, eq=False)
class CriticalPoint:
    """Where the load turns back, or branches part."""

    branch: int
    """Number of the branch."""
    load: float
    """Fraction of the given load."""
    kind: str
    """``"limit"``, ``"cable-slackens"`` or ``"bifurcation"``."""
    tip: Array
    """(3,) position of the tip in m."""


@dataclass(frozen=True)
class Branches:
    """All equilibria under a load."""

    equilibria: tuple[Equilibrium, ...]
    """Branch by branch."""
    critical_points: tuple[CriticalPoint, ...]
    """Where they turn and part."""
    complete: bool
    """Whether every branch was followed to the end; otherwise there may be more."""

    @classmethod
    def _of(cls, case: Case, model: _core.Model, found: tuple[list[Any], list[Any], bool]) -> Branches:
        equilibria, points, complete = found
        return cls(
            tuple(
                Equilibrium(branch, stable, Solution._of(case, model, answer, None))
                for branch, stable, answer in equilibria
            ),
            tuple(CriticalPoint(branch, load, kind, np.array(tip)) for branch, load, kind, tip in points),
            complete,
        )
