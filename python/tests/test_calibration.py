"""Lenses from photographs of boards, beside OpenCV's."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
import whipcord
from whipcord import Calibration, CalibrationError, Camera, InputError

SIZE = (640, 480)
SQUARE = 0.03
MATRIX = np.array([[820.0, 0, 325.0], [0, 815.0, 236.0], [0, 0, 1]])
DISTORTION = np.array([-0.25, 0.08, 8e-4, -5e-4])
# Tilt about x and y, turn, and where the middle of the board is from the camera.
VIEWS = [
    ((0.0, 0.0, 0.0), (0.0, 0.0, 0.46)),
    ((0.45, -0.3, 0.3), (0.02, 0.01, 0.52)),
    ((-0.5, 0.2, 0.1), (-0.05, -0.03, 0.55)),
    ((0.1, 0.55, 0.2), (0.05, -0.03, 0.5)),
    ((-0.2, -0.6, -0.3), (0.08, 0.06, 0.6)),
    ((0.5, 0.1, 0.1), (-0.08, 0.05, 0.58)),
]


def charuco() -> cv2.aruco.CharucoBoard:
    return cv2.aruco.CharucoBoard(
        (8, 6), SQUARE, 0.022, cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    )


def photographs(kind: str) -> list[np.ndarray]:
    """Photographs of a board of 8 by 6 squares, drawn by OpenCV four times as large, with blur and noise."""
    scale, margin = 40, 40
    if kind == "charuco":
        sheet = charuco().generateImage((8 * scale, 6 * scale), marginSize=0)
    else:
        rows, columns = np.mgrid[: 6 * scale, : 8 * scale] // scale
        sheet = np.where((rows + columns) % 2, 255, 0).astype(np.uint8)
    sheet = cv2.copyMakeBorder(sheet, margin, margin, margin, margin, cv2.BORDER_CONSTANT, value=255)
    rng = np.random.default_rng(3)
    photos = []
    for turn, shift in VIEWS:
        pose = cv2.Rodrigues(np.array(turn))[0]
        # Where the pixels of the photograph are on the board; each is the mean of 16.
        v, u = (np.mgrid[: 4 * SIZE[1], : 4 * SIZE[0]] + 0.5) / 4 - 0.5
        seen = np.stack([u, v], -1).reshape(-1, 1, 2)
        criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 40, 1e-9)
        ideal = cv2.undistortPoints(seen, MATRIX, DISTORTION, criteria=criteria).reshape(-1, 2)
        rays = np.column_stack([ideal, np.ones(len(ideal))]) @ pose
        origin = -np.array(shift) @ pose
        points = origin[:2] - rays[:, :2] * (origin[2] / rays[:, 2])[:, None]
        points += np.array([4, 3]) * SQUARE
        places = (points / SQUARE * scale + margin - 0.5).astype(np.float32).reshape(*u.shape, 2)
        fine = cv2.remap(
            sheet, places[..., 0], places[..., 1], cv2.INTER_LINEAR, None, cv2.BORDER_CONSTANT, 128
        )
        photo = fine.reshape(SIZE[1], 4, SIZE[0], 4).mean(axis=(1, 3))
        photo = cv2.GaussianBlur(photo, (0, 0), 0.7) * 0.7 + 20 + rng.normal(0, 1.0, photo.shape)
        photos.append(np.clip(np.round(photo), 0, 255).astype(np.uint8))
    return photos


@pytest.fixture(scope="module")
def chessboards() -> list[np.ndarray]:
    return photographs("chessboard")


def true(found: Calibration) -> None:
    """All numbers are the true ones within some standard deviations."""
    camera = found.camera
    assert camera.focal is not None
    off = np.abs(np.subtract(camera.focal, MATRIX.diagonal()[:2])) / found.focal_deviation
    assert off.max() < 4, off
    assert np.all(np.abs(np.subtract(camera.centre, MATRIX[:2, 2])) < 4 * found.centre_deviation)
    assert np.all(np.abs(np.subtract(camera.distortion, DISTORTION)) < 4 * found.distortion_deviation)


def test_a_chessboard_as_opencv_sees_it(chessboards: list[np.ndarray], tmp_path: Path) -> None:
    blank = np.full((*SIZE[::-1], 3), 90, dtype=np.uint8)
    path = tmp_path / "first.png"
    cv2.imwrite(str(path), chessboards[0])
    found = Camera.calibrate(
        [path, blank, *chessboards[1:]], board="chessboard:7x5", square="30 mm", distortion="4"
    )
    assert found.used == (0, 2, 3, 4, 5, 6) and found.refused == ((1, "no board is seen"),)
    assert found.camera.size == SIZE and found.rms < 0.06 and found.tilt > 0.5
    assert found.warnings[0].startswith("only 6 photographs show the board")
    true(found)
    # The same corners.
    for photo, (numbers, points, pixels) in zip(chessboards, found.corners):
        assert len(numbers) == 35
        assert np.allclose(points[:, :2], SQUARE * np.column_stack([numbers % 7, numbers // 7]))
        seen, corners = cv2.findChessboardCornersSB(photo, (7, 5), flags=cv2.CALIB_CB_ACCURACY)
        assert seen
        corners = corners.reshape(-1, 2)
        apart = np.linalg.norm(pixels[:, None] - corners[None], axis=-1).min(axis=1)
        assert apart.max() < 0.15 and np.sqrt(np.mean(apart**2)) < 0.06


@pytest.mark.parametrize("flags, distortion", [(cv2.CALIB_FIX_K3, "4"), (0, "5")])
def test_the_same_corners_give_the_lens_of_opencv(
    chessboards: list[np.ndarray], flags: int, distortion: str
) -> None:
    found = Camera.calibrate(chessboards, board="chessboard:7x5", square=SQUARE, distortion="4")
    # OpenCV takes both in single precision.
    views = [(points.astype(np.float32), pixels.astype(np.float32)) for _, points, pixels in found.corners]
    again = Camera.calibrate(views, size=SIZE, distortion=distortion)  # type: ignore[arg-type]
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 1000, 1e-16)
    rms, matrix, coefficients, _, _, sure, _, of_views = cv2.calibrateCameraExtended(
        *zip(*views), SIZE, None, None, flags=flags, criteria=criteria
    )
    count = int(distortion)
    expected = np.array([matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2]])
    assert again.camera.focal is not None
    got = np.array([*again.camera.focal, *again.camera.centre])
    assert np.abs(got / expected - 1).max() < 1e-6
    assert np.abs(np.subtract(again.camera.distortion, coefficients.ravel()[:count])).max() < 1e-5
    assert again.rms == pytest.approx(rms, rel=1e-6)
    assert np.allclose(again.view_rms, of_views.ravel(), rtol=1e-4)
    deviations = np.concatenate([again.focal_deviation, again.centre_deviation, again.distortion_deviation])
    assert np.allclose(deviations, sure.ravel()[: 4 + count], rtol=1e-3)


def test_a_charuco_board_partly_hidden() -> None:
    photos = photographs("charuco")
    for photo in photos[1:4]:
        photo[:, :260] = 100
    found = Camera.calibrate(
        photos,
        board="charuco:8x6",
        square="30 mm",
        marker="22 mm",
        dictionary="DICT_4X4_50",
        distortion="4",
    )
    assert found.refused == () and min(len(numbers) for numbers, _, _ in found.corners) < 30
    true(found)
    detector = cv2.aruco.CharucoDetector(charuco())
    for photo, (numbers, points, pixels) in zip(photos, found.corners):
        corners, ids, _, _ = detector.detectBoard(photo)
        # Its detector leaves them where the markers have them, to some tenths.
        criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 100, 1e-4)
        corners = cv2.cornerSubPix(photo, corners, (4, 4), (-1, -1), criteria)
        both, ours, theirs = np.intersect1d(numbers, ids.ravel(), return_indices=True)
        assert len(both) > 8
        assert np.allclose(charuco().getChessboardCorners()[numbers], points)
        apart = np.linalg.norm(pixels[ours] - corners.reshape(-1, 2)[theirs], axis=-1)
        assert np.median(apart) < 0.1


def test_what_gives_no_lens_is_refused(chessboards: list[np.ndarray]) -> None:
    with pytest.raises(CalibrationError, match="needs 3 photographs of the board or more") as caught:
        Camera.calibrate(
            [*chessboards[:2], chessboards[0][:300, :400]], board="chessboard:7x5", square=SQUARE
        )
    assert list(caught.value.used) == [0, 1]
    assert caught.value.refused[0][0] == 2
    assert isinstance(caught.value, whipcord.WhipcordError)
    for arguments, words in [
        ({"board": "chessboard:7", "square": SQUARE}, "is no board"),
        ({"board": "chessboard:7x5"}, "side of its squares"),
        ({"board": "charuco:8x6", "square": SQUARE}, "side of its markers"),
        ({"board": "chessboard:7x5", "square": SQUARE, "distortion": "3"}, "distortion must be one of"),
        ({}, "give the board, or with points the size"),
        ({"size": SIZE}, "must be the points of the board and their pixels"),
    ]:
        with pytest.raises(InputError, match=words):
            Camera.calibrate(chessboards[:3], **arguments)  # type: ignore[arg-type]
