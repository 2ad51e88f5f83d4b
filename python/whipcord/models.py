"""Models and their options.

Wherever a model is asked for, its name will do: ``"cosserat"``, ``"cosserat-disks"``, ``"four-bar"``,
``"constant-curvature"``, which has no options, ``"piecewise-constant-curvature"`` or ``"pseudo-rigid-body"``.
These classes are for other options than the defaults.
"""

from __future__ import annotations

import operator
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import Any, Literal, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._commands import seconds
from .errors import InputError

__all__ = ["NAMES", "Cosserat", "CosseratDisks", "FourBar", "PiecewiseConstantCurvature", "PseudoRigidBody"]

NAMES = (
    "cosserat",
    "cosserat-disks",
    "four-bar",
    "constant-curvature",
    "piecewise-constant-curvature",
    "pseudo-rigid-body",
)
"""The models by name."""


@dataclass(frozen=True)
class _Rod:
    tolerance: float | None = None
    """Steps are halved until the estimated error is below this fraction of the length; 1e-6 by default."""
    steps: int | None = None
    """At least this many integration steps, instead of a tolerance."""
    stability: bool | Literal["eigenvalue"] = True
    """Whether it is computed if the answer is stable. ``"eigenvalue"``: its least eigenvalue too, which takes longer."""
    residual: float | None = None
    """Residual at which equilibrium under load counts as met, relative to the scales of the problem."""
    max_iterations: int | None = None
    """Newton iterations that a solve may take, with those at parts of the load; then it ends with
    :class:`whipcord.errors.BudgetSpentError`. By default there are enough for about two seconds."""


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
    max_iterations: int | None = None
    """Newton iterations that a solve may take, as for :class:`Cosserat`."""


@dataclass(frozen=True)
class PiecewiseConstantCurvature:
    """An arc between each two disks, in equilibrium with cables and loads."""

    stability: bool | Literal["eigenvalue"] = True
    """Whether it is computed if the answer is stable. ``"eigenvalue"``: its least eigenvalue too, which takes longer."""
    residual: float | None = None
    """Residual at which equilibrium counts as met, relative to the scales of the problem."""
    max_iterations: int | None = None
    """Newton iterations that a solve may take, as for :class:`Cosserat`."""


@dataclass(frozen=True)
class PseudoRigidBody(PiecewiseConstantCurvature):
    """Rigid bodies on springs between each two disks, in equilibrium with cables and loads."""

    coefficients: Literal["su", "rao"] = "su"
    """Published lengths of the bodies and stiffness of the joints."""


_CLASSES = {
    Cosserat: "cosserat",
    CosseratDisks: "cosserat-disks",
    FourBar: "four-bar",
    PiecewiseConstantCurvature: "piecewise-constant-curvature",
    PseudoRigidBody: "pseudo-rigid-body",
}

ModelLike = Union[str, Cosserat, CosseratDisks, FourBar, PiecewiseConstantCurvature, PseudoRigidBody]
"""A model, by its name or with its options."""
StationsLike = Union[int, "np.integer[Any]", Sequence[float], "npt.NDArray[np.float64]", None]
"""How many equally spaced stations, or their arc lengths in m; None for the disks."""


def core(
    model: ModelLike,
    stations: StationsLike = None,
    actuation: str | None = None,
    timeout: float | None = None,
) -> _core.Model:
    """The model as the extension knows it, whose calls end after ``timeout`` seconds."""
    if not isinstance(model, (str, *_CLASSES)):
        message = f"model must be one of {', '.join(NAMES)}, or a class of whipcord.models, but is {model!r}"
        raise InputError(message, path="model")
    try:
        return _core_model(model, _stations(stations), actuation, seconds(timeout))
    except TypeError as error:
        raise InputError(
            f"an option of the model {model!r} has a wrong type: {error}", path="model"
        ) from None


def _stations(stations: StationsLike) -> int | tuple[float, ...] | None:
    if stations is None:
        return None
    try:
        return operator.index(stations)  # type: ignore[arg-type]
    except TypeError:
        pass
    try:
        arc_lengths = np.asarray(stations)
        if arc_lengths.ndim == 1 and (arc_lengths.dtype.kind in "fiu" or not arc_lengths.size):
            return tuple(arc_lengths.astype(float).tolist())
    except ValueError:
        pass
    message = f"stations must be a whole number or a list of arc lengths in m, but is {stations!r}"
    raise InputError(message, path="stations")


@lru_cache(maxsize=256)
def _core_model(
    model: ModelLike,
    stations: int | tuple[float, ...] | None,
    actuation: str | None,
    timeout: float | None,
) -> _core.Model:
    if isinstance(model, str):
        return _core.Model(model, stations=stations, actuation=actuation, timeout=timeout)
    kind = _CLASSES[type(model)]
    return _core.Model(kind, stations=stations, actuation=actuation, timeout=timeout, **asdict(model))
