"""Robots and cases: built, written, read, changed."""

from __future__ import annotations

import copy
import pickle
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import whipcord
from whipcord import (
    Along,
    Backbone,
    Base,
    Cable,
    Case,
    Disks,
    DistributedLoad,
    Loads,
    Obstacle,
    PointLoad,
    PointMass,
    Robot,
    Routing,
    Section,
    SectionStiffness,
    Step,
)

EXAMPLES = sorted((Path(__file__).resolve().parents[2] / "examples").rglob("*.toml"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_every_example_comes_back_from_its_text_parts_and_pickle(path: Path) -> None:
    case = whipcord.load(path)
    again = Case.from_toml(case.to_toml())
    assert again == case and hash(again) == hash(case)
    assert again.reference == case.reference
    robot = Robot(
        backbone=case.robot.backbone.replace(),
        disks=None if case.robot.disks is None else case.robot.disks.replace(),
        cables=[cable.replace() for cable in case.robot.cables],
        motors=[motor.replace() for motor in case.robot.motors],
    )
    assert robot == case.robot and hash(robot) == hash(case.robot)
    rebuilt = case.replace(loads=case.loads.replace(), base=case.base.replace())
    assert rebuilt._tables == case._tables
    for thing in (case, robot, case.loads, case.base, *case.robot.cables, *case.obstacles):
        copy = pickle.loads(pickle.dumps(thing))
        assert copy == thing and hash(copy) == hash(thing) and repr(copy) == repr(thing)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_what_is_written_solves_to_the_same_bits(path: Path, tmp_path: Path) -> None:
    case = whipcord.load(path)
    case.save(tmp_path / "copy.toml")
    copy = whipcord.load(tmp_path / "copy.toml")
    if not case.robot.cables:
        return
    model = "cosserat-disks" if case.robot.cables[0].friction else "cosserat"
    assert np.array_equal(copy.solve(model=model).position, case.solve(model=model).position)


def test_obstacles_come_and_go_with_a_case() -> None:
    case = whipcord.load(Path(__file__).resolve().parents[2] / "examples/contact/arm-at-wall.toml")
    (wall,) = case.obstacles
    assert wall.kind == "half-space" and wall.name == "wall" and wall.position == (0.04, 0.0, 0.0)
    assert case.robot.disks is not None and case.robot.disks.outer_radius == 0.01
    ball = Obstacle(kind="sphere", radius="5 mm", rotation={"axis": [0, 0, 1], "angle": 1.0})
    assert pickle.loads(pickle.dumps(ball)) == ball and hash(ball) == hash(ball.replace())
    both = case.replace(obstacles=[wall, ball])
    assert [obstacle.name for obstacle in both.obstacles] == ["wall", "obstacle-2"]
    assert both.replace(obstacles=()).obstacles == () and case != both
    with pytest.raises(whipcord.InputError, match="a sphere has no `radius`"):
        Obstacle(kind="sphere")
    with pytest.raises(whipcord.InputError, match="there is no such file"):
        case.replace(obstacles=[Obstacle(kind="mesh", file="none.stl", unit="mm")])


def test_materials_have_their_numbers_and_keep_their_names(tmp_path: Path) -> None:
    known = whipcord.materials()
    assert len(known) >= 15 and all(name == material.name for name, material in known.items())
    nitinol = known["nitinol"]
    rod = Backbone(length="180 mm", diameter="1 mm", material="nitinol", density="6.4 g/cm^3")
    assert (rod.young_modulus, rod.poisson_ratio) == (nitinol.young_modulus, nitinol.poisson_ratio)
    assert rod.density == 6400 and rod.yield_strain == nitinol.yield_strain
    # Another material takes the place of all numbers, a number that of one.
    assert rod.replace(material="PTFE").density == known["PTFE"].density
    assert rod.replace(young_modulus="58 GPa").material == "nitinol"
    fibres = rod.replace(material="carbon fibre rod")
    assert fibres.poisson_ratio is None and fibres.shear_modulus == known["carbon fibre rod"].shear_modulus
    pull = Cable(name="pull", routing=Routing.straight(angle=0, radius="8 mm"))
    case = Case(Robot(backbone=rod, disks=Disks(count=10), cables=[pull]), tension=1)
    assert case.warnings == [] and case.robot.backbone == rod
    case.save(tmp_path / "case.toml")
    assert 'material = "nitinol"' in (tmp_path / "case.toml").read_text()
    again = whipcord.load(tmp_path / "case.toml")
    assert again == case and again.warnings == []
    softer = case.with_parameters({"backbone.young_modulus": 5e10}).robot.backbone
    assert (softer.material, softer.young_modulus) == ("nitinol", 5e10)
    with pytest.raises(whipcord.InputError, match="did you mean `nitinol`"):
        Backbone(length=1, material="Nitinol")


def test_a_robot_without_disks() -> None:
    body = Backbone(length="150 mm", diameter="14 mm", material="Dragon Skin 30")
    flexor = Cable(name="flexor", routing=Routing.straight(angle="90 deg", radius="5 mm"))
    robot = Robot(backbone=body, cables=[flexor])
    assert robot.disks is None and "disks=None" in repr(robot)
    assert eval(repr(robot), dict(vars(whipcord))) == robot == pickle.loads(pickle.dumps(robot))
    case = Case(robot, tension="2 N")
    assert "disks" not in case.to_toml() and Case.from_toml(case.to_toml()) == case
    solution = case.solve()
    assert solution.position.shape == (21, 3) and solution.position[-1, 1] > 0.05
    assert whipcord.plot.solution(solution) is not None
    with pytest.raises(whipcord.ModelError, match="add \\[disks\\]"):
        case.solve(model="four-bar")
    with pytest.raises(whipcord.InputError, match="the robot has no disks"):
        Robot(backbone=body, cables=[Cable(name="a", holes=[1, 2])])
    with_disks = robot.replace(disks=Disks(count=10))
    assert with_disks.disks is not None and with_disks.replace(disks=None) == robot


def everything() -> Case:
    """A case with a value for nearly every key."""
    robot = Robot(
        backbone=Backbone(
            length="0.2 m",
            diameters=Along(at=["0 mm", "100 mm", "100 mm"], values=["4 mm", "3 mm", 0.0025]),
            inner_diameter=["1 mm", "0.9 mm", "0.8 mm"],
            young_modulus="2 GPa",
            shear_modulus="700 MPa",
            shear_correction=0.886,
            linear_density="7.4 g/m",
            rest_curvature=[[0, "1 1/m", 0], [0, "2 1/m", 0], [0, 0, 0]],
            shearable=False,
        ),
        disks=Disks(
            positions=[0, "90 mm", 0.2],
            hole_circle_radius=["8 mm", "7 mm", "6 mm"],
            holes=12,
            mass="1.2 g",
        ),
        cables=[
            Cable(name="holes", holes=[1, 2], interpolation="pchip", friction=0.0),
            Cable(name="straight", routing=Routing.straight(angle="90 deg", radius="8 mm")),
            Cable(
                name="helix",
                routing=Routing.helix(turns=-0.75, radius="7 mm", start_angle="0.25 turn"),
                ends_at="150 mm",
                axial_stiffness="2 kN",
            ),
            Cable(name="linear", routing=Routing.linear(start=["8 mm", 0], end=["3 mm", 0])),
            Cable(name="curve", routing=Routing.polynomial(x=[0.008, -0.01], y=[0.0, 0.02])),
        ],
    )
    return Case(
        robot,
        tension=["1 N", 0.5, None, "20 gf", 0],
        shortening=[None, "1.1 %", "-1 mm", 0.002, "0.3 %"],
        loads=Loads(
            frame="world",
            gravity=[0, 0, "-1 g0"],
            tip_force=["20 mN", 0, 0],
            tip_moment=[0, 0, "1 mN*m"],
            point=[PointLoad(at="90 mm", force=[0, "0.1 N", 0], follower=True)],
            distributed=[
                DistributedLoad(start="40 mm", end="140 mm", force=[0, "0.5 N/m", 0]),
                DistributedLoad(at=[0, "0.1 m", 0.2], moment=[[0, 0, 0], [0, 0, 1e-3], [0, 0, 0]]),
            ],
            mass=[PointMass(at="200 mm", mass="12 g")],
        ),
        base=Base(position=[0, 0, "0.4 m"], rotation={"axis": [0, 1, 0], "angle": "90 deg"}),
        title='All of "it"',
    )


def test_every_key_goes_there_and_back(tmp_path: Path) -> None:
    case = everything()
    case.save(tmp_path / "all.toml")
    again = whipcord.load(tmp_path / "all.toml")
    assert again == case and again.title == 'All of "it"'
    assert pickle.loads(pickle.dumps(case)) == case
    assert case.tension == (1.0, 0.5, None, 20 * 9.80665e-3, 0.0)
    assert case.shortening == (None, "1.1 %", -0.001, 0.002, "0.3 %")
    assert case.robot.backbone.diameters == Along(at=(0.0, 0.1, 0.1), values=(0.004, 0.003, 0.0025))
    assert case.robot.cables[2].routing == Routing.helix(turns=-0.75, radius=0.007, start_angle=np.pi / 2)
    assert case.loads.distributed[0].end == 0.14
    solution = case.solve()
    assert np.array_equal(solution.position, again.solve().position)


def test_a_given_stiffness_and_a_bar_are_kept() -> None:
    matrix = np.diag([3e3, 3e3, 8e3, 4e-3, 4e-3, 3e-3])
    bar = Backbone(
        length=0.1,
        section=Section(width=["6 mm", "4 mm"], height="4 mm", at=[0, 0.1]),
        stiffness=SectionStiffness(matrix=matrix),
        density=1000,
    )
    robot = Robot(backbone=bar, disks=Disks(count=2))
    assert robot.backbone == bar
    assert bar.stiffness is not None and bar.stiffness.matrix == tuple(map(tuple, matrix))
    assert bar.section == Section(width=(0.006, 0.004), height=0.004, at=(0.0, 0.1))
    assert hash(bar) == hash(bar.replace())


def test_a_robot_built_in_python_is_that_of_the_file(case: whipcord.Case) -> None:
    robot = Robot(
        backbone=Backbone(length="180 mm", diameter="3 mm", young_modulus="1.1 GPa", poisson_ratio=0.3),
        disks=Disks(count=10, hole_circle_radius="8 mm", holes=12),
        cables=[Cable(name="pull", holes=[1, 2, 3, 4, 4, 4, 4, 3, 2, 1])],
    )
    assert robot == case.robot
    built = Case(robot, tension=["400 gf"])
    assert np.array_equal(built.solve().position, case.solve().position)


def test_replace_changes_one_thing_and_leaves_the_rest(case: whipcord.Case) -> None:
    other = case.replace(robot=case.robot.replace(backbone=case.robot.backbone.replace(length=0.2)))
    assert (other.robot.backbone.length, case.robot.backbone.length) == (0.2, 0.18)
    assert other.tension == case.tension and other.title == case.title
    tube = case.robot.backbone.replace(diameter=None, diameters=[0.003] * 10)
    assert tube.diameters == (0.003,) * 10 and tube.diameter is None
    assert case.replace(tension=[1]).tension == (1.0,)


def test_steps_are_the_cases(tmp_path: Path) -> None:
    case = whipcord.load("examples/rubbing-finger.toml")
    assert [step.tension for step in case.steps] == [(1.5,), (4.0,), (3.0,), (1.5,)]
    assert case.tension == (1.5,)
    steps = case.solve_steps(model="cosserat-disks")
    assert len(steps) == 4
    assert np.array_equal(steps[-1].position, case.solve(model="cosserat-disks").position)
    pulled = case.replace(steps=[Step(tension=["1.5 N"])])
    assert len(pulled.steps) == 0 and pulled.tension == (1.5,)
    assert np.array_equal(pulled.solve(model="cosserat-disks").position, steps[0].position)


def test_nothing_changes_in_place(case: whipcord.Case) -> None:
    solution = case.solve()
    for thing, name in (
        (case, "title"),
        (case.robot, "backbone"),
        (case.robot.backbone, "length"),
        (case.loads, "gravity"),
    ):
        with pytest.raises(AttributeError):
            setattr(thing, name, 1)
    turned = Base(rotation={"axis": [0, 1, 0], "angle": "90 deg"})
    assert turned.rotation is not None
    with pytest.raises(TypeError, match="does not support item assignment"):
        turned.rotation["angle"] = 5.0  # type: ignore[index]
    for copied in (copy.deepcopy(turned), pickle.loads(pickle.dumps(turned)), turned.replace()):
        assert copied == turned and hash(copied) == hash(turned)
    with pytest.raises(ValueError, match="read-only"):
        solution.position[0, 0] = 1.0


def test_reprs_are_python(case: whipcord.Case) -> None:
    scope = vars(whipcord)
    for thing in (case.robot, case.robot.backbone, everything().loads, everything().base):
        assert eval(repr(thing), dict(scope)) == thing
    assert "Case III" in repr(case)


def test_notebooks_get_a_picture(case: whipcord.Case) -> None:
    for thing in (case, case.robot, case.solve()):
        page = thing._repr_html_()
        assert page.startswith("<div") and "<svg" in page and page.endswith("</div>")


CAMERA = """%YAML:1.0
---
projection: orthographic
pixels_per_metre: 4000.
principal_point: [ 320., 240. ]
"""

MEASURED_BY_CAMERA = """
[measured]
disks = "mm.csv"
unit = "mm"
deviation = "0.3 mm"
pixel_deviation = 0.5
registration = "rigid"
[[measured.cameras]]
name = "side"
file = "side.yml"
"""


def test_measurements_are_read_and_written(case: whipcord.Case, tmp_path: Path) -> None:
    solution = case.solve()
    lines = [f"{i + 1},{x!r},{y!r},{z!r}" for i, (x, y, z) in enumerate(solution.position.tolist())]
    (tmp_path / "disks.csv").write_text("disk,x,y,z\n" + "\n".join(lines[1:4]) + "\n")
    text = case.to_toml() + '\n[measured]\ndisks = "disks.csv"\n'
    (tmp_path / "case.toml").write_text(text)
    measured = whipcord.load(tmp_path / "case.toml")
    assert measured.measured is not None
    assert measured.measured.disks == (2, 3, 4)
    assert np.array_equal(measured.measured.position, solution.position[1:4])
    (tmp_path / "below").mkdir()
    measured.save(tmp_path / "below" / "copy.toml")
    copy = whipcord.load(tmp_path / "below" / "copy.toml")
    assert copy.measured is not None and np.array_equal(copy.measured.position, measured.measured.position)
    comparison = whipcord.compare(measured)
    assert comparison["cosserat"].distance_to_measured == 0.0
    # What the table says beside it is kept, and the same in the other folder.
    positions = (1e3 * solution.position).tolist()
    millimetres = [f"{i + 1},{x!r},{y!r},{z!r}" for i, (x, y, z) in enumerate(positions)]
    (tmp_path / "mm.csv").write_text("disk,x,y,z\n" + "\n".join(millimetres) + "\n")
    (tmp_path / "side.yml").write_text(CAMERA)
    text = case.to_toml() + MEASURED_BY_CAMERA
    (tmp_path / "mm.toml").write_text(text)
    there = whipcord.load(tmp_path / "mm.toml")
    there.save(tmp_path / "below" / "mm.toml")
    again = whipcord.load(tmp_path / "below" / "mm.toml")
    for seen in (there.measured, again.measured, pickle.loads(pickle.dumps(again)).measured):
        assert seen is not None
        assert np.allclose(seen.position, solution.position, rtol=0, atol=1e-15)
        assert (seen.unit, seen.deviation, seen.pixel_deviation, seen.registration) == (
            "mm",
            3e-4,
            0.5,
            "rigid",
        )
        assert [name for name, _ in seen.cameras] == ["side"]
        assert Path(seen.cameras[0][1]).samefile(tmp_path / "side.yml")
    # Moved onto the model, what was computed by it is where it has it.
    run = whipcord.compare(again)["cosserat"]
    assert run.distance_to_measured is not None and run.distance_to_measured < 1e-12
    # It stays as long as it is what the robot did.
    path = "backbone.young_modulus"
    for same in (copy.replace(title="again"), copy.with_parameters({path: 1e9}), copy.solve().case):
        assert same.measured is not None and copy.measured is not None
        assert same.measured.observations == copy.measured.observations
    for other in (
        copy.replace(tension=[1.0]),
        copy.replace(loads=Loads(tip_force=[0.01, 0, 0])),
        copy.with_parameters({"loads.tip_force[0]": 0.01}),
        copy.solve(tension=[1.0]).case,
    ):
        assert other.measured is None and other.reference is None


def test_a_changed_title_changes_nothing_else(case: whipcord.Case) -> None:
    assert case.reference is not None
    assert case.replace(title=case.title) == case
    assert case.solve().case == case
    assert case.with_parameters({"backbone.diameter": 0.003}) == case
    assert case.with_parameters({"backbone.diameter": 0.0031}).reference is None


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Backbone(length=0.18, dimeter=0.003), "did you mean `diameter`"),
        (lambda: Backbone(length=0.18, radius="1.5 mm"), 'write `diameter = "3 mm"`, twice this value'),
        (lambda: Disks(n_disks=10), "did you mean `count`"),
        (lambda: Cable(name="pull", mu=0.1), "did you mean `friction`"),
        (lambda: Loads(tip_load=(0, 0, 1)), "did you mean `tip_force`"),
        (
            lambda: Robot(backbone=Backbone(length=0.18), disks=Disks(count=3), cabels=[]),
            "did you mean 'cables'",
        ),
    ],
)
def test_what_is_meant_by_another_name_is_said(call: Callable[[], object], message: str) -> None:
    with pytest.raises(TypeError, match=re.escape(message)):
        call()


def test_misspelt_arguments_of_functions_are_told_from_the_others(tmp_path: Path) -> None:
    case = whipcord.load(Path(__file__).resolve().parents[2] / "examples/table1/case-3.toml")
    with pytest.raises(
        TypeError, match=r"Case.solve\(\) has no argument 'tensoin'; did you mean 'tension'\?"
    ):
        case.solve(tensoin=5)
    with pytest.raises(TypeError, match=r"Case\(\) has no argument 'load'; did you mean 'loads'\?"):
        Case(case.robot, load=None)
    (tmp_path / "disks.csv").write_text("disk,x,y,z\n10,0.05,0.01,0.15\n")
    measured = case.with_measured(tmp_path / "disks.csv")
    with pytest.raises(whipcord.InputError, match=r"did you mean backbone\.young_modulus\?"):
        whipcord.fit(measured, ["backbone.youngs_modulus"])
