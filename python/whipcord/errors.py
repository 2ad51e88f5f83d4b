"""Exceptions, with the numbers of each as attributes.

All derive from :class:`WhipcordError`:

* :class:`FileError`, a robot file that cannot be used; :class:`FileMissingError` where there is none;
* :class:`InputError`, an argument that cannot be (also a ``ValueError``), and :class:`ModelError`, a model
  that lacks something or cannot take the robot;
* :class:`DetectionError`, a photograph in which disks or markers are not found as they must be;
* :class:`CalibrationError`, photographs that do not fix a lens;
* :class:`FitError`, parameters that cannot be estimated;
* :class:`SolveError`, a case without an answer, by its reason.

Only files that cannot be written and packages that are not installed raise Python's own ``OSError`` and
``ModuleNotFoundError``; they name the file, and how to get the package.

>>> import whipcord
>>> issubclass(whipcord.errors.BuckledError, whipcord.SolveError)
True
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

__all__ = [
    "AmbiguousBaseError",
    "BuckledError",
    "BudgetSpentError",
    "CablesConflictError",
    "CalibrationError",
    "ContradictoryLengthsError",
    "DetectionError",
    "FileError",
    "FileMissingError",
    "FitError",
    "FitNotConvergedError",
    "GapError",
    "InputError",
    "MirroredError",
    "ModelError",
    "MotionError",
    "NoDerivativesError",
    "NoLeverError",
    "NoRowError",
    "NotConvergedError",
    "NotInsertedError",
    "NothingFoundError",
    "ObjectOverlapsError",
    "ObstacleInTheWayError",
    "ObstructedError",
    "SectionFoldsError",
    "SectionOutOfReachError",
    "SolveError",
    "StepsTooCoarseError",
    "TensionsNotFoundError",
    "TooFewFoundError",
    "TooManyFoundError",
    "UnreachableLengthError",
    "WhipcordError",
    "WhipcordTimeout",
]


class WhipcordError(Exception):
    """Whatever went wrong here."""

    def __init__(self, message: str, **numbers: Any) -> None:
        super().__init__(message)
        for name, value in numbers.items():
            setattr(self, name, value)

    def __reduce__(self) -> tuple[Any, ...]:
        return (_again, (type(self), self.args[0], dict(self.__dict__)))


def _again(kind: type[WhipcordError], message: str, numbers: dict[str, Any]) -> WhipcordError:
    return kind(message, **numbers)


class FileError(WhipcordError):
    """A robot file that cannot be used. The message shows every place with its line."""

    path: str
    """The file."""
    problems: Sequence[Mapping[str, Any]]
    """All that is wrong: ``message``, ``help``, ``file``, ``line`` and ``column`` of each."""


class FileMissingError(FileError, FileNotFoundError):
    """There is no such robot file."""

    def __str__(self) -> str:
        return str(self.args[0])


class InputError(WhipcordError, ValueError):
    """An argument that cannot be; the message says what was expected."""

    path: str
    """Which one, in the terms of the robot file: ``cables[0].tension``."""
    problems: Sequence[Mapping[str, Any]] = ()
    """Where several are wrong: ``message`` and ``help`` of each."""


class ModelError(InputError):
    """A model that needs something that is not given, or that cannot take a part of the robot."""

    model: str
    """The model."""
    advice: str
    """What to do."""


class DetectionError(WhipcordError):
    """Disks or markers that are not found in a photograph, or not as they must be. Pixels are (column, row)."""


class NothingFoundError(DetectionError):
    """Nothing stands out, nothing of that kind, or all of it does."""


class TooFewFoundError(DetectionError):
    """Fewer than there must be."""

    found: Sequence[tuple[float, float]]
    """Pixel of each, from the base on as far as that could be told."""
    expected: int
    """How many there must be."""
    gaps: Sequence[int]
    """After which of them, from 1, one or more seem to be missing."""


class TooManyFoundError(DetectionError):
    """More than there can be."""

    found: Sequence[tuple[float, float]]
    """Pixel of each."""
    expected: int
    """How many there must be."""
    least_sure: Sequence[tuple[float, float]]
    """Those with the least confidence, as many as are too many."""


class GapError(DetectionError):
    """A gap in the row, and no count that would determine it."""

    found: Sequence[tuple[float, float]]
    """Pixel of each from base to tip."""
    gaps: Sequence[int]
    """After which of them, from 1."""


class NoRowError(DetectionError):
    """What was found does not lie in a row."""

    found: Sequence[tuple[float, float]]
    """Pixel of each."""
    at: tuple[float, float]
    """Where more than two neighbours meet."""


class AmbiguousBaseError(DetectionError):
    """Which end is the base cannot be told."""

    ends: Sequence[tuple[float, float]]
    """Both ends of the row."""


class MirroredError(DetectionError):
    """The distances between the disks fit the robot from the other end."""

    base: tuple[float, float]
    """Where the base was said to be."""
    forward: float
    """Relative deviation of the distances from the robot's, counted from there."""
    reversed: float
    """Counted from the other end."""


class CalibrationError(WhipcordError):
    """Photographs that do not fix the lens of a camera."""

    used: Sequence[int]
    """Numbers of the photographs that show the board, from 0."""
    refused: Sequence[tuple[int, str]]
    """Those that do not, and why."""


class FitError(WhipcordError):
    """Parameters that cannot be estimated. Where a model has no answer, that is the cause (``__cause__``)."""

    case: int | None
    """Number of the case, from 0, that has no answer."""


class FitNotConvergedError(FitError):
    """A fit that has not converged: no estimate."""

    iterations: int
    """Steps of the search."""
    unresolved: Sequence[str]
    """What the measurements cannot tell apart."""


class SolveError(WhipcordError):
    """A case without an answer."""


class WhipcordTimeout(SolveError, TimeoutError):
    """The time limit (``timeout``) was reached before there was an answer."""

    last_load: float | None
    """Fraction of what was given up to which there was an answer, from 0 to 1; None where that is not known."""

    def __str__(self) -> str:
        return str(self.args[0])


class SectionFoldsError(SolveError):
    """The cables wind a section up so far that one of them has no length left in it."""

    cable: str
    """Name of the cable."""
    arc_length: float
    """Where, in m."""
    tension: float
    """Tension of the cable in N."""
    last_load: float
    """Fraction of what was given up to which there was an answer."""


class UnreachableLengthError(SolveError):
    """A prescribed cable length that no tension reaches."""

    cable: str
    """Name of the cable."""
    requested: float
    """Shortening asked for in m."""
    reachable: float
    """Greatest shortening that can be reached in m."""


class ContradictoryLengthsError(SolveError):
    """Cable lengths that cannot be had together."""

    excess: Mapping[str, float]
    """What each of the cables concerned is too long by at the best compromise, in m."""


class SectionOutOfReachError(SolveError):
    """A section that cannot be bent so far that its cable gets as short as prescribed."""

    cable: str
    """Name of the cable."""
    disk: int
    """Number of the section's lower disk; the base disk is 1."""
    requested: float
    """Length prescribed there in m."""
    shortest: float
    """Least length in m that the section takes."""
    longest: float
    """Length in m in the straight section."""


class CablesConflictError(SolveError):
    """Cables whose lengths contradict each other in a section."""

    cable: str
    """Name of the cable that is farthest from its length."""
    first_disk: int
    """Number of the disk where the conflict begins; the base disk is 1."""
    last_disk: int
    """Number of the disk where it ends."""
    excess: float
    """Length of that cable beyond the prescribed one in m."""


class NoLeverError(SolveError):
    """A cable that does not decide which way its section bends."""

    cable: str
    """Name of the cable."""
    disk: int
    """Number of the section's lower disk; the base disk is 1."""


class BuckledError(SolveError):
    """The robot buckles or snaps before all of the load acts, and no shape was found beyond."""

    last_load: float
    """Fraction of the given load at which it does, from 0 to 1."""
    iterations: int
    """Newton iterations spent."""


class NotConvergedError(SolveError):
    """The iteration stopped before the equations were met."""

    iterations: int
    """Newton iterations spent."""
    residual: float
    """What is left of the equations, relative to their scale."""
    last_load: float
    """Fraction of the given load up to which there was an answer, from 0 to 1."""
    advice: str
    """What to do."""


class BudgetSpentError(SolveError):
    """The model's ``max_iterations``, or the budget that every solve has, were spent before there was an answer."""

    iterations: int
    """Newton iterations spent."""
    integration_steps: int
    """Integration steps of all shapes that were tried."""
    last_load: float | None
    """Fraction of what was given up to which there was an answer, from 0 to 1; None where that is not known."""


class ObstacleInTheWayError(SolveError):
    """An obstacle overlaps the robot before anything acts."""

    obstacle: str
    """Name of the obstacle."""
    arc_length: float
    """Arc length in m of the cross-section that it overlaps most."""
    depth: float
    """How far they overlap in m."""


class ObjectOverlapsError(SolveError):
    """A movable object overlaps an obstacle, or another object, before anything moves."""

    object: str
    """Name of one."""
    obstacle: str
    """Name of the other."""
    depth: float
    """How far they overlap in m."""


class ObstructedError(SolveError):
    """The obstacles let the robot get only a part of the way."""

    reached: float
    """The part of the way, from 0 to 1."""
    touching: Sequence[str]
    """Names of the obstacles that it touches there."""


class NotInsertedError(ObstructedError):
    """The robot cannot be inserted into a pipe as far as its base stands."""

    pipe: str
    """Name of the pipe."""
    inserted: float
    """How far it was inserted in m: its length less what its base is still away from its place."""
    length: float
    """Length of the robot in m."""
    why: str
    """Why it gets no farther."""


class TensionsNotFoundError(SolveError):
    """Tensions that give the prescribed cable lengths were searched for in vain."""


class NoDerivativesError(SolveError):
    """An answer that a small change moves without bound: the robot is about to buckle; or one whose cables come to rest in
    their holes on a way that is not known well enough."""


class MotionError(SolveError):
    """A motion that does not go on, or that has no equilibrium to start from."""

    time: float | None
    """Time in s at which it ends; None where it has no start."""
    motion: Any = None
    """The :class:`whipcord.Motion` until then, where :meth:`whipcord.Case.simulate` raised it."""


class StepsTooCoarseError(SolveError):
    """The estimated error does not fall below the tolerance."""

    error: float
    """Estimated error of a position in m."""
    tolerance: float
    """Tolerance in m."""
    steps: int
    """Steps used."""
