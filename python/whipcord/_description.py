"""What is asked of a robot: one robot file in Python."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from functools import cached_property, partial
from typing import Any, TypeVar

from . import _core
from ._commands import Commands, each, paths
from ._files import write
from ._html import picture
from ._suggest import suggests
from ._tables import Quantity, part, parts, plain
from .camera import Camera
from .errors import InputError
from .loads import Base, Loads, Step
from .obstacles import Obstacle
from .published import Measured, Reference, published, still_true
from .robot import Robot
from .warning import WhipcordWarning, listed, tell

Self = TypeVar("Self", bound="Description")


class Description:
    """See :class:`whipcord.Case`, which answers as well."""

    _setup: _core.Setup

    @partial(suggests, called="Case")
    def __init__(
        self,
        robot: Robot,
        *,
        tension: Commands | None = None,
        shortening: Commands | None = None,
        motors: Commands | None = None,
        loads: Loads | None = None,
        base: Base | None = None,
        steps: Sequence[Step] = (),
        independent: bool = False,
        obstacles: Sequence[Obstacle] = (),
        title: str = "case",
    ) -> None:
        if not isinstance(robot, Robot):
            raise InputError(f"robot must be a Robot, but is {robot!r}", path="robot")
        cables = [plain(cable) for cable in robot.cables]
        for key, values in (("tension", tension), ("shortening", shortening)):
            for cable, value in zip(cables, each(values, robot.cables, key)):
                cable[key] = value
        pulling = [plain(motor) for motor in robot.motors]
        for motor, value in zip(pulling, each(motors, robot.motors, "motors")):
            motor["angle" if "spool_radius" in motor else "travel"] = value
        tables = {
            "title": title,
            "backbone": plain(robot.backbone),
            "disks": plain(robot.disks) if robot.disks is not None else None,
            "cables": cables or None,
            "motors": pulling or None,
            "base": part(base, Base, "base") or None,
            "loads": part(loads, Loads, "loads") or None,
            "obstacles": parts(obstacles, Obstacle, "obstacles"),
            "commands": {"each": "independent"} if independent and steps else None,
            "steps": parts(steps, Step, "steps"),
        }
        self._keep(_core.Setup.of_tables(tables, "Case"))
        tell(self.warnings)

    def _keep(self, setup: _core.Setup) -> None:
        object.__setattr__(self, "_setup", setup)

    @classmethod
    def _of(cls: type[Self], setup: _core.Setup) -> Self:
        self = cls.__new__(cls)
        self._keep(setup)
        return self

    @classmethod
    def from_toml(cls: type[Self], text: str, path: str | os.PathLike[str] = "text") -> Self:
        """Reads the text of a robot file; files it names are looked for in the folder of `path`.

        Parameters
        ----------
        text
            The text.
        path
            What messages call it.
        """
        self = cls._of(_core.Setup.parse(text, os.fspath(path)))
        tell(self.warnings)
        return self

    @cached_property
    def _tables(self) -> dict[str, Any]:
        return self._setup.tables()

    @property
    def warnings(self) -> list[WhipcordWarning]:
        """Warnings about the robot and the case."""
        return listed(self._setup.warnings())

    @property
    def title(self) -> str:
        """What it is."""
        return self._setup.title

    @cached_property
    def robot(self) -> Robot:
        """The robot."""
        return Robot._of(self._tables)

    @cached_property
    def loads(self) -> Loads:
        """What acts from outside."""
        return Loads._of(self._tables.get("loads", {}))

    @cached_property
    def base(self) -> Base:
        """Where the base is."""
        return Base._of(self._tables.get("base", {}))

    @cached_property
    def obstacles(self) -> tuple[Obstacle, ...]:
        """What stands in the robot's way."""
        return tuple(Obstacle._of(obstacle) for obstacle in self._tables.get("obstacles", ()))

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """Steps of actuation; none where the case is a single one."""
        return tuple(Step._of(step) for step in self._tables.get("steps", ()))

    @property
    def independent(self) -> bool:
        """Whether each step starts from the robot at rest, as the rows of a table of commands may."""
        each: str = self._tables.get("commands", {}).get("each", "in order")
        return each == "independent"

    @property
    def tension(self) -> tuple[float | None, ...]:
        """Tension of each cable in N, where it is given."""
        return self._commands("tension")

    @property
    def shortening(self) -> tuple[Quantity | None, ...]:
        """Shortening of each cable in m, or a text in per cent, where it is given."""
        return self._commands("shortening")

    @property
    def motors(self) -> tuple[float | None, ...]:
        """Angle in rad or travel in m of each motor, where it is given."""
        motors = self._tables.get("motors", ())
        if self.steps:
            return self.steps[-1].motors or (None,) * len(motors)
        return tuple(motor.get("angle", motor.get("travel")) for motor in motors)

    @cached_property
    def measured(self) -> Measured | None:
        """What the real robot did, where the file says so."""
        measured = self._setup.measured
        return None if measured is None else Measured._of(measured)

    @cached_property
    def reference(self) -> Reference | None:
        """What others have published for the case, where the file says so."""
        reference = self._setup.reference
        return None if reference is None else Reference(**reference)

    def _commands(self, key: str) -> tuple[Any, ...]:
        cables = self._tables.get("cables", ())
        if self.steps:
            return getattr(self.steps[-1], key) or (None,) * len(cables)
        return tuple(cable.get(key) for cable in cables)

    def replace(self: Self, **changes: Any) -> Self:
        """The same case with another robot, other commands, loads, base, steps, obstacles or title.

        Other commands take the place of the steps, and with them of what friction keeps of the steps before.
        What was measured stays as long as commands, loads, base, obstacles and the places of the disks do; what was
        published, as long as the whole robot does too.

        Parameters
        ----------
        changes
            ``robot``, ``tension``, ``shortening``, ``motors``, ``loads``, ``base``, ``steps``, ``independent``,
            ``obstacles``, ``title``, as for :class:`whipcord.Case`.
        """
        given: dict[str, Any] = {"loads": self.loads, "base": self.base, "title": self.title}
        if {"tension", "shortening", "motors"} & changes.keys() and "steps" not in changes:
            changes = {"steps": (), **changes}
        if self.obstacles:
            given["obstacles"] = self.obstacles
        if self.steps:
            given["steps"] = self.steps
            given["independent"] = self.independent
        else:
            # A robot with other cables takes the place of one whose cables are told nothing.
            for key, values in (("tension", self.tension), ("shortening", self.shortening)):
                given[key] = values if any(value is not None for value in values) else None
        robot = changes.pop("robot", self.robot)
        # The motors and the shortenings of cables take the place of each other.
        if "motors" in changes:
            given.update(tension=None, shortening=None)
        elif not {"tension", "shortening"} & changes.keys() and len(robot.motors) == len(self.motors):
            given["motors"] = None if self.steps else self.motors or None
        if changes.get("steps"):
            given.update(tension=None, shortening=None, motors=None)
        return self._with_published(type(self)(robot, **{**given, **changes}))

    def _with_published(self: Self, other: Self) -> Self:
        measured, reference = still_true(self, other)
        return type(self)._of(other._setup.beside(self._setup, measured, reference))

    def with_measured(
        self: Self,
        disks: str | os.PathLike[str],
        *,
        unit: str | None = None,
        deviation: Quantity | None = None,
        pixel_deviation: float | None = None,
        registration: str | None = None,
        cameras: Mapping[str, str | os.PathLike[str]] | None = None,
    ) -> Self:
        """The same case with what the real robot did, as ``[measured]`` of a robot file has it.

        Parameters
        ----------
        disks
            CSV or Parquet file with the markers.
        unit
            Unit of its lengths, ``"m"`` by default.
        deviation, pixel_deviation
            Standard deviation of a coordinate, and of a place in an image in pixels, where the file does not say it.
        registration
            How positions are moved onto a model: ``"none"``, ``"rigid"`` or ``"base"``.
        cameras
            Camera files by the names that the CSV file gives the cameras.
        """
        named = {name: os.path.abspath(path) for name, path in (cameras or {}).items()}
        table = {
            "disks": os.path.abspath(disks),
            "unit": unit,
            "deviation": deviation,
            "pixel_deviation": pixel_deviation,
            "registration": registration,
            "cameras": [{"name": name, "file": path} for name, path in named.items()] or None,
        }
        tables = {**self._tables, **published(None, self.reference, None), "measured": table}
        return type(self)._of(_core.Setup.of_tables(tables, "measured"))

    def to_toml(self) -> str:
        """The text of a robot file; read again, it gives the identical robot and case.

        >>> import whipcord
        >>> case = whipcord.load("examples/tapered-arm.toml")
        >>> type(case).from_toml(case.to_toml()) == case
        True
        """
        return self._text(None)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a robot file, whole or not at all.

        Parameters
        ----------
        path
            The file, which is replaced if it exists.
        """
        folder = os.path.dirname(os.path.abspath(path))
        write(path, self._text(folder))

    def _text(self, folder: str | None) -> str:
        return _core.toml({**self._tables, **published(self.measured, self.reference, folder)})

    def parameter(self, path: str) -> float:
        """The value of a quantity of robot or case, by its path.

        Parameters
        ----------
        path
            Path of the quantity, as in robot files and counted from 0: ``"cables[0].routing.radius"``.

        Examples
        --------
        >>> import whipcord
        >>> whipcord.load("examples/table1/case-3.toml").parameter("backbone.diameter")
        0.003
        """
        return self._setup.parameter(*paths([path]))

    def with_parameters(self: Self, values: Mapping[str, float]) -> Self:
        """The same case with these quantities changed, by their paths; measurements as for :meth:`replace`.

        Parameters
        ----------
        values
            New values in SI, by their paths.

        Examples
        --------
        >>> import whipcord
        >>> case = whipcord.load("examples/table1/case-3.toml")
        >>> case.with_parameters({"backbone.young_modulus": 2e9}).robot.backbone.young_modulus
        2000000000.0
        """
        if not isinstance(values, Mapping):
            message = f"values must be a dict of paths and numbers, but is {values!r}"
            raise InputError(message, path="values")
        changed = self._setup.with_parameters(list(values.items()))
        return self._with_published(type(self)._of(changed))

    def _answered(self: Self, answer: _core.Solution) -> Self:
        """The case that an answer is the answer to."""
        return self._with_published(type(self)._of(self._setup.of_answer(answer)))

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"a case never changes: use replace({name}=...)")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Description) and self.to_toml() == other.to_toml()

    def __hash__(self) -> int:
        return hash(self.to_toml())

    def __reduce__(self) -> tuple[Any, ...]:
        measured, reference = self._setup.measured, self._setup.reference
        if measured is not None:
            measured["views"] = [Camera._of(camera) for camera in measured["views"]]
        return (_unpickled, (type(self), _core.toml(self._tables), measured, reference))

    def __repr__(self) -> str:
        cables = self.robot.cables
        names = ", ".join(cable.name for cable in cables)
        given = []
        for key in ("tension", "shortening"):
            values = getattr(self, key)
            if any(value is not None for value in values):
                given.append(f"{key}={values!r}")
        if self.steps:
            given.append(f"{len(self.steps)} steps")
        if self.loads != Loads():
            given.append(f"loads={self.loads!r}")
        if self.base != Base():
            given.append(f"base={self.base!r}")
        if self.obstacles:
            around = ", ".join(str(obstacle.name) for obstacle in self.obstacles)
            given.append(f"obstacles [{around}]")
        length = self.robot.backbone.length
        asked = "".join(f", {item}" for item in given)
        return f"<Case {self.title!r}: robot of {length} m, cables [{names}]{asked}>"

    def _repr_html_(self) -> str:
        return picture(_core.svg(self._setup, [], 620.0))


def _unpickled(
    kind: type[Self], text: str, measured: dict[str, Any] | None, reference: dict[str, Any] | None
) -> Self:
    # The files that the measurements came from need not be here.
    tables = text if reference is None else text + "\n" + _core.toml({"reference": reference})
    setup = _core.Setup.parse(tables, "case")
    if measured is None:
        return kind._of(setup)
    views = [camera._camera for camera in measured["views"]]
    return kind._of(setup.with_measured({**measured, "views": views}))
