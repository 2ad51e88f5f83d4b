"""Robots in motion."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import whipcord
from whipcord.errors import InputError, ModelError, WhipcordTimeout

ARM = "examples/released-arm.toml"
STEP = {"left": [(0, "4 N"), (0, "0 N")]}


@pytest.fixture(scope="module")
def arm() -> whipcord.Case:
    return whipcord.load(ARM)


def command(*arguments: str) -> Any:
    run = [sys.executable, "-m", "whipcord", *arguments, "--json"]
    return json.loads(subprocess.run(run, check=True, capture_output=True, text=True).stdout)


def test_it_is_what_the_command_says(arm: whipcord.Case) -> None:
    states = command("simulate", ARM, "--set", 'motion.duration="0.2 s"')["states"]
    motion = arm.simulate("0.2 s")
    assert len(motion) == len(states) == 21
    assert motion.ok and motion.cables == ("left", "right")
    assert np.array_equal(motion.time, [state["time"] for state in states])
    for name in ("position", "orientation"):
        expected = [[pose[name] for pose in state["poses"]] for state in states]
        assert np.array_equal(getattr(motion, name), expected)
    for name in ("tension", "length", "slack"):
        assert np.array_equal(getattr(motion, name), [[of[name] for of in state["cables"]] for state in states])
    assert np.array_equal(motion.velocity, [state["velocities"] for state in states])
    assert np.array_equal(motion.strain, [state["strains"] for state in states])
    for name in ("kinetic", "elastic", "gravity", "cables", "loads", "dissipated", "defect"):
        assert np.array_equal(motion.energy[name], [state["energy"][name] for state in states])
    # The tip starts where the statics has it.
    assert np.allclose(motion.tip[0], arm.solve(tension=[4.0, 0.0]).tip, atol=2e-4)


def test_commands_are_tables_values_or_functions(arm: whipcord.Case) -> None:
    motion = arm.simulate("0.1 s")
    for tension in (STEP, {"left": np.array([[0, 4.0], [0, 0]])}, [[(0, 4), (0, 0)], None], [[(0, 4), (0, 0)], 0.0]):
        assert np.array_equal(arm.simulate("0.1 s", tension=tension).position, motion.position)
    # A function is taken at the steps: of straight lines nothing is lost.
    ramp = arm.simulate("0.1 s", tension={"left": [(0, 0), (0.05, 2), (1, 2)]})
    of_time = arm.simulate("0.1 s", tension={"left": lambda t: min(40 * t, 2.0)})
    assert np.allclose(ramp.position, of_time.position, rtol=0, atol=1e-9)
    assert ramp.tension[5, 0] == pytest.approx(2.0)
    short = arm.simulate("0.1 s", shortening={"left": [(0, 0), (0.1, "2 mm")]}, method="robust")
    # The length inside the robot follows the command where the cable is taut.
    assert short.length[0, 0] - short.length[-1, 0] == pytest.approx(2e-3, abs=1e-6)
    assert short.tension[-1, 0] > 0


def test_energy_is_balanced(arm: whipcord.Case) -> None:
    for step in ("1 ms", "10 ms"):
        energy = arm.simulate("0.5 s", method="energy", step=step, damping=0.0).energy
        total = energy["kinetic"] + energy["elastic"] + energy["gravity"]
        # Nothing acts and nothing is damped.
        assert abs(total - total[0]).max() < 1e-10 * energy["elastic"][0]
        assert abs(energy["dissipated"]).max() == 0.0
    energy = arm.simulate("0.5 s", step="1 ms").energy
    total = energy["kinetic"] + energy["elastic"] + energy["gravity"]
    assert np.allclose(total - total[0], energy["defect"] - energy["dissipated"], rtol=0, atol=1e-12)
    assert abs(energy["defect"]).max() < 0.01 * energy["dissipated"][-1]
    pushed = arm.simulate("0.3 s", tension={"left": 0.0}, loads=[(whipcord.Loads(tip_force=[0, 0.05, 0]), [(0, 0), (0, 1)])])
    total = sum(pushed.energy[name] for name in ("kinetic", "elastic", "gravity"))
    given = pushed.energy["loads"] - pushed.energy["dissipated"]
    assert pushed.energy["loads"][-1] > 0 and pushed.tip[-1, 1] > 0
    assert np.allclose(total - total[0], given, atol=0.01 * pushed.energy["loads"].max())


def test_a_simulation_steps_as_the_motion_does(arm: whipcord.Case) -> None:
    motion = arm.simulate("0.1 s", step="5 ms", every="5 ms")
    simulation = whipcord.Simulation(arm)
    assert np.array_equal(simulation.position, motion.position[0])
    for row in range(1, len(motion)):
        simulation.step(motion.time[row] - simulation.time)
        assert np.array_equal(simulation.position, motion.position[row])
    assert simulation.energy["kinetic"] == motion.energy["kinetic"][-1]
    assert simulation.method == "accurate"
    assert simulation.arc_length[-1] == pytest.approx(0.3)
    # Commands stay in force, and a state can be returned to.
    kept = simulation.state
    simulation.step("5 ms", tension=[2.0, None])
    simulation.step("5 ms")
    assert simulation.tension[0] == 2.0
    there = simulation.tip
    simulation.restore(kept)
    assert simulation.time == pytest.approx(0.1)
    simulation.step("5 ms", tension=[2.0, None])
    simulation.step("5 ms")
    assert np.array_equal(simulation.tip, there)
    other = whipcord.Simulation(arm.replace(robot=arm.robot.replace(cables=arm.robot.cables[:1]), tension=[0.0]))
    with pytest.raises(InputError, match="cables"):
        other.restore(kept)


def test_a_held_load_ends_in_the_equilibrium_of_the_statics(arm: whipcord.Case) -> None:
    loads = whipcord.Loads(tip_force=["50 mN", 0, 0])
    simulation = whipcord.Simulation(arm, initial="rest", damping="20 ms", method="robust")
    for _ in range(300):
        simulation.step(0.02, tension=[0.0, 1.0], loads=loads)
    gravity = whipcord.Loads(tip_force=["50 mN", 0, 0], gravity=arm.loads.gravity)
    still = arm.replace(loads=gravity).solve(tension=[0.0, 1.0])
    assert np.allclose(simulation.tip, still.tip, atol=1e-4)
    assert abs(simulation.velocity).max() < 1e-4
    assert np.allclose(simulation.momentum, 0, atol=1e-5)
    # The base holds the weight and the force.
    assert simulation.base_wrench[0] == pytest.approx(-0.05, abs=1e-4)
    with pytest.raises(ModelError, match="gravity"):
        simulation.step(0.01, loads=whipcord.Loads(gravity=[0, 0, 1]))


def test_modes_are_those_of_the_command_and_of_the_linearisation(arm: whipcord.Case) -> None:
    modes = arm.modes(4)
    expected = command("modes", ARM, "--count", "4")["modes"]
    for name in ("frequency", "damped_frequency", "damping_ratio", "displacement", "rotation"):
        assert np.array_equal(getattr(modes, name), [mode[name] for mode in expected])
    assert np.allclose(modes.energy.sum(axis=1), 1)
    # At rest under no commands: λ = −ζω ± i ω √(1 − ζ²).
    still = whipcord.Simulation(arm, tension=[0.0, 0.0])
    linear = still.linearize()
    assert linear.b.shape == (len(linear.a), 2)
    values = np.linalg.eigvals(linear.a)
    slow = values[(values.imag > 1) & (values.imag < 2 * np.pi * modes.frequency[3])]
    slow = slow[np.argsort(slow.imag)][:2]
    assert np.allclose(slow.imag, 2 * np.pi * modes.damped_frequency[:2], rtol=1e-4)
    assert np.allclose(-slow.real, modes.damping_ratio[:2] * 2 * np.pi * modes.frequency[:2], rtol=1e-3)
    assert np.allclose(still.modes(2).frequency, modes.frequency[:2], rtol=1e-6)
    assert np.allclose(arm.modes(2, time="0.5 s").frequency, modes.frequency[:2])
    assert arm.linearize().a.shape == linear.a.shape


def test_the_motion_of_a_file_stays(arm: whipcord.Case, tmp_path: Path) -> None:
    assert arm.robot.backbone.damping == whipcord.Damping(time="1.5 ms")
    again = whipcord.Case.from_toml(arm.to_toml())
    longer = again.with_parameters({"backbone.density": 1040.0})
    for case in (again, longer, pickle.loads(pickle.dumps(arm)), arm.replace(title="other")):
        assert np.array_equal(case.simulate("50 ms").position, arm.simulate("50 ms").position)
    undamped = arm.replace(robot=arm.robot.replace(backbone=arm.robot.backbone.replace(damping=None)))
    assert undamped.simulate("50 ms").energy["dissipated"][-1] == 0
    motion = arm.simulate("50 ms")
    motion.to_csv(tmp_path / "motion.csv")
    header, *rows = (tmp_path / "motion.csv").read_text().splitlines()
    assert header.startswith("t,tip_x") and len(rows) == len(motion)


def test_what_cannot_be_is_said(arm: whipcord.Case, segment: whipcord.Case) -> None:
    with pytest.raises(InputError, match="duration"):
        segment.simulate()
    with pytest.raises(ModelError, match="density"):
        segment.simulate("1 s")
    with pytest.raises(InputError, match="no cable 'up'"):
        arm.simulate(tension={"up": 1.0})
    with pytest.raises(InputError, match="tension"):
        arm.simulate(tension=[1.0])
    with pytest.raises(InputError, match="rows of a time"):
        arm.simulate(tension={"left": [(0, 1, 2)]})
    with pytest.raises(InputError, match="finite"):
        arm.simulate(tension={"left": lambda t: float("nan")})
    with pytest.raises(InputError, match="method"):
        arm.simulate(method="magic")
    with pytest.raises(InputError, match="count"):
        arm.modes(0)
    with pytest.raises(InputError, match="negative"):
        whipcord.Simulation(arm).step(0.01, tension=[-1.0, 0.0])
    with pytest.raises(InputError, match="step"):
        whipcord.Simulation(arm).step(-0.01)
    with pytest.raises(WhipcordTimeout):
        arm.simulate("1000 s", step="1 ms", every="1 s", timeout=0.2)


def test_surroundings_and_a_moving_base(arm: whipcord.Case, tmp_path: Path) -> None:
    def swing(motion: whipcord.Motion) -> float:
        return float(np.ptp(motion.tip[20:, 0]))

    free = arm.simulate("0.4 s")
    for drag in (2.0, "2 N*s/m^2", {"across": 2.0}):
        assert swing(arm.simulate("0.4 s", drag=drag)) < 0.9 * swing(free)
    assert arm.simulate("0.02 s", elements=60).arc_length.size > free.arc_length.size
    # The base goes 20 mm along its axis and stops.
    still = {"left": 0.0, "right": 0.0}
    velocity = [0, 0, [(0, "0.1 m/s"), (0.2, "0.1 m/s"), (0.2, 0)]]
    moved = arm.simulate("0.3 s", tension=still, base={"velocity": velocity})
    assert moved.position[-1, 0] - moved.position[0, 0] == pytest.approx([0, 0, 0.02], abs=1e-12)
    assert moved.energy["base"][-1] != 0.0
    table = tmp_path / "base.csv"
    table.write_text("t,x,y,z\n0,0,0,0\n0.2,0,0,0.02\n")
    led = arm.simulate("0.3 s", tension=still, base={"csv": str(table)})
    assert np.allclose(led.position, moved.position, atol=1e-9)
    with pytest.raises(InputError, match="speed"):
        arm.simulate("0.1 s", base={"velocity": [0, 0, "1 m"]})
    by_energy = arm.simulate("0.3 s", tension=still, method="energy", base={"velocity": velocity})
    assert np.allclose(by_energy.position[:, 0], moved.position[:, 0], atol=1e-12)
    assert np.allclose(by_energy.tip, moved.tip, atol=5e-3)


def test_a_motion_goes_on_from_a_state(arm: whipcord.Case, tmp_path: Path) -> None:
    whole = arm.simulate("0.2 s", step="2 ms")
    first = arm.simulate("0.1 s", step="2 ms")
    slack = {"left": 0.0}
    rest = arm.simulate("0.1 s", step="2 ms", initial=first, tension=slack)
    assert np.array_equal(rest.strain[0], first.strain[-1])
    assert np.allclose(rest.tip[-1], whole.tip[-1], atol=1e-4)
    simulation = whipcord.Simulation(arm, initial=first, tension=slack)
    assert np.array_equal(simulation.tip, first.tip[-1])
    again = whipcord.Simulation(arm, initial=simulation.state, tension=slack)
    assert np.array_equal(again.tip, first.tip[-1])
    with pytest.raises(InputError, match="initial"):
        arm.simulate("0.1 s", initial=3)  # type: ignore[arg-type]


def test_many_motions_are_those_of_each(arm: whipcord.Case) -> None:
    motions = whipcord.Motions(arm, "5 ms")
    rows = np.random.default_rng(1).uniform(0.2, 2.0, (3, 2, 8, 2))
    batch = motions(rows)
    assert batch.position.shape == (3, 2, 9, *batch.position.shape[3:]) and batch.ok.all() and not batch.errors
    simulation = whipcord.Simulation(arm)
    for k, tension in enumerate(rows[1, 1]):
        simulation.step("5 ms", tension=tension)
        assert np.array_equal(batch.position[1, 1, k + 1], simulation.position)
        assert np.array_equal(batch.strain[1, 1, k + 1], simulation.state.strain)
    for threads in (1, 2, 5):
        assert np.array_equal(motions(rows, threads=threads).position, batch.position)
    # A cable without a command keeps its own.
    own = motions(np.full((4, 2), np.nan))
    assert np.allclose(own.tip, arm.simulate("20 ms", step="5 ms", every="5 ms").tip, atol=1e-12)
    for wrong in (rows[..., :1], rows[0, 0, 0], -rows, rows * np.inf):
        with pytest.raises(InputError):
            motions(wrong)
    with pytest.raises(InputError, match="threads"):
        motions(rows, threads=0)


def test_a_motion_that_fails_is_flagged(arm: whipcord.Case) -> None:
    motions = whipcord.Motions(arm, "5 ms", initial="rest")
    rows = np.ones((3, 6, 2))
    rows[1] = 1e9
    with pytest.raises(whipcord.errors.MotionError):
        motions(rows)
    batch = motions(rows, on_failure="flag")
    assert batch.ok.tolist() == [True, False, True] and list(batch.errors) == [(1,)]
    assert np.isnan(batch.position[1]).all() and np.isfinite(batch.position[[0, 2]]).all()
    seed = np.ones_like(batch.position)
    gradient = motions.pull_back(rows, position=seed, on_failure="flag")
    assert not gradient.command[1].any() and gradient.command[0].any()


@pytest.mark.parametrize("actuation", ["tension", "shortening"])
def test_gradients_of_motions_are_those_of_differences(arm: whipcord.Case, actuation: Any) -> None:
    motions = whipcord.Motions(arm, "5 ms", actuation=actuation, initial="rest", drag=0.1)
    size = 1.0 if actuation == "tension" else 1e-3
    commands = size * np.random.default_rng(2).uniform(1.0, 2.0, (6, 2))
    weights = np.random.default_rng(3).normal(size=motions(commands).position.shape)

    def number(at: Any) -> float:
        return float((weights * motions(at).position).sum())

    found = motions.pull_back(commands, position=weights)
    largest = abs(found.command).max()
    for index in np.ndindex(commands.shape):
        step = np.zeros_like(commands)
        step[index] = 1e-4 * size
        difference = (number(commands + step) - number(commands - step)) / (2e-4 * size)
        assert found.command[index] == pytest.approx(difference, abs=1e-4 * largest)
    assert np.isfinite([found.stiffness, found.damping, found.mass]).all() and found.stiffness != 0.0
    with pytest.raises(InputError, match="position"):
        motions.pull_back(commands, position=weights[1:])


def test_gradients_with_friction_and_in_contact_are_those_of_differences(tmp_path: Path) -> None:
    rubs = Path(ARM).read_text().replace('name = "left"', 'name = "left"\nfriction = 0.4')
    # The arm leans on the wall when it is let go.
    wall = """
[[obstacles]]
name = "wall"
kind = "half-space"
position = ["110 mm", "0 mm", "0 mm"]
normal = [-1, 0, 0]
friction = 0.1
"""
    for text, initial, touches in ((rubs, "rest", False), (Path(ARM).read_text() + wall, None, True)):
        (tmp_path / "arm.toml").write_text(text)
        motions = whipcord.Motions(whipcord.load(tmp_path / "arm.toml"), "5 ms", initial=initial)
        commands = np.array([[3.8, 0.1], [4.0, 0.2], [4.1, 0.1]]) if touches else np.array([[1.0, 0.5], [1.4, 0.4], [1.1, 0.6]])
        weights = np.random.default_rng(3).normal(size=motions(commands).position.shape)
        found = motions.pull_back(commands, position=weights)
        assert found.one_sided.shape == (3,) and not found.one_sided.any()
        for index in np.ndindex(commands.shape):
            step = np.zeros_like(commands)
            step[index] = 1e-4
            above, below = (float((weights * motions(commands + by * step).position).sum()) for by in (1, -1))
            assert found.command[index] == pytest.approx((above - below) / 2e-4, abs=1e-3 * abs(found.command).max())
        along = np.random.default_rng(4).normal(size=commands.shape)
        change = motions.push_forward(commands, command=along)
        assert (weights * change.position).sum() == pytest.approx((found.command * along).sum(), rel=1e-9)
        assert np.array_equal(change.one_sided, found.one_sided)


@pytest.mark.parametrize("method", ["accurate", "energy", "robust"])
@pytest.mark.parametrize("is_free", [False, True])
def test_changes_along_a_direction_are_the_transpose_of_gradients(arm: whipcord.Case, method: str, is_free: bool) -> None:
    if is_free and method == "energy":
        pytest.skip("no free base by this method")
    base = {"free": True} if is_free else None
    motions = whipcord.Motions(arm, "5 ms", method=method, base=base)
    random = np.random.default_rng(4)
    commands, along = random.uniform(0.5, 1.5, (3, 5, 2)), random.normal(size=(3, 5, 2))
    factors = {"stiffness": np.array([0.1, 0.2, 0.3]), "damping": -0.2, "mass": 0.4}
    batch = motions(commands)
    seeds = {name: random.normal(size=getattr(batch, name).shape) for name in ("position", "velocity", "strain")}
    gradient = motions.pull_back(commands, **seeds)
    change = motions.push_forward(commands, command=along, **factors)
    by_gradient = (gradient.command * along).sum() + sum((getattr(gradient, of) * by).sum() for of, by in factors.items())
    terms = [(seed * getattr(change, name)).ravel() for name, seed in seeds.items()]
    bound = 1e-8 if method == "energy" else 1e-12
    assert by_gradient == pytest.approx(np.concatenate(terms).sum(), abs=bound * np.abs(np.concatenate(terms)).sum())
    only = motions.push_forward(commands, command=along)
    if method != "accurate":
        # Whose stages are iterated to a tolerance, which differences see.
        step = 1e-2
        moved = motions(commands + step * along).position - motions(commands - step * along).position
        assert np.allclose(only.position, moved / (2 * step), atol=1e-4 * np.abs(only.position).max())
    assert np.array_equal(only.tip, only.position[:, :, -1]) and only.turn.shape == only.position.shape
    with pytest.raises(InputError, match="command"):
        motions.push_forward(commands, command=along[:, 1:])


def test_an_arm_comes_to_rest_on_a_ball() -> None:
    case = whipcord.load("examples/contact/falling-arm.toml")
    motion = case.simulate()
    assert not motion.contacts[0] and motion.contacts[-1]
    assert 0 == motion.frictionless_parts < motion.parts
    touch = motion.contacts[-1][0]
    assert touch.obstacle == "ball" and touch.force is not None and touch.force > 0
    assert touch.friction is not None and np.linalg.norm(touch.friction) <= 0.3 * touch.force * (1 + 1e-6)
    assert (np.diff(motion.energy["contacts"]) <= 1e-6 * motion.energy["kinetic"].max()).all() and motion.energy["contacts"][-1] < 0
    still = case.solve(model="cosserat")
    known = sum(of.force or 0.0 for of in still.contacts)
    assert sum(of.force or 0.0 for of in motion.contacts[-1]) == pytest.approx(known, rel=0.4)

    simulation = whipcord.Simulation(case)
    while not simulation.state.contacts:
        simulation.step("5 ms")
    assert simulation.state.contacts[0].obstacle == "ball" and simulation.time < 1.0
    # What touches goes on to touch.
    touching = simulation.modes(2)
    assert 0 < touching.frequency[0] <= touching.frequency[1]
    linear = simulation.linearize()
    assert np.isfinite(linear.a).all() and linear.a.shape[0] == linear.b.shape[0]


def test_a_motor_with_inertia_overshoots_and_goes_on_from_where_it_was() -> None:
    robot = whipcord.Robot(
        backbone=whipcord.Backbone(
            length="200 mm", diameter="4 mm", young_modulus="1 GPa", poisson_ratio=0.3, density="1200 kg/m^3"
        ),
        cables=[whipcord.Cable(name="a", routing=whipcord.Routing.straight(angle=0, radius="10 mm"))],
        motors=[
            whipcord.Motor(
                name="m",
                cables=["a"],
                spool_radius="10 mm",
                stiffness="2 N/mm",
                inertia="200 g*cm^2",
                proportional_gain="0.5 N*m/rad",
                derivative_gain="1 mN*m*s/rad",
                damping=1e-6,
                integral_gain=0.2,
            )
        ],
    )
    assert robot.motors[0].inertia == pytest.approx(2e-5)
    case = whipcord.Case(robot)
    motion = case.simulate("0.3 s", motors={"m": [[0, 0], [0, 1.0]]}, step="1 ms")
    angle = motion.motor_position[:, 0]
    assert motion.motors == ("m",) and angle[0] == pytest.approx(0, abs=1e-6)
    assert angle.max() > 1.1 > 1.0 > angle[1]
    assert np.allclose(motion.motor_output, 1.0 * motion.motor_position)
    energy = motion.energy
    assert energy["motors"].max() > 0 and energy["control"][-1] > 0 and abs(energy["cables"]).max() == 0
    assert np.allclose(energy["motors"], 0.5 * 2e-5 * motion.motor_velocity[:, 0] ** 2)
    on = case.simulate("0.1 s", motors={"m": 1.0}, step="1 ms", initial=motion)
    assert on.motor_position[0, 0] == pytest.approx(angle[-1])
    assert on.motor_velocity[0, 0] == pytest.approx(motion.motor_velocity[-1, 0])
    assert on.motor_integral[0, 0] == pytest.approx(motion.motor_integral[-1, 0])
    assert {"position:m", "rate:m", "effort:m"} <= set(motion._columns())


def test_cables_straight_between_disks_and_with_friction(arm: whipcord.Case, tmp_path: Path) -> None:
    ramp = {"left": [(0, 0), (0.1, 3)]}
    smooth = arm.simulate(0.1, tension=ramp, initial="rest")
    straight = arm.simulate(0.1, tension=ramp, initial="rest", model="cosserat-disks")
    assert 1e-6 < np.linalg.norm(smooth.tip[-1] - straight.tip[-1]) < 5e-3
    frequencies = [arm.modes(1, model=model).frequency[0] for model in (None, "cosserat-disks")]
    assert frequencies[0] == pytest.approx(frequencies[1], rel=0.05)
    text = Path(ARM).read_text().replace('name = "left"', 'name = "left"\nfriction = 0.4')
    (tmp_path / "rubs.toml").write_text(text)
    rubs = whipcord.load(tmp_path / "rubs.toml").simulate(0.1, tension=ramp, initial="rest", model="cosserat-disks")
    assert abs(rubs.tip[-1, 0]) < abs(straight.tip[-1, 0])
    assert rubs.energy["dissipated"][-1] > 0
    # What is pulled at the base falls from hole to hole.
    passages = rubs.passage_tensions[rubs.cables.index("left")]
    assert passages.shape[0] == len(rubs) and passages.shape[1] > 1
    assert passages[-1, 0] == pytest.approx(3, rel=0.05) and (np.diff(passages[-1]) < 0).all()
    assert straight.passage_tensions[0].shape == straight.lengths_beyond[0].shape == (len(straight), 0)
    # A motion goes on from what the holes remember.
    beyond = rubs.lengths_beyond[rubs.cables.index("left")]
    assert beyond.shape == passages.shape and (np.diff(beyond[-1]) < 0).all()
    held = whipcord.load(tmp_path / "rubs.toml").simulate(
        0.05, tension={"left": 3.0}, initial=rubs, model="cosserat-disks"
    )
    assert held.tip[0] == pytest.approx(rubs.tip[-1], abs=1e-12)
    assert held.passage_tensions[rubs.cables.index("left")][0] == pytest.approx(passages[-1], abs=1e-12)
    # Slack cables hold nothing; those that are pulled slide in their holes.
    case = whipcord.load(tmp_path / "rubs.toml")
    assert case.modes(1).frequency[0] == pytest.approx(frequencies[0], rel=1e-6)
    pulled = whipcord.Simulation(case, initial="rest")
    pulled.step("5 ms", tension=[3.0, 1.0])
    with pytest.raises(whipcord.errors.MotionError, match="slides"):
        pulled.linearize()


def test_a_free_base(arm: whipcord.Case) -> None:
    free = whipcord.Simulation(arm, base={"free": True}, initial="rest", tension={"left": 0.0})
    start = free.position.copy()
    for _ in range(10):
        free.step(0.01)
    fallen = free.position - start
    # Gravity pulls from the base to the tip.
    np.testing.assert_allclose(fallen[:, 2], 0.5 * 9.81 * 0.01, atol=1e-9)
    np.testing.assert_allclose(free.momentum[:2], 0, atol=1e-12)
    np.testing.assert_allclose(free.angular_momentum, 0, atol=1e-9)
    np.testing.assert_allclose(free.base_wrench, 0)
    # Its own displacement and velocity are in the state, and its motions as a whole have frequency 0 without gravity.
    assert free.linearize().a.shape[0] == 12 + whipcord.Simulation(arm, initial="rest").linearize().a.shape[0]
