"""Exceptions, with the numbers of each as attributes.

All derive from :class:`WhipcordError`:

* :class:`FileError`, a robot file that cannot be used; :class:`FileMissingError` where there is none;
* :class:`InputError`, an argument that cannot be (also a ``ValueError``), and :class:`ModelError`, a model
  that lacks something or cannot take the robot;
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
    "BuckledError",
    "CablesConflictError",
    "ContradictoryLengthsError",
    "FileError",
    "FileMissingError",
    "InputError",
    "ModelError",
    "NoDerivativesError",
    "NoLeverError",
    "NotConvergedError",
    "SectionFoldsError",
    "SectionOutOfReachError",
    "SolveError",
    "StepsTooCoarseError",
    "TensionsNotFoundError",
    "UnreachableLengthError",
    "WhipcordError",
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


class SolveError(WhipcordError):
    """A case without an answer."""


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


class TensionsNotFoundError(SolveError):
    """Tensions that give the prescribed cable lengths were searched for in vain."""


class NoDerivativesError(SolveError):
    """An answer that a small change moves without bound: the robot is about to buckle."""


class StepsTooCoarseError(SolveError):
    """The estimated error does not fall below the tolerance."""

    error: float
    """Estimated error of a position in m."""
    tolerance: float
    """Tolerance in m."""
    steps: int
    """Steps used."""
