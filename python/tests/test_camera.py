"""Cameras see what OpenCV's see, and can be saved, copied and located."""

from __future__ import annotations

import pickle
from pathlib import Path

import cv2
import numpy as np
import pytest
import whipcord
from whipcord import Camera, InputError

COUNTS = [0, 4, 5, 8, 12, 14]


def random_camera(
    rng: np.random.Generator, count: int
) -> tuple[Camera, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """A camera that looks at the origin from half a metre or more, and OpenCV's K, D, rvec and tvec of it."""
    spans = [0.3, 0.1, 2e-3, 2e-3, 0.05, 0.1, 0.05, 0.02, 2e-3, 2e-3, 2e-3, 2e-3, 0.05, 0.05]
    distortion = rng.uniform(-1, 1, count) * spans[:count]
    focal, centre = rng.uniform(700, 1800, 2), rng.uniform(250, 400, 2)
    turn = cv2.Rodrigues(rng.uniform(-2, 2, 3))[0]
    tvec = np.array([*rng.uniform(-0.05, 0.05, 2), rng.uniform(0.5, 1.5)])
    matrix = np.array([[focal[0], 0, centre[0]], [0, focal[1], centre[1]], [0, 0, 1]])
    rvec = cv2.Rodrigues(turn)[0].ravel()
    half = np.linalg.norm(rvec) / 2
    axis = rvec / np.linalg.norm(rvec)
    camera = Camera(
        focal=focal,
        centre=centre,
        distortion=distortion,
        position=-turn.T @ tvec,
        orientation=[np.cos(half), *(-np.sin(half) * axis)],
        size=(640, 480),
    )
    return camera, matrix, distortion, rvec, tvec


@pytest.mark.parametrize("count", COUNTS)
def test_opencv_projects_and_undistorts_alike(count: int) -> None:
    rng = np.random.default_rng(count)
    for _ in range(30):
        camera, matrix, distortion, rvec, tvec = random_camera(rng, count)
        points = rng.uniform(-0.12, 0.12, (40, 3))
        coefficients = distortion if count else None
        expected = cv2.projectPoints(points, rvec, tvec, matrix, coefficients)[0].reshape(-1, 2)
        pixels = camera.project(points)
        assert np.abs(pixels - expected).max() < 1e-9
        # OpenCV iterates to a fixed point: to rounding if it may take long enough.
        zeros = np.zeros(4) if coefficients is None else coefficients
        criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 2000, 1e-14)
        ideal = cv2.undistortPoints(pixels.reshape(-1, 1, 2), matrix, zeros, criteria=criteria).reshape(-1, 2)
        assert np.abs((camera.undistort(pixels) - ideal) * camera.focal).max() < 1e-6
        assert np.allclose(camera.rvec, rvec, atol=1e-12) and np.allclose(camera.tvec, tvec, atol=1e-12)
        origin, direction = camera.rays(pixels)
        assert np.abs(np.cross(points - origin, direction)).max() < 1e-9


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("flat", [False, True])
def test_opencv_finds_the_same_pose(count: int, flat: bool) -> None:
    rng = np.random.default_rng(100 + count)
    for _ in range(10):
        camera, matrix, distortion, rvec, tvec = random_camera(rng, count)
        points = rng.uniform(-0.12, 0.12, (12, 3)) * [1, 1, 0 if flat else 1]
        coefficients = distortion if count else None
        pixels = cv2.projectPoints(points, rvec, tvec, matrix, coefficients)[0].reshape(-1, 2)
        bare = Camera(focal=camera.focal, centre=camera.centre, distortion=distortion)
        found = bare.locate(points, pixels)
        assert found.rms < 1e-6
        assert np.abs(found.camera.tvec - tvec).max() < 1e-6
        assert np.abs(cv2.Rodrigues(found.camera.rvec)[0] - cv2.Rodrigues(rvec)[0]).max() < 1e-6
        # With noise both are at the same least squares.
        noisy = pixels + rng.normal(0, 0.3, pixels.shape)
        found = bare.locate(points, noisy)
        criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 1000, 1e-15)
        turn, shift = cv2.solvePnPRefineLM(
            points,
            noisy,
            matrix,
            coefficients,
            rvec.reshape(3, 1).copy(),
            tvec.reshape(3, 1).copy(),
            criteria=criteria,
        )
        again = cv2.projectPoints(points, turn, shift, matrix, coefficients)[0].reshape(-1, 2)
        assert found.rms <= np.sqrt(((again - noisy) ** 2).sum(axis=1).mean()) + 1e-9
        if not found.is_ambiguous:
            assert np.abs(found.camera.tvec - shift.ravel()).max() < 1e-6
            assert np.abs(found.camera.project(points) - again).max() < 1e-4


def test_opencv_reads_what_is_written_and_the_other_way_round(tmp_path: Path) -> None:
    rng = np.random.default_rng(7)
    for count in COUNTS:
        camera, matrix, distortion, rvec, tvec = random_camera(rng, count)
        for name in ("camera.yml", "camera.json"):
            camera.save(tmp_path / name)
            file = cv2.FileStorage(str(tmp_path / name), cv2.FILE_STORAGE_READ)
            assert np.array_equal(file.getNode("camera_matrix").mat(), matrix)
            if count:
                assert np.array_equal(file.getNode("distortion_coefficients").mat().ravel(), distortion)
            assert np.allclose(file.getNode("rvec").mat().ravel(), rvec, atol=1e-12)
            assert np.allclose(file.getNode("tvec").mat().ravel(), tvec, atol=1e-12)
            assert file.getNode("image_width").real() == 640
            file.release()
            file = cv2.FileStorage(str(tmp_path / f"cv-{name}"), cv2.FILE_STORAGE_WRITE)
            file.write("image_width", 640)
            file.write("image_height", 480)
            file.write("camera_matrix", matrix)
            if count:
                file.write("distortion_coefficients", distortion.reshape(1, -1))
            file.write("rvec", rvec.reshape(3, 1))
            file.write("tvec", tvec)
            file.release()
            read = Camera.load(tmp_path / f"cv-{name}")
            assert read.distortion == camera.distortion and np.array_equal(read.matrix, matrix)
            assert np.allclose(read.position, camera.position, atol=1e-12) and read.size == (640, 480)


def test_a_camera_is_a_value(tmp_path: Path) -> None:
    flat = Camera.orthographic(scale=2500, centre=(319.5, 239.5), position=(0.1, 0, 0), size=(640, 480))
    for camera in (random_camera(np.random.default_rng(1), 14)[0], flat):
        copy = pickle.loads(pickle.dumps(camera))
        assert copy == camera and hash(copy) == hash(camera) and eval(repr(camera)) == camera
        with pytest.raises(AttributeError, match="does not change"):
            camera.centre = (0, 0)  # type: ignore[misc]
    flat.save(tmp_path / "flat.yml")
    assert Camera.load(tmp_path / "flat.yml") == flat
    assert flat.projection == "orthographic" and flat.focal is None and flat.matrix is None
    assert np.allclose(flat.project([[0.1, 0, 9], [0.2, 0.1, -9]]), [[319.5, 239.5], [569.5, 489.5]])


def test_a_straight_robot_needs_the_direction_of_view() -> None:
    disks = np.zeros((10, 3))
    disks[:, 2] = np.linspace(0, 0.18, 10)
    camera = Camera(
        focal=(1500, 1500), centre=(320, 240), position=(0.7, 0.05, 0.1), orientation=(0.5, 0.5, -0.5, -0.5)
    )
    pixels = camera.project(disks)
    with pytest.raises(InputError, match="on one line, along"):
        camera.locate(disks, pixels)
    found = camera.locate(disks, pixels, view=(-1, 0, 0))
    assert found.rms < 1e-9 and np.allclose(found.camera.position, camera.position, atol=1e-6)
    # The paper's procedure: the scale of a side view from the known length.
    side = Camera.locate_orthographic(disks[[0, -1]], [[320, 460], [320, 10]], view=(-1, 0, 0))
    assert side.camera.scale == pytest.approx(450 / 0.18)


def test_what_cannot_be_is_refused(tmp_path: Path) -> None:
    camera = Camera(focal=(800, 800), centre=(320, 240))
    with pytest.raises(InputError, match=r"points\[1\]: the point is not in front of the camera") as caught:
        camera.project([[0, 0, 1], [0, 0, -1]])
    assert caught.value.path == "points[1]"
    for arguments, words in [
        ({"distortion": [1, 2]}, "4, 5, 8, 12 or 14"),
        ({"focal": (0, 1)}, "must be greater than zero"),
        ({"orientation": (0, 0, 0, 0)}, "a quaternion of norm 1"),
        ({"centre": 3}, "centre must be 2 numbers"),
        ({"size": (640.5, 480)}, "columns and rows"),
    ]:
        with pytest.raises(InputError, match=words):
            Camera(**{"focal": (800, 800), "centre": (320, 240), **arguments})  # type: ignore[arg-type]
    with pytest.raises(InputError, match="shape"):
        camera.project([[1, 2]])
    with pytest.raises(InputError, match="must be a finite number"):
        camera.undistort([[np.nan, 0]])
    with pytest.raises(InputError, match="3 points are seen at 2 pixels"):
        camera.locate(np.zeros((3, 3)), np.zeros((2, 2)))
    with pytest.raises(InputError, match=r"should end in \.yml"):
        camera.save(tmp_path / "camera.xml")
    (tmp_path / "camera.xml").write_text("<?xml version='1.0'?>")
    with pytest.raises(whipcord.FileError, match="XML are not read"):
        Camera.load(tmp_path / "camera.xml")


def test_located_cameras_have_a_covariance(tmp_path: Path) -> None:
    def camera(rows: np.ndarray | None = None) -> Camera:
        return Camera(
            focal=(820, 815), centre=(320, 240), size=(640, 480), position=(0, 0, -0.5), lens_covariance=rows
        )

    truth = camera()
    points = np.array([[0.03 * np.cos(1.3 * k), 0.03 * np.sin(1.3 * k), 0.02 * k] for k in range(10)])
    random = np.random.default_rng(5)
    pixels = truth.project(points) + random.normal(0, 0.3, (10, 2))
    found = truth.locate(points, pixels, pixel_deviation=0.3)
    assert found.covariance is not None and found.covariance.shape == (6, 6)
    assert found.position_deviation is not None
    assert found.pixel_deviation == 0.3
    # The scatter over many sets is that of the covariance.
    off = []
    for _ in range(300):
        again = truth.locate(points, truth.project(points) + random.normal(0, 0.3, (10, 2)))
        off.append(again.camera.position - truth.position)
        assert again.pixel_deviation == pytest.approx(again.rms * np.sqrt(10 / 14))
    np.testing.assert_allclose(np.std(off, axis=0), found.position_deviation, rtol=0.15)
    # Focal lengths that go together and are 1 % off, at a distance of about 0.6 m along z.
    rows = np.zeros((4, 4))
    rows[:2, :2] = 8.2**2
    calibrated = camera(rows)
    with_lens = calibrated.locate(points, pixels, pixel_deviation=0.3)
    assert with_lens.position_deviation is not None and with_lens.camera.lens_covariance is not None
    assert with_lens.position_deviation[2] > 5e-3 > 2 * found.position_deviation[2]
    assert np.array_equal(with_lens.camera.lens_covariance, rows)
    for name in ("camera.yml", "camera.json"):
        calibrated.save(tmp_path / name)
        again = Camera.load(tmp_path / name)
        assert again == calibrated and hash(again) == hash(calibrated)
        assert again != truth
    assert pickle.loads(pickle.dumps(calibrated)) == calibrated
    assert "lens_covariance" not in repr(calibrated)


def test_covariances_that_cannot_be_are_refused() -> None:
    for rows in (np.eye(3), np.eye(5), [[1, 2, 3, 4]] * 4, -np.eye(4)):
        with pytest.raises(InputError, match="lens_covariance"):
            Camera(focal=(800, 800), centre=(320, 240), lens_covariance=rows)
    camera = Camera(focal=(800, 800), centre=(320, 240))
    with pytest.raises(InputError, match="pixel_deviation"):
        camera.locate(np.eye(4, 3), np.zeros((4, 2)), pixel_deviation=0.0)


def test_two_located_cameras_have_a_covariance() -> None:
    def pair(z: float) -> list[Camera]:
        return [Camera(focal=(800, 800), centre=(320, 240), position=(x, 0, z)) for x in (0, 0.2)]

    moved, both = pair(0.0), pair(-0.5)
    seen = np.array([[0, 0, 0], [0.05, 0, 0.02], [0, 0.05, -0.01], [0.04, 0.03, 0.05]])
    random = np.random.default_rng(2)
    off = []
    for _ in range(200):
        pixels = [camera.project(seen) + random.normal(0, 0.3, (4, 2)) for camera in both]
        found = whipcord.locate_stereo(moved, (seen, seen), pixels, pixel_deviation=0.3)
        off.append(found.cameras[0].position - both[0].position)
    assert found.covariance is not None
    deviation = np.sqrt(np.diagonal(found.covariance)[:3])
    np.testing.assert_allclose(np.std(off, axis=0), deviation, rtol=0.2)
