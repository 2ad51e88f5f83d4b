"""Robots that take target shapes."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Union

import numpy as np
import numpy.typing as npt

from . import _core
from .errors import InputError

if TYPE_CHECKING:
    from .case import Case

__all__ = ["DesignTarget", "Designed", "design"]

Array = npt.NDArray[np.float64]
Target = Union[str, Mapping[int, Sequence[float]], npt.ArrayLike]
"""A curve such as ``"arc, angle = 90 deg"``, ``"measured"``, a place of the tip in m, places of the disks in m, or a dict of them by
number of the disk from 0."""


@dataclass(frozen=True, eq=False, repr=False)
class DesignTarget:
    """How near the robot of a design comes to one of its targets."""

    disk: npt.NDArray[np.int64]
    """(N,) numbers of the disks with a wanted place, from 0."""
    wanted: Array
    """(N, 3) these places in m."""
    position: Array
    """(N, 3) where the disks are, in m."""
    distance: Array
    """(N,) how far they are off, in m."""
    check: float | None
    """Greatest distance by ``cosserat-disks`` at a fine resolution in m; None where it has no answer."""

    def __repr__(self) -> str:
        if len(self.disk) == 0:
            return "<DesignTarget without places>"
        return f"<DesignTarget of {len(self.disk)} disks, {1e3 * self.distance.max():.3g} mm off at most>"


@dataclass(frozen=True, eq=False, repr=False)
class Designed:
    """A robot that was designed for target shapes, and what is known of it.

    Examples
    --------
    >>> import whipcord
    >>> case = whipcord.load("examples/table1/case-3.toml").replace(tension=["8 N"])
    >>> found = case.design("s, angle = 20 deg", vary=["cables[0].holes", "cables[0].tension"])
    >>> found.proven
    False
    >>> [finding["vary"] for finding in found.findings]
    ['cables[0].holes', 'cables[0].tension']
    >>> bool(found.error < found.before["error"])
    True
    """

    case: Case
    """The robot with the commands of the design; several targets are steps."""
    targets: tuple[DesignTarget, ...]
    """One for each target."""
    values: dict[str, Any]
    """All that ``whipcord design --json`` prints."""

    @property
    def error(self) -> float:
        """Root of the mean of the squared distances of all disks from their wanted places, in m."""
        return float(self.values["error"])

    @property
    def largest_error(self) -> float:
        """Greatest of these distances in m."""
        return float(self.values["largest_error"])

    @property
    def lower_bound(self) -> float | None:
        """The `error` that no other list of holes is below with these tensions, in m, as far as that is known. It is `error` itself where the list
        is proven to be the best, and None where no holes were varied or nothing is known."""
        found: float | None = self.values["lower_bound"]
        return found

    @property
    def before(self) -> dict[str, float] | None:
        """``error`` and ``largest_error`` of the robot as it was; None where it has no answer."""
        found: dict[str, float] | None = self.values["before"]
        return found

    @property
    def proven(self) -> bool:
        """Whether no better robot exists within the rules, as is proven."""
        return bool(self.values["proven"])

    @property
    def findings(self) -> list[dict[str, Any]]:
        """Of each quantity that was varied what is known: ``vary``, ``known``, ``proven`` and ``words``."""
        found: list[dict[str, Any]] = self.values["findings"]
        return found

    @property
    def ended(self) -> str | None:
        """What ended the search before it came to its end, ``"solves"`` or ``"time"``; then the robot is the best until then. None where nothing did."""
        found: str | None = self.values["ended"]
        return found

    @property
    def solves(self) -> int:
        """Solves of whole shapes that the search took."""
        return int(self.values["solves"])

    @property
    def criteria(self) -> list[dict[str, Any]]:
        """Of each criterion ``quantity``, ``weight``, ``limit``, ``value``, ``before`` and whether it is ``met``, in SI units."""
        found: list[dict[str, Any]] = self.values["criteria"]
        return found

    @property
    def tolerances(self) -> dict[str, Any] | None:
        """What deviations of manufacture do, in SI units; None where they were not asked for."""
        found: dict[str, Any] | None = self.values["tolerances"]
        return found

    def __repr__(self) -> str:
        known = "proven" if self.proven else "not proven"
        return f"<Designed: {1e3 * self.error:.3g} mm off on average, {known}>"


def design(
    case: Case | str | os.PathLike[str],
    target: Target | None = None,
    *,
    vary: str | Sequence[str],
    **options: Any,
) -> Designed:
    """Changes a robot so that it takes target shapes, as ``whipcord design`` does.

    Parameters
    ----------
    case
        The robot with its commands and loads, or the name of its file.
    target
        A curve such as ``"arc, angle = 90 deg"``, ``"measured"``, or places in m.
    vary
        What may change, such as ``"cables[0].holes"``.
    options
        Those of :meth:`Case.design`, such as `targets`, `path`, `criteria`, `max_jump`, `limits` and `tolerances`.

    Returns
    -------
    Designed
        The robot, how near it comes to its targets, and what is proven.

    Examples
    --------
    >>> import whipcord
    >>> file = whipcord.examples.path("table1/case-3.toml")
    >>> found = whipcord.design(file, "s, angle = 20 deg", vary=["cables[0].holes", "cables[0].tension"], max_jump=3)
    >>> bool(found.error < found.before["error"])
    True
    """
    from .case import Case, load

    changed = case if isinstance(case, Case) else load(case)
    return changed.design(target, vary=vary, **options)


def wanted(target: Target, disks: int, tension: Any, weight: float | None) -> dict[str, Any]:
    """A target for the extension module."""
    curve: str | None = None
    points: list[tuple[int, tuple[float, ...]]] | None = None
    if isinstance(target, str):
        curve = None if target.strip() == "measured" else target
    elif isinstance(target, Mapping):
        points = [(int(disk), row(place)) for disk, place in target.items()]
    else:
        places = np.asarray(target, dtype=np.float64)
        if places.shape == (3,):
            points = [(disks - 1, row(places))]
        elif places.ndim == 2 and places.shape[1] == 3 and len(places) in (disks - 1, disks):
            first = disks - len(places)
            points = [(first + k, row(place)) for k, place in enumerate(places) if first + k > 0]
        else:
            message = (
                f"target must be a curve, a place of the tip, or {disks - 1} places of the disks beyond the base, "
                f"but has the shape {places.shape}"
            )
            raise InputError(message, path="target")
    given = None if tension is None else [float(value) for value in np.atleast_1d(tension)]
    return {"curve": curve, "points": points, "path": None, "tension": given, "weight": weight}


def along(path: npt.ArrayLike) -> dict[str, Any]:
    """Places of the tip for the extension module."""
    places = np.asarray(path, dtype=np.float64)
    if places.ndim != 2 or places.shape[1] != 3 or len(places) == 0:
        raise InputError(f"path must be (N, 3) places of the tip, but has the shape {places.shape}", path="path")
    return {"curve": None, "points": None, "path": [row(place) for place in places], "tension": None, "weight": None}


def row(place: Any) -> tuple[float, ...]:
    """A place as three numbers."""
    found = np.asarray(place, dtype=np.float64)
    if found.shape != (3,) or not np.isfinite(found).all():
        raise InputError(f"a place must be three finite numbers in m, but is {place!r}", path="target")
    return tuple(float(value) for value in found)


def found(
    case: Case,
    targets: list[dict[str, Any]],
    table: dict[str, Any],
    model: _core.Model,
    chosen: bool,
    tolerances: bool,
) -> Designed:
    """Designs the robot of a case."""
    tables = dict(case._tables)
    given = {**tables.get("design", {}), **table}
    if targets:
        given.pop("targets", None)
    tables["design"] = given
    setup = case._setup.beside_goal(_core.Setup.of_tables(tables, "design"))
    values = _core.design(setup, model, targets, chosen, tolerances)
    near = tuple(DesignTarget(**each) for each in values["targets"])
    return Designed(type(case)._of(values["setup"]), near, json.loads(values["json"]))
