"""Warnings: the input is valid but probably a mistake."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable

__all__ = ["WhipcordWarning"]

Notice = tuple[str, str, str, "tuple[str, int, int] | None"]


class WhipcordWarning(UserWarning):
    """A warning about a robot, a case or an answer: the input is valid but probably a mistake.

    Python shows each once for a line of a program; ``warnings.simplefilter("error", WhipcordWarning)`` makes
    them errors.

    >>> import warnings, whipcord
    >>> with warnings.catch_warnings(record=True):
    ...     rod = whipcord.Backbone(length=180, diameter="3 mm")
    ...     case = whipcord.Case(whipcord.Robot(backbone=rod, disks=whipcord.Disks(count=10)))
    >>> [(warning.code, warning.help) for warning in case.warnings]
    [('bare-number', 'write "180 mm", or "180 m" if that is meant')]
    """

    code: str
    """Its name, which stays the same from version to version."""
    message: str
    """What it says."""
    help: str
    """What to do about it."""
    place: tuple[str, int, int] | None
    """Path of the robot file, line and column, counted from 1; None where no key is at fault."""

    def __init__(self, code: str, message: str, help: str, place: tuple[str, int, int] | None = None) -> None:
        super().__init__(code, message, help, place)
        self.code, self.message, self.help, self.place = code, message, help, place

    def __str__(self) -> str:
        place = "" if self.place is None else f"{self.place[0]}:{self.place[1]}:{self.place[2]}: "
        return f"{place}{self.message}; {self.help}"


def listed(notices: Iterable[Notice]) -> list[WhipcordWarning]:
    """The warnings that the extension module has found."""
    return [WhipcordWarning(*notice) for notice in notices]


def distinct(found: Iterable[WhipcordWarning]) -> list[WhipcordWarning]:
    """The first of each code."""
    return list({warning.code: warning for warning in reversed(list(found))}.values())[::-1]


def tell(found: Iterable[WhipcordWarning]) -> None:
    """Has Python show warnings as those of the caller of the package."""
    found = list(found)
    if not found:
        return
    level, frame = 1, sys._getframe()
    # The first frame that is not of this package; a module of its own at the bottom of the stack is the caller, too.
    while frame.f_back is not None and _is_own(frame.f_globals.get("__name__", "")):
        level, frame = level + 1, frame.f_back
    for warning in found:
        warnings.warn(warning, stacklevel=level)


def _is_own(module: str) -> bool:
    return module == "whipcord" or module.startswith("whipcord.")
