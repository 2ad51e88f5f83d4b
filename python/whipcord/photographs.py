"""Disks and markers in photographs."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._commands import seconds, whole
from ._files import write, write_bytes
from .camera import Camera
from .case import Case
from .errors import InputError
from .robot import Robot

__all__ = ["Marks", "measure"]

Array = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]

PhotoLike = Union[str, "os.PathLike[str]", npt.NDArray[Any]]
"""A PNG or JPEG file, or its pixels: (h, w) grey or (h, w, 3) red, green and blue, as bytes."""
Base = Union[Literal["left", "right", "top", "bottom"], Sequence[float]]
"""Where the base is in a photograph: at which end, or the pixel (column, row) near it."""


@dataclass(frozen=True, eq=False)
class Marks:
    """Disks or markers that were found in a photograph, in order from base to tip.

    Pixels are (column, row); the centre of the first pixel is (0, 0).
    """

    disk: tuple[int, ...]
    """Numbers of the disks, from 1."""
    pixel: Array
    """(k, 2) columns and rows of their centres."""
    radius: Array
    """(k,) half of their greater extent in pixels."""
    axis: Array
    """(k, 2) direction of that extent: along the rim of a disk."""
    confidence: Array
    """(k,) from 0 to 1, by how much each looks like what was looked for; no probability."""
    kind: str
    """What was looked for."""
    size: tuple[int, int]
    """Columns and rows of the photograph."""
    _photo: _core.Photo = field(repr=False)

    def __len__(self) -> int:
        return len(self.disk)

    def to_csv(
        self, path: str | os.PathLike[str], *, camera: str | None = None, step: int | None = None
    ) -> None:
        """Writes a table as ``[measured]`` takes it: with the name of the camera, and the step, from 1, where they are
        given.

        Parameters
        ----------
        path
            The file, which is replaced if it exists.
        camera
            Name of the camera, for a file with several.
        step
            Number of the step that the photograph shows, from 1.
        """
        number = None if step is None else whole(step, "step")
        if number is not None and number < 1:
            raise InputError(f"step must be at least 1, but is {number}", path="step")
        marks = list(zip(self.disk, self.pixel.tolist(), self.confidence.tolist()))
        write(path, _core.marks_csv(number, camera, marks))

    def annotated(self) -> Pixels:
        """(h, w, 3) the photograph with what was found drawn into it, as bytes."""
        return self._drawn().pixels()

    def save_annotated(self, path: str | os.PathLike[str]) -> None:
        """Writes the photograph with what was found drawn into it, as PNG.

        Parameters
        ----------
        path
            The file, whose name ends in ``.png``.
        """
        if not os.fspath(path).lower().endswith(".png"):
            raise InputError(f"the name must end in .png, but is {os.fspath(path)!r}", path="path")
        write_bytes(path, self._drawn().png())

    def _drawn(self) -> _core.Photo:
        columns = (self.pixel, self.radius, self.axis, self.confidence)
        return self._photo.annotated(
            self.kind, list(zip(self.disk, *(column.tolist() for column in columns)))
        )


def measure(
    photo: PhotoLike,
    robot: Case | Robot | None = None,
    *,
    kind: Literal["disks", "dots", "circles"] = "disks",
    count: int | None = None,
    hidden: Sequence[int] = (),
    colour: str | Sequence[int] | None = None,
    radius: float | None = None,
    mask: PhotoLike | None = None,
    base: Base | None = None,
    camera: Camera | None = None,
    timeout: float | None = None,
) -> Marks:
    """Finds disks or markers in a photograph, to a fraction of a pixel and in order from base to tip.

    It refuses rather than guesses, and says what was found and where.

    Parameters
    ----------
    photo
        PNG or JPEG file, or its pixels: (h, w) or (h, w, 3) bytes.
    robot
        Case or robot: it has as many disks as must be found, and their distances.
    kind
        Disks from the side, coloured dots, or small circles.
    count
        How many must be found, instead of a robot; without either, however many lie in an even row.
    hidden
        Numbers of disks, from 1, that the photograph does not show.
    colour
        Of the disks or dots, as ``"#d02020"`` or (208, 32, 32); without, disks and circles are found by contrast, and
        dots by the most vivid colour.
    radius
        Of a disk or marker in pixels, to a third; without, what most have.
    mask
        Picture of the same size, or (h, w) booleans, light where to look.
    base
        Where the base is: ``"left"``, ``"right"``, ``"top"``, ``"bottom"``, or a pixel near it.
    camera
        With a case, the base is where this camera sees it, unless `base` is given.
    timeout
        Seconds after which the call ends; the search then comes to its end in the background.

    Raises
    ------
    WhipcordTimeout
        After `timeout` seconds.
    FileError
        For a file that is no photograph.
    DetectionError
        Where there are too few, too many, or no order can be told.

    Examples
    --------
    >>> import numpy as np
    >>> photo = np.full((120, 300, 3), 200, dtype=np.uint8)
    >>> for column in (60, 110, 160, 210):
    ...     photo[40:80, column - 3 : column + 4] = 30
    >>> marks = measure(photo, count=4, base="left")
    >>> marks.disk
    (1, 2, 3, 4)
    >>> bool(np.allclose(marks.pixel, [[60, 59.5], [110, 59.5], [160, 59.5], [210, 59.5]], atol=0.1))
    True
    """
    opened = picture(photo, "photo")
    places, of = _row(robot)
    if places is not None and count is not None:
        raise InputError("give either a robot or a count", path="count")
    expected = len(places) if places is not None else None if count is None else whole(count, "count")
    if expected is not None and expected < 0:
        raise InputError(f"count must not be negative, but is {expected}", path="count")
    if camera is not None and not isinstance(camera, Camera):
        raise InputError(f"camera must be a Camera, but is {camera!r}", path="camera")
    if camera is not None and camera.size not in (None, tuple(opened.size)):
        raise InputError(
            f"camera is of pictures of {camera.size} pixels, but the photograph has {tuple(opened.size)}",
            path="camera",
        )
    if base is None and camera is not None and of is not None:
        base = tuple(_base(of, camera))
    side, near = (base, None) if base is None or isinstance(base, str) else (None, _pixel(base))
    numbers = [whole(number, f"hidden[{i}]") for i, number in enumerate(hidden)]
    if any(number < 1 for number in numbers):
        raise InputError(f"hidden must be numbers of disks, from 1, but is {hidden!r}", path="hidden")
    found = opened.find(
        kind,
        None if colour is None else _colour(colour),
        None if radius is None else _radius(radius),
        None if mask is None else picture(mask, "mask"),
        expected,
        places,
        numbers,
        side,
        near,
        seconds(timeout),
    )
    disk, pixel, radii, axis, confidence = zip(*found) if found else ((), (), (), (), ())
    columns, rows = opened.size
    return Marks(
        tuple(disk),
        _frozen(pixel, 2),
        _frozen(radii),
        _frozen(axis, 2),
        _frozen(confidence),
        kind,
        (columns, rows),
        opened,
    )


def picture(photo: PhotoLike, name: str) -> _core.Photo:
    """A photograph of a file, or of its pixels."""
    if isinstance(photo, (str, os.PathLike)):
        return _core.Photo.load(os.fspath(photo))
    pixels = np.asarray(photo)
    if pixels.dtype == np.bool_:
        pixels = np.where(pixels, np.uint8(255), np.uint8(0))
    if pixels.ndim == 2:
        pixels = np.repeat(pixels[:, :, None], 3, axis=2)
    if pixels.dtype != np.uint8 or pixels.ndim != 3 or pixels.shape[2] != 3:
        message = (
            f"{name} must be a path, or bytes of the shape (h, w) or (h, w, 3), but is "
            f"{'an array of ' + str(pixels.dtype) + ' of the shape ' + str(pixels.shape)}"
        )
        raise InputError(message, path=name)
    return _core.Photo.of_array(np.ascontiguousarray(pixels))


def _row(robot: Case | Robot | None) -> tuple[list[float] | None, Case | None]:
    """Arc lengths of the disks in m, where there are any, and the case."""
    if robot is None:
        return None, None
    if not isinstance(robot, (Case, Robot)):
        raise InputError(f"robot must be a Case or a Robot, but is {robot!r}", path="robot")
    case = robot if isinstance(robot, Case) else Case(robot)
    places = None if case.robot.disks is None else case._setup.disks()
    return places, case if isinstance(robot, Case) else None


def _base(case: Case, camera: Camera) -> list[float]:
    pixel: list[float] = camera.project(case._setup.base()).tolist()
    return pixel


def _pixel(base: Sequence[float]) -> list[float]:
    try:
        pixel = [float(value) for value in base]
    except (TypeError, ValueError):
        pixel = []
    if len(pixel) != 2 or not all(abs(value) < 1e6 for value in pixel):
        message = f"base must be left, right, top, bottom or a pixel (column, row), but is {base!r}"
        raise InputError(message, path="base")
    return pixel


def _colour(colour: str | Sequence[int]) -> list[int]:
    channels: list[int] = []
    if isinstance(colour, str):
        digits = colour.removeprefix("#")
        if len(digits) == 6 and all(digit in "0123456789abcdefABCDEF" for digit in digits):
            channels = [int(digits[i : i + 2], 16) for i in (0, 2, 4)]
    else:
        channels = [whole(value, "colour", "three whole numbers") for value in colour]
    if len(channels) != 3 or not all(0 <= value <= 255 for value in channels):
        message = f'colour must be as "#d02020" or (208, 32, 32), but is {colour!r}'
        raise InputError(message, path="colour")
    return channels


def _radius(radius: float) -> float:
    value = float(radius)
    if not 1.0 <= value <= 10_000.0:
        raise InputError(f"radius must be from 1 to 10000 pixels, but is {radius!r}", path="radius")
    return value


def _frozen(values: Sequence[Any], width: int | None = None) -> Array:
    array = np.array(values, dtype=np.float64)
    if width is not None:
        array = array.reshape(-1, width)
    array.flags.writeable = False
    return array
