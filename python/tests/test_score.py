"""Models against tables of measurements."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import whipcord
from whipcord import InputError, Score

ARM = "motor-log/arm.toml"
MODELS = ["cosserat-disks", "four-bar", "constant-curvature"]


@pytest.fixture(scope="module")
def scored() -> Score:
    return whipcord.score(whipcord.load(whipcord.examples.path(ARM)), by=MODELS)


def test_the_numbers_are_those_of_the_command(scored: Score, tmp_path: Path) -> None:
    path = str(whipcord.examples.path(ARM))
    models = [word for model in MODELS for word in ("--model", model)]
    command = [sys.executable, "-m", "whipcord", "score", path, *models, "--json", "--rows", "--no-figures"]
    said = subprocess.run([*command, "--out", str(tmp_path)], capture_output=True, check=True, text=True)
    assert json.loads(said.stdout) == json.loads(scored.to_json(rows=True))


def test_a_score_has_models_cases_and_rows(scored: Score) -> None:
    assert [of.model for of in scored] == MODELS
    best = scored.best
    assert best is not None and best.model == "cosserat-disks" and best.distance is not None
    assert best.compared == 62 and best.failed == 0 and best.angle is not None
    [case] = scored.cases
    assert case.each == "independent" and case.registration == "rigid" and case.rows == 62
    rows = scored.cases[0].models[0].rows_scored
    errors = np.array([row.error for row in rows], dtype=float)
    assert errors.max() == pytest.approx(best.distance.worst)
    assert best.worst_row is not None and rows[int(errors.argmax())].row == best.worst_row["row"]
    assert best.down_weighted == 0 and not any(row.down_weighted for row in rows)
    assert scored["four-bar"].distance is None and scored["four-bar"].reasons
    assert "RMS" in repr(scored)
    with pytest.raises(KeyError):
        scored["none"]


def test_threads_change_nothing(scored: Score) -> None:
    case = whipcord.load(whipcord.examples.path(ARM))
    assert whipcord.score(case, by=MODELS, threads=1).to_json(rows=True) == scored.to_json(rows=True)


def test_a_score_is_a_table_and_a_report(scored: Score, tmp_path: Path) -> None:
    frame = scored.to_pandas()
    assert len(frame) == 3 * 62 and set(frame["model"]) == set(MODELS)
    report = Path(scored.report(tmp_path / "score"))
    assert report.exists() and (tmp_path / "score" / "rows.csv").exists()
    assert list((tmp_path / "score").glob("*.svg"))


def test_cases_without_measurements_are_refused() -> None:
    case = whipcord.load(whipcord.examples.path("table1/case-3.toml"))
    with pytest.raises(InputError, match="nothing was measured in space"):
        whipcord.score(case)
    with pytest.raises(InputError, match="list of models"):
        whipcord.score(case, by="cosserat")
    with pytest.raises(InputError, match="at least 1"):
        whipcord.score(case, threads=0)


def test_a_fit_moves_the_measurement_by_one_rigid_motion() -> None:
    case = whipcord.load(whipcord.examples.path(ARM))
    before = whipcord.score(case, by=["cosserat-disks"])["cosserat-disks"].distance
    found = whipcord.fit(case, ["motors[*].stiffness"], model="cosserat-disks")
    assert before is not None and found.rms_distance is not None and found.rms_distance < before.rms
    # The frame of the tracker is an unknown too.
    assert found["measured.position[2]"].deviation is not None
    after = whipcord.score(found.cases[0], by=["cosserat-disks"])["cosserat-disks"].distance
    assert after is not None and after.rms == pytest.approx(found.rms_distance, rel=1e-3)
