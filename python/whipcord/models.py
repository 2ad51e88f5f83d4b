"""Models and their options.

Wherever a model is asked for, its name will do: ``"cosserat"``, ``"cosserat-disks"`` or ``"four-bar"``.
These classes are for other options than the defaults.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import Literal, Union

import numpy as np
import numpy.typing as npt

from . import _core

__all__ = ["NAMES", "Cosserat", "CosseratDisks", "FourBar"]

NAMES = ("cosserat", "cosserat-disks", "four-bar")
"""The models by name."""


@dataclass(frozen=True)
class _Rod:
    tolerance: float | None = None
    """Steps are halved until the estimated error is below this fraction of the length; 1e-9 by default."""
    steps: int | None = None
    """At least this many integration steps, instead of a tolerance."""
    stability: bool = True
    """Whether the stability of the answer is computed."""
    residual: float | None = None
    """Residual at which equilibrium under load counts as met, relative to the scales of the problem."""


@dataclass(frozen=True)
class Cosserat(_Rod):
    """Cosserat rod with continuous cables.

    Examples
    --------
    >>> import whipcord
    >>> case = whipcord.load("examples/table1/case-3.toml")
    >>> case.solve(model=Cosserat(steps=24)).diagnostics.discretization_error is None
    True
    """


@dataclass(frozen=True)
class CosseratDisks(_Rod):
    """Cosserat rod with cables that run straight from hole to hole."""


@dataclass(frozen=True)
class FourBar:
    """Four-bar sections, the paper's optimisation-based model."""

    objective: Literal["coupler-angle", "strain-energy", "as-printed"] = "coupler-angle"
    """What is minimised in a section."""
    chord: Literal["bisector", "arc"] = "bisector"
    """How the backbone runs from disk to disk."""
    length_rule: Literal["proportional", "equal", "free"] = "proportional"
    """How a cable's shortening is shared out between the sections."""


ModelLike = Union[str, Cosserat, CosseratDisks, FourBar]
"""A model, by its name or with its options."""
StationsLike = Union[int, Sequence[float], "npt.NDArray[np.float64]", None]
"""How many equally spaced stations, or their arc lengths in m; None for the disks."""


def core(model: ModelLike, stations: StationsLike = None, actuation: str | None = None) -> _core.Model:
    """The model as the extension knows it."""
    if stations is not None and not isinstance(stations, int):
        stations = tuple(np.asarray(stations, dtype=float).ravel().tolist())
    return _core_model(model, stations, actuation)


@lru_cache(maxsize=256)
def _core_model(
    model: ModelLike, stations: int | tuple[float, ...] | None, actuation: str | None
) -> _core.Model:
    if isinstance(model, str):
        return _core.Model(model, stations=stations, actuation=actuation)
    names = {Cosserat: "cosserat", CosseratDisks: "cosserat-disks", FourBar: "four-bar"}
    return _core.Model(names[type(model)], stations=stations, actuation=actuation, **asdict(model))
