"""Lenses of cameras, by photographs of a board."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._commands import metres
from .camera import Camera, _pairs, _pixels
from .errors import InputError
from .photographs import PhotoLike, picture

__all__ = ["Calibration", "Distortion"]

Array = npt.NDArray[np.float64]
Length = Union[float, str]
Distortion = Literal["none", "k1k2", "4", "5", "8", "12"]
"""Distortion coefficients that are sought, in OpenCV's order."""


@dataclass(frozen=True, eq=False)
class Calibration:
    """The lens of a camera, how sure it is, and how well it explains the photographs it was had from."""

    camera: Camera
    """The camera, at the origin of the world."""
    rms: float
    """Root mean square distance in pixels between where corners are seen and where the lens has them."""
    view_rms: Array
    """(k,) the same for each photograph that was used."""
    used: tuple[int, ...]
    """Numbers of the photographs that were used, from 0."""
    refused: tuple[tuple[int, str], ...]
    """Those that were not, and why."""
    corners: tuple[tuple[Array, Array, Array], ...]
    """For each photograph that was used (n,) numbers of the corners, (n, 3) where they are on the board in m, and (n, 2)
    where they are seen in pixels."""
    focal_deviation: Array
    """(2,) standard deviations of the focal lengths in pixels."""
    centre_deviation: Array
    """(2,) those of the principal point."""
    distortion_deviation: Array
    """Those of the distortion coefficients: 0 for one that was not sought, NaN for one that the photographs do not tell."""
    pixel_deviation: float
    """That of a column or row at which a corner was seen."""
    covariance: Array
    """(4 + c, 4 + c) of the focal lengths, the principal point and the c distortion coefficients that were sought."""
    tilt: float
    """Greatest angle between the boards in two photographs, in rad, seen from the camera."""
    warnings: tuple[str, ...]
    """What speaks against relying on it."""


def calibrate(
    photos: Iterable[PhotoLike] | Iterable[tuple[npt.ArrayLike, npt.ArrayLike]],
    board: str | None,
    square: Length | None,
    marker: Length | None,
    dictionary: str | None,
    size: Sequence[int] | None,
    distortion: str,
) -> Calibration:
    """See :meth:`whipcord.Camera.calibrate`."""
    if board is None:
        seen = _given(photos, size)
    else:
        looked_for = _board(board, square, marker, dictionary, size)
        # One at a time: photographs are large.
        seen = [looked_for.find(picture(_photo(photo), f"photos[{i}]")) for i, photo in enumerate(photos)]
    camera, sure, (rms, view_rms, tilt), used, refused, warnings = _core.calibrate(seen, str(distortion))
    focal, centre, coefficients, pixel, covariance = sure
    return Calibration(
        camera=Camera._of(camera),
        rms=rms,
        view_rms=np.array(view_rms),
        used=tuple(used),
        refused=tuple(refused),
        corners=tuple(_corners(seen[i]) for i in used),
        focal_deviation=np.array(focal),
        centre_deviation=np.array(centre),
        distortion_deviation=np.array([math.nan if d is None else d for d in coefficients]),
        pixel_deviation=pixel,
        covariance=np.array(covariance),
        tilt=tilt,
        warnings=tuple(warnings),
    )


def _photo(photo: Any) -> PhotoLike:
    if isinstance(photo, tuple):
        raise InputError("points and pixels are given without a board", path="board")
    given: PhotoLike = photo
    return given


def _board(
    board: str,
    square: Length | None,
    marker: Length | None,
    dictionary: str | None,
    size: Sequence[int] | None,
) -> _core.Board:
    """The board that photographs, which have a size of their own, are searched for."""
    if square is None:
        raise InputError("a board needs the side of its squares", path="square")
    if size is not None:
        raise InputError("photographs have a size of their own", path="size")
    side = None if marker is None else metres(marker, "marker")
    return _core.Board(board, metres(square, "square"), side, dictionary)


def _given(views: Iterable[Any], size: Sequence[int] | None) -> list[_core.Seen]:
    whole = _pixels(size)
    if whole is None:
        raise InputError("give the board, or with points the size of the images", path="size")
    seen = []
    for i, view in enumerate(views):
        if not isinstance(view, (tuple, list)) or len(view) != 2:
            raise InputError(
                f"photos[{i}] must be the points of the board and their pixels", path=f"photos[{i}]"
            )
        seen.append(_core.Seen(whole, *_pairs(*view)))
    return seen


def _corners(seen: _core.Seen) -> tuple[Array, Array, Array]:
    numbers, points, pixels = zip(*seen.corners)
    return np.array(numbers), np.array(points), np.array(pixels)
