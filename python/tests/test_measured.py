"""What was measured, beside the models: the numbers are those of the command, and what was put in."""

from __future__ import annotations

import csv
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import whipcord
from scipy.spatial.transform import Rotation

FIT = """
[fit]
parameters = ["backbone.young_modulus"]
each = ["base.position[0]"]
[[fit.known]]
parameter = "backbone.young_modulus"
start = 1.2e9
"""


def measured(case: whipcord.Case, positions: np.ndarray, folder: Path, registration: str) -> Path:
    """The robot file of a case whose disks were measured here."""
    lines = [f"{i + 1},{x!r},{y!r},{z!r}" for i, (x, y, z) in enumerate(positions.tolist())]
    (folder / "disks.csv").write_text("disk,x,y,z\n" + "\n".join(lines) + "\n")
    table = f'\n[measured]\ndisks = "disks.csv"\nregistration = "{registration}"\n'
    (folder / "case.toml").write_text(case.to_toml() + table)
    return folder / "case.toml"


def kabsch(points: np.ndarray, targets: np.ndarray) -> np.ndarray:
    """The points, moved rigidly as near to the targets as they get (SciPy)."""
    turn, _ = Rotation.align_vectors(targets - targets.mean(axis=0), points - points.mean(axis=0))
    moved: np.ndarray = turn.apply(points - points.mean(axis=0)) + targets.mean(axis=0)
    return moved


def test_a_measurement_in_another_frame_is_compared(case: whipcord.Case, tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    frame = Rotation.from_rotvec([0.4, -1.1, 0.7])
    there = frame.apply(case.solve().position + rng.normal(0, 4e-4, (10, 3))) + np.array([0.3, -0.2, 1.0])
    file = measured(case, there, tmp_path, "rigid")
    comparison = whipcord.compare(whipcord.load(file))
    models = set(whipcord.models.NAMES) - {"constant-curvature"}
    assert comparison["constant-curvature"].solution is None
    for model in models:
        found = comparison[model]
        assert found.solution is not None and isinstance(found.measured, whipcord.Distances)
        model_has = found.solution.disks.position
        moved = kabsch(there, model_has)
        assert np.allclose(found.measured.measured, moved, atol=1e-12)
        assert found.measured.down_weighted == ()
        expected = np.sqrt(np.mean(np.sum((moved - model_has)[1:] ** 2, axis=1)))
        assert found.distance_to_measured == pytest.approx(expected, rel=1e-9)
        assert found.measured.disk == tuple(range(1, 11)) and found.measured.at_base == (True,) + 9 * (False,)
    command = [sys.executable, "-m", "whipcord", "compare", str(file), "--out", str(tmp_path / "report")]
    subprocess.run(command, check=True, capture_output=True)
    with open(tmp_path / "report" / "cases.csv") as table:
        rows = {row["model"]: row for row in csv.DictReader(table) if "shape" not in row["commands"].lower()}
    for model in models:
        assert float(rows[model]["rms_to_measured"]) == comparison[model].distance_to_measured


def test_one_disk_on_the_base_shifts(case: whipcord.Case, tmp_path: Path) -> None:
    positions = case.solve().position + np.array([0.1, 0.2, -0.3])
    positions[1:, 2] += 4e-3
    found = whipcord.compare(whipcord.load(measured(case, positions, tmp_path, "base")))["cosserat"]
    assert found.distance_to_measured == pytest.approx(4e-3, abs=1e-12)
    assert isinstance(found.measured, whipcord.Distances) and found.measured.motion is not None
    assert np.allclose(found.measured.motion[0], [-0.1, -0.2, 0.3])


def test_too_few_markers_are_no_frame(case: whipcord.Case, tmp_path: Path) -> None:
    found = whipcord.compare(whipcord.load(measured(case, case.solve().position[:1], tmp_path, "rigid")))[
        "cosserat"
    ]
    assert found.solution is not None and found.distance_to_measured is None
    assert isinstance(found.measured, whipcord.InputError) and "needs 2 points or more" in str(found.measured)


def test_what_is_to_be_fitted_is_kept(case: whipcord.Case, tmp_path: Path) -> None:
    file = measured(case, case.solve().position, tmp_path, "none")
    file.write_text(file.read_text() + FIT)
    known = whipcord.load(file)
    assert "[fit]" not in case.to_toml() and known != case
    for same in (known, known.replace(title="b"), known.with_parameters({"backbone.diameter": 2e-3})):
        same.save(tmp_path / "again.toml")
        again = whipcord.load(tmp_path / "again.toml")
        assert again == same and again.to_toml().count("1200000000") == 1
        assert pickle.loads(pickle.dumps(same)) == same
    copy = pickle.loads(pickle.dumps(known))
    (tmp_path / "disks.csv").unlink()
    assert whipcord.compare(copy)["cosserat"].distance_to_measured == 0.0


def test_all_steps_with_measurements_count(case: whipcord.Case, tmp_path: Path) -> None:
    """Tips in the first and the last of three steps, 7 mm and 1 mm off: the root mean square is 5 mm."""
    stepped = case.replace(steps=[whipcord.Step(tension=[pull]) for pull in (1.0, 3.0, 2.0)])
    tips = [solution.tip for solution in stepped.solve_steps()]
    lines = [
        f"{step},10,{float(x + off)!r},{float(y)!r},{float(z)!r}"
        for step, (x, y, z), off in ((1, tips[0], 7e-3), (3, tips[2], 1e-3))
    ]
    (tmp_path / "tips.csv").write_text("step,disk,x,y,z\n" + "\n".join(lines) + "\n")
    for registration, rms in (("none", 5e-3), ("base", None)):
        table = f'\n[measured]\ndisks = "tips.csv"\nregistration = "{registration}"\n'
        (tmp_path / "case.toml").write_text(stepped.to_toml() + table)
        comparison = whipcord.compare(whipcord.load(tmp_path / "case.toml"), by=["cosserat"])
        run = comparison["cosserat"]
        if rms is None:
            assert run.distance_to_measured is None and "cannot be moved" in str(run.why_not_measured)
            assert "cannot be moved" in repr(comparison)
            continue
        assert run.distance_to_measured == pytest.approx(rms, rel=1e-6)
        assert isinstance(run.measured, whipcord.Distances)
        assert (run.measured.step, run.measured.steps, run.measured.points) == ((1, 3), 2, 2)
        assert "5.000 mm from the measurement over 2 points in 2 steps" in repr(comparison)
        assert run.stable is True and len(run.steps) == 3
        [row] = [row for row in comparison.benchmark.rows if row.preset == "usual"]
        assert row.rms == pytest.approx(rms, rel=1e-6) and (row.compared_steps, row.compared_points) == (2, 2)
