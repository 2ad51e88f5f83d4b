"""How answers change."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from . import _core
from ._commands import whole
from .batch import numbers
from .errors import InputError, ModelError

if TYPE_CHECKING:
    from .solution import Solution

__all__ = ["Derivatives", "Dexterity", "Gradient", "Place"]

Array = npt.NDArray[np.float64]
Hold = Literal["commands", "tensions", "lengths"]
"""What is held while something else changes: what the case gives, every tension, or the length of every
taut cable."""


@dataclass(frozen=True, eq=False)
class Gradient:
    """The derivative of a scalar by everything that can change."""

    commands: Array
    """(c,) by the tension in N or the shortening in m of each cable."""
    parameters: Array
    """(p,) by each parameter that was asked for."""
    wrenches: Array
    """(n, 6) by a dead force and moment at each station, along the axes of the world."""


class Derivatives:
    """The exact derivatives of one answer, by :meth:`whipcord.Case.differentiate`.

    Every model in equilibrium under loads knows all of them, and so does the four-bar model with the objective
    ``"strain-energy"`` and the length rule ``"free"``. With other options the four-bar model knows those by its commands, the
    shortenings: :attr:`twist_by_command` and :attr:`length_by_command`; all else raises :class:`whipcord.errors.InputError`.

    Where obstacles or cables rub, the answer remembers the way to it: from rest, derivatives by commands and parameters are those of the
    whole way. With ``start=`` among obstacles that rub, and with cables that do not, they are those of the motion that goes on from that
    answer. Compliance, stiffness and derivatives by loads at a place add these to the robot as it stands.

    What says how stations move is along the axes of the world, as positions are. Rotations are turns
    ``dR = φ̂ R``. Compliance and stiffness are along the axes of the base, as the command
    ``whipcord stiffness`` has them.

    Examples
    --------
    >>> import whipcord
    >>> case = whipcord.load("examples/table1/case-3.toml")
    >>> solution, derivatives = case.differentiate()
    >>> here = derivatives.position_by_command[-1, :, 0]
    >>> h = 1e-5
    >>> tips = [case.solve(tension=[solution.tension[0] + d]).tip for d in (h, -h)]
    >>> bool(np.allclose(here, (tips[0] - tips[1]) / (2 * h), rtol=1e-5))
    True
    """

    parameters: tuple[str, ...]
    """Paths of the parameters that were asked for."""

    def __init__(self, inner: _core.Derivatives, parameters: tuple[str, ...]) -> None:
        self._inner, self.parameters = inner, parameters

    @property
    def one_sided(self) -> tuple[str, ...]:
        """What is about to change at the answer, so that these are derivatives of the side that the answer is on: ``"contact"`` (opens, closes, sticks or slides),
        ``"hole"`` (a cable sticks or slides in it), ``"cable"`` (goes slack or becomes taut) and ``"bending"`` (friction against bending sticks or slides)."""
        return tuple(self._inner.one_sided())

    @property
    def lengths_dependent(self) -> bool:
        """Whether the commanded lengths depend on each other, as those of two antagonists do on a backbone that keeps its length: the tensions are then not
        determined, and a command counts by the part that does not contradict the others."""
        return self._inner.lengths_dependent()

    @cached_property
    def twist_by_command(self) -> Array:
        """(n, 6, c) velocity and angular velocity of each station with the command of each cable."""
        return self._inner.commands()

    @cached_property
    def twist_by_tension(self) -> Array:
        """(n, 6, c) the same with the tension of each cable, whatever drives it."""
        return self._inner.tensions()

    @property
    def position_by_command(self) -> Array:
        """(n, 3, c) change of each position with the tension in N or the shortening in m of each cable."""
        part: Array = self.twist_by_command[:, :3]
        return part

    @property
    def rotation_by_command(self) -> Array:
        """(n, 3, c) turn of each station in rad with the command of each cable."""
        part: Array = self.twist_by_command[:, 3:]
        return part

    def twist_by_parameter(self, hold: Hold = "commands") -> Array:
        """(n, 6, p) velocity and angular velocity of each station with each parameter.

        Parameters
        ----------
        hold
            What is held while a parameter changes: the ``"commands"`` of the case, all ``"tensions"``, or the ``"lengths"`` of all taut
            cables.
        """
        return self._inner.parameters(hold)

    @cached_property
    def position_by_parameter(self) -> Array:
        """(n, 3, p) change of each position with each parameter, in its unit; the commands are held."""
        part: Array = self.twist_by_parameter()[:, :3]
        return part

    @property
    def length_by_command(self) -> Array:
        """(c, c) change of the length of each cable in m with the command of each, in N or m."""
        return self._inner.length_by_command()

    @property
    def length_by_tension(self) -> Array:
        """(c, c) change of the length of each cable in m with the tension of each in N."""
        return self._inner.length_by_tension()

    def cables_by_parameter(self, hold: Hold = "commands") -> tuple[Array, Array]:
        """(c, p) change of the length, and (c, p) of the tension, of each cable with each parameter.

        Parameters
        ----------
        hold
            What is held, as for :meth:`twist_by_parameter`.
        """
        return self._inner.cables_by_parameters(hold)

    def compliance(self, at: int | None = None, hold: Hold = "tensions") -> Array:
        """(6, 6) motion of a station, or of the tip, under a dead force in N and moment in N·m on it.

        Rows are translation (x, y, z) in m and rotation in rad, columns force and moment. Stations count from
        0, and from the end where `at` is negative.

        Parameters
        ----------
        at
            Number of the station; by default the tip.
        hold
            What is held, as for :meth:`twist_by_parameter`.
        """
        return self._inner.compliance(self._station(at), hold)

    def stiffness(self, at: int | None = None, hold: Hold = "tensions") -> Array | None:
        """(6, 6) the inverse; None where the place does not yield in every direction.

        Parameters
        ----------
        at
            Number of the station; by default the tip.
        hold
            What is held, as for :meth:`twist_by_parameter`.
        """
        return self._inner.stiffness(self._station(at), hold)

    def _station(self, at: int | None) -> int | None:
        """The number from 0 of a station that is counted from the end where it is negative, as in NumPy."""
        if at is None:
            return None
        number = whole(at, "at", "the number of a station")
        if number >= 0:
            return number
        stations = len(self.twist_by_command)
        if number < -stations:
            message = f"there is no station {number}: they are 0 to {stations - 1}, or -{stations} to -1"
            raise InputError(message, path="at")
        return number + stations

    def pull_back(
        self,
        *,
        position: npt.ArrayLike | None = None,
        rotation: npt.ArrayLike | None = None,
        tension: npt.ArrayLike | None = None,
        length: npt.ArrayLike | None = None,
        hold: Hold = "commands",
    ) -> Gradient:
        """A vector–Jacobian product: the gradient of a scalar from its derivatives by the answer.

        Parameters
        ----------
        position
            (n, 3) its derivative by each position.
        rotation
            (n, 3) its derivative by a turn of each station, in rad about the axes of the world.
        tension, length
            (c,) its derivatives by the tensions and lengths of the cables.
        hold
            What is held when a parameter or a wrench changes.

        Examples
        --------
        >>> import whipcord
        >>> case = whipcord.load("examples/table1/case-3.toml")
        >>> solution, derivatives = case.differentiate()
        >>> weights = np.ones_like(solution.position)
        >>> gradient = derivatives.pull_back(position=weights)
        >>> bool(np.allclose(gradient.commands[0], derivatives.position_by_command.sum()))
        True
        """
        given = [
            ("position", "(n, 3)", position),
            ("rotation", "(n, 3)", rotation),
            ("tension", "(c,)", tension),
            ("length", "(c,)", length),
        ]
        arrays = [
            None if values is None else numbers(values, name, shape, 1 + shape.count("3"))
            for name, shape, values in given
        ]
        return Gradient(**self._inner.pull_back(hold, *arrays))


@dataclass(frozen=True)
class Dexterity:
    """How well the cables of one kind move a place."""

    driven_by: str
    """``"tension"`` or ``"shortening"``."""
    manipulability: float
    """Product of what unit commands move it along its principal directions."""
    directions: int
    """In how many directions they move it."""
    condition: float | None
    """Greatest by least motion; None where they do not move it."""


@dataclass(frozen=True, eq=False)
class Place:
    """How a place of a robot moves and yields; matrices are along the axes of the base."""

    solution: Solution
    """The shape."""
    arc_length: float
    """Where it is, in m."""
    jacobian: Array
    """(6, c) velocity and angular velocity with the command of each cable."""
    driven_by: tuple[str, ...]
    """Whether each of them is a ``"tension"`` in N or a ``"shortening"`` in m."""
    length_jacobian: Array
    """(c, c) change of the length of each cable with the command of each."""
    estimated_error: float | None
    """Relative error, where the numbers come from differences of solutions; None where they are exact."""
    one_sided: tuple[str, ...]
    """What is about to change at the answer, so that the numbers are derivatives of the side that the answer is on: ``"contact"``, ``"hole"``, ``"cable"``,
    ``"bending"``."""
    lengths_dependent: bool
    """Whether the commanded lengths depend on each other, so that the tensions are not determined, and a command counts by the part that does not contradict
    the others."""
    dexterity: tuple[Dexterity, ...]
    """How well the cables move it: those driven by tension, those by shortening."""
    yield_unknown: str | None
    """Why it is not known how the place yields; None where it is. Compliances and stiffnesses then raise
    :class:`whipcord.errors.ModelError`."""
    _yields: dict[str, Array | None]

    @classmethod
    def _of(cls, solution: Solution, values: dict[str, Any]) -> Place:
        values["dexterity"] = tuple(Dexterity(**kind) for kind in values["dexterity"])
        values["driven_by"] = tuple(values["driven_by"])
        values["one_sided"] = tuple(values["one_sided"])
        values.setdefault("yield_unknown", None)
        held = [name for name in values if name.startswith(("compliance", "stiffness"))]
        return cls(solution=solution, _yields={name: values.pop(name) for name in held}, **values)

    def _known(self, name: str) -> Any:
        if self.yield_unknown is not None:
            advice = self.yield_unknown.partition(": ")[2]
            message = f"the model {self.solution.model} does not say how a place yields: {self.yield_unknown}"
            raise ModelError(message, path="model", model=self.solution.model, advice=advice)
        return self._yields[name]

    @property
    def compliance_tensions_held(self) -> Array:
        """(6, 6) motion under force and moment, with the tensions held."""
        compliance: Array = self._known("compliance_tensions_held")
        return compliance

    @property
    def compliance_lengths_held(self) -> Array:
        """(6, 6) the same with all taut cables locked."""
        compliance: Array = self._known("compliance_lengths_held")
        return compliance

    @property
    def stiffness_tensions_held(self) -> Array | None:
        """(6, 6) the inverse; None where the place does not yield in every direction."""
        stiffness: Array | None = self._known("stiffness_tensions_held")
        return stiffness

    @property
    def stiffness_lengths_held(self) -> Array | None:
        """(6, 6) the inverse; None where the place does not yield in every direction."""
        stiffness: Array | None = self._known("stiffness_lengths_held")
        return stiffness

    @property
    def compliance(self) -> Array:
        """(6, 6) compliance with the tensions held."""
        return self.compliance_tensions_held

    @property
    def stiffness(self) -> Array | None:
        """(6, 6) stiffness with the tensions held."""
        return self.stiffness_tensions_held
