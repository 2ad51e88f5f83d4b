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
        ({}, "must be a list with one number for each cable"),
        ({"pull": 1}, "must be a list with one number for each cable"),
        ({3.0}, "must be a list with one number for each cable"),
        (True, "must be a list with one number for each cable"),
        (np.array([True]), "must be a list with one number for each cable"),
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
        (None, "give tensions, shortenings or commands of motors"),
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
        ({"stations": 10**12}, "stations must be a number from 2"),
        ({"stations": [0.5]}, "arc length of a station"),
        ({"stations": []}, "a list of arc lengths"),
        ({"stations": "5"}, "stations must be a whole number or a list of arc lengths in m"),
        ({"stations": 37.0}, "stations must be a whole number or a list of arc lengths in m"),
        ({"stations": ["90 mm"]}, "stations must be a whole number or a list of arc lengths in m"),
        ({"model": 3}, "model must be one of cosserat"),
        ({"model": whipcord.models.Cosserat(steps="x")}, "has a wrong type"),
        ({"start": 3}, "start must be a Solution, but is 3"),
        ({"shortening": [0.01], "length": [0.17]}, "either the length or the shortening of cable pull"),
        ({"length": [[1]]}, "length must be a number in m or a text with a unit, but is [1]"),
        ({"actuation": "force"}, "choose tension or shortening"),
        ({"model": whipcord.models.Cosserat(steps=0)}, "greater than zero"),
        ({"model": whipcord.models.CosseratDisks(tolerance=100.0)}, "tolerance must be from 1e-13 to 0.01"),
        ({"model": whipcord.models.Cosserat(steps=10**12)}, "must be at most 100000, but is 1000000000000"),
        ({"model": whipcord.models.FourBar(chord="bow")}, "there is no chord `bow`"),
    ):
        with pytest.raises(InputError) as caught:
            case.solve(**options)  # type: ignore[arg-type]
        assert words in str(caught.value), options
    with pytest.raises(InputError, match="at least 1"):
        case.solve_batch([[1.0]], threads=0)
    with pytest.raises(InputError, match=r"there is no parameter `backbone\.colour`"):
        case.differentiate(parameters=["backbone.colour"])
    for path, near in [
        ("backbone.diamter", "backbone.diameter"),
        ("young_modulus", "backbone.young_modulus"),
        ("cables[0].routing.raduis", r"cables\[0\].routing.radius"),
        ("loads.tip_force", r"loads.tip_force\[0\]"),
    ]:
        with pytest.raises(InputError, match=f": did you mean `{near}`\\?"):
            case.differentiate(parameters=[path])
        with pytest.raises(InputError, match=f": did you mean `{near}`\\?"):
            case.parameter(path)
    with pytest.raises(InputError, match="threads must be a whole number"):
        case.solve_batch([[1.0]], threads=2.5)  # type: ignore[arg-type]
    for call in (case.differentiate, case.pull_back_batch):
        with pytest.raises(InputError, match=r"a list of paths, but is 'backbone\.diameter'"):
            call(parameters="backbone.diameter")
    with pytest.raises(InputError, match="by parameters are known to models in equilibrium under loads, not to four-bar"):
        case.differentiate(model="four-bar", parameters=["backbone.diameter"])
    straight = whipcord.load("examples/table1/case-1.toml")
    with pytest.raises(InputError, match="not to constant-curvature"):
        straight.differentiate(model="constant-curvature")


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


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda case: Case(3), "robot must be a Robot, but is 3"),
        (lambda case: Case(case.robot, loads=3), "loads must be a Loads, but is 3"),
        (lambda case: Case(case.robot, loads=Disks(count=3)), "loads must be a Loads, but is Disks(count=3)"),
        (lambda case: Case(case.robot, steps=whipcord.Step(tension=[1])), "steps must be a list of Step"),
        (lambda case: Case(case.robot, steps=[3]), "steps[0] must be a Step, but is 3"),
        (lambda case: Robot(backbone=3, disks=case.robot.disks), "backbone must be a Backbone, but is 3"),
        (lambda case: case.robot.replace(cables=case.robot.cables[0]), "cables must be a list of Cable"),
        (lambda case: Loads(point=[3]), "point[0] must be a PointLoad, but is 3"),
        (lambda case: case.robot.backbone.replace(section=3), "section must be a Section, but is 3"),
        (lambda case: case.robot.cables[0].replace(routing=3), "routing must be a Routing, but is 3"),
        (lambda case: whipcord.compare(case.robot), "case must be a Case"),
        (lambda case: whipcord.compare(case, by=["x"]), "there is no model `x`"),
        (lambda case: whipcord.compare(case, by="cosserat"), "by must be a list of models"),
        (lambda case: whipcord.solve_cases(case), "cases must be a list of cases"),
        (lambda case: whipcord.solve_cases([3]), "cases must be a list of cases"),
        (lambda case: whipcord.plot.compare(), "there is no answer to draw"),
        (lambda case: whipcord.plot.compare(case.solve(), labels=["a", "b"]), "labels must be one for each"),
        (lambda case: case.stiffness([1]), "at must be a number in m or a text with a unit"),
        (lambda case: case.parameter(3), "parameters must be a list of paths, but is [3]"),
        (lambda case: case.with_parameters([3]), "values must be a dict of paths and numbers"),
        (lambda case: case.solve().rms_distance(3), "other must be a Solution"),
    ],
)
def test_what_is_no_part_of_this_is_refused_in_terms_of_python(
    case: whipcord.Case, call: Any, words: str
) -> None:
    with pytest.raises(InputError) as caught:
        call(case)
    assert words in str(caught.value)
    assert "line of its own" not in str(caught.value)


def test_robots_with_other_disks_have_no_distance(case: whipcord.Case) -> None:
    fewer = case.robot.replace(
        disks=case.robot.disks.replace(count=7), cables=[Cable(name="a", holes=[1] * 7)]
    )
    with pytest.raises(InputError, match="a robot with 10 disks has no distance to one with 7"):
        case.solve().rms_distance(Case(fewer, tension=[1.0]).solve())


def test_what_is_pulled_back_and_where(case: whipcord.Case) -> None:
    _, derivatives = case.differentiate()
    for weights in ("abc", np.ones(3), np.ones((9, 3))):
        with pytest.raises(InputError, match="position must"):
            derivatives.pull_back(position=weights)  # type: ignore[arg-type]
    assert np.array_equal(derivatives.compliance(-1), derivatives.compliance(9))
    assert np.array_equal(derivatives.compliance(np.int64(-10)), derivatives.compliance(0))
    for at, words in ((-11, "no station -11"), (10, "no station 10"), (1.5, "at must be the number")):
        with pytest.raises(InputError, match=words):
            derivatives.compliance(at)  # type: ignore[arg-type]


def test_a_file_that_cannot_be_written_is_named(case: whipcord.Case, tmp_path: Path) -> None:
    path = tmp_path / "none" / "a"
    for write in (case.save, case.robot.save, case.solve().to_csv):
        with pytest.raises(FileNotFoundError) as caught:
            write(path)
        assert str(path) in str(caught.value)


def test_a_package_that_is_not_installed_is_named(
    case: whipcord.Case, monkeypatch: pytest.MonkeyPatch
) -> None:
    import sys

    # What is None there cannot be imported.
    for name in ("pandas", "polars", "xarray", "pyvista", "tqdm"):
        for module in [name, *(m for m in sys.modules if m.startswith(f"{name}."))]:
            monkeypatch.setitem(sys.modules, module, None)  # type: ignore[arg-type]
    solution = case.solve()
    comparison = whipcord.compare(case)
    for name, call in (
        ("pandas", solution.to_pandas),
        ("pandas", comparison.to_pandas),
        ("polars", solution.to_polars),
        ("xarray", solution.to_xarray),
        ("pyvista", lambda: solution.plot(backend="pyvista")),
        ("tqdm", lambda: case.solve_batch([[1.0]], progress=True)),
    ):
        with pytest.raises(ModuleNotFoundError, match=f"pip install {name}"):
            call()


@pytest.mark.parametrize("how", ["solve", "differentiate", "stiffness"])
def test_a_cable_is_driven_by_tension_or_by_shortening(case: whipcord.Case, how: str) -> None:
    with pytest.raises(InputError, match="tension and shortening of cable pull are both given") as caught:
        getattr(case, how)(tension=[2.0], shortening=[0.001])
    assert caught.value.path == "shortening" and "leave out shortening" in str(caught.value)
    # Which of them drives may be said.
    both = getattr(case, how)(tension=[2.0], shortening=[0.001], actuation="tension")
    assert both is not None


def test_a_cable_is_driven_by_tension_or_by_length(case: whipcord.Case) -> None:
    with pytest.raises(InputError, match="tension and length of cable pull are both given"):
        case.solve(tension=[2.0], length=[0.17])


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (
            lambda: Backbone(length=0.18, young_modulus=0),
            "`backbone.young_modulus` must be greater than zero",
        ),
        (lambda: Backbone(length=0.18, young_modulus=-1e9), "`backbone.young_modulus` must be greater"),
        (lambda: Backbone(length=0.18, young_modulus=float("nan")), "must be a finite number, but is NaN"),
        (lambda: Backbone(length=0.18, young_modulus=float("inf")), "must be a finite number, but is inf"),
        (lambda: Backbone(length=0.18, shear_modulus=0), "`backbone.shear_modulus` must be greater"),
        (lambda: Backbone(length=0.0), "`backbone.length` must be greater than zero, but is 0"),
        (lambda: Backbone(length=0.18, diameter=0), "`backbone.diameter` must be greater than zero"),
        (lambda: Backbone(length=0.18, diameters=[0.003, 0]), "`backbone.diameters` must be greater"),
        (lambda: Backbone(length=0.18, poisson_ratio=0.6), "`backbone.poisson_ratio` must be at most 0.5"),
        (lambda: Backbone(length=0.18, poisson_ratio=-1), "`backbone.poisson_ratio` must be greater than -1"),
        (lambda: Backbone(length=0.18, density=-1), "`backbone.density` must not be negative"),
        (lambda: Backbone(length=0.18, shear_correction=0), "`backbone.shear_correction` must be greater"),
        (
            lambda: Backbone(length=0.18, rest_curvature=[0, float("inf"), 0]),
            "`rest_curvature` must be a finite number",
        ),
        (
            lambda: Disks(count=10, hole_circle_radius=-0.01),
            "`disks.hole_circle_radius` must be greater than zero",
        ),
        (lambda: Disks(count=10, mass=-1), "`disks.mass` must not be negative"),
        (lambda: Cable(name="a", holes=[1, 1], friction=-0.1), "`cables.friction` must not be negative"),
        (
            lambda: Cable(name="a", holes=[1, 1], axial_stiffness=0),
            "`cables.axial_stiffness` must be greater",
        ),
    ],
)
def test_numbers_that_make_no_sense_are_refused_where_they_are_given(make: Any, words: str) -> None:
    with pytest.raises(InputError) as caught:
        make()
    assert words in str(caught.value)
