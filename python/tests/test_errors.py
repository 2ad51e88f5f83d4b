"""What goes wrong says what to do, with the numbers as attributes."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import whipcord
from whipcord import Backbone, Cable, Case, Disks, InputError, Loads, Robot, errors


def test_the_hierarchy() -> None:
    assert issubclass(InputError, ValueError)
    assert issubclass(errors.ModelError, InputError)
    assert issubclass(errors.FileMissingError, FileNotFoundError)
    for name in errors.__all__:
        assert issubclass(getattr(errors, name), errors.WhipcordError)


def test_a_missing_file(tmp_path: Path) -> None:
    path = tmp_path / "none.toml"
    with pytest.raises(FileNotFoundError, match="there is no such file") as caught:
        whipcord.load(path)
    assert isinstance(caught.value, errors.FileError)
    assert caught.value.path == str(path)


def test_a_damaged_file_says_where(tmp_path: Path) -> None:
    path = tmp_path / "bad.toml"
    path.write_text('[backbone]\nlenght = "180 mm"\n[disks]\ncount = 10\n')
    with pytest.raises(errors.FileError, match="did you mean `length`") as caught:
        whipcord.load(path)
    (problem,) = caught.value.problems
    assert (problem["line"], problem["column"], problem["file"]) == (2, 1, str(path))
    assert "lenght" in problem["message"]
    copy = pickle.loads(pickle.dumps(caught.value))
    assert str(copy) == str(caught.value) and copy.problems == caught.value.problems


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Backbone(length="180 kg"), "`kg` is a unit of mass"),
        (lambda: Backbone(length="180"), "has no unit"),
        (lambda: Backbone(length=float("nan")), "must be a finite number"),
        (lambda: Backbone(length=[1, 2]), "`length` must be a length, but is a list"),
        (lambda: Backbone(length=object()), "must be a number"),
        (lambda: Backbone(length=1, diameter=0.1, diameters=[0.1, 0.1]), "cannot stand beside"),
        (lambda: Disks(count=10.5), "`count` must be a whole number"),
        (lambda: Disks(), "has neither `count` nor `positions`"),
        (lambda: Cable(name="a", holes=[1.5, 2]), "must be a whole number"),
        (lambda: Cable(name="a", routing={"kind": "spiral"}), "`spiral` is no `kind`"),
        (lambda: Loads(tip_force=[1, 2]), "must have 3 values, but has 2"),
        (lambda: whipcord._core.parse_quantity("3 N", "length"), "is a unit of force"),
    ],
)
def test_parts_refuse_what_cannot_be(make: Any, words: str) -> None:
    with pytest.raises(InputError) as caught:
        make()
    assert words in str(caught.value)


def test_a_robot_is_refused_as_a_whole() -> None:
    rod = Backbone(length=0.18, diameter=0.003)
    with pytest.raises(InputError, match="names 3 holes, but there are only 2 disks"):
        Robot(
            backbone=rod,
            disks=Disks(count=2, hole_circle_radius=0.008, holes=12),
            cables=[Cable(name="a", holes=[1, 1, 1])],
        )
    with pytest.raises(InputError, match="must be greater than zero"):
        Robot(backbone=Backbone(length=-1), disks=Disks(count=2))


@pytest.mark.parametrize(
    ("tension", "words"),
    [
        ([1.0, 2.0], "tension must have 1 entry, one for each cable (pull), but has 2"),
        (np.ones((2, 1)), "must have the shape (1,)"),
        ([-1.0], "must not be negative, but is -1"),
        ([float("nan")], "must be a finite number"),
        (["400 mm"], "`mm` is a unit of length"),
        (["much"], "does not begin with a number"),
        ([object()], 'a text such as "400 gf", but is a `object`'),
        ([None], "needs `tension` of cable 1"),
        ({}, "but has 0"),
    ],
)
def test_wrong_tensions(case: whipcord.Case, tension: Any, words: str) -> None:
    with pytest.raises(InputError) as caught:
        case.solve(tension=tension)
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (np.ones(3), "tension must have the shape (N, 1)"),
        (np.ones((3, 2)), "one column for each cable (pull), but has (3, 2)"),
        ([["a"]], "must be an array of numbers"),
        (np.ones((2, 1), dtype=complex), "must be an array of numbers"),
        ([[1.0], [1.0, 2.0]], "must be an array of numbers"),
        (None, "give either tensions or shortenings"),
    ],
)
def test_wrong_rows(case: whipcord.Case, rows: Any, words: str) -> None:
    with pytest.raises(InputError) as caught:
        case.solve_batch(rows)
    assert words in str(caught.value)


def test_wrong_options(case: whipcord.Case) -> None:
    for options, words in (
        ({"model": "cosserats"}, "there is no model `cosserats`: choose"),
        ({"stations": 1}, "stations must be a number from 2"),
        ({"stations": [0.5]}, "arc length of a station"),
        ({"stations": []}, "a list of arc lengths"),
        ({"actuation": "force"}, "choose tension or shortening"),
        ({"model": whipcord.models.Cosserat(steps=0)}, "greater than zero"),
        ({"model": whipcord.models.FourBar(chord="bow")}, "there is no chord `bow`"),
    ):
        with pytest.raises(InputError) as caught:
            case.solve(**options)  # type: ignore[arg-type]
        assert words in str(caught.value), options
    with pytest.raises(InputError, match="at least 1"):
        case.solve_batch([[1.0]], threads=0)
    with pytest.raises(InputError, match=r"there is no parameter `backbone\.colour`"):
        case.differentiate(parameters=["backbone.colour"])
    with pytest.raises(InputError, match="not to four-bar"):
        case.differentiate(model="four-bar")


def test_a_model_that_misses_something(case: whipcord.Case) -> None:
    bare = case.robot.backbone.replace(young_modulus=None, poisson_ratio=None)
    with pytest.raises(errors.ModelError) as caught:
        case.replace(robot=case.robot.replace(backbone=bare)).solve()
    assert (caught.value.model, caught.value.path) == ("cosserat", "backbone.young_modulus")
    loaded = case.replace(loads=Loads(tip_force=[0.1, 0, 0]))
    with pytest.raises(errors.ModelError, match="the four-bar model cannot take"):
        loaded.solve(model="four-bar")


def test_a_section_that_folds(case: whipcord.Case) -> None:
    with pytest.raises(errors.SectionFoldsError) as caught:
        case.solve(tension=[1e5])
    error = caught.value
    assert (error.cable, error.tension) == ("pull", 1e5)
    assert 0 < error.last_load < 1 and 0 <= error.arc_length <= 0.18
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is type(error) and vars(copy) == vars(error)


def test_a_length_out_of_reach(case: whipcord.Case) -> None:
    with pytest.raises(errors.UnreachableLengthError) as caught:
        case.solve(shortening=["183 mm"])
    assert caught.value.requested == 0.183
    assert 0 < caught.value.reachable < 0.183


def test_lengths_that_contradict_one_another(segment: whipcord.Case) -> None:
    rod = segment.robot.backbone.replace(extensible=False, shearable=False)
    stiff = segment.replace(robot=segment.robot.replace(backbone=rod))
    with pytest.raises(errors.ContradictoryLengthsError) as caught:
        stiff.solve(shortening=["5 mm"] * 3)
    assert all(excess > 0 for excess in caught.value.excess.values())


def test_a_case_is_checked_when_it_is_made(case: whipcord.Case) -> None:
    with pytest.raises(InputError, match="must not be negative"):
        Case(case.robot, tension=[-1])
    with pytest.raises(InputError, match="one for each cable"):
        Case(case.robot, tension=[1, 2])
    with pytest.raises(InputError, match="beyond the tip at"):
        Case(case.robot, tension=[1], loads=Loads(point=[whipcord.PointLoad(at=1, force=[1, 0, 0])]))
