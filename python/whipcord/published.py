"""What others have measured and published."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .camera import Camera

if TYPE_CHECKING:
    from ._description import Description

__all__ = ["Measured", "Observation", "Reference"]


@dataclass(frozen=True)
class Observation:
    """A marker of the real robot, seen once."""

    step: int
    """Step of actuation, from 1."""
    disk: int | None
    """Number of the disk, from 1, that it sits on; None where it sits between disks."""
    arc_length: float | None
    """Or where on the backbone it sits, in m."""
    offset: tuple[float, ...]
    """(3,) where it is in the frame at its place, in m."""
    position: tuple[float, ...] | None
    """(3,) where it was, in m, in the frame of the measurement."""
    camera: str | None
    """Or the camera that saw it,"""
    pixel: tuple[float, ...] | None
    """and at which column and row."""
    deviation: float | None
    """Standard deviation of each number, in m or pixels, where it is known."""

    @classmethod
    def _of(cls, given: tuple[Any, ...], cameras: tuple[tuple[str, str], ...]) -> Observation:
        step, disk, arc_length, offset, position, camera, pixel, deviation = given
        return cls(
            step + 1,
            None if disk is None else disk + 1,
            arc_length,
            tuple(offset),
            None if position is None else tuple(position),
            None if camera is None else cameras[camera][0],
            None if pixel is None else tuple(pixel),
            deviation,
        )


@dataclass(frozen=True, eq=False)
class Measured:
    """Where the disks of the real robot were."""

    disks: tuple[int, ...]
    """Numbers of the disks that were measured, from 1."""
    position: npt.NDArray[np.float64]
    """(k, 3) positions in m, in the frame of the world: that of the base, where the case does not place it."""
    path: str
    """The file they stand in."""
    unit: str = "m"
    """Unit of the lengths in that file."""
    deviation: float | None = None
    """Standard deviation of a coordinate in m, where the file does not give it."""
    pixel_deviation: float | None = None
    """Standard deviation of a place in an image in pixels, where the file does not give it."""
    registration: str = "none"
    """How positions are moved onto a model before they are compared: ``"none"``, ``"rigid"`` or ``"base"``."""
    is_of_commands: bool = False
    """Whether the lines of that file are of the rows of a table of commands. Without that table they say nothing: the text of a
    case, which has the commands themselves, leaves them out."""
    cameras: tuple[tuple[str, str], ...] = ()
    """Names and files of the cameras whose images the file refers to."""
    views: tuple[Camera, ...] = ()
    """These cameras."""
    observations: tuple[Observation, ...] = ()
    """All that was seen, in space or in images, in all steps."""

    @classmethod
    def _of(cls, given: dict[str, Any]) -> Measured:
        """As the extension module has it."""
        cameras = tuple((name, str(path)) for name, path in given["cameras"])
        seen = [Observation._of(one, cameras) for one in given["observations"]]
        kept = {
            "disks": tuple(given["disks"]),
            "path": str(given["path"]),
            "cameras": cameras,
            "views": tuple(Camera._of(camera) for camera in given["views"]),
            "observations": tuple(seen),
        }
        return cls(**{**given, **kept})


@dataclass(frozen=True)
class Reference:
    """What others have published for a case."""

    source: str
    """Where the values stand."""
    rms_four_bar: float | None = None
    """RMS error of the four-bar model against the measurement in m."""
    rms_cosserat: float | None = None
    """RMS error of the Cosserat model against the measurement in m."""
    time_four_bar: float | None = None
    """Solve time of the four-bar model in s."""
    time_cosserat: float | None = None
    """Solve time of the Cosserat model in s."""


def published(measured: Measured | None, reference: Reference | None, folder: str | None) -> dict[str, Any]:
    """Their tables of a robot file in this folder."""
    tables: dict[str, Any] = {}
    if measured and not measured.is_of_commands:
        table: dict[str, Any] = {"disks": _seen_from(folder, measured.path)}
        for name in ("unit", "deviation", "pixel_deviation", "registration"):
            table[name] = getattr(measured, name)
        if measured.cameras:
            cameras = measured.cameras
            table["cameras"] = [{"name": name, "file": _seen_from(folder, path)} for name, path in cameras]
        tables["measured"] = {name: value for name, value in table.items() if value is not None}
    if reference:
        tables["reference"] = vars(reference)
    return tables


def _seen_from(folder: str | None, path: str) -> str:
    """The path of a file as a robot file in this folder names it."""
    there = os.path.abspath(path)
    return os.path.relpath(there, folder) if folder else there


def _places(case: Description) -> tuple[Any, ...] | None:
    """Where the disks are; None of a body without."""
    disks = case.robot.disks
    return None if disks is None else (disks.count, disks.positions)


def still_true(case: Description, other: Description) -> tuple[bool, bool]:
    """Whether what was measured and what was published for a case is so for another."""
    if case.measured is None and case.reference is None:
        return False, False
    asked = ("tension", "shortening", "steps", "independent", "loads", "base", "obstacles")
    same = all(getattr(case, name) == getattr(other, name) for name in asked)
    if not same or _places(case) != _places(other):
        return False, False
    return True, case.robot == other.robot
