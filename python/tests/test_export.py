"""Exports, read by other programs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import whipcord

from .mujoco_answers import ROBOTS, at_rest, bodies, disks_in, of_robot

mujoco = pytest.importorskip("mujoco")

ARM = "examples/two-segment-arm.toml"


@pytest.mark.parametrize("name", ROBOTS)
def test_mujoco_comes_to_rest_where_the_rod_with_disks_does(name: str, tmp_path: Path) -> None:
    robot = ROBOTS[name]
    case = of_robot(robot)
    exact = case.solve(model="cosserat-disks")
    case.export(tmp_path / "robot.xml", model="cosserat-disks", per_span=robot.per_span)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.xml"))
    data = at_rest(model, "rest")
    distance = np.linalg.norm(disks_in(model, data) - exact.position, axis=1).max()
    length = float(exact.arc_length[-1])
    assert distance < robot.within * length, f"{100 * distance / length} % of the length"


def test_the_error_falls_with_the_square_of_the_number_of_bodies(tmp_path: Path) -> None:
    case = of_robot(ROBOTS["large bending"])
    exact = case.solve(model="cosserat-disks").position
    errors = []
    for per_span in (1, 2, 4):
        case.export(tmp_path / "robot.xml", model="cosserat-disks", per_span=per_span)
        model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.xml"))
        data = at_rest(model, "case")
        errors.append(np.linalg.norm(disks_in(model, data) - exact, axis=1).max())
    assert errors[0] / errors[1] > 3
    assert errors[1] / errors[2] > 3


def test_the_keyframe_has_the_solved_shape_and_its_tensions(tmp_path: Path) -> None:
    case = whipcord.load(ARM)
    exact = case.solve(model="cosserat-disks")
    case.export(tmp_path / "robot.xml", model="cosserat-disks")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("case").id)
    mujoco.mj_forward(model, data)
    for cable in exact.cables:
        assert data.actuator(cable.name).ctrl[0] == pytest.approx(cable.tension)
        # Pulled: the tendon works against its lengthening.
        assert data.actuator(cable.name).force[0] == pytest.approx(cable.tension)
        assert data.ten_length[model.tendon(cable.name).id] == pytest.approx(cable.length, rel=2e-3)
    assert np.linalg.norm(disks_in(model, data) - exact.position, axis=1).max() < 1e-3
    weight = model.body_mass[2:].sum() * np.linalg.norm(model.opt.gravity)
    backbone = 1900 * np.pi * 0.001**2 * 0.3
    # That of the base stands on the ground.
    assert weight == pytest.approx(9.81 * (backbone + 14 * 0.003), rel=0.02)


def test_cables_driven_by_their_lengths_have_the_tensions_of_the_answer(tmp_path: Path) -> None:
    case = whipcord.load("examples/tapered-arm.toml")
    exact = case.solve(model="cosserat-disks", actuation="shortening")
    case.export(tmp_path / "robot.xml", model="cosserat-disks", actuation="shortening")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.xml"))
    data = at_rest(model, "case")
    for cable in exact.cables:
        assert -data.actuator(cable.name).force[0] == pytest.approx(cable.tension, rel=0.02)
    distance = np.linalg.norm(disks_in(model, data) - exact.position, axis=1).max()
    assert distance < 0.005 * exact.arc_length[-1]


@pytest.mark.parametrize("name", ["arm-at-wall", "gripping-finger"])
def test_contacts_hold_the_robot_in_mujoco_too(name: str, tmp_path: Path) -> None:
    case = whipcord.load(f"examples/contact/{name}.toml")
    exact = case.solve(model="cosserat-disks")
    case.export(tmp_path / "robot.xml", model="cosserat-disks")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.xml"))
    data = at_rest(model, "case")
    assert data.ncon > 0
    distance = np.linalg.norm(disks_in(model, data) - exact.position, axis=1).max()
    assert distance < 0.005 * exact.arc_length[-1]


def test_steps_under_other_loads_have_keyframes_that_hold(tmp_path: Path) -> None:
    rows = ["a [N],b [N],c [N],tip_force.x [N],tip_force.y [N]", "2,1,1,0,0.2", "2,1,1,0.1,0", "3,1,1,0.2,0"]
    (tmp_path / "steps.csv").write_text("\n".join(rows) + "\n")
    text = Path("examples/three-cable-segment.toml").read_text()
    kept = [line for line in text.splitlines() if not line.startswith(("tension", "shortening"))]
    (tmp_path / "robot.toml").write_text("\n".join([*kept, "[commands]", 'table = "steps.csv"', 'each = "in order"', ""]))
    case = whipcord.load(tmp_path / "robot.toml")
    case.export(tmp_path / "robot.xml", model="cosserat-disks")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.xml"))
    names = [model.actuator(i).name for i in range(model.nu)]
    # The force along x grows; that along y is another one.
    assert names == ["a", "b", "c", "load:tip", "load:tip:step-1"]
    np.testing.assert_allclose([model.key(f"step-{k}").ctrl[3:] for k in (1, 2, 3)], [[0, 1], [0.5, 0], [1, 0]])
    for k, exact in enumerate(case.solve_steps(model="cosserat-disks"), 1):
        data = at_rest(model, f"step-{k}", end=f"step-{k}")
        distance = np.linalg.norm(disks_in(model, data) - exact.position, axis=1).max()
        assert distance < 0.005 * exact.arc_length[-1]


def test_obstacles_are_read_as_closed_surfaces(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    case = whipcord.load("examples/contact/gripping-finger.toml")
    case.export(tmp_path / "finger.glb")
    scene = trimesh.load(tmp_path / "finger.glb")
    named = [name for name in scene.graph.nodes if name.startswith("obstacle ")]
    assert named
    for name in named:
        _, geometry = scene.graph[name]
        mesh = scene.geometry[geometry]
        mesh.merge_vertices(merge_norm=True)
        assert mesh.is_watertight, name


def test_urdf_is_read_and_its_joint_angles_give_the_shape(tmp_path: Path) -> None:
    yourdfpy = pytest.importorskip("yourdfpy")
    case = whipcord.load("examples/wall-mounted-arm.toml")
    exact = case.solve(model="cosserat")
    made = case.export(tmp_path / "arm.urdf")
    robot = yourdfpy.URDF.load(str(made.files[0]), load_meshes=False, build_collision_scene_graph=False)
    angles: dict[str, Any] = json.loads(made.files[1].read_text())["steps"][-1]
    for joints, expected, near in [
        ({}, case.replace(tension=[0], loads=whipcord.Loads()).solve().position, 1e-9),
        (angles["joints"], exact.position, 1e-3),
    ]:
        robot.update_cfg(joints or dict.fromkeys(angles["joints"], 0.0))
        frames = [robot.get_transform(f"disk-{k}", "world") for k in range(1, len(expected) + 1)]
        found = np.array([frame[:3, 3] for frame in frames])
        assert np.linalg.norm(found - expected, axis=1).max() < near
    assert angles["greatest_distance"] < 1e-3
    mass = sum(link.inertial.mass for link in robot.robot.links if link.inertial)
    model_mass = 7 * 0.003 + 0.018
    assert model_mass < mass < model_mass + 0.02


def test_gltf_is_read_with_names_and_in_metres(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    case = whipcord.load(ARM)
    exact = case.solve()
    case.export(tmp_path / "arm.glb")
    scene = trimesh.load(tmp_path / "arm.glb")
    names = set(scene.graph.nodes)
    assert {"backbone", "disk 1", "disk 15", "cable upper-1", "Two-segment arm"} <= names
    # The z axis of the robot is the y axis of the scene.
    place, _ = scene.graph["disk 15"]
    x, y, z = exact.position[-1]
    np.testing.assert_allclose(place[:3, 3], [x, z, -y], atol=1e-6)
    for mesh in scene.geometry.values():
        mesh.merge_vertices(merge_norm=True)
        assert mesh.is_watertight


def test_step_is_read(tmp_path: Path) -> None:
    p21 = pytest.importorskip("steputils.p21")
    case = whipcord.load(ARM)
    made = case.export(tmp_path / "arm.step", model="cosserat-disks")
    file = p21.readfile(str(made.files[0]))
    entities = [i.entity for i in file.data[0].instances.values() if hasattr(i, "entity")]
    names = [entity.name for entity in entities]
    assert [names.count(of) for of in ("B_SPLINE_CURVE_WITH_KNOTS", "POLYLINE", "CIRCLE")] == [1, 6, 15]
    tip = next(e for e in entities if e.name == "CARTESIAN_POINT" and e.params[0] == "disk 15")
    np.testing.assert_allclose(
        tip.params[1], 1e3 * case.solve(model="cosserat-disks").position[-1], atol=1e-3
    )


def test_the_name_of_the_file_says_the_format(tmp_path: Path) -> None:
    case = whipcord.load(ARM)
    assert [path.name for path in case.export(tmp_path / "arm.pvd").files][:2] == [
        "arm.pvd",
        "backbone-1.vtp",
    ]
    with pytest.raises(whipcord.InputError, match=r"says no format: let it end in one of \.xml"):
        case.export(tmp_path / "arm.stl")
    with pytest.raises(whipcord.InputError, match=r"must end in \.glb"):
        case.export(tmp_path / "arm.xml", to="gltf")
    with pytest.raises(whipcord.InputError, match="choose one of mjcf"):
        case.export(tmp_path / "arm.xml", to="sdf")
    with pytest.raises(whipcord.InputError, match="at most 490"):
        case.export(tmp_path / "arm.xml", per_span=100)
    assert not (tmp_path / "arm.xml").exists()


def test_there_are_as_many_bodies_as_said(tmp_path: Path) -> None:
    case = whipcord.load("examples/table1/case-3.toml")
    case.export(tmp_path / "robot.xml", per_span=3)
    assert bodies(mujoco.MjModel.from_xml_path(str(tmp_path / "robot.xml"))) == 1 + 9 * 3
