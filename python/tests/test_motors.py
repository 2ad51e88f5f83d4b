"""Robots with motors."""

import math
import pickle

import numpy as np
import pytest
import whipcord
from whipcord import Backbone, Cable, Case, Disks, InputError, Motor, Robot, Routing, Step


def arm(**motor: object) -> Robot:
    sides = {"left": "0 deg", "right": "180 deg"}
    return Robot(
        backbone=Backbone(length="180 mm", diameter="3 mm", young_modulus="1.1 GPa", poisson_ratio=0.3),
        disks=Disks(count=10),
        cables=[
            Cable(name=name, routing=Routing.straight(angle=angle, radius="8 mm"))
            for name, angle in sides.items()
        ],
        motors=[Motor(name="bend", cables=["left", "-right"], spool_radius="10 mm", **motor)],
    )


def test_a_motor_bends_the_robot_as_its_shortenings_do() -> None:
    case = Case(arm(gear_ratio=2), motors=["90 deg"])
    assert case.motors == pytest.approx((math.pi / 2,))
    wound = 0.010 * math.pi / 4
    by_lengths = case.replace(shortening=[wound, -wound])
    assert by_lengths.motors == (None,)
    assert by_lengths.solve().tip == pytest.approx(case.solve().tip, abs=1e-12)


def test_a_soft_drive_gives_and_stays_with_the_robot() -> None:
    robot = arm(stiffness="5 N/mm", pretension="4 N")
    rigid, soft = (Case(of, motors=[0.5]).solve() for of in (arm(), robot))
    assert soft.bend < 0.99 * rigid.bend
    case = Case(robot, motors=[0.5])
    again = Case.from_toml(case.to_toml())
    assert again == case
    assert again.robot.motors == robot.motors
    heavier = case.replace(loads=whipcord.Loads(tip_force=[0, "0.1 N", 0]))
    assert heavier.motors == (0.5,)
    assert heavier.robot.motors[0].pretension == 4.0
    assert case.replace(motors=["1 rad"]).solve().bend > soft.bend


def test_steps_of_a_drive_with_backlash_depend_on_their_order() -> None:
    robot = arm(backlash=0.2)
    there, back = (
        Case(robot, steps=[Step(motors=[first]), Step(motors=[0.5])]).solve() for first in (0.2, 0.9)
    )
    assert there.cables[0].shortening == pytest.approx(0.010 * 0.4)
    assert back.cables[0].shortening == pytest.approx(0.010 * 0.6)


def test_what_does_not_fit_the_motors_is_refused() -> None:
    with pytest.raises(InputError, match="one for each motor"):
        Case(arm(), motors=[1, 2])
    with pytest.raises(InputError, match="is a unit of length"):
        Case(arm(), motors=["5 mm"])
    with pytest.raises(InputError, match="there is no cable"):
        arm().replace(motors=[Motor(name="m", cables=["middle"])])


def test_an_answer_says_what_each_motor_holds() -> None:
    case = Case(arm(gear_ratio=2, torque_limit="20 N mm"))
    solution = case.solve(motors=["90 deg"])
    assert solution.case.motors == pytest.approx((math.pi / 2,))
    (bend,) = solution.motors
    left, right = solution.tension
    assert bend.angle == pytest.approx(math.pi / 2)
    assert bend.torque == pytest.approx(0.010 * (left - right) / 2)
    assert bend.utilization == pytest.approx(abs(bend.torque) / 0.020)
    assert (bend.travel, bend.force) == (None, None)
    pulled = case.solve(tension=[2.0, 0.0]).motors[0]
    assert (pulled.angle, pulled.torque) == (None, pytest.approx(0.010))
    by_four_bar = case.solve(motors=[0.2], model="four-bar").motors[0]
    assert (by_four_bar.angle, by_four_bar.torque) == (0.2, None)
    place = case.stiffness(motors=[0.5])
    assert place.solution.case.motors == (0.5,)
    again = pickle.loads(pickle.dumps(solution))
    assert again.motors == solution.motors


def test_rows_of_motors_are_their_cases() -> None:
    case = Case(arm(stiffness="5 N/mm", pretension="4 N"))
    rows = np.array([[0.1], [0.5], [-0.3]])
    batch = case.solve_batch(motors=rows)
    for row, tip in zip(rows, batch.tip):
        assert tip == pytest.approx(case.solve(motors=row).tip, abs=1e-12)
    weights = np.zeros((3, 10, 3))
    weights[:, -1, 0] = 1
    slopes = case.pull_back_batch(motors=rows, position=weights).commands
    assert slopes.shape == (3, 1)
    for (angle,), slope in zip(rows, slopes[:, 0]):
        ahead, behind = (case.solve(motors=[angle + by]).tip[0] for by in (1e-4, -1e-4))
        assert slope == pytest.approx((ahead - behind) / 2e-4, rel=1e-5)
    _, derivatives = case.differentiate(motors=[0.5], parameters=["motors[0].angle"])
    assert derivatives.position_by_parameter[-1, 0, 0] == pytest.approx(slopes[1, 0], rel=1e-9)


def test_commands_that_do_not_go_together_are_refused() -> None:
    case = Case(arm())
    with pytest.raises(InputError, match="pulled by the motor bend"):
        case.solve(motors=[0.1], shortening=[0.001, None])
    with pytest.raises(InputError, match="one for each motor"):
        case.solve(motors=[0.1, 0.2])
    with pytest.raises(InputError, match="is a unit of length"):
        case.solve(motors=["5 mm"])
    with pytest.raises(InputError, match="motors"):
        case.solve_batch(motors=[[0.1]], tension=[[1.0, 0.0]])
    with pytest.raises(InputError, match=r"one column for each motor \(bend\)"):
        case.solve_batch(motors=[[0.1, 0.2]])
    with pytest.raises(InputError, match="no motor"):
        Case(arm().replace(motors=[])).solve(motors=[0.1])
    far = Case(arm(angle_limits=["-1 rad", "1 rad"]))
    with pytest.raises(InputError, match="limit"):
        far.solve(motors=[2.0])
    batch = far.solve_batch(motors=[[0.5], [2.0]])
    assert batch.ok.tolist() == [True, False]
    assert "limit" in str(batch.error(1))
