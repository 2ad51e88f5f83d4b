"""The command of the wheel, and that Python says the same as it, to the last bit."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import whipcord

SOLVED = [
    ("examples/table1/case-3.toml", "cosserat", None),
    ("examples/table1/case-3.toml", "cosserat", 37),
    ("examples/table1/case-3.toml", "four-bar", None),
    ("examples/wall-mounted-arm.toml", "cosserat", None),
    ("examples/three-cable-segment.toml", "cosserat-disks", None),
    ("examples/composite-finger.toml", "cosserat", 11),
    ("examples/rubbing-finger.toml", "cosserat-disks", None),
]


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [str(Path(sys.executable).parent / "whipcord"), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def as_json(*arguments: str) -> Any:
    done = run(*arguments, "--json")
    assert (done.returncode, done.stderr) == (0, "")
    return json.loads(done.stdout)


@pytest.mark.parametrize(("path", "model", "stations"), SOLVED)
def test_python_and_the_command_agree_to_the_last_bit(path: str, model: str, stations: int | None) -> None:
    options = [] if stations is None else ["--stations", str(stations)]
    told = as_json("solve", path, "--model", model, *options)
    # The command solves at the disks; the shape at stations starts from that answer.
    case = whipcord.load(path)
    solution = case.solve(model=model)
    shaped = solution if stations is None else case.solve(model=model, stations=stations, start=solution)
    assert shaped.position.tolist() == told["shape"]["position"]
    assert shaped.orientation.tolist() == told["shape"]["orientation"]
    assert shaped.arc_length.tolist() == told["shape"]["arc_length"]
    assert solution.disks.position.tolist() == [disk["position"] for disk in told["disks"]]
    for cable, other in zip(solution.cables, told["cables"]):
        assert (cable.name, cable.tension, cable.length) == (
            other["name"],
            other["tension"],
            other["length"],
        )
    assert solution.stable == told["stable"]
    assert solution.diagnostics.stability_absent == told["diagnostics"].get("stability_absent")


def test_stiffness_agrees_to_the_last_bit() -> None:
    path = "examples/wall-mounted-arm.toml"
    told = as_json("stiffness", path, "--at", "150 mm")
    place = whipcord.load(path).stiffness("150 mm")
    assert place.jacobian.tolist() == told["actuation_jacobian"]
    assert place.compliance.tolist() == told["tensions_held"]["compliance"]
    assert place.compliance_lengths_held.tolist() == told["lengths_held"]["compliance"]
    assert place.dexterity[0].manipulability == told["dexterity"][0]["manipulability"]


def test_the_csv_is_that_of_the_command(tmp_path: Path) -> None:
    solution = whipcord.load("examples/table1/case-3.toml").solve()
    solution.to_csv(tmp_path / "shape.csv")
    done = run("solve", "examples/table1/case-3.toml", "--csv")
    assert (tmp_path / "shape.csv").read_text() == done.stdout


def test_the_command_has_the_statuses_of_the_contract(tmp_path: Path) -> None:
    assert run("--version").stdout.split() == ["whipcord", whipcord.__version__]
    missing = run("solve", str(tmp_path / "none.toml"))
    assert (missing.returncode, missing.stdout) == (2, "")
    assert "there is no such file" in missing.stderr
    assert run("no-such-verb").returncode == 2
    folds = tmp_path / "folds.toml"
    whipcord.load("examples/table1/case-1.toml").replace(tension=[1e5]).save(folds)
    failed = run("solve", str(folds))
    assert (failed.returncode, failed.stdout) == (1, "")


def test_a_report_solves_to_the_same_bits(tmp_path: Path) -> None:
    path = tmp_path / "report.toml"
    case = whipcord.load("examples/wall-mounted-arm.toml")
    answer = case.solve(tension=["5 N"])
    solution = case.solve(tension=["5 N"], stations=21, start=answer)
    path.write_text(solution.report())
    told = as_json("solve", str(path), "--stations", "21")
    assert np.array_equal(solution.position, told["shape"]["position"])
