"""Cameras: how a photograph sees the world."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._files import write
from .errors import InputError

if TYPE_CHECKING:
    from .calibration import Calibration, Distortion
    from .photographs import PhotoLike
    from .stereo import StereoCalibration

__all__ = ["Camera", "Located"]

Array = npt.NDArray[np.float64]


class Camera:
    """A pinhole camera with OpenCV's distortion, or a scaled orthographic one. It does not change.

    The camera's frame has x to the right of the image, y down and z along the view. Pixels are (column, row), and the
    centre of the first pixel is (0, 0).

    Parameters
    ----------
    focal
        Focal lengths (fx, fy) in pixels.
    centre
        Principal point (cx, cy) in pixels.
    distortion
        OpenCV's 4, 5, 8, 12 or 14 coefficients in its order, or none.
    position
        Where the camera is in the world, in m.
    orientation
        Quaternion (w, x, y, z) that turns the camera's frame into the world's.
    size
        Columns and rows of its images.
    lens_covariance
        (n, n) covariance of the focal lengths, the principal point and the first n - 4 distortion coefficients, as
        :attr:`Calibration.covariance` has it; without it the lens is taken as it is.

    Examples
    --------
    >>> camera = Camera(focal=(800, 800), centre=(319.5, 239.5), distortion=(-0.2, 0.05, 0, 0), size=(640, 480))
    >>> pixels = camera.project([[0.05, -0.02, 0.5]])
    >>> camera.undistort(pixels)
    array([[ 0.1 , -0.04]])
    >>> camera.save("lens.yml")  # doctest: +SKIP
    """

    __slots__ = ("_camera",)
    _camera: _core.Camera

    def __init__(
        self,
        *,
        focal: Sequence[float],
        centre: Sequence[float],
        distortion: Sequence[float] = (),
        position: Sequence[float] = (0.0, 0.0, 0.0),
        orientation: Sequence[float] = (1.0, 0.0, 0.0, 0.0),
        size: Sequence[int] | None = None,
        lens_covariance: npt.ArrayLike | None = None,
    ) -> None:
        place = (_numbers(position, 3, "position"), _numbers(orientation, 4, "orientation"))
        coefficients = [float(value) for value in np.ravel(distortion)]
        focal, centre = _numbers(focal, 2, "focal"), _numbers(centre, 2, "centre")
        camera = _core.Camera.pinhole(focal, centre, coefficients, place, _pixels(size))
        self._hold(camera.with_lens_covariance(_covariance(lens_covariance, 4 + len(coefficients))))

    @classmethod
    def orthographic(
        cls,
        *,
        scale: float,
        centre: Sequence[float] = (0.0, 0.0),
        position: Sequence[float] = (0.0, 0.0, 0.0),
        orientation: Sequence[float] = (1.0, 0.0, 0.0, 0.0),
        size: Sequence[int] | None = None,
    ) -> Camera:
        """A camera whose image is a parallel projection, with `scale` pixels per metre.

        Parameters
        ----------
        scale
            Pixels per metre.
        centre
            Column and row in px of the point on the optical axis.
        position
            (3,) a point on the optical axis in the world, in m.
        orientation
            (4,) quaternion (w, x, y, z) that turns the camera's frame into the world's.
        size
            Columns and rows of its images, where they are known.
        """
        place = (_numbers(position, 3, "position"), _numbers(orientation, 4, "orientation"))
        centre = _numbers(centre, 2, "centre")
        return cls._of(_core.Camera.orthographic(float(scale), centre, place, _pixels(size)))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Camera:
        """The camera of a file in OpenCV's YAML or JSON.

        Parameters
        ----------
        path
            The file.
        """
        return cls._of(_core.Camera.load(os.fspath(path)))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the camera in OpenCV's YAML (``.yml``, ``.yaml``) or JSON (``.json``).

        Parameters
        ----------
        path
            The file, whose name ends in ``.yml``, ``.yaml`` or ``.json``.
        """
        write(path, self._camera.text(os.fspath(path)))

    @staticmethod
    def calibrate(
        photos: Iterable[PhotoLike] | Iterable[tuple[npt.ArrayLike, npt.ArrayLike]],
        *,
        board: str | None = None,
        square: float | str | None = None,
        marker: float | str | None = None,
        dictionary: str | None = None,
        size: Sequence[int] | None = None,
        distortion: Distortion = "5",
    ) -> Calibration:
        """The lens of a camera, by photographs of a flat board, or by its corners that others have found.

        Photographs in which no board is found that can be used are passed over, and named in the result.

        Parameters
        ----------
        photos
            PNG or JPEG files, or their pixels: (h, w) or (h, w, 3) bytes. Without a board, for each photograph the (n, 3) points
            of the board in m and the (n, 2) pixels at which they are seen.
        board
            ``"chessboard:9x6"`` with the number of inner corners, or ``"charuco:8x6"`` with the number of squares.
        square
            Side of a square, in m or as ``"25 mm"``.
        marker
            Side of the markers of a ChArUco board.
        dictionary
            OpenCV's name of the dictionary that they are from, as ``"DICT_4X4_50"``.
        size
            Columns and rows of the photographs, where points are given.
        distortion
            Coefficients that are sought: ``"none"``, ``"k1k2"``, or the first ``"4"``, ``"5"``, ``"8"`` or ``"12"`` in OpenCV's order.

        Raises
        ------
        CalibrationError
            Where the photographs do not fix the lens.

        Examples
        --------
        >>> found = Camera.calibrate(paths, board="chessboard:9x6", square="25 mm")  # doctest: +SKIP
        >>> found.camera.save("lens.yml")  # doctest: +SKIP
        """
        from .calibration import calibrate

        return calibrate(photos, board, square, marker, dictionary, size, distortion)

    @staticmethod
    def calibrate_stereo(
        first: Iterable[PhotoLike] | Iterable[tuple[npt.ArrayLike, npt.ArrayLike]],
        second: Iterable[PhotoLike] | Iterable[tuple[npt.ArrayLike, npt.ArrayLike]],
        *,
        board: str | None = None,
        square: float | str | None = None,
        marker: float | str | None = None,
        dictionary: str | None = None,
        size: Sequence[int] | None = None,
        lenses: Sequence[Camera | None] = (None, None),
        distortion: Distortion = "5",
    ) -> StereoCalibration:
        """Two cameras and their relative pose, by photographs of a flat board that both took at one time.

        The standard deviations of the pose contain the errors of the corners, those of lenses that are sought in the same photographs, and those of
        known lenses with a covariance; other known lenses are taken as they are.

        Parameters
        ----------
        first, second
            Photographs of each camera, in the same order, or points and pixels, as for :meth:`calibrate`. Without a board the points of
            both photographs of a pair have one numbering.
        board, square, marker, dictionary, size
            As for :meth:`calibrate`.
        lenses
            Cameras whose lenses are known, and None for a lens that is sought in the same photographs. The first camera keeps its
            pose.
        distortion
            Coefficients that are sought of lenses that are not known.

        Raises
        ------
        CalibrationError
            Where the photographs do not fix the lenses or the pose.

        Examples
        --------
        >>> pair = Camera.calibrate_stereo(left, right, board="charuco:8x6", square="30 mm", marker="22 mm",
        ...                                dictionary="DICT_4X4_50", lenses=lenses)  # doctest: +SKIP
        >>> points = pair.triangulate(left_pixels, right_pixels)  # doctest: +SKIP
        """
        from .stereo import calibrate_stereo

        return calibrate_stereo(
            first, second, board, square, marker, dictionary, size, lenses, distortion
        )

    @property
    def projection(self) -> str:
        """``"pinhole"`` or ``"orthographic"``."""
        return "pinhole" if self._camera.lens else "orthographic"

    @property
    def focal(self) -> tuple[float, ...] | None:
        """Focal lengths (fx, fy) in pixels of a pinhole."""
        return tuple(self._camera.lens[0]) if self._camera.lens else None

    @property
    def distortion(self) -> tuple[float, ...]:
        """Distortion coefficients in OpenCV's order."""
        return tuple(self._camera.lens[1]) if self._camera.lens else ()

    @property
    def scale(self) -> float | None:
        """Pixels per metre of an orthographic camera."""
        return self._camera.scale

    @property
    def centre(self) -> tuple[float, ...]:
        """Principal point (cx, cy) in pixels."""
        return tuple(self._camera.centre)

    @property
    def position(self) -> Array:
        """(3,) where the camera is in the world, in m."""
        return np.array(self._camera.place[0])

    @property
    def orientation(self) -> Array:
        """(4,) quaternion (w, x, y, z) that turns the camera's frame into the world's."""
        return np.array(self._camera.place[1])

    @property
    def size(self) -> tuple[int, ...] | None:
        """Columns and rows of its images."""
        return tuple(self._camera.size) if self._camera.size else None

    @property
    def lens_covariance(self) -> Array | None:
        """(n, n) covariance of the focal lengths, the principal point and the first n - 4 distortion coefficients; None where the lens is
        taken as it is."""
        rows = self._camera.lens_covariance
        return None if rows is None else np.array(rows)

    @property
    def matrix(self) -> Array | None:
        """(3, 3) OpenCV's camera matrix of a pinhole."""
        if not self._camera.lens:
            return None
        (fx, fy), (cx, cy) = self._camera.lens[0], self._camera.centre
        return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])

    @property
    def rvec(self) -> Array:
        """(3,) OpenCV's rotation vector from the world to the camera, in rad."""
        return np.array(self._camera.extrinsics[0])

    @property
    def tvec(self) -> Array:
        """(3,) OpenCV's translation from the world to the camera, in m."""
        return np.array(self._camera.extrinsics[1])

    def project(self, points: npt.ArrayLike) -> Array:
        """(..., 2) pixels at which (..., 3) points of the world, in m, are seen.

        A point that the camera does not see, behind it or where the distortion folds the image, is an
        :class:`~whipcord.InputError`.

        Parameters
        ----------
        points
            (..., 3) points of the world in m.
        """
        return _by_rows(self._camera.project, points, 3, 2, "points")

    def undistort(self, pixels: npt.ArrayLike) -> Array:
        """(..., 2) ideal images of (..., 2) pixels, as ``cv2.undistortPoints`` gives them: tangents of a pinhole, metres
        of an orthographic camera.

        Parameters
        ----------
        pixels
            (..., 2) columns and rows in px.
        """
        return _by_rows(self._camera.undistort, pixels, 2, 2, "pixels")

    def rays(self, pixels: npt.ArrayLike) -> tuple[Array, Array]:
        """(..., 3) origins in m and (..., 3) directions, in the world, of all that is seen at (..., 2) pixels.

        Parameters
        ----------
        pixels
            (..., 2) columns and rows in px.
        """
        both = _by_rows(self._camera.rays, pixels, 2, 6, "pixels")
        return both[..., :3], both[..., 3:]

    def locate(
        self,
        points: npt.ArrayLike,
        pixels: npt.ArrayLike,
        *,
        view: Sequence[float] | None = None,
        pixel_deviation: float | None = None,
    ) -> Located:
        """The same camera in the place from which it sees (n, 3) points of the world, in m, at (n, 2) pixels.

        The squares of the distances in the image are least. Points on one line, such as the centres of the disks of a
        straight robot, look the same from all sides of it: they need `view`, the direction of the world in which the
        camera looks. Of an orthographic camera the scale is sought, too.

        Parameters
        ----------
        points
            (n, 3) points of the world in m.
        pixels
            (n, 2) columns and rows in px at which they are seen.
        view
            (3,) direction of the world in which the camera looks, where the points alone do not tell.
        pixel_deviation
            Standard deviation of a column or row in px; by default as the residuals tell it.

        Examples
        --------
        >>> camera = Camera(focal=(800, 800), centre=(320, 240), position=(0, 0, -0.5))
        >>> points = [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1], [0.1, 0.1, 0.05], [0.1, 0, 0.1]]
        >>> found = Camera(focal=(800, 800), centre=(320, 240)).locate(points, camera.project(points))
        >>> bool(np.allclose(found.camera.position, [0, 0, -0.5]))
        True
        """
        points, pixels = _pairs(points, pixels)
        return Located._of(self._camera.locate(points, pixels, _view(view), _deviation(pixel_deviation)))

    @staticmethod
    def locate_orthographic(
        points: npt.ArrayLike,
        pixels: npt.ArrayLike,
        *,
        size: Sequence[int] | None = None,
        view: Sequence[float] | None = None,
        pixel_deviation: float | None = None,
    ) -> Located:
        """The orthographic camera that sees (n, 3) points of the world, in m, at (n, 2) pixels: its scale and its place.

        With `view`, the direction of the world in which it looks, two points do.

        Parameters
        ----------
        points
            (n, 3) points of the world in m.
        pixels
            (n, 2) columns and rows in px at which they are seen.
        size
            Columns and rows of the images, where they are known.
        view
            (3,) direction of the world in which the camera looks, where the points alone do not tell.
        pixel_deviation
            Standard deviation of a column or row in px; by default as the residuals tell it.
        """
        points, pixels = _pairs(points, pixels)
        found = _core.locate_orthographic(
            points, pixels, _pixels(size), _view(view), _deviation(pixel_deviation)
        )
        return Located._of(found)

    def __repr__(self) -> str:
        arguments = [f"{name}={value!r}" for name, value in self._arguments(False).items()]
        kind = "Camera" if self._camera.lens else "Camera.orthographic"
        return f"{kind}({', '.join(arguments)})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Camera) and self._arguments() == other._arguments()

    def __hash__(self) -> int:
        return hash(tuple(self._arguments().items()))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a camera does not change: make another one with another `{name}`")

    def __reduce__(self) -> tuple[Any, ...]:
        return (_again, (self.projection, self._arguments()))

    def _arguments(self, whole: bool = True) -> dict[str, Any]:
        position, orientation = self._camera.place
        lens = {"scale": self.scale} if self._camera.scale else {"focal": self.focal}
        coefficients = {"distortion": self.distortion} if self.distortion else {}
        place = {"position": tuple(position), "orientation": tuple(orientation)}
        size = {"size": self.size} if self.size else {}
        rows = self._camera.lens_covariance if whole else None
        sure = {"lens_covariance": tuple(map(tuple, rows))} if rows else {}
        return {**lens, "centre": self.centre, **coefficients, **place, **size, **sure}

    def _hold(self, core: _core.Camera) -> None:
        object.__setattr__(self, "_camera", core)

    @classmethod
    def _of(cls, core: _core.Camera) -> Camera:
        camera = object.__new__(cls)
        camera._hold(core)
        return camera


def _again(projection: str, arguments: dict[str, Any]) -> Camera:
    return Camera(**arguments) if projection == "pinhole" else Camera.orthographic(**arguments)


@dataclass(frozen=True, eq=False)
class Located:
    """A camera in its place, and how well it explains what was seen."""

    camera: Camera
    """The camera."""
    residuals: Array
    """(n, 2) columns and rows by which each point was seen beside where the camera has it."""
    rms: float
    """The root of their mean square distance, in pixels."""
    other: Camera | None
    """The next best pose, where there is one: a plane looks much the same from two sides."""
    other_rms: float | None
    """The RMS distance that it leaves, in pixels."""
    is_ambiguous: bool
    """Whether what was seen does not tell the two apart."""
    covariance: Array | None
    """(6, 6) covariance of the position in m and the rotation in rad, along and about the axes of the world, by the errors of the pixels and
    of a lens with a covariance. A direction of view that is given is exact. None where there are no more columns and rows than unknowns
    and no `pixel_deviation` is given."""
    pixel_deviation: float | None
    """Standard deviation of a column or row in pixels, as given or as the residuals tell it."""
    relative_scale_deviation: float | None
    """Standard deviation of the scale of an orthographic camera, relative to it."""

    @property
    def position_deviation(self) -> Array | None:
        """(3,) standard deviations of the position in m."""
        return _deviations(self.covariance, 0)

    @property
    def rotation_deviation(self) -> Array | None:
        """(3,) standard deviations of the rotation in rad."""
        return _deviations(self.covariance, 3)

    @classmethod
    def _of(cls, found: _core._Located) -> Located:
        camera, residuals, rms, other, ambiguous, (covariance, pixel), scale = found
        next_best, other_rms = (Camera._of(other[0]), other[1]) if other else (None, None)
        placed = Camera._of(camera)
        return cls(placed, residuals, rms, next_best, other_rms, ambiguous, covariance, pixel, scale)


def _deviations(covariance: Array | None, first: int) -> Array | None:
    if covariance is None:
        return None
    deviations: Array = np.sqrt(np.maximum(np.diagonal(covariance)[first : first + 3], 0.0))
    return deviations


def _deviation(pixels: float | None) -> float | None:
    if pixels is None:
        return None
    value = float(pixels)
    if not 0.0 < value < np.inf:
        message = f"pixel_deviation must be positive, but is {pixels!r}"
        raise InputError(message, path="pixel_deviation")
    return value


def _covariance(given: npt.ArrayLike | None, most: int) -> list[list[float]] | None:
    if given is None:
        return None
    rows = np.asarray(given, dtype=np.float64)
    square = rows.ndim == 2 and rows.shape[0] == rows.shape[1] and 4 <= len(rows) <= min(most, 16)
    if not square or not np.all(np.isfinite(rows)) or not np.allclose(rows, rows.T) or np.any(np.diagonal(rows) < 0):
        message = (
            f"lens_covariance must be a covariance of the focal lengths, the principal point and at most {most - 4} "
            f"distortion coefficients, but has the shape {rows.shape}, or is not symmetric"
        )
        raise InputError(message, path="lens_covariance")
    listed: list[list[float]] = rows.tolist()
    return listed


def _numbers(given: Sequence[float], count: int, name: str) -> list[float]:
    try:
        values = [float(value) for value in given]
    except (TypeError, ValueError):
        values = []
    if len(values) != count:
        raise InputError(f"{name} must be {count} numbers, but is {given!r}", path=name)
    return values


def _pixels(size: Sequence[int] | None) -> list[int] | None:
    if size is None:
        return None
    whole = [int(value) for value in size]
    if len(whole) != 2 or whole != list(size) or not all(0 < value <= 1_000_000 for value in whole):
        raise InputError(f"size must be the columns and rows of the images, but is {size!r}", path="size")
    return whole


def _view(view: Sequence[float] | None) -> list[float] | None:
    return None if view is None else _numbers(view, 3, "view")


def _rows(given: npt.ArrayLike, width: int, name: str) -> Array:
    try:
        rows = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{name} must be an array of numbers", path=name) from None
    if rows.ndim == 0 or rows.shape[-1] != width:
        raise InputError(f"{name} must have the shape (..., {width}), but has {rows.shape}", path=name)
    return rows


def _by_rows(each: Any, given: npt.ArrayLike, width: int, wide: int, name: str) -> Array:
    rows = _rows(given, width, name)
    found: Array = each(rows.reshape(-1, width))
    return found.reshape(*rows.shape[:-1], wide)


def _pairs(points: npt.ArrayLike, pixels: npt.ArrayLike) -> tuple[Array, Array]:
    rows = _rows(points, 3, "points").reshape(-1, 3), _rows(pixels, 2, "pixels").reshape(-1, 2)
    if len(rows[0]) != len(rows[1]):
        raise InputError(f"{len(rows[0])} points are seen at {len(rows[1])} pixels", path="pixels")
    return rows
