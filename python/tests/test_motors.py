"""Robots with motors."""

import math

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
