"""Two cameras: their relative pose, and points in space."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._commands import whole
from ._files import write
from .calibration import Distortion, _board, _given, _photo, calibrate
from .camera import Camera, _deviation, _pairs, _view
from .case import Case
from .errors import InputError
from .photographs import Base, Marks, PhotoLike, measure, picture
from .robot import Robot

__all__ = [
    "LocatedPair",
    "PointsInSpace",
    "StereoCalibration",
    "StereoPair",
    "Triangulated",
    "locate_stereo",
    "measure_stereo",
    "triangulate",
]

Array = npt.NDArray[np.float64]
Length = Union[float, str]


@dataclass(frozen=True, eq=False)
class Triangulated:
    """Points that two cameras see."""

    position: Array
    """(n, 3) where they are in the world, in m."""
    covariance: Array
    """(n, 3, 3) covariances in m² by the errors of the pixels alone: those of the cameras are not part of them."""
    residuals: Array
    """(n, 2, 2) by how many columns and rows each camera sees each beside where it has the point."""
    epipolar: Array
    """(n,) distances of the pixels from the nearest ones whose lines of sight meet, in pixels."""
    angle: Array
    """(n,) angles between the lines of sight in rad."""

    @property
    def deviation(self) -> Array:
        """(n, 3) standard deviations of the coordinates in m."""
        variances: Array = np.einsum("nii->ni", self.covariance)
        deviations: Array = np.sqrt(np.maximum(variances, 0.0))
        return deviations

    def __len__(self) -> int:
        return len(self.position)


def triangulate(
    cameras: Sequence[Camera], first: npt.ArrayLike, second: npt.ArrayLike, *, pixel_deviation: float = 0.3
) -> Triangulated:
    """The points that two cameras with known poses see, with the least squares of the distances in both images.

    Parameters
    ----------
    cameras
        The two cameras.
    first, second
        (n, 2) columns and rows at which each camera sees the points.
    pixel_deviation
        Standard deviation of a column or row in pixels.

    Examples
    --------
    >>> import numpy as np
    >>> left = Camera(focal=(800, 800), centre=(319.5, 239.5))
    >>> turned = (np.cos(0.25), 0.0, -np.sin(0.25), 0.0)
    >>> right = Camera(focal=(800, 800), centre=(319.5, 239.5), position=(0.25, 0, 0.05), orientation=turned)
    >>> points = np.array([[0.02, -0.01, 0.5], [0.0, 0.03, 0.55]])
    >>> found = triangulate((left, right), left.project(points), right.project(points))
    >>> bool(np.allclose(found.position, points, atol=1e-9)), bool(found.deviation.max() < 1e-3)
    (True, True)
    """
    pixels = [_columns_and_rows(given, name) for given, name in ((first, "first"), (second, "second"))]
    if len(pixels[0]) != len(pixels[1]):
        message = f"both cameras must see the same points, but first has {len(pixels[0])} and second {len(pixels[1])}"
        raise InputError(message, path="second")
    return Triangulated(*_core.triangulate(_two(cameras), pixels, _positive(pixel_deviation, "pixel_deviation")))


@dataclass(frozen=True)
class StereoPair:
    """A pair of photographs of a board."""

    number: int
    """Its number, from 0."""
    common: int
    """Corners that both photographs show."""
    rms: tuple[float, float]
    """Root mean square distance between seen and projected corners in pixels, for each camera."""
    epipolar: float | None
    """Root mean square epipolar distance of the common corners in pixels; None without them."""
    renumbered: bool
    """Whether the second photograph numbers the corners of a symmetric board from another one than the first."""


@dataclass(frozen=True, eq=False)
class StereoCalibration:
    """Two cameras, and how sure their relative pose is."""

    cameras: tuple[Camera, Camera]
    """The cameras, with the first where it was given."""
    position: Array
    """(3,) where the second is in the frame of the first, in m."""
    rotation: Array
    """(3,) rotation vector from the first to the second, in rad."""
    covariance: Array
    """(6, 6) of position in m and rotation in rad, by the errors of the corners and of lenses that were sought in the same photographs."""
    baseline: float
    """Distance of the cameras in m."""
    baseline_deviation: float
    """Its standard deviation."""
    pixel_deviation: float
    """Standard deviation of a column or row at which a corner was seen."""
    rms: float
    """Root mean square distance between seen and projected corners in pixels."""
    epipolar: float | None
    """Root mean square epipolar distance of common corners in pixels; None without common corners."""
    pairs: tuple[StereoPair, ...]
    """The pairs of photographs that were used."""
    refused: tuple[tuple[int, str], ...]
    """Numbers of those that were not, from 0, and why."""

    @property
    def position_deviation(self) -> Array:
        """(3,) standard deviations of the position in m."""
        return np.sqrt(np.maximum(self.covariance.diagonal()[:3], 0.0))

    @property
    def rotation_deviation(self) -> Array:
        """(3,) standard deviations of the rotation in rad."""
        return np.sqrt(np.maximum(self.covariance.diagonal()[3:], 0.0))

    def triangulate(
        self, first: npt.ArrayLike, second: npt.ArrayLike, *, pixel_deviation: float | None = None
    ) -> Triangulated:
        """The points that both cameras see; see :func:`whipcord.triangulate`.

        Parameters
        ----------
        first, second
            (n, 2) columns and rows at which each camera sees the points.
        pixel_deviation
            Standard deviation of a column or row in pixels; by default that of the corners of the board.
        """
        deviation = max(self.pixel_deviation, 1e-6) if pixel_deviation is None else pixel_deviation
        return triangulate(self.cameras, first, second, pixel_deviation=deviation)


def calibrate_stereo(
    first: Iterable[Any],
    second: Iterable[Any],
    board: str | None,
    square: Length | None,
    marker: Length | None,
    dictionary: str | None,
    size: Sequence[int] | None,
    lenses: Sequence[Camera | None],
    distortion: Distortion,
) -> StereoCalibration:
    """See :meth:`whipcord.Camera.calibrate_stereo`."""
    photos = [list(first), list(second)]
    if len(photos[0]) != len(photos[1]):
        message = f"there are {len(photos[0])} photographs of the first camera, but {len(photos[1])} of the second"
        raise InputError(message, path="second")
    known = list(lenses)
    if len(known) != 2 or not all(lens is None or isinstance(lens, Camera) for lens in known):
        raise InputError(f"lenses must be two cameras or None, but is {lenses!r}", path="lenses")
    looked_for = None
    if board is None:
        given = [
            size if size is not None or lens is None else lens.size for lens in known
        ]
        seen = [_given(views, of) for views, of in zip(photos, given)]
    else:
        looked_for = _board(board, square, marker, dictionary, size)
        seen = [
            [looked_for.find(picture(_photo(photo), f"{name}[{i}]")) for i, photo in enumerate(views)]
            for name, views in zip(("first", "second"), photos)
        ]
    cameras: list[Camera] = []
    for lens, views in zip(known, photos):
        if lens is not None:
            cameras.append(lens)
            continue
        cameras.append(calibrate(views, board, square, marker, dictionary, size, distortion).camera)
    placed, values = _core.calibrate_two([camera._camera for camera in cameras], seen, looked_for)
    pairs = [
        StereoPair(number, common, (rms[0], rms[1]), epipolar, renumbered)
        for number, common, rms, epipolar, renumbered in values["pairs"]
    ]
    return StereoCalibration(
        cameras=(Camera._of(placed[0]), Camera._of(placed[1])),
        position=np.array(values["position"]),
        rotation=np.array(values["rotation"]),
        covariance=values["covariance"],
        baseline=values["baseline"],
        baseline_deviation=values["baseline_deviation"],
        pixel_deviation=values["pixel_deviation"],
        rms=values["rms"],
        epipolar=values["epipolar"],
        pairs=tuple(pairs),
        refused=tuple(values["refused"]),
    )


@dataclass(frozen=True, eq=False)
class PointsInSpace:
    """Disks or markers that two photographs show, in space."""

    disk: tuple[int, ...]
    """Numbers of the disks, from 1."""
    points: Triangulated
    """Where they are."""
    marks: tuple[Marks, Marks]
    """What each photograph shows."""
    left_out: tuple[tuple[tuple[int, int], float | None, str], ...]
    """Pairs that do not belong together: their numbers in the photographs, the epipolar distance in pixels, and why."""
    in_one_photo: tuple[tuple[int, ...], tuple[int, ...]]
    """Numbers of what one photograph alone shows."""

    @property
    def position(self) -> Array:
        """(n, 3) where they are in the world, in m."""
        return self.points.position

    @property
    def covariance(self) -> Array:
        """(n, 3, 3) covariances in m² by the errors of the pixels."""
        return self.points.covariance

    @property
    def deviation(self) -> Array:
        """(n, 3) standard deviations in m."""
        return self.points.deviation

    @property
    def epipolar(self) -> Array:
        """(n,) epipolar distances in pixels."""
        return self.points.epipolar

    def __len__(self) -> int:
        return len(self.disk)

    def to_csv(self, path: str | os.PathLike[str], *, step: int | None = None) -> None:
        """Writes a table as ``[measured]`` takes it.

        Parameters
        ----------
        path
            The file, which is replaced if it exists.
        step
            Number of the step that the photographs show, from 1.
        """
        number = None if step is None else whole(step, "step")
        if number is not None and number < 1:
            raise InputError(f"step must be at least 1, but is {number}", path="step")
        rows = list(
            zip(self.disk, self.position.tolist(), self.deviation.tolist(), self.epipolar.tolist())
        )
        write(path, _core.points_csv(number, rows))


@dataclass(frozen=True, eq=False)
class LocatedPair:
    """Two cameras in their places, and how well they explain what was seen."""

    cameras: tuple[Camera, Camera]
    """The cameras; the second is in the frame of the first where it was."""
    residuals: tuple[Array, Array]
    """(n, 2) of each camera, the columns and rows by which each point was seen beside where the camera has it."""
    rms: tuple[float, float]
    """The root of their mean square distance in each image, in pixels."""
    other: Camera | None
    """The next best place of the first camera, where there is one."""
    other_rms: float | None
    """The RMS distance over both images that it leaves, in pixels."""
    is_ambiguous: bool
    """Whether what was seen does not tell the two apart."""
    covariance: Array | None
    """(6, 6) covariance of the position in m and the rotation in rad of the first camera, along and about the axes of the world, by the errors
    of the pixels alone; the lenses and the relative pose are taken as they are. None where there are no more columns and rows than
    unknowns and no `pixel_deviation` is given."""
    pixel_deviation: float | None
    """Standard deviation of a column or row in pixels, as given or as the residuals tell it."""


def locate_stereo(
    cameras: Sequence[Camera],
    points: Sequence[npt.ArrayLike],
    pixels: Sequence[npt.ArrayLike],
    *,
    view: Sequence[float] | None = None,
    pixel_deviation: float | None = None,
) -> LocatedPair:
    """Two cameras, fastened to one another, in the place from which they see points of the world.

    The pose of the second camera relative to the first is kept; the squares of the distances in both images are least. Three
    points that both see, or four that one sees, are enough. Points on one line, such as the centres of the disks of a straight
    robot, need `view`.

    Parameters
    ----------
    cameras
        The two cameras, as :meth:`Camera.calibrate_stereo` gives them.
    points
        For each camera (n, 3) points of the world in m that it sees; the same numbers where both see the same point.
    pixels
        For each camera (n, 2) columns and rows at which they are seen.
    view
        (3,) direction of the world in which the first camera looks, where the points are on one line.
    pixel_deviation
        Standard deviation of a column or row in px; by default as the residuals tell it.

    Examples
    --------
    >>> left = Camera(focal=(800, 800), centre=(320, 240), position=(0, 0, -0.5))
    >>> right = Camera(focal=(800, 800), centre=(320, 240), position=(0.2, 0, -0.5))
    >>> seen = [[0, 0, 0], [0.05, 0, 0.02], [0, 0.05, -0.01]]
    >>> pixels = left.project(seen), right.project(seen)
    >>> moved = [Camera(focal=(800, 800), centre=(320, 240), position=(x, 0, 0)) for x in (0, 0.2)]
    >>> found = locate_stereo(moved, (seen, seen), pixels)
    >>> bool(np.allclose(found.cameras[0].position, [0, 0, -0.5]))
    True
    """
    if not len(cameras) == len(points) == len(pixels) == 2:
        message = "cameras, points and pixels must be two each, one for each camera"
        raise InputError(message, path="cameras")
    pairs = [_pairs(own, seen) for own, seen in zip(points, pixels)]
    found, residuals, rms, other, ambiguous, (covariance, pixel) = _core.locate_pair(
        [camera._camera for camera in cameras],
        [own for own, _ in pairs],
        [seen for _, seen in pairs],
        _view(view),
        _deviation(pixel_deviation),
    )
    return LocatedPair(
        cameras=(Camera._of(found[0]), Camera._of(found[1])),
        residuals=(residuals[0], residuals[1]),
        rms=(rms[0], rms[1]),
        other=Camera._of(other[0]) if other else None,
        other_rms=other[1] if other else None,
        is_ambiguous=ambiguous,
        covariance=covariance,
        pixel_deviation=pixel,
    )


def measure_stereo(
    photos: Sequence[PhotoLike | Marks],
    cameras: Sequence[Camera],
    robot: Case | Robot | None = None,
    *,
    kind: Literal["disks", "dots", "circles"] = "disks",
    count: int | None = None,
    hidden: Sequence[Sequence[int]] = ((), ()),
    colour: str | Sequence[int] | None = None,
    radius: float | None = None,
    mask: Sequence[PhotoLike | None] = (None, None),
    base: Sequence[Base | None] = (None, None),
    epipolar: float = 3.0,
    pixel_deviation: float = 0.3,
    timeout: float | None = None,
) -> PointsInSpace:
    """Where disks or markers are in space, from two photographs of one moment.

    With a robot or a count the disks have numbers, and those that one photograph does not show are named in `hidden`. Without, what
    is found is matched in order along the robot by the epipolar constraint, also where some markers are seen in one photograph alone.

    Parameters
    ----------
    photos
        Two photographs, as for :func:`whipcord.measure`, or what that has found in them.
    cameras
        Their cameras, with their poses, as :meth:`Camera.calibrate_stereo` or :meth:`Camera.locate` give them.
    robot, kind, count, colour, radius, timeout
        As for :func:`whipcord.measure`.
    hidden, mask, base
        As for :func:`whipcord.measure`, one for each photograph.
    epipolar
        Largest distance from the epipolar constraint in pixels: pairs beyond it are left out.
    pixel_deviation
        Standard deviation of a column or row in pixels.

    Raises
    ------
    DetectionError
        Where nothing is found in a photograph, or what is found does not belong together.

    Examples
    --------
    >>> found = measure_stereo(("left.jpg", "right.jpg"), pair.cameras, case, base=("left", "left"))  # doctest: +SKIP
    >>> found.to_csv("disks.csv")  # doctest: +SKIP
    """
    given = [_both(values, name) for values, name in
             ((photos, "photos"), (hidden, "hidden"), (mask, "mask"), (base, "base"))]
    two = _two(cameras)
    # Of cameras that are not located the first is at the origin of the world, not the robot.
    placed = not (np.allclose(cameras[0].position, 0) and np.allclose(cameras[0].orientation, (1, 0, 0, 0)))
    marks = [
        photo
        if isinstance(photo, Marks)
        else measure(
            photo, robot, kind=kind, count=count, hidden=unseen, colour=colour, radius=radius, mask=where,
            base=end, camera=camera if placed else None, timeout=timeout,
        )
        for photo, unseen, where, end, camera in zip(*given, cameras)
    ]
    places = robot.robot.disks if isinstance(robot, Case) else None if robot is None else robot.disks
    numbered = count is not None or places is not None
    rows = [
        list(zip(of.disk, of.pixel.tolist(), of.radius.tolist(), of.axis.tolist(), of.confidence.tolist()))
        for of in marks
    ]
    numbers, points, left_out, single = _core.in_space(
        two, rows, numbered, _positive(epipolar, "epipolar"), _positive(pixel_deviation, "pixel_deviation")
    )
    return PointsInSpace(
        disk=tuple(numbers),
        points=Triangulated(*points),
        marks=(marks[0], marks[1]),
        left_out=tuple(((pair[0], pair[1]), distance, why) for pair, distance, why in left_out),
        in_one_photo=(tuple(single[0]), tuple(single[1])),
    )


def _both(given: Any, name: str) -> list[Any]:
    if isinstance(given, (str, bytes, os.PathLike)) or len(given) != 2:
        raise InputError(f"{name} must be two, one for each camera, but is {given!r}", path=name)
    return list(given)


def _two(cameras: Sequence[Camera]) -> list[_core.Camera]:
    two = list(cameras)
    if len(two) != 2 or not all(isinstance(camera, Camera) for camera in two):
        raise InputError(f"cameras must be two cameras, but is {cameras!r}", path="cameras")
    return [camera._camera for camera in two]


def _positive(given: float, name: str) -> float:
    value = float(given)
    if not (np.isfinite(value) and value > 0):
        raise InputError(f"{name} must be greater than 0, but is {given!r}", path=name)
    return value


def _columns_and_rows(given: npt.ArrayLike, name: str) -> Array:
    pixels = np.asarray(given, dtype=np.float64)
    if pixels.ndim != 2 or pixels.shape[1] != 2:
        raise InputError(f"{name} must have the shape (n, 2), but has {pixels.shape}", path=name)
    return np.ascontiguousarray(pixels)
