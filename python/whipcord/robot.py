"""What the robot is."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

from . import _core
from ._files import write
from ._html import picture
from ._suggest import suggests
from ._tables import Quantity, Table, part, parts, plain
from .motor import Motor
from .viewing import HEIGHT, Viewer, view

__all__ = [
    "Along",
    "Backbone",
    "BackboneSegment",
    "Cable",
    "Disks",
    "Robot",
    "Routing",
    "Section",
    "SectionStiffness",
]


@dataclass(frozen=True, init=False, repr=False)
class Along(Table):
    """A quantity that is given at arc lengths, and linear between them.

    It is constant before the first place and beyond the last. A place named twice is a step.

    Parameters
    ----------
    at
        Arc lengths in m, ascending.
    values
        The value at each of them, in the unit of the quantity.

    Examples
    --------
    >>> taper = Along(at=["0 mm", "180 mm"], values=["4 mm", "2 mm"])
    >>> Backbone(length="180 mm", diameters=taper).diameters.values
    (0.004, 0.002)
    """

    at: tuple[float, ...]
    values: tuple[Any, ...]

    def __init__(self, *, at: Sequence[Quantity], values: Sequence[Any]) -> None:
        # What the values measure is known where they belong.
        object.__setattr__(self, "at", plain(at))
        object.__setattr__(self, "values", plain(values))


@dataclass(frozen=True, init=False, repr=False)
class Section(Table):
    """A rectangular cross-section.

    Parameters
    ----------
    width, height
        Extent along x and y in m: one value, a list with one for each disk, or one for each entry of `at`.
    at
        Arc lengths in m at which lists are given, instead of the disks.
    """

    width: float | tuple[float, ...]
    height: float | tuple[float, ...]
    at: tuple[float, ...] | None = None

    _name: ClassVar[str] = "backbone.section"

    def __init__(
        self,
        *,
        width: Quantity | Sequence[Quantity],
        height: Quantity | Sequence[Quantity],
        at: Sequence[Quantity] | None = None,
    ) -> None:
        self._set(width=width, height=height, at=at)


@dataclass(frozen=True, init=False, repr=False)
class SectionStiffness(Table):
    """Stiffness of the sections, instead of that of section and material.

    Each entry is one value, a list with one for each disk, or one for each entry of `at`.

    Parameters
    ----------
    bending
        EI about x and y in N·m²: a pair.
    torsion
        GJ in N·m².
    shear
        GA along x and y in N: a pair; not needed where the backbone is not shearable.
    axial
        EA in N; not needed where the backbone is not extensible.
    matrix
        (6, 6), symmetric and positive definite, instead of all others: shear x, shear y, axial, bending x,
        bending y, twist; in N, N·m and N·m².
    at
        Arc lengths in m at which lists are given, instead of the disks.
    """

    at: tuple[float, ...] | None = None
    shear: tuple[Any, ...] | None = None
    axial: float | tuple[float, ...] | None = None
    bending: tuple[Any, ...] | None = None
    torsion: float | tuple[float, ...] | None = None
    matrix: tuple[Any, ...] | None = None

    _name: ClassVar[str] = "backbone.stiffness"

    def __init__(
        self,
        *,
        bending: Sequence[Any] | None = None,
        torsion: Quantity | Sequence[Quantity] | None = None,
        shear: Sequence[Any] | None = None,
        axial: Quantity | Sequence[Quantity] | None = None,
        matrix: Any = None,
        at: Sequence[Quantity] | None = None,
    ) -> None:
        self._set(bending=bending, torsion=torsion, shear=shear, axial=axial, matrix=matrix, at=at)


@dataclass(frozen=True, init=False, repr=False)
class BackboneSegment(Table):
    """A named segment of the backbone, with factors on its stiffness.

    Parameters
    ----------
    name
        Name, unique among the segments; ``segment-1``, ``segment-2``, ... by default. A fit names the segment by it:
        ``backbone.segments[near].bending_factor``.
    group
        Group of segments that it belongs to; a fit can give the segments of a group one number together.
    starts_at
        Arc length in m at which it begins; by default the end of the segment before it, or the base.
    ends_at
        Arc length in m at which it ends; by default the tip.
    bending_factor, torsion_factor, extension_factor, shear_factor
        Factors on EI, GJ, EA and GA; 1 by default.

    Examples
    --------
    >>> near = BackboneSegment(name="near", ends_at="90 mm", bending_factor=1.1)
    >>> near.ends_at, near.bending_factor
    (0.09, 1.1)
    """

    name: str | None = None
    group: str | None = None
    starts_at: float | None = None
    ends_at: float | None = None
    bending_factor: float = 1.0
    torsion_factor: float = 1.0
    extension_factor: float = 1.0
    shear_factor: float = 1.0

    _name: ClassVar[str] = "backbone.segments"

    def __init__(
        self,
        *,
        name: str | None = None,
        group: str | None = None,
        starts_at: Quantity | None = None,
        ends_at: Quantity | None = None,
        bending_factor: Quantity | None = None,
        torsion_factor: Quantity | None = None,
        extension_factor: Quantity | None = None,
        shear_factor: Quantity | None = None,
    ) -> None:
        self._set(
            name=name,
            group=group,
            starts_at=starts_at,
            ends_at=ends_at,
            bending_factor=bending_factor,
            torsion_factor=torsion_factor,
            extension_factor=extension_factor,
            shear_factor=shear_factor,
        )


@dataclass(frozen=True, init=False, repr=False)
class Damping(Table):
    """Forces and moments in the sections of the backbone by the rates of their strains (Kelvin–Voigt), for motion.

    Parameters
    ----------
    time
        Time in s that the stiffness of each section is multiplied by.
    matrix
        (6, 6), symmetric and without negative eigenvalues, instead of a time, in the order of
        :class:`SectionStiffness`; in N·s and N·m·s by rates of the strains.

    Examples
    --------
    >>> Damping(time="1.5 ms")
    Damping(time=0.0015)
    """

    time: float | None = None
    matrix: tuple[tuple[float, ...], ...] | None = None

    _name: ClassVar[str] = "backbone.damping"

    def __init__(self, *, time: Quantity | None = None, matrix: Sequence[Sequence[float]] | None = None) -> None:
        self._set(time=time, matrix=matrix)


@dataclass(frozen=True, init=False, repr=False)
class Backbone(Table):
    """The elastic rod that runs through the disks.

    Every quantity is a number in SI or a text with a unit.

    Parameters
    ----------
    length
        Length of the undeformed backbone in m.
    diameter
        Outer diameter in m of a round rod or tube.
    diameters
        Outer diameter at each disk, or :class:`Along`; instead of `diameter`.
    inner_diameter
        Inner diameter in m of a tube: one value, one for each disk, or :class:`Along`.
    section
        A rectangular cross-section, instead of diameters.
    material
        Name of a material preset (see :func:`materials`). It sets `young_modulus`, `poisson_ratio` or `shear_modulus`,
        `density` and, if it is known, `yield_strain`; entries beside it override single values.
    young_modulus, poisson_ratio, shear_modulus
        Of the material, in Pa; Poisson's ratio or the shear modulus.
    shear_correction
        Timoshenko's factor on the shear stiffness; 1 by default.
    stiffness
        The stiffness itself, instead of a material.
    damping
        Damping of the material, for motion.
    segments
        Named segments with factors on the stiffness, from the base on; a fit can estimate the factors.
    density
        In kg/m³; needed only with gravity.
    linear_density
        Mass per length in kg/m, instead of a density: one value, one for each disk, or :class:`Along`.
    yield_strain
        Strain up to which the material springs back. No model computes with it: an answer with more gets a
        warning; without it, one with more than 10 %.
    yield_moment
        Greatest moment in N·m of the friction against bending inside the backbone: one value, or one about x and one about
        y. The shape then depends on all steps before (``steps``).
    yield_stiffness
        Bending stiffness in N·m² that this friction adds until it slides; 10 times EI by default.
    rest_curvature
        Curvature in 1/m when nothing pulls: about x, about y, twist; one such vector, one for each disk, or
        :class:`Along`.
    extensible, shearable
        Whether it can stretch, and whether its sections can shear.

    Examples
    --------
    >>> rod = Backbone(length="180 mm", diameter="3 mm", young_modulus="1.1 GPa", poisson_ratio=0.3)
    >>> rod
    Backbone(length=0.18, diameter=0.003, young_modulus=1100000000.0, poisson_ratio=0.3)
    >>> rod.replace(diameter="4 mm").diameter
    0.004
    >>> wire = Backbone(length="180 mm", diameter="1 mm", material="nitinol", young_modulus="58 GPa")
    >>> wire.young_modulus, wire.density
    (58000000000.0, 6450.0)
    >>> wire.replace(material="PTFE").young_modulus
    500000000.0
    """

    length: float
    diameter: float | None = None
    inner_diameter: float | tuple[float, ...] | Along | None = None
    diameters: tuple[float, ...] | Along | None = None
    section: Section | None = None
    material: str | None = None
    young_modulus: float | None = None
    poisson_ratio: float | None = None
    shear_modulus: float | None = None
    shear_correction: float = 1.0
    stiffness: SectionStiffness | None = None
    damping: Damping | None = None
    segments: tuple[BackboneSegment, ...] = ()
    density: float | None = None
    linear_density: float | tuple[float, ...] | Along | None = None
    yield_strain: float | None = None
    yield_moment: float | tuple[float, float] | None = None
    yield_stiffness: float | tuple[float, float] | None = None
    rest_curvature: tuple[Any, ...] | Along | None = None
    extensible: bool = True
    shearable: bool = True

    _name: ClassVar[str] = "backbone"
    _inner: ClassVar[Mapping[str, type[Table]]] = {
        "inner_diameter": Along,
        "diameters": Along,
        "section": Section,
        "stiffness": SectionStiffness,
        "damping": Damping,
        "segments": BackboneSegment,
        "linear_density": Along,
        "rest_curvature": Along,
    }

    def __init__(
        self,
        *,
        length: Quantity,
        diameter: Quantity | None = None,
        inner_diameter: Quantity | Sequence[Quantity] | Along | None = None,
        diameters: Sequence[Quantity] | Along | None = None,
        section: Section | Mapping[str, Any] | None = None,
        material: str | None = None,
        young_modulus: Quantity | None = None,
        poisson_ratio: Quantity | None = None,
        shear_modulus: Quantity | None = None,
        shear_correction: Quantity | None = None,
        stiffness: SectionStiffness | Mapping[str, Any] | None = None,
        damping: Damping | Mapping[str, Any] | None = None,
        segments: Sequence[BackboneSegment | Mapping[str, Any]] | None = None,
        density: Quantity | None = None,
        linear_density: Quantity | Sequence[Quantity] | Along | None = None,
        yield_strain: Quantity | None = None,
        yield_moment: Quantity | Sequence[Quantity] | None = None,
        yield_stiffness: Quantity | Sequence[Quantity] | None = None,
        rest_curvature: Sequence[Any] | Along | None = None,
        extensible: bool = True,
        shearable: bool = True,
    ) -> None:
        self._set(
            length=length,
            diameter=diameter,
            inner_diameter=inner_diameter,
            diameters=diameters,
            section=part(section, Section, "section"),
            material=material,
            young_modulus=young_modulus,
            poisson_ratio=poisson_ratio,
            shear_modulus=shear_modulus,
            shear_correction=shear_correction,
            stiffness=part(stiffness, SectionStiffness, "stiffness"),
            damping=part(damping, Damping, "damping"),
            segments=parts(segments, BackboneSegment, "segments"),
            density=density,
            linear_density=linear_density,
            yield_strain=yield_strain,
            yield_moment=yield_moment,
            yield_stiffness=yield_stiffness,
            rest_curvature=rest_curvature,
            extensible=extensible,
            shearable=shearable,
        )

    def replace(self, **changes: Any) -> Backbone:
        """The same backbone with other entries.

        Parameters
        ----------
        changes
            Entries by their names; None removes an entry. Another ``material`` also replaces all constants of the old one.
        """
        if changes.get("material") is not None:
            changes = {**dict.fromkeys(_OF_MATERIAL), **changes}
        return super().replace(**changes)


_OF_MATERIAL = (
    "young_modulus",
    "poisson_ratio",
    "shear_modulus",
    "density",
    "linear_density",
    "yield_strain",
    "stiffness",
)
"""What another material replaces, as in a robot file that extends another file."""


@dataclass(frozen=True, init=False, repr=False)
class Disks(Table):
    """The perforated disks, base disk first.

    Parameters
    ----------
    count
        Number of equally spaced disks, base and tip disk included.
    positions
        Arc length of each disk in m, from 0 to the length of the backbone; instead of `count`.
    hole_circle_radius
        Radius in m of the circle on which the holes lie: one for all disks, or one for each.
    holes
        Number of equally spaced holes of each disk. Hole 1 lies on the x axis; they count
        counter-clockwise, seen from the tip.
    mass
        Mass of each disk in kg.
    outer_radius, thickness
        Of each disk in m, where it touches obstacles; by default the radius of its hole circle and a tenth of
        the outer radius.

    Examples
    --------
    >>> Disks(count=10, hole_circle_radius="8 mm", holes=12)
    Disks(count=10, hole_circle_radius=0.008, holes=12)
    """

    count: int | None = None
    positions: tuple[float, ...] | None = None
    hole_circle_radius: float | tuple[float, ...] | None = None
    holes: int | None = None
    mass: float = 0.0
    outer_radius: float | None = None
    thickness: float | None = None

    _name: ClassVar[str] = "disks"

    def __init__(
        self,
        *,
        count: int | None = None,
        positions: Sequence[Quantity] | None = None,
        hole_circle_radius: Quantity | Sequence[Quantity] | None = None,
        holes: int | None = None,
        mass: Quantity | None = None,
        outer_radius: Quantity | None = None,
        thickness: Quantity | None = None,
    ) -> None:
        self._set(
            count=count,
            positions=positions,
            hole_circle_radius=hole_circle_radius,
            holes=holes,
            mass=mass,
            outer_radius=outer_radius,
            thickness=thickness,
        )


@dataclass(frozen=True, init=False, repr=False)
class Routing(Table):
    """How a cable runs, as a curve in the cross-sections.

    Made by :meth:`straight`, :meth:`helix`, :meth:`linear` or :meth:`polynomial`; angles in rad from x
    towards y, lengths in m. A cable that runs through holes needs none (see :class:`Cable`).

    Parameters
    ----------
    kind
        ``"straight"``, ``"helix"``, ``"linear"`` or ``"polynomial"``: which of the entries below it has.
    angle, start_angle, turns, radius
        Of a straight cable its angle and radius; of a helix its angle at the base, its turns and its radius.
    start, end
        (x, y) of a slanted cable at the base and at the tip.
    x, y
        Coefficients of a polynomial in the arc length.

    Examples
    --------
    >>> Routing.helix(turns=0.75, radius="8 mm")
    Routing(kind='helix', turns=0.75, radius=0.008)
    """

    kind: str
    angle: float | None = None
    start_angle: float | None = None
    turns: float | None = None
    radius: float | None = None
    start: tuple[float, ...] | None = None
    end: tuple[float, ...] | None = None
    x: tuple[float, ...] | None = None
    y: tuple[float, ...] | None = None

    def __init__(self, *, kind: str, **entries: Any) -> None:
        given = {"name": "a", "routing": {"kind": kind, **plain(entries)}}
        self._keep(_core.table_in_si("cables", given)["routing"])

    @classmethod
    def straight(cls, *, angle: Quantity, radius: Quantity) -> Routing:
        """Parallel to the backbone, at this angle and this distance from its axis.

        Parameters
        ----------
        angle
            From the x axis towards y, in rad or as ``"90 deg"``.
        radius
            Distance from the axis, in m or as ``"8 mm"``.
        """
        return cls(kind="straight", angle=angle, radius=radius)

    @classmethod
    def helix(cls, *, turns: Quantity, radius: Quantity, start_angle: Quantity | None = None) -> Routing:
        """Round the backbone, with so many turns over its whole length, positive counter-clockwise.

        Parameters
        ----------
        turns
            Turns over the whole length of the backbone.
        radius
            Distance from the axis, in m or as ``"8 mm"``.
        start_angle
            Angle at the base, from the x axis towards y, in rad or as ``"90 deg"``; 0 by default.
        """
        return cls(kind="helix", start_angle=start_angle, turns=turns, radius=radius)

    @classmethod
    def linear(cls, *, start: Sequence[Quantity], end: Sequence[Quantity]) -> Routing:
        """On the straight line from (x, y) at the base to (x, y) at the tip.

        Parameters
        ----------
        start
            (x, y) at the base, in m or as ``"8 mm"``.
        end
            (x, y) at the tip, likewise.
        """
        return cls(kind="linear", start=start, end=end)

    @classmethod
    def polynomial(cls, *, x: Sequence[float], y: Sequence[float]) -> Routing:
        """By coefficients of x and y in ascending powers of the arc length, in SI.

        Parameters
        ----------
        x, y
            Coefficients of 1, s, s², …, in m, 1, 1/m, ….
        """
        return cls(kind="polynomial", x=x, y=y)


@dataclass(frozen=True, init=False, repr=False)
class Cable(Table):
    """A cable: where it runs and what it is made of.

    Parameters
    ----------
    name
        Name, unique in the robot.
    group
        Group of cables that it belongs to. Cables of a group can share parameters in a fit.
    holes
        The hole it passes at each disk, from the base disk on, counted from 1. A list shorter than the disks
        ends the cable at its last hole.
    interpolation
        How the continuous model leads it from hole to hole: ``"spline"`` (default), ``"pchip"`` or
        ``"fourier"``.
    routing
        Where it runs, as a curve; instead of `holes`.
    hole_angle_offset
        Angle in rad by which it runs beside the centres of its holes at every disk.
    hole_radius_offset
        By how many m it runs farther from the axis than the centres of its holes at every disk.
    ends_at
        Arc length in m at which it is anchored; the tip by default.
    friction
        Capstan friction coefficient at the holes.
    axial_stiffness
        Young's modulus times area in N; inextensible by default.

    Examples
    --------
    >>> Cable(name="pull", holes=[1, 2, 3, 4])
    Cable(name='pull', holes=(1, 2, 3, 4))
    """

    name: str
    holes: tuple[int, ...] | None = None
    interpolation: str | None = None
    routing: Routing | None = None
    ends_at: float | None = None
    friction: float | None = None
    axial_stiffness: float | None = None
    group: str | None = None
    hole_angle_offset: float | None = None
    hole_radius_offset: float | None = None

    _name: ClassVar[str] = "cables"
    _inner: ClassVar[Mapping[str, type[Table]]] = {"routing": Routing}

    def __init__(
        self,
        *,
        name: str,
        holes: Sequence[int] | None = None,
        interpolation: str | None = None,
        routing: Routing | Mapping[str, Any] | None = None,
        ends_at: Quantity | None = None,
        friction: Quantity | None = None,
        axial_stiffness: Quantity | None = None,
        group: str | None = None,
        hole_angle_offset: Quantity | None = None,
        hole_radius_offset: Quantity | None = None,
    ) -> None:
        self._set(
            name=name,
            holes=holes,
            interpolation=interpolation,
            routing=part(routing, Routing, "routing"),
            ends_at=ends_at,
            friction=friction,
            axial_stiffness=axial_stiffness,
            group=group,
            hole_angle_offset=hole_angle_offset,
            hole_radius_offset=hole_radius_offset,
        )


class Robot:
    """A cable-driven continuum robot. It is checked as a whole when it is made, and never changes.

    Parameters
    ----------
    backbone, disks, cables
        What it is made of. Without disks the robot is a body with cables in channels: each cable needs a
        `routing`, and only the models ``"cosserat"`` and ``"constant-curvature"`` accept it. Solutions are given at 21 equally
        spaced stations instead of the disks.
    motors
        What pulls the cables.

    Examples
    --------
    >>> robot = Robot(
    ...     backbone=Backbone(
    ...         length="180 mm", diameter="3 mm", young_modulus="1.1 GPa", poisson_ratio=0.3
    ...     ),
    ...     disks=Disks(count=10, hole_circle_radius="8 mm", holes=12),
    ...     cables=[Cable(name="pull", holes=[1, 2, 3, 4, 4, 4, 4, 3, 2, 1])],
    ... )
    >>> stiffer = robot.replace(backbone=robot.backbone.replace(diameter="3.5 mm"))
    >>> stiffer.backbone.diameter, robot.backbone.diameter
    (0.0035, 0.003)
    >>> finger = Robot(
    ...     backbone=Backbone(length="100 mm", diameter="20 mm", material="Dragon Skin 30"),
    ...     cables=[Cable(name="pull", routing=Routing.straight(angle=0, radius="6 mm"))],
    ... )
    >>> finger.disks is None
    True
    """

    @suggests
    def __init__(
        self,
        *,
        backbone: Backbone,
        disks: Disks | None = None,
        cables: Sequence[Cable] = (),
        motors: Sequence[Motor] = (),
    ) -> None:
        tables = {
            "backbone": part(backbone, Backbone, "backbone"),
            "disks": part(disks, Disks, "disks"),
            "cables": parts(cables, Cable, "cables"),
            "motors": parts(motors, Motor, "motors"),
        }
        object.__setattr__(self, "_setup", _core.Setup.of_tables(tables, "Robot"))

    _setup: _core.Setup

    @classmethod
    def _of(cls, tables: Mapping[str, Any]) -> Robot:
        """Of the tables of a file that is known to be right."""
        commands = ("tension", "shortening", "angle", "travel")

        def without_commands(name: str) -> list[dict[str, Any]] | None:
            own = [
                {key: value for key, value in entry.items() if key not in commands}
                for entry in tables.get(name, ())
            ]
            return own or None

        self = cls.__new__(cls)
        own = {
            "backbone": tables["backbone"],
            "disks": tables.get("disks"),
            "cables": without_commands("cables"),
            "motors": without_commands("motors"),
        }
        object.__setattr__(self, "_setup", _core.Setup.of_tables(own, "Robot"))
        return self

    @cached_property
    def _tables(self) -> dict[str, Any]:
        tables = self._setup.tables()
        tables.pop("title", None)
        return tables

    @cached_property
    def backbone(self) -> Backbone:
        """The backbone."""
        return Backbone._of(self._tables["backbone"])

    @cached_property
    def disks(self) -> Disks | None:
        """The disks, base disk first; None of a body without."""
        disks = self._tables.get("disks")
        return None if disks is None else Disks._of(disks)

    @cached_property
    def cables(self) -> tuple[Cable, ...]:
        """The cables."""
        return tuple(Cable._of(cable) for cable in self._tables.get("cables", ()))

    @cached_property
    def motors(self) -> tuple[Motor, ...]:
        """The motors."""
        return tuple(Motor._of(motor) for motor in self._tables.get("motors", ()))

    def replace(self, **changes: Any) -> Robot:
        """The same robot with another backbone, disks, cables or motors.

        Parameters
        ----------
        changes
            ``backbone``, ``disks``, ``cables`` or ``motors``.
        """
        parts = {"backbone": self.backbone, "disks": self.disks, "cables": self.cables, "motors": self.motors}
        return Robot(**{**parts, **changes})

    def to_toml(self) -> str:
        """The text of a robot file; read again, it gives the identical robot."""
        return _core.toml(self._tables)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a robot file, whole or not at all.

        Parameters
        ----------
        path
            The file, which is replaced if it exists.
        """
        write(path, self.to_toml())

    def view(self, *, open: bool | None = None, height: int = HEIGHT) -> Viewer:
        """Shows the robot in the browser, as :meth:`Case.view` does.

        Parameters
        ----------
        open
            Whether a tab of the browser is opened: by default, except in a notebook.
        height
            Height of the page in a notebook, in px.
        """
        return view(self.to_toml(), open=open, height=height)

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"a robot never changes: use replace({name}=...)")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Robot) and self._tables == other._tables

    def __hash__(self) -> int:
        return hash(self.to_toml())

    def __reduce__(self) -> tuple[Any, ...]:
        return (Robot._of, (self._tables,))

    def __repr__(self) -> str:
        cables = ",\n           ".join(map(repr, self.cables))
        motors = f"  motors={list(self.motors)!r},\n" if self.motors else ""
        return f"Robot(\n  backbone={self.backbone!r},\n  disks={self.disks!r},\n  cables=[{cables}],\n{motors})"

    def _repr_html_(self) -> str:
        return picture(_core.svg(self._setup, [], 620.0, ""))
