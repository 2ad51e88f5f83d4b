"""Two cameras: their relative pose, and points in space."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import whipcord
from whipcord import CalibrationError, Camera, DetectionError, InputError, StereoCalibration

LEFT = Camera(focal=(800, 790), centre=(319.5, 239.5), size=(640, 480))
ORIENTATION = (np.cos(0.2), 0.0, -np.sin(0.2), 0.0)
RIGHT = Camera(
    focal=(810, 805), centre=(322.0, 236.0), size=(640, 480), position=(0.2, 0.01, 0.04), orientation=ORIENTATION
)


def rotation(turn: tuple[float, float, float]) -> np.ndarray:
    """Rotation by a rotation vector."""
    angle = np.linalg.norm(turn)
    if angle == 0:
        return np.eye(3)
    x, y, z = np.array(turn) / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def boards(noise: float) -> list[list[tuple[np.ndarray, np.ndarray]]]:
    """Corners of a board that both cameras see, with noise in pixels."""
    rng = np.random.default_rng(5)
    corners = np.array([[0.03 * i, 0.03 * j, 0.0] for j in range(5) for i in range(7)])
    turns = [(0.1, 0.0, 0.0), (0.4, -0.3, 0.2), (-0.4, 0.3, 0.1), (0.2, 0.5, -0.2), (-0.3, -0.4, 0.3), (0.5, 0.1, 0)]
    seen: list[list[tuple[np.ndarray, np.ndarray]]] = [[], []]
    for turn in turns:
        points = corners @ rotation(turn).T + (-0.09, -0.06, 0.55)
        for views, camera in zip(seen, (LEFT, RIGHT)):
            pixels = camera.project(points)
            views.append((corners, pixels + rng.normal(0, noise, pixels.shape)))
    return seen


@pytest.fixture(scope="module")
def pair() -> StereoCalibration:
    first, second = boards(0.1)
    return Camera.calibrate_stereo(first, second, size=(640, 480), lenses=(LEFT, RIGHT))


def test_the_relative_pose_is_found_within_its_deviations(pair: StereoCalibration) -> None:
    off = np.abs(pair.position - RIGHT.position) / pair.position_deviation
    assert off.max() < 4, off
    assert np.abs(pair.rotation - (0, -0.4, 0)).max() < 4 * pair.rotation_deviation.max()
    assert 0.07 < pair.pixel_deviation < 0.13 and pair.epipolar is not None and pair.epipolar < 0.2
    assert abs(pair.baseline - np.linalg.norm(RIGHT.position)) < 4 * pair.baseline_deviation
    assert len(pair.pairs) == 6 and not pair.refused and pair.pairs[0].common == 35


def test_points_are_triangulated_within_their_deviations(pair: StereoCalibration) -> None:
    rng = np.random.default_rng(7)
    points = rng.uniform((-0.05, -0.05, 0.45), (0.05, 0.05, 0.6), (200, 3))
    pixels = [camera.project(points) + rng.normal(0, 0.2, (200, 2)) for camera in (LEFT, RIGHT)]
    found = whipcord.triangulate((LEFT, RIGHT), *pixels, pixel_deviation=0.2)
    off = found.position - points
    # Squares of the distances in units of their covariance have the mean 3.
    squares = [d @ np.linalg.solve(covariance, d) for d, covariance in zip(off, found.covariance)]
    assert 2.4 < np.mean(squares) < 3.6
    assert found.epipolar.mean() < 0.3 and len(found) == 200
    by_pair = pair.triangulate(*pixels)
    assert np.abs(by_pair.position - points).max() < 3e-3


def test_lenses_that_are_not_known_are_sought() -> None:
    first, second = boards(0.05)
    found = Camera.calibrate_stereo(first, second, size=(640, 480), distortion="none")
    assert np.abs(found.position - RIGHT.position).max() < 5e-3
    assert found.cameras[0].focal is not None and abs(found.cameras[0].focal[0] - 800) < 10


def test_what_cannot_be_is_refused() -> None:
    first, second = boards(0.1)
    with pytest.raises(InputError, match="photographs of the first camera"):
        Camera.calibrate_stereo(first, second[1:], size=(640, 480))
    with pytest.raises(InputError, match="lenses must be two"):
        Camera.calibrate_stereo(first, second, size=(640, 480), lenses=(LEFT,))
    with pytest.raises(CalibrationError):
        Camera.calibrate_stereo(first, first, size=(640, 480), lenses=(LEFT, LEFT))
    with pytest.raises(InputError, match="same points"):
        whipcord.triangulate((LEFT, RIGHT), np.zeros((2, 2)), np.zeros((3, 2)))
    with pytest.raises(InputError, match=r"\(n, 2\)"):
        whipcord.triangulate((LEFT, RIGHT), np.zeros(2), np.zeros(2))
    with pytest.raises(InputError, match="two cameras"):
        whipcord.triangulate((LEFT,), np.zeros((2, 2)), np.zeros((2, 2)))


def photograph(pixels: np.ndarray) -> np.ndarray:
    """Dark dots on a light ground."""
    v, u = np.mgrid[:480, :640]
    photo = np.full((480, 640), 210.0)
    for column, row in pixels:
        outside = np.clip(np.hypot(u - column, v - row) - 6, -20, 20)
        photo -= 170 / (1 + np.exp(2 * outside))
    return np.clip(photo, 0, 255).astype(np.uint8)


def test_dots_in_two_photographs_are_points_in_space(tmp_path: Path) -> None:
    s = np.linspace(0, 0.16, 6)
    points = np.column_stack([s - 0.06, 0.02 * np.sin(12 * s), 0.5 + 0.3 * s**2])
    photos = [photograph(camera.project(points)) for camera in (LEFT, RIGHT)]
    found = whipcord.measure_stereo(photos, (LEFT, RIGHT), kind="circles", count=6, base=("left", "left"))
    assert found.disk == (1, 2, 3, 4, 5, 6) and not found.left_out
    assert np.abs(found.position - points).max() < 4e-4
    table = tmp_path / "points.csv"
    found.to_csv(table, step=2)
    assert table.read_text().startswith("step,disk,x,y,z")
    # One dot is hidden in the second photograph.
    fewer = [photos[0], photograph(RIGHT.project(np.delete(points, 2, axis=0)))]
    found = whipcord.measure_stereo(
        fewer, (LEFT, RIGHT), kind="circles", count=6, hidden=((), (3,)), base=("left", "left")
    )
    assert found.disk == (1, 2, 4, 5, 6) and found.in_one_photo == ((3,), ())
    with pytest.raises(DetectionError):
        whipcord.measure_stereo(photos, (RIGHT, LEFT), kind="circles", count=6, base=("left", "left"))
    with pytest.raises(InputError, match="one for each camera"):
        whipcord.measure_stereo(photos[:1], (LEFT, RIGHT))


def test_two_cameras_are_located_together(pair: StereoCalibration) -> None:
    points = np.array([[0.0, 0.0, 0.5], [0.05, 0.0, 0.52], [-0.02, 0.06, 0.47]])
    turn = rotation((0.3, -0.2, 0.1))
    known = points @ turn.T + (0.1, 0.2, -0.3)
    pixels = LEFT.project(points), RIGHT.project(points)
    found = whipcord.locate_stereo((LEFT, RIGHT), (known, known), pixels)
    assert np.allclose(found.cameras[0].position, (0.1, 0.2, -0.3), atol=1e-8)
    assert np.allclose(found.cameras[1].position, turn @ RIGHT.position + (0.1, 0.2, -0.3), atol=1e-8)
    assert max(found.rms) < 1e-6 and not found.is_ambiguous
    assert [len(of) for of in found.residuals] == [3, 3]
    with pytest.raises(InputError, match="two each"):
        whipcord.locate_stereo((LEFT,), (known,), pixels[:1])
    with pytest.raises(InputError, match="on one line"):
        line = np.array([[0.0, 0.0, 0.5 + 0.01 * k] for k in range(5)])
        whipcord.locate_stereo((LEFT, RIGHT), (line, line), (LEFT.project(line), RIGHT.project(line)))
