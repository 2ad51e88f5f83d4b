"""What cables are told to do."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from ._tables import Quantity
from .errors import InputError
from .robot import Cable

Commands = Union[Sequence[Union[Quantity, None]], "npt.NDArray[np.float64]", Quantity]
"""One value for each cable: in SI or with a unit; None for a cable that is driven otherwise."""


def each(values: Commands | None, cables: tuple[Cable, ...], name: str) -> list[Any]:
    """One value for each cable."""
    if values is None:
        return [None] * len(cables)
    single = isinstance(values, str) or np.ndim(values) == 0  # type: ignore[arg-type]
    listed: list[Any] = [values] if single else list(values)  # type: ignore[arg-type]
    if len(listed) != len(cables) or any(isinstance(value, np.ndarray) for value in listed):
        names = ", ".join(cable.name for cable in cables)
        count = f"{len(cables)} {'entry' if len(cables) == 1 else 'entries'}"
        message = f"{name} must have {count}, one for each cable ({names}), but is {values!r}"
        raise InputError(message, path=name)
    return listed
