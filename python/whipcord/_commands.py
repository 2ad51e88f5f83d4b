"""What cables are told to do."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Mapping, Sequence, Set
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._tables import Quantity
from .errors import InputError
from .motor import Motor
from .robot import Cable, Robot

Commands = Union[Sequence[Union[Quantity, None]], "npt.NDArray[np.float64]", Quantity]
"""One value for each cable: in SI or with a unit; None for a cable that is driven otherwise."""


def listed(values: Commands | None, name: str) -> list[Any] | None:
    """The values in the order of the cables, or None where there are none."""
    if values is None:
        return None
    single = isinstance(values, str) or not isinstance(values, Iterable) or getattr(values, "ndim", 1) == 0
    if isinstance(values, np.ndarray) and values.ndim > 1:
        # Refused with the right shape where the cables are known.
        return values  # type: ignore[return-value]
    given: list[Any] = [values] if single else list(values)  # type: ignore[arg-type]
    given = [v.item() if isinstance(v, (np.ndarray, np.generic)) and v.ndim == 0 else v for v in given]
    # The entries of sets and dicts are in no order of the cables.
    if isinstance(values, (Mapping, Set)) or any(isinstance(value, bool) for value in given):
        message = f"{name} must be a list with one number for each cable, but is {values!r}"
        raise InputError(message, path=name)
    return given


def commanded(
    tension: Commands | None,
    shortening: Commands | None,
    model: _core.Model,
    robot: Robot,
    motors: Commands | None = None,
    name: str = "shortening",
) -> tuple[list[Any] | None, list[Any] | None, list[Any] | None]:
    """The tensions and shortenings in the order of the cables, of which a cable has one, and the commands of the
    motors. `name` is what the shortenings were given as."""
    tensions, shortenings = listed(tension, "tension"), listed(shortening, "shortening")
    angles = listed(motors, "motors")
    for motor, angle in zip(robot.motors, angles if angles is not None else ()):
        if angle is None:
            continue
        pulled = {cable.removeprefix("-") for cable in motor.cables}
        for given, kind in ((tensions, "tension"), (shortenings, name)):
            for cable, value in zip(robot.cables, given if given is not None else ()):
                if value is not None and cable.name in pulled:
                    message = (
                        f"cable {cable.name} has a {kind} and is pulled by the motor {motor.name}, which has a command: "
                        f"leave out one of them (None in its list)"
                    )
                    raise InputError(message, path=kind)
    if tensions is None or shortenings is None or model.arguments.get("actuation") is not None:
        return tensions, shortenings, angles
    for cable, pull, short in zip(robot.cables, tensions, shortenings):
        if pull is not None and short is not None:
            message = (
                f"tension and {name} of cable {cable.name} are both given, and one of them drives it: leave out "
                f"{name} to drive it by tension, or tension to drive it by {name} (of several cables, None in its "
                'list); or give actuation="tension" or "shortening"'
            )
            raise InputError(message, path=name)
    return tensions, shortenings, angles


def each(values: Commands | None, cables: Sequence[Cable | Motor], name: str) -> list[Any]:
    """One value for each cable or motor."""
    given = listed(values, name)
    if given is None:
        return [None] * len(cables)
    if len(given) != len(cables) or any(isinstance(value, np.ndarray) for value in given):
        names = ", ".join(cable.name for cable in cables)
        count = f"{len(cables)} {'entry' if len(cables) == 1 else 'entries'}"
        kind = "motor" if name == "motors" else "cable"
        message = f"{name} must have {count}, one for each {kind} ({names}), but is {values!r}"
        raise InputError(message, path=name)
    return given


def shortening_for(
    length: Commands, shortening: Commands | None, initial: list[float], cables: tuple[Cable, ...]
) -> list[Any]:
    """The shortening of each cable, where some are given by their length."""
    driven = []
    for cable, start, long, short in zip(
        cables, initial, each(length, cables, "length"), each(shortening, cables, "shortening")
    ):
        if long is None:
            driven.append(short)
            continue
        if short is not None:
            message = f"give either the length or the shortening of cable {cable.name}"
            raise InputError(message, path="length")
        driven.append(start - metres(long, "length"))
    return driven


def whole(value: Any, name: str, what: str = "a whole number") -> int:
    """A whole number, of any of the types that are one."""
    try:
        return operator.index(value)
    except TypeError:
        raise InputError(f"{name} must be {what}, but is {value!r}", path=name) from None


def metres(value: Quantity, name: str) -> float:
    """A length in m."""
    if isinstance(value, str):
        return _core.parse_quantity(value, "length")
    try:
        return float(value)
    except (TypeError, ValueError):
        message = f"{name} must be a number in m or a text with a unit, but is {value!r}"
        raise InputError(message, path=name) from None


def seconds(timeout: float | None) -> float | None:
    """A time limit in s; None for none."""
    if timeout is None:
        return None
    try:
        return float(timeout)
    except (TypeError, ValueError):
        message = f"timeout must be a number of seconds, but is {timeout!r}"
        raise InputError(message, path="timeout") from None


def paths(parameters: Sequence[str]) -> list[str]:
    """Paths of parameters."""
    if isinstance(parameters, str) or not all(isinstance(path, str) for path in parameters):
        message = f"parameters must be a list of paths, but is {parameters!r}"
        raise InputError(message, path="parameters")
    return list(parameters)
