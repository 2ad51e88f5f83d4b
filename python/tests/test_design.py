"""Robots for target shapes."""

from __future__ import annotations

import numpy as np
import pytest
import whipcord
from whipcord.errors import InputError


@pytest.fixture(scope="module")
def finger() -> whipcord.Case:
    robot = whipcord.Robot(
        backbone=whipcord.Backbone(
            length=0.12, diameter=0.002, young_modulus=30e9, poisson_ratio=0.3
        ),
        disks=whipcord.Disks(count=8, hole_circle_radius=0.008, holes=12),
        cables=[whipcord.Cable(name="pull", holes=[1] * 8)],
    )
    return whipcord.Case(robot, tension=[6.0])


def test_planted_holes_are_found_again(finger: whipcord.Case) -> None:
    planted = [1, 2, 3, 3, 2, 1, 12, 11]
    cable = whipcord.Cable(name="pull", holes=planted)
    robot = whipcord.Robot(backbone=finger.robot.backbone, disks=finger.robot.disks, cables=[cable])
    places = whipcord.Case(robot, tension=[6.0]).solve(model="cosserat-disks").disks.position[1:]
    found = finger.design(places, vary="holes", tolerances={"samples": 20})
    assert found.proven and found.largest_error < 1e-9
    assert list(found.case.robot.cables[0].holes or ()) == planted
    (target,) = found.targets
    assert np.allclose(target.wanted, places) and np.allclose(target.position, places, atol=1e-9)
    assert found.tolerances is not None and found.tolerances["samples"] == 20
    assert found.before is not None and found.before["error"] > 1e-3
    again = found.case.solve(model="cosserat-disks")
    assert np.allclose(again.disks.position[1:], places, atol=1e-9)


def test_several_shapes_under_tensions_of_their_own(finger: whipcord.Case) -> None:
    shapes = [finger.replace(tension=[pull]).solve(model="cosserat-disks").disks.position[1:] for pull in (2, 5)]
    found = finger.design(vary="cables[0].holes", targets=[(shapes[0], [2.0]), (shapes[1], [5.0])])
    assert len(found.targets) == 2 and found.largest_error < 1e-8


def test_criteria_are_kept_and_told(finger: whipcord.Case) -> None:
    straight = finger.replace(tension=[0.0])
    wanted = "stiffness, disk = 8, direction = y, at_least = 60 N/m"
    found = straight.design(vary="backbone.diameter", criteria=wanted)
    (criterion,) = found.criteria
    assert criterion["met"] and criterion["limit"] == 60.0 and criterion["disk"] == 8
    assert criterion["before"] < 60.0 <= criterion["value"] < 64.0
    # The same by the robot of the design.
    compliance = found.case.stiffness().compliance
    assert 1.0 / compliance[1, 1] == pytest.approx(criterion["value"], rel=1e-3)
    assert len(found.targets[0].distance) == 0 and "without places" in repr(found.targets[0])
    with pytest.raises(InputError, match="instead of at least"):
        straight.design(vary="backbone.diameters", diameter=[1e-3, 2e-3], criteria="stiffness, disk = 8, at_least = 9e5 N/m")
    with pytest.raises(InputError, match="no criterion"):
        straight.design(vary="backbone.diameter", criteria="strength, weight = 1")


def test_a_path_has_tensions_of_its_own(finger: whipcord.Case) -> None:
    path = np.array([finger.replace(tension=[pull]).solve().tip for pull in (1.0, 2.0, 3.0)])
    found = finger.design(path=path, vary="cables[0].tension")
    assert len(found.targets) == 3 and found.largest_error < 1e-6
    with pytest.raises(InputError, match="tensions of their own"):
        finger.design(path=path, vary="holes")
    with pytest.raises(InputError, match="path must be"):
        finger.design(path=np.zeros((2, 2)), vary="tension")


def test_no_list_of_holes_is_below_the_bound(finger: whipcord.Case) -> None:
    proven = finger.design("arc, angle = 40 deg", vary="holes")
    assert proven.proven and proven.lower_bound == pytest.approx(proven.error, rel=1e-6)
    # Beyond the reach of the tension; of every other list the error is greater.
    fine = whipcord.Disks(count=8, hole_circle_radius=0.008, holes=36)
    robot = whipcord.Robot(backbone=finger.robot.backbone, disks=fine, cables=finger.robot.cables)
    found = whipcord.Case(robot, tension=[1.0]).design("arc, angle = 60 deg", vary="holes")
    assert found.lower_bound is not None and 0.8 * found.error < found.lower_bound <= found.error * (1 + 1e-9)
    wanted = found.targets[0].wanted
    random = np.random.default_rng(3)
    for holes in [[1] * 8, *random.integers(1, 37, size=(20, 8)).tolist()]:
        other = whipcord.Robot(
            backbone=robot.backbone, disks=fine, cables=[whipcord.Cable(name="pull", holes=holes)]
        )
        off = whipcord.Case(other, tension=[1.0]).solve(model="cosserat-disks").disks.position[1:] - wanted
        assert np.sqrt((off**2).sum(axis=1).mean()) >= found.lower_bound
    assert finger.design("arc, angle = 40 deg", vary="backbone.young_modulus").lower_bound is None


def test_what_is_no_design_says_why(finger: whipcord.Case) -> None:
    with pytest.raises(InputError, match="did you mean `helix`"):
        finger.design("helx, radius = 20 mm", vary="holes")
    with pytest.raises(InputError, match="target"):
        finger.design(vary="holes")
    with pytest.raises(InputError, match="shape"):
        finger.design(np.zeros((3, 3)), vary="holes")
    with pytest.raises(InputError, match="cables"):
        finger.design("arc, angle = 30 deg", vary="colour")
    with pytest.raises(InputError, match="measured"):
        finger.design("measured", vary="holes")


def test_a_search_ends_with_the_best_so_far(finger: whipcord.Case) -> None:
    def search(solves: int | None = None, timeout: float | None = 60.0) -> whipcord.Designed:
        wanted = np.array([0.03, 0.0, 0.1])
        return finger.design(wanted, vary=["holes", "tension"], model="cosserat", solves=solves, timeout=timeout)

    few = [search(solves=200) for _ in range(2)]
    assert few[0].ended == "solves" and not few[0].proven
    # The budget counts solves: the same robot again.
    assert few[0].solves == few[1].solves >= 200 and few[0].error == few[1].error
    more = search(solves=1000)
    assert more.error <= few[0].error and few[0].before is not None
    assert few[0].error <= few[0].before["error"] * (1 + 1e-9)
    late = search(timeout=1e-3)
    assert late.ended == "time" and late.solves < few[0].solves
    assert {finding["known"] for finding in late.findings} == {"budget_spent"}
    # Nothing ends a search that is done.
    assert finger.design("s, angle = 20 deg", vary="cables[0].tension").ended is None


def test_the_function_takes_files_weights_and_budgets(finger: whipcord.Case) -> None:
    file = whipcord.examples.path("table1/case-3.toml")
    found = whipcord.design(file, "s, angle = 20 deg", vary="cables[0].tension", starts=1, iterations=50)
    assert found.before is not None and found.error < found.before["error"]
    # One tension for two shapes: what counts a thousand times more is nearer.
    shapes = [finger.replace(tension=[pull]).solve().disks.position[1:] for pull in (2.0, 5.0)]
    errors = []
    for weights in ((1000.0, 1.0), (1.0, 1000.0)):
        targets = [(shape, [3.0], weight) for shape, weight in zip(shapes, weights)]
        near = whipcord.design(finger, vary="backbone.young_modulus", targets=targets)
        errors.append([target.distance.max() for target in near.targets])
    assert errors[0][0] < errors[0][1] and errors[1][1] < errors[1][0]
    planted = finger.design(shapes[1], vary="cables[0].tension")
    assert planted.proven and planted.findings[0]["known"] == "targets_met"
