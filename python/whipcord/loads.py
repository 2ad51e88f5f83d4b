"""What acts on a robot from outside, and where its base is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar

from ._tables import Quantity, Table, parts

__all__ = ["Base", "DistributedLoad", "Loads", "PointLoad", "PointMass", "Step"]

Vector = Sequence[Quantity]


@dataclass(frozen=True, init=False, repr=False)
class PointLoad(Table):
    """A force in N and a moment in N·m at one place of the backbone.

    Parameters
    ----------
    at
        Arc length in m.
    force, moment
        (3,).
    follower
        Whether they turn with the backbone.
    """

    at: float
    force: tuple[float, ...] | None = None
    moment: tuple[float, ...] | None = None
    follower: bool = False

    _name: ClassVar[str] = "loads.point"

    def __init__(
        self,
        *,
        at: Quantity,
        force: Vector | None = None,
        moment: Vector | None = None,
        follower: bool = False,
    ) -> None:
        self._set(at=at, force=force, moment=moment, follower=follower)


@dataclass(frozen=True, init=False, repr=False)
class DistributedLoad(Table):
    """A force in N/m and a moment in N·m/m spread along the backbone.

    Parameters
    ----------
    start, end
        Arc lengths in m at which a constant load begins and ends; base and tip by default.
    at
        Arc lengths in m at which `force` and `moment` are given as lists of vectors, linear between them;
        instead of `start` and `end`.
    force, moment
        (3,), or one such vector for each entry of `at`.
    follower
        Whether they turn with the cross-sections.

    Examples
    --------
    >>> DistributedLoad(start="40 mm", end="140 mm", force=["0", "0.5 N/m", "0"])
    DistributedLoad(start=0.04, end=0.14, force=(0.0, 0.5, 0.0))
    """

    start: float | None = None
    end: float | None = None
    at: tuple[float, ...] | None = None
    force: tuple[Any, ...] | None = None
    moment: tuple[Any, ...] | None = None
    follower: bool = False

    _name: ClassVar[str] = "loads.distributed"

    def __init__(
        self,
        *,
        start: Quantity | None = None,
        end: Quantity | None = None,
        at: Sequence[Quantity] | None = None,
        force: Sequence[Any] | None = None,
        moment: Sequence[Any] | None = None,
        follower: bool = False,
    ) -> None:
        given = {"from": start, "to": end, "at": at, "force": force, "moment": moment}
        self._set(**given, follower=follower)

    # `from` is no name in Python.
    def _keep(self, entries: Mapping[str, Any]) -> None:
        renamed = {"from": "start", "to": "end"}
        super()._keep({renamed.get(key, key): value for key, value in entries.items()})

    def as_dict(self) -> dict[str, Any]:
        """The entries as a robot file has them, in SI."""
        renamed = {"start": "from", "end": "to"}
        return {renamed.get(key, key): value for key, value in super().as_dict().items()}


@dataclass(frozen=True, init=False, repr=False)
class PointMass(Table):
    """A mass that the robot carries. Gravity acts on it.

    Parameters
    ----------
    at
        Arc length of its place in m.
    mass
        The mass in kg.
    """

    at: float
    mass: float

    _name: ClassVar[str] = "loads.mass"

    def __init__(self, *, at: Quantity, mass: Quantity) -> None:
        self._set(at=at, mass=mass)


@dataclass(frozen=True, init=False, repr=False)
class Loads(Table):
    """External loads, fixed in the frame of the base unless they follow or `frame` says otherwise.

    Parameters
    ----------
    frame
        ``"base"`` (default) or ``"world"``: in which gravity and dead loads are given.
    gravity
        (3,) acceleration in m/s².
    tip_force, tip_moment
        (3,) in N and N·m.
    follower
        Whether those two turn with the tip.
    point, distributed, mass
        Further loads, and masses that the robot carries.

    Examples
    --------
    >>> Loads(gravity=["0", "0", "-9.81 m/s^2"], tip_force=[0.05, 0, 0])
    Loads(gravity=(0.0, 0.0, -9.81), tip_force=(0.05, 0.0, 0.0))
    """

    frame: str | None = None
    gravity: tuple[float, ...] | None = None
    tip_force: tuple[float, ...] | None = None
    tip_moment: tuple[float, ...] | None = None
    follower: bool = False
    point: tuple[PointLoad, ...] = ()
    distributed: tuple[DistributedLoad, ...] = ()
    mass: tuple[PointMass, ...] = ()

    _name: ClassVar[str] = "loads"
    _inner: ClassVar[Mapping[str, type[Table]]] = {
        "point": PointLoad,
        "distributed": DistributedLoad,
        "mass": PointMass,
    }

    def __init__(
        self,
        *,
        frame: str | None = None,
        gravity: Vector | None = None,
        tip_force: Vector | None = None,
        tip_moment: Vector | None = None,
        follower: bool = False,
        point: Sequence[PointLoad] = (),
        distributed: Sequence[DistributedLoad] = (),
        mass: Sequence[PointMass] = (),
    ) -> None:
        self._set(
            frame=frame,
            gravity=gravity,
            tip_force=tip_force,
            tip_moment=tip_moment,
            follower=follower,
            point=parts(point, PointLoad, "point"),
            distributed=parts(distributed, DistributedLoad, "distributed"),
            mass=parts(mass, PointMass, "mass"),
        )


@dataclass(frozen=True, init=False, repr=False)
class Base(Table):
    """Where the robot's base is in the world, and how it is turned there.

    Parameters
    ----------
    position
        (3,) in m; the origin by default.
    orientation
        (4,) quaternion (w, x, y, z) from the frame of the base to the world, of any norm.
    rotation
        The same rotation as a dict of ``axis``, (3,) of any length, and ``angle`` in rad.

    Examples
    --------
    >>> Base(rotation={"axis": [0, 1, 0], "angle": "90 deg"}).rotation["angle"]
    1.5707963267948966
    """

    position: tuple[float, ...] | None = None
    orientation: tuple[float, ...] | None = None
    rotation: Mapping[str, Any] | None = None

    _name: ClassVar[str] = "base"

    def __init__(
        self,
        *,
        position: Vector | None = None,
        orientation: Sequence[float] | None = None,
        rotation: Mapping[str, Any] | None = None,
    ) -> None:
        self._set(position=position, orientation=orientation, rotation=rotation)

    def _keep(self, entries: Mapping[str, Any]) -> None:
        super()._keep(entries)
        if self.rotation is not None:
            object.__setattr__(self, "rotation", MappingProxyType(dict(self.rotation)))

    # A view that cannot be changed cannot be pickled.
    def __reduce__(self) -> tuple[Any, ...]:
        return (Base._of, (self.as_dict(),))

    def __hash__(self) -> int:
        turn = self.rotation and tuple(sorted(self.rotation.items()))
        return hash((self.position, self.orientation, turn))


@dataclass(frozen=True, init=False, repr=False)
class Step(Table):
    """One step of actuation, for every cable in order.

    Parameters
    ----------
    tension
        (c,) in N.
    shortening
        (c,) in m, or texts such as ``"5 %"`` of the cable's own initial length.
        Beside `tension`, as for a case: each model is driven by the one that it takes.
    motors
        (m,) angle in rad or travel in m of each motor, instead of shortenings.
    """

    tension: tuple[float, ...] | None = None
    shortening: tuple[Quantity, ...] | None = None
    motors: tuple[float, ...] | None = None

    _name: ClassVar[str] = "steps"

    def __init__(
        self,
        *,
        tension: Vector | None = None,
        shortening: Vector | None = None,
        motors: Vector | None = None,
    ) -> None:
        self._set(tension=tension, shortening=shortening, motors=motors)
