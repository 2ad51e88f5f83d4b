"""Warnings are Python's own, and say where."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest
import whipcord
from whipcord import Backbone, Cable, Case, Disks, Loads, Robot, WhipcordWarning


def robot(**changes: object) -> Robot:
    rod = {
        "length": "180 mm",
        "diameter": "3 mm",
        "young_modulus": "1.1 GPa",
        "poisson_ratio": 0.3,
        **changes,
    }
    disks = Disks(count=10, hole_circle_radius="8 mm", holes=12)
    cable = Cable(name="pull", holes=[4] * 10)
    return Robot(backbone=Backbone(**rod), disks=disks, cables=[cable])  # type: ignore[arg-type]


def test_nothing_is_said_where_all_is_as_usual(case: Case) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert Case(robot(), tension=[4.0]).warnings == []
        assert case.warnings == [] and case.solve().warnings == []
        # Numbers in SI are Python's own; that this one had a unit is not known any more.
        soft = Case(robot(young_modulus="500 kPa"))
        assert soft.warnings == []


def test_a_case_warns_where_it_is_made() -> None:
    with pytest.warns(WhipcordWarning) as told:
        case = Case(robot(length=180))
    assert [warning.code for warning in case.warnings] == ["bare-number"]
    assert all(warning.filename == __file__ for warning in told)
    assert isinstance(case.warnings[0], UserWarning)
    assert case.warnings[0].place is None and '"180 mm"' in str(case.warnings[0])


def test_a_file_warns_where_it_is_read_and_says_the_place(tmp_path: Path) -> None:
    path = tmp_path / "robot.toml"
    path.write_text('[backbone]\nlength = "180 mm"\ndiameter = 3\n[disks]\ncount = 10\n')
    with pytest.warns(WhipcordWarning) as told:
        case = whipcord.load(path)
    (warning,) = case.warnings
    assert warning.place == (str(path), 3, 12)
    assert told[0].filename == __file__ and str(path) in str(told[0].message)


def test_an_answer_warns_where_it_is_asked_for() -> None:
    case = Case(robot(yield_strain="1 %"), tension=[4.0])
    assert case.warnings == [] and case.robot.backbone.yield_strain == 0.01
    with pytest.warns(WhipcordWarning, match="yield strain of 1 %") as told:
        solution = case.solve()
    assert [warning.code for warning in solution.warnings] == ["yield-strain"]
    assert told[0].filename == __file__
    with pytest.warns(WhipcordWarning) as told:
        assert [warning.code for warning in whipcord.compare(case).warnings] == ["yield-strain"]
    assert len(told) == 1


def test_a_load_far_too_large_is_spoken_of() -> None:
    loads = Loads(tip_force=[0, 0, "-5 N"])
    with pytest.warns(WhipcordWarning, match="15 times the load"):
        case = Case(robot(), tension=[0.0], loads=loads)
    assert case.warnings[0].code == "beyond-buckling"


def test_warnings_are_values_like_others() -> None:
    import copy
    import pickle

    warning = WhipcordWarning("unstable", "it is", "let go", ("a.toml", 1, 2))
    for other in (copy.copy(warning), pickle.loads(pickle.dumps(warning))):
        assert (other.code, other.message, other.help, other.place) == warning.args
