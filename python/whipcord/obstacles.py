"""What stands in the robot's way."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar

from ._tables import Quantity, Table

__all__ = ["Obstacle"]

Vector = Sequence[Quantity]


@dataclass(frozen=True, init=False, repr=False)
class Obstacle(Table):
    """A rigid body that the robot touches but does not enter: fixed in the world or, with a mass, a movable object.

    Parameters
    ----------
    kind
        ``"half-space"``, ``"sphere"``, ``"capsule"``, ``"box"``, ``"cylinder"``, ``"pipe"``,
        ``"superellipsoid"`` or ``"mesh"``. Each takes the parameters that it has.
    name
        What messages and reports call it; by default ``"obstacle-1"``, ``"obstacle-2"``, …
    friction
        Coefficient of Coulomb friction between it and the robot; 0 by default.
    position
        (3,) origin of its frame in the world in m.
    orientation
        (4,) quaternion (w, x, y, z) from its frame to the world, of any norm.
    rotation
        The same rotation as a dict of ``axis`` and ``angle``.
    normal
        (3,) direction out of a half-space into free space; instead of `orientation`.
    radius
        Of a sphere, capsule, cylinder or the bore of a pipe, in m.
    length
        Of a cylinder or a capsule's segment along z, in m.
    size
        (3,) lengths of the edges of a box in m.
    points
        (k, 3) points that the middle of a pipe goes through, in m.
    bends
        How it goes from point to point: ``"smooth"`` (default) or ``"corners"``.
    semi_axes, exponents
        (3,) in m and (2,) of a superellipsoid.
    file, unit, scale
        STL or OBJ file of a mesh, the unit of its lengths (``"m"``, ``"cm"``, ``"mm"``, ``"um"`` or ``"in"``),
        and a factor on them.
    mass, density
        One of them, in kg or kg/m³, makes it a movable object: contacts balance its weight, and `Solution.objects` has
        its pose. `position` and `orientation` are then those of rest.
    center_of_mass
        (3,) of a movable object in its frame in m; the centroid of its volume by default.
    force, moment
        (3,) dead force in N at the centre of mass of a movable object, and dead moment in N·m, in the frame of the loads.

    Examples
    --------
    >>> Obstacle(kind="sphere", name="ball", radius="20 mm", position=["30 mm", 0, "80 mm"])
    Obstacle(kind='sphere', name='ball', position=(0.03, 0.0, 0.08), radius=0.02)
    """

    kind: str
    name: str | None = None
    friction: float | None = None
    position: tuple[float, ...] | None = None
    orientation: tuple[float, ...] | None = None
    rotation: Mapping[str, Any] | None = None
    normal: tuple[float, ...] | None = None
    radius: float | None = None
    length: float | None = None
    size: tuple[float, ...] | None = None
    points: tuple[tuple[float, ...], ...] | None = None
    bends: str | None = None
    semi_axes: tuple[float, ...] | None = None
    exponents: tuple[float, ...] | None = None
    file: str | None = None
    unit: str | None = None
    scale: float | None = None
    mass: float | None = None
    density: float | None = None
    center_of_mass: tuple[float, ...] | None = None
    force: tuple[float, ...] | None = None
    moment: tuple[float, ...] | None = None

    _name: ClassVar[str] = "obstacles"

    def __init__(
        self,
        *,
        kind: str,
        name: str | None = None,
        friction: float | None = None,
        position: Vector | None = None,
        orientation: Sequence[float] | None = None,
        rotation: Mapping[str, Any] | None = None,
        normal: Sequence[float] | None = None,
        radius: Quantity | None = None,
        length: Quantity | None = None,
        size: Vector | None = None,
        points: Sequence[Vector] | None = None,
        bends: str | None = None,
        semi_axes: Vector | None = None,
        exponents: Sequence[float] | None = None,
        file: str | os.PathLike[str] | None = None,
        unit: str | None = None,
        scale: float | None = None,
        mass: Quantity | None = None,
        density: Quantity | None = None,
        center_of_mass: Vector | None = None,
        force: Vector | None = None,
        moment: Vector | None = None,
    ) -> None:
        self._set(
            kind=kind,
            name=name,
            friction=friction,
            position=position,
            orientation=orientation,
            rotation=rotation,
            normal=normal,
            radius=radius,
            length=length,
            size=size,
            points=points,
            bends=bends,
            semi_axes=semi_axes,
            exponents=exponents,
            file=None if file is None else os.path.abspath(file),
            unit=unit,
            scale=scale,
            mass=mass,
            density=density,
            center_of_mass=center_of_mass,
            force=force,
            moment=moment,
        )

    def _keep(self, entries: Mapping[str, Any]) -> None:
        super()._keep(entries)
        if self.rotation is not None:
            object.__setattr__(self, "rotation", MappingProxyType(dict(self.rotation)))

    # A view that cannot be changed cannot be pickled.
    def __reduce__(self) -> tuple[Any, ...]:
        return (Obstacle._of, (self.as_dict(),))

    def __hash__(self) -> int:
        return hash(repr(self))
