"""A controller, cycle by cycle."""

from __future__ import annotations

import numpy as np
import pytest
import whipcord
from whipcord.errors import InputError

LIMITS = {"tension": ["0.2 N", "40 N"], "rate": "40 N/s"}
PERIOD = 0.02


@pytest.fixture(scope="module")
def arm() -> whipcord.Case:
    return whipcord.load("examples/two-segment-arm.toml")


def test_a_point_is_approached_within_the_limits(arm: whipcord.Case) -> None:
    goal = np.array([0.05, 0.02, 0.285])
    controller = arm.controller(period="20 ms", gain=20, limits=LIMITS, estimator=False)
    assert controller.actuators[0] == ("tension", "upper-1") and len(controller.actuators) == 6
    before = np.array(arm.tension, dtype=float)
    for _ in range(120):
        cycle = controller.step(tip=goal)
        assert (cycle.command >= 0.2).all() and (cycle.command <= 40).all()
        assert (abs(cycle.command - before) <= 40 * PERIOD + 1e-9).all()
        before = cycle.command
    assert cycle.error < 1e-4
    assert np.allclose(arm.solve(tension=cycle.command).tip, goal, atol=2e-4)
    assert (cycle.bias == 0).all() and (cycle.force == 0).all()


def test_exports_are_the_derivatives(arm: whipcord.Case) -> None:
    controller = arm.controller(period=PERIOD, estimator=False)
    cycle = controller.step(tip=[0.05, 0.02, 0.285])
    # Before the first commands the robot is as the case has it.
    solution, derivatives = arm.differentiate()
    assert np.allclose(cycle.tip, solution.tip, atol=1e-9)
    assert np.allclose(cycle.jacobian[:3], derivatives.position_by_command[-1], rtol=1e-6, atol=1e-9)
    assert np.allclose(cycle.compliance, derivatives.compliance()[:, :3], rtol=1e-6, atol=1e-9)
    assert np.allclose(cycle.length_by_command, derivatives.length_by_command, rtol=1e-6, atol=1e-10)
    assert np.allclose(cycle.tension_by_command, np.eye(6), atol=1e-12)
    # And by differences.
    tension = np.array(arm.tension, dtype=float)
    h = 1e-4
    moved = arm.solve(tension=tension + h * np.eye(6)[3])
    assert np.allclose((moved.tip - solution.tip) / h, cycle.jacobian[:3, 3], rtol=1e-3)
    assert np.allclose(
        (moved.length - solution.length) / h, cycle.length_by_command[:, 3], rtol=1e-2, atol=1e-7
    )


def test_an_unknown_force_is_estimated(arm: whipcord.Case) -> None:
    force = np.array([0.06, -0.04, 0.0])
    real = arm.replace(loads=arm.loads.replace(tip_force=list(force)))
    estimator = whipcord.Estimator(position="20 um", angle=1e-4, bias=1e-6, force="0.2 N", memory="20 s")
    controller = arm.controller(period=PERIOD, limits=LIMITS, estimator=estimator)
    tension = np.array(arm.tension, dtype=float)
    hold = real.solve().tip
    for _ in range(80):
        seen = real.solve(tension=tension)
        cycle = controller.step(tip=hold, measured_pose=(seen.tip, seen.orientation[-1]))
        tension = cycle.command
    assert np.linalg.norm(cycle.force - force) < 0.1 * np.linalg.norm(force)
    assert (cycle.force_deviation > 0).all() and (cycle.force_deviation < 0.2).all()


def test_targets_of_every_kind(arm: whipcord.Case) -> None:
    solution = arm.solve()
    shape = np.full_like(solution.position, np.nan)
    shape[[7, 14]] = solution.position[[7, 14]]
    pose = (solution.tip, solution.orientation[-1])
    for target in (
        {"tip": ["60 mm", 0, 0.28]},
        {"pose": pose},
        {"axis": [0, 0, 1]},
        {"shape": shape},
        {"tip": [0.05, 0, 0.28], "axis": [0, 0, 1]},
    ):
        controller = arm.controller(period=PERIOD)
        cycle = controller.step(**target, measured_shape=shape)
        assert np.isfinite(cycle.command).all()
    again = arm.controller(period=PERIOD).step(pose=pose)
    assert again.error < 1e-9 and again.error_angle < 1e-9


def test_what_cannot_be_asked_is_said(arm: whipcord.Case) -> None:
    with pytest.raises(InputError, match="period must be greater"):
        arm.controller(period=0)
    with pytest.raises(InputError, match="must be positive"):
        arm.controller(period=PERIOD, gain=-1)
    with pytest.raises(InputError, match="exact derivatives"):
        arm.controller(period=PERIOD, model="constant-curvature")
    with pytest.raises(InputError, match="force must be greater"):
        whipcord.Estimator(force=-1)
    controller = arm.controller(period=PERIOD)
    with pytest.raises(InputError, match="there is no target"):
        controller.step()
    with pytest.raises(InputError, match="3 numbers"):
        controller.step(tip=[0, 1])
    with pytest.raises(InputError, match="finite number"):
        controller.step(tip=[0, 1, np.inf])
    with pytest.raises(InputError, match="several are given"):
        controller.step(tip=[0, 0, 0.3], pose=([0, 0, 0.3], [1, 0, 0, 0]))
