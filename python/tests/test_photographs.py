"""Photographs: what was drawn is found, the command says the same, and models lie where the camera sees them."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
import whipcord
from whipcord import Camera, Case, InputError, errors

# A view along +x: y of the world to the left, z up.
CAMERA = Camera.orthographic(
    scale=2000, centre=(320, 440), position=(-1, 0, 0), orientation=(0.5, -0.5, 0.5, -0.5), size=(640, 480)
)


def command(*arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, "-m", "whipcord", *arguments], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def bent(case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Where the camera sees the disks, and the direction of their rims there."""
    solution = case.solve()
    centres = CAMERA.project(solution.disks.position)
    # In the frame of a disk, whose axis lies in the image, its rim is across.
    tangent = CAMERA.project(solution.disks.position + 1e-3 * solution.disks.rotation[:, :, 2]) - centres
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    return centres, np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)


def photograph(centres: np.ndarray, rims: np.ndarray, colour: Any = (40, 40, 45)) -> np.ndarray:
    """Bars across the backbone, before a light wall; four by four samples in each pixel."""
    light = np.full((480, 640, 3), 205.0)
    fine = (np.arange(4) + 0.5) / 4 - 0.5
    for centre, rim in zip(centres, rims):
        left, top = np.maximum(np.floor(centre).astype(int) - 30, 0)
        rows, columns = np.mgrid[top : top + 60, left : left + 60]
        inside = np.zeros(rows.shape)
        for dv in fine:
            for du in fine:
                away = np.stack([columns + du, rows + dv], axis=-1) - centre
                across, along = away @ rim, away @ np.array([-rim[1], rim[0]])
                inside += (abs(across) < 20) & (abs(along) < 2.5)
        share = (inside / 16)[:, :, None]
        area = light[top : top + 60, left : left + 60]
        area += (share * (np.array(colour) - area))[: area.shape[0], : area.shape[1]]
    return np.rint(light).astype(np.uint8)


@pytest.fixture
def plane() -> Case:
    """A robot that bends in the image."""
    robot = whipcord.Robot(
        backbone=whipcord.Backbone(length=0.18, diameter=0.003, young_modulus=1.1e9, poisson_ratio=0.3),
        disks=whipcord.Disks(count=10, hole_circle_radius=0.008, holes=4),
        cables=[whipcord.Cable(name="pull", holes=10 * [2])],
    )
    return Case(robot, tension=[2.0], shortening=["4 %"], title="plane")


def test_disks_that_were_drawn_are_found(plane: Case, tmp_path: Path) -> None:
    centres, rims = bent(plane)
    photo = photograph(centres, rims)
    marks = whipcord.measure(photo, plane, camera=CAMERA)
    other = whipcord.Camera(focal=(800, 800), centre=(5, 5), size=(11, 11))
    with pytest.raises(whipcord.InputError, match=r"camera is of pictures of \(11, 11\) pixels"):
        whipcord.measure(photo, plane, camera=other)
    assert marks.disk == tuple(range(1, 11)) and len(marks) == 10 and marks.size == (640, 480)
    assert np.sqrt(((marks.pixel - centres) ** 2).sum(axis=1).mean()) < 0.15
    assert np.abs(np.sum(marks.axis * rims, axis=1)).min() > 0.999
    assert abs(np.median(marks.radius) - 20) < 1 and marks.confidence.min() > 0.5
    # The command says the same of the same picture.
    matplotlib.image.imsave(tmp_path / "photo.png", photo)
    plane.save(tmp_path / "robot.toml")
    CAMERA.save(tmp_path / "side.yml")
    files = [str(tmp_path / name) for name in ("photo.png", "robot.toml", "side.yml", "cli.csv")]
    said = json.loads(
        command("measure", files[0], "--robot", files[1], "--camera", files[2], "-o", files[3], "--json")
    )
    assert [[mark["u"], mark["v"]] for mark in said["marks"]] == marks.pixel.tolist()
    again = whipcord.measure(tmp_path / "photo.png", plane.robot, base="bottom")
    assert np.array_equal(again.pixel, marks.pixel)
    again.to_csv(tmp_path / "py.csv", camera="side")
    assert (tmp_path / "py.csv").read_text() == (tmp_path / "cli.csv").read_text()
    again.to_csv(tmp_path / "second.csv", step=2)
    assert (tmp_path / "second.csv").read_text().startswith("step,disk,u,v,confidence\n2,1,")
    # What was found is drawn into it.
    drawn = marks.annotated()
    assert (
        drawn.shape == photo.shape
        and drawn.dtype == np.uint8
        and 0 < (drawn != photo).any(axis=2).sum() < 3e4
    )
    marks.save_annotated(tmp_path / "marked.png")
    stored = np.rint(255 * matplotlib.image.imread(tmp_path / "marked.png")[:, :, :3]).astype(np.uint8)
    assert np.array_equal(stored, drawn)


def test_a_grey_picture_a_mask_and_hidden_disks(plane: Case) -> None:
    centres, rims = bent(plane)
    shown = [0, 1, 2, 3, 5, 6, 7, 8, 9]
    photo = photograph(centres[shown], rims[shown])
    photo[30:90, 30:90] = 20
    mask = np.ones((480, 640), dtype=bool)
    mask[:120, :120] = False
    marks = whipcord.measure(photo[:, :, 0], plane, hidden=[5], mask=mask, base=(320, 440))
    assert marks.disk == (1, 2, 3, 4, 6, 7, 8, 9, 10)
    assert np.abs(marks.pixel - centres[shown]).max() < 0.3


def test_dots_have_a_colour(plane: Case) -> None:
    rows, columns = np.mgrid[:480, :640]
    photo = np.full((480, 640, 3), 190, dtype=np.uint8)
    centres = np.array([[100.0, 240.0], [200, 235], [300, 225], [400, 210]])
    for u, v in centres:
        photo[np.hypot(columns - u, rows - v) < 9] = (208, 32, 32)
    for colour in ("#d02020", (208, 32, 32), None):
        marks = whipcord.measure(photo, kind="dots", count=4, colour=colour, base="left")
        assert np.abs(marks.pixel - centres).max() < 0.1


def test_what_cannot_be_measured_is_refused(plane: Case, tmp_path: Path) -> None:
    centres, rims = bent(plane)
    photo = photograph(centres, rims)
    with pytest.raises(errors.TooFewFoundError, match="10 were found where there must be 12") as few:
        whipcord.measure(photo, count=12, base="bottom")
    assert few.value.expected == 12 and np.abs(np.array(few.value.found) - centres).max() < 0.3
    with pytest.raises(errors.TooManyFoundError) as many:
        whipcord.measure(photo, count=9)
    assert len(many.value.found) == 10 and len(many.value.least_sure) == 1
    with pytest.raises(whipcord.DetectionError):
        whipcord.measure(np.full((100, 100), 128, dtype=np.uint8))
    (tmp_path / "text.png").write_text("no picture")
    with pytest.raises(whipcord.FileError, match="neither PNG nor JPEG") as none:
        whipcord.measure(tmp_path / "text.png")
    assert none.value.path == str(tmp_path / "text.png")
    with pytest.raises(FileNotFoundError):
        whipcord.measure(tmp_path / "nowhere.png")
    for arguments, words in [
        ({"kind": "bars"}, "there is no kind `bars`"),
        ({"hidden": [3]}, "without how many there are"),
        ({"hidden": [11], "count": 10}, "hidden 11: there are disks 1 to 10"),
        ({"hidden": [0], "count": 10}, "from 1"),
        ({"base": "up"}, "must be left, right, top, bottom"),
        ({"base": (1, 2, 3)}, "must be left, right, top, bottom"),
        ({"colour": "red"}, "#d02020"),
        ({"radius": 0}, "from 1 to 10000"),
        ({"count": 2.5}, "whole number"),
        ({"count": -1}, "not be negative"),
        ({"count": 9, "robot": plane}, "either a robot or a count"),
        ({"mask": np.ones((3, 3), dtype=bool)}, "the mask has 3×3 pixels"),
        ({"mask": np.zeros((480, 640), dtype=bool)}, "the mask is black"),
        ({"photo": photo.astype(float)}, "bytes of the shape"),
        ({"photo": photo[0, 0]}, "bytes of the shape"),
    ]:
        with pytest.raises(InputError, match=words):
            whipcord.measure(**{"photo": photo, **arguments})  # type: ignore[arg-type]


def test_models_lie_over_the_photograph(plane: Case, tmp_path: Path) -> None:
    centres, rims = bent(plane)
    marks = whipcord.measure(photograph(centres, rims), plane, camera=CAMERA)
    # Seen 3 pixels to the right of and 4 above where they are: 5 pixels, and half a millimetre for each.
    shifted = photograph(centres + np.array([3.0, -4.0]), rims)
    seen = whipcord.measure(shifted, plane, base="bottom")
    over = whipcord.overlay(shifted, plane, camera=CAMERA, marks=seen)
    run = over["cosserat"]
    assert run.rms_pixels == pytest.approx(5, abs=0.1) and run.rms_distance == pytest.approx(2.5e-3, abs=5e-5)
    assert run.rms_fraction == pytest.approx(2.5e-3 / 0.18, abs=5e-4)
    assert np.allclose(run.pixel, centres, atol=1e-6) and np.allclose(run.distance, run.pixels / 2000)
    assert over.disk == tuple(range(1, 11)) and np.array_equal(over.seen, seen.pixel)
    other = over["four-bar"].solution
    assert other is not None and np.allclose(CAMERA.project(other.disks.position), over["four-bar"].pixel)
    exact = whipcord.overlay(shifted, plane, camera=CAMERA, marks=marks, models=["cosserat"])
    assert len(exact) == 1 and (exact["cosserat"].rms_pixels or 1) < 0.2
    for name in ("over.svg", "over.png"):
        over.save(tmp_path / name)
    assert (tmp_path / "over.svg").read_text() == over.svg
    assert matplotlib.image.imread(tmp_path / "over.png").shape[1] == 2 * 980
    # The command says the same, of what [measured] says.
    matplotlib.image.imsave(tmp_path / "photo.png", shifted)
    seen.to_csv(tmp_path / "seen.csv", camera="side")
    CAMERA.save(tmp_path / "side.yml")
    by_table = whipcord.overlay(shifted, plane, camera=CAMERA, marks=tmp_path / "seen.csv")
    assert np.array_equal(by_table["cosserat"].distance, run.distance)
    known = plane.with_measured(tmp_path / "seen.csv", cameras={"side": tmp_path / "side.yml"})
    known.save(tmp_path / "robot.toml")
    files = [str(tmp_path / name) for name in ("photo.png", "robot.toml", "out")]
    command("overlay", files[0], files[1], "--out", files[2])
    lines = (tmp_path / "out" / "photo-distances.csv").read_text().splitlines()
    told = [line.split(",") for line in lines]
    by_file = whipcord.overlay(files[0], whipcord.load(files[1]))
    column = told[0].index("distance")
    for run in by_file:
        assert [float(row[column]) for row in told[1:] if row[0] == run.model] == run.distance.tolist()
    assert (tmp_path / "out" / "photo-overlay.svg").read_text() == by_file.svg
    assert np.array_equal(whipcord.overlay(files[0], known, camera="side").seen, by_file.seen)


def test_what_cannot_be_laid_over_is_refused(plane: Case) -> None:
    photo = np.full((480, 640), 180, dtype=np.uint8)
    for arguments, words in [
        ({}, "which camera took the photograph"),
        ({"camera": "side"}, "there is no camera 'side'"),
        ({"camera": CAMERA, "step": 2}, "there is no step 2"),
        ({"camera": CAMERA, "models": ["rod"]}, "rod"),
        ({"camera": CAMERA, "photo": photo[:100]}, "640×480 pixels, but the photograph has 640×100"),
        ({"camera": Camera.orthographic(scale=2e5, centre=(-9e4, 0))}, "no disk of `cosserat"),
    ]:
        with pytest.raises(InputError, match=words):
            whipcord.overlay(**{"photo": photo, "case": plane, **arguments})  # type: ignore[arg-type]
    pulled = plane.replace(tension=[2.0], shortening=None)
    over = whipcord.overlay(photo, pulled, camera=CAMERA)
    assert isinstance(over["four-bar"].error, whipcord.ModelError) and over["cosserat"].solution is not None
    assert over["cosserat"].rms_pixels is None and over.seen.shape == (0, 2)
    with pytest.raises(whipcord.ModelError):
        whipcord.overlay(photo, pulled, camera=CAMERA, models=["four-bar"])
