"""Answers, against SciPy, closed forms, each other, and differences."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
import whipcord
from whipcord import Backbone, Cable, Case, Disks, InputError, Loads, Obstacle, Robot, Routing, errors, models

Array = npt.NDArray[np.float64]


def test_an_answer_has_the_shapes_of_the_contract(case: whipcord.Case) -> None:
    solution = case.solve(tension=[2.0], model="cosserat", stations=37)
    assert solution.position.shape == (37, 3) and solution.position.dtype == np.float64
    assert solution.orientation.shape == (37, 4)
    assert solution.arc_length.tolist()[::36] == [0.0, 0.18]
    assert solution.disks.position.shape == (10, 3)
    assert solution.tension.tolist() == [2.0]
    assert case.solve(stations=[0.0, 0.05, 0.18]).position.shape == (3, 3)
    assert np.array_equal(case.solve(tension=[2.0], stations=np.int64(37)).position, solution.position)
    turned = solution.rotation @ solution.rotation.transpose(0, 2, 1)
    assert np.allclose(turned, np.eye(3), atol=1e-14)


def test_all_ways_to_give_a_command_are_one(case: whipcord.Case) -> None:
    position = case.solve(tension=[3.92266]).position
    for tension in (3.92266, np.array(3.92266), "400 gf", ["400 gf"], (3.92266,), np.array([3.92266]), None):
        assert np.array_equal(case.solve(tension=tension).position, position)
        if tension is not None:
            assert whipcord.Case(case.robot, tension=tension).tension == case.tension
    for tension in (np.array([4]), [4], np.float32(4.0), np.array([4.0, 0.0])[::2]):
        assert case.solve(tension=tension).tension.tolist() == [4.0]


def test_lengths_are_met_in_every_model(case: whipcord.Case) -> None:
    # No single arc goes round with a cable that turns.
    with pytest.raises(whipcord.ModelError, match="parallel to the backbone"):
        case.solve(shortening=["5 %"], model="constant-curvature")
    for model in set(whipcord.models.NAMES) - {"constant-curvature"}:
        solution = case.solve(shortening=["5 %"], model=model)
        (cable,) = solution.cables
        assert abs(cable.shortening / cable.initial_length - 0.05) < 1e-9
        again = case.solve(length=[cable.length], model=model)
        assert abs(again.cables[0].length - cable.length) < 1e-12
        assert np.allclose(again.position, solution.position, atol=1e-9)
    assert abs(case.solve(length="170 mm").cables[0].length - 0.17) < 1e-11


def test_a_cable_that_is_driven_otherwise(segment: whipcord.Case) -> None:
    solution = segment.solve(tension=[None, 1.0, 2.0], shortening=["2 mm", None, None])
    assert solution.tension[1:].tolist() == [1.0, 2.0]
    assert abs(solution.cables[0].shortening - 0.002) < 1e-12


def test_a_warm_start_leads_to_the_same_answer() -> None:
    case = whipcord.load("examples/wall-mounted-arm.toml")
    cold = case.solve(tension=[15.0])
    warm = case.solve(tension=[15.0], start=cold)
    assert np.allclose(cold.position, warm.position, atol=1e-10)
    assert warm.diagnostics.iterations < cold.diagnostics.iterations
    assert "neighbouring" in warm.report() and "neighbouring" not in cold.report()


def test_a_command_takes_the_place_of_the_last_step_or_of_all() -> None:
    case = whipcord.load("examples/rubbing-finger.toml")
    model = "cosserat-disks"
    last = case.replace(steps=[*case.steps[:-1], whipcord.Step(tension=[2.0])])
    given = case.solve(tension=[2.0], model=model)
    assert np.array_equal(given.position, last.solve(model=model).position)
    assert np.allclose(case.solve_batch([[2.0]], model=model).position[0], given.position, atol=1e-9)
    alone = case.replace(tension=[2.0])
    assert not alone.steps
    apart = alone.solve(model=model).tip - given.tip
    assert np.linalg.norm(apart) > 1e-3
    # Nothing is kept of the answer that another one starts from.
    before = case.solve_steps(model=model)[-2]
    warm = alone.solve(model=model, start=before)
    assert np.allclose(warm.position, alone.solve(model=model).position, atol=1e-9)


def test_an_answer_knows_what_it_answers(case: whipcord.Case) -> None:
    solution = case.solve(tension=["2 N"])
    assert solution.case == whipcord.Case(case.robot, tension=[2.0], title=case.title)
    assert solution.robot == case.robot
    tensions = np.array([2.5])
    answer = case.solve(tension=tensions)
    tensions[0] = 0.0
    assert answer.case.tension == (2.5,)


def test_answers_are_pickled_to_the_last_bit() -> None:
    for name, model in (("table1/case-3", "cosserat"), ("rubbing-finger", "cosserat-disks")):
        solution = whipcord.load(f"examples/{name}.toml").solve(model=model, stations=11)
        copy = pickle.loads(pickle.dumps(solution))
        assert copy == solution
        assert np.array_equal(copy.position, solution.position)
        assert copy.cables == solution.cables and copy.diagnostics == solution.diagnostics
        assert copy.report() == solution.report()
        assert copy.case == solution.case
    assert copy != whipcord.load("examples/table1/case-3.toml").solve()


def test_touches_are_pickled_to_the_last_bit(tmp_path: Path) -> None:
    # A mesh is read from its file again, so that it goes where that is.
    mesh = "o v\nv 0 -1 0\nv 0 2 0\nv 0 -1 2\nv 1 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
    (tmp_path / "wedge.obj").write_text(mesh)
    case = whipcord.suite("routing", only=["wall-9-30"])["wall-9-30"]
    wedge = Obstacle(
        kind="mesh", name="wedge", file=tmp_path / "wedge.obj", unit="mm", scale=10, position=["80 mm", 0, 0]
    )
    case = case.replace(obstacles=[*case.obstacles, wedge])
    sliding = whipcord.models.FourBar(objective="strain-energy", length_rule="free")
    answers = [
        case.solve(model="cosserat"),
        case.solve(model=sliding, shortening=[0.004]),
    ]
    for solution in answers:
        (touch,) = solution.contacts
        assert (touch.obstacle, touch.part, touch.disk) == ("wall", "disk", 9)
        assert touch.force is not None and touch.force > 0 and abs(touch.gap) < 1e-9
        for copy in (pickle.loads(pickle.dumps(solution)), deepcopy(solution)):
            assert copy == solution and copy.case == solution.case
            assert copy.case.obstacles == case.obstacles
            for seen in (copy.contacts, pickle.loads(pickle.dumps(solution.contacts))):
                (again,) = seen
                for name in ("obstacle", "part", "disk", "arc_length", "force", "gap"):
                    assert getattr(again, name) == getattr(touch, name)
                assert np.array_equal(again.point, touch.point) and np.array_equal(again.normal, touch.normal)
            assert copy.diagnostics == solution.diagnostics
            assert copy.stable is True and copy.diagnostics.stability_absent is None
            assert copy.report() == solution.report()
    assert answers[0] != answers[1]
    # A pickled answer is as good a start as the answer: nothing is left to do.
    start = pickle.loads(pickle.dumps(answers[0]))
    assert np.array_equal(case.solve(start=start).position, case.solve(start=answers[0]).position)


# The paper's eq. (3) for one cable and a uniform round rod, in v and u: force and moment of the rod are
# n = K_se (v − e₃) and m = K_bt u; the cable bears τ t with t = p_b′/‖p_b′‖ and p_b′ = û r + r′ + v, and
# acts on the rod by the force −(τ t)′ and the moment −r × (τ t)′ per length. With the derivative of a unit
# vector, (τ t)′ = −τ p̂_b′² p_b″/‖p_b′‖³, equilibrium is linear in v′ and u′.


def eq3(case: whipcord.Case, route: object, force: Array) -> tuple[Array, Array]:
    """Positions and rotations at the ends of ten sections, by SciPy's solver of boundary value problems."""
    from scipy.integrate import solve_bvp

    rod = case.robot.backbone
    assert rod.young_modulus is not None and rod.diameter is not None
    assert rod.poisson_ratio is not None
    (tension,) = case.tension
    length, area = rod.length, np.pi * rod.diameter**2 / 4
    inertia = np.pi * rod.diameter**4 / 64
    shear = rod.young_modulus / (2 * (1 + rod.poisson_ratio))
    stretch = np.diag([shear * area, shear * area, rod.young_modulus * area])
    bend = np.diag([rod.young_modulus * inertia] * 2 + [2 * shear * inertia])
    e3 = np.array([0.0, 0.0, 1.0])

    def hat(a: Array) -> Array:
        """(..., 3, 3) of (..., 3)."""
        return -np.cross(a[..., None, :], np.eye(3))

    def along(s: Array, y: Array) -> Array:
        turn, v, u = y[:, 3:12].reshape(-1, 3, 3), y[:, 12:15], y[:, 15:18]
        r, dr, ddr = route(s)  # type: ignore[operator]
        tangent = np.cross(u, r) + dr + v
        norm = np.linalg.norm(tangent, axis=1)[:, None, None]
        a = -tension * hat(tangent) @ hat(tangent) / norm**3
        b = hat(r) @ a
        known = np.cross(u, tangent) + np.cross(u, dr) + ddr
        # [K_se + A, −A r̂; B, K_bt − B r̂] [v′; u′] = right
        matrix = np.block([[stretch + a, -a @ hat(r)], [b, bend - b @ hat(r)]])
        n, m = (v - e3) @ stretch, u @ bend
        force = -np.cross(u, n) - np.einsum("nij,nj->ni", a, known)
        moment = -np.cross(u, m) - np.cross(v, n) - np.einsum("nij,nj->ni", b, known)
        right = np.concatenate([force, moment], axis=1)
        change = np.linalg.solve(matrix, right[:, :, None])[:, :, 0]
        moved = np.einsum("nij,nj->ni", turn, v)
        return np.concatenate([moved, (turn @ hat(u)).reshape(-1, 9), change], axis=1)

    def rates(s: Array, y: Array) -> Array:
        return along(s, y.T).T

    def ends(start: Array, end: Array) -> Array:
        (r,), (dr,), _ = route(np.array([length]))  # type: ignore[operator]
        turn, v, u = end[3:12].reshape(3, 3), end[12:15], end[15:18]
        tangent = np.cross(u, r) + dr + v
        pull = -tension * tangent / np.linalg.norm(tangent)
        outside = turn.T @ force
        fixed = np.concatenate([start[:3], start[3:12] - np.eye(3).ravel()])
        # What the cable's end and the load leave to the rod.
        free_force = stretch @ (v - e3) - pull - outside
        free_moment = bend @ u - np.cross(r, pull)
        return np.concatenate([fixed, free_force, free_moment * 100])

    mesh = np.linspace(0, length, 61)
    guess = np.zeros((18, mesh.size))
    guess[2], guess[14] = mesh, 1.0
    guess[[3, 7, 11]] = 1.0
    found = solve_bvp(rates, ends, mesh, guess, tol=1e-8, max_nodes=4000)
    assert found.success, found.message
    y = found.sol(np.linspace(0, length, 11))
    return y[:3].T, y[3:12].T.reshape(-1, 3, 3)


def round_rod(routing: Routing, tension: float, loads: Loads | None = None) -> Case:
    rod = Backbone(length=0.18, diameter=0.003, young_modulus=1.1e9, poisson_ratio=0.3)
    robot = Robot(backbone=rod, disks=Disks(count=11), cables=[Cable(name="pull", routing=routing)])
    return Case(robot, tension=[tension], loads=loads)


def helix(turns: float, radius: float, start: float, length: float = 0.18) -> object:
    k = 2 * np.pi * turns / length

    def at(s: Array) -> tuple[Array, Array, Array]:
        angle = start + k * s
        cos, sin, zero = np.cos(angle), np.sin(angle), np.zeros_like(angle)
        out = radius * np.stack([cos, sin, zero], axis=1)
        across = radius * np.stack([-sin, cos, zero], axis=1)
        return out, k * across, -k * k * out

    return at


def converging(start: Array, end: Array, length: float = 0.18) -> object:
    def at(s: Array) -> tuple[Array, Array, Array]:
        slope = np.tile((end - start) / length, (len(s), 1))
        return start + slope * s[:, None], slope, np.zeros_like(slope)

    return at


def test_scipy_solves_eq_3_to_the_same_shape_for_a_helical_cable() -> None:
    case = round_rod(Routing.helix(turns=0.5, radius=0.008, start_angle=0.3), 3.0)
    agree(case, helix(0.5, 0.008, 0.3), np.zeros(3))


def test_scipy_solves_eq_3_to_the_same_shape_for_a_converging_cable() -> None:
    case = round_rod(Routing.linear(start=[0.008, 0.002], end=[0.002, -0.003]), 5.0)
    agree(case, converging(np.array([0.008, 0.002, 0]), np.array([0.002, -0.003, 0])), np.zeros(3))


def test_scipy_solves_eq_3_to_the_same_shape_under_a_tip_force() -> None:
    force = np.array([0.03, -0.05, 0.02])
    case = round_rod(Routing.helix(turns=-0.3, radius=0.006), 2.0, Loads(tip_force=force.tolist()))
    agree(case, helix(-0.3, 0.006, 0.0), force)


def agree(case: Case, route: object, force: Array) -> None:
    position, rotation = eq3(case, route, force)
    solution = case.solve()
    assert np.linalg.norm(solution.position[-1] - [0, 0, 0.18]) > 0.03
    assert np.abs(solution.position - position).max() < 1e-6 * 0.18
    assert np.abs(solution.rotation - rotation).max() < 1e-6


@pytest.mark.parametrize(
    "model",
    [
        # So accurate that differences are.
        models.Cosserat(tolerance=1e-10),
        models.CosseratDisks(tolerance=1e-10),
        "piecewise-constant-curvature",
        "pseudo-rigid-body",
    ],
    ids=str,
)
def test_jacobians_are_those_of_differences(model: models.Cosserat | models.CosseratDisks | str) -> None:
    case = whipcord.load("examples/wall-mounted-arm.toml")
    parameters = ["loads.tip_force[0]", "backbone.young_modulus", "disks.mass"]
    steps = [1e-4, 1e4, 1e-5]
    case = case.replace(loads=case.loads.replace(tip_force=[0.01, 0.02, 0.03]))
    solution, derivatives = case.differentiate(parameters=parameters, model=model)
    h = 1e-4
    ahead, behind = (case.solve(tension=[6 + d], model=model).position for d in (h, -h))
    expected = (ahead - behind) / (2 * h)
    scale = np.abs(expected).max()
    assert np.abs(derivatives.position_by_command[:, :, 0] - expected).max() < 1e-6 * scale
    for i, (path, step) in enumerate(zip(parameters, steps)):
        value = case.parameter(path)
        ahead, behind = (case.with_parameters({path: value + d}).solve(model=model).position for d in (step, -step))
        expected = (ahead - behind) / (2 * step)
        got = derivatives.position_by_parameter[:, :, i]
        assert np.abs(got - expected).max() < 1e-5 * np.abs(expected).max(), path
    # Along the axes of the world a force at the tip moves it by the compliance turned.
    turn = solution.rotation[0]
    compliance = turn @ derivatives.compliance()[:3, :3] @ turn.T
    assert np.allclose(derivatives.position_by_parameter[-1, :, 0], compliance[:, 0], rtol=1e-9)


@pytest.mark.parametrize(
    "model",
    [
        models.Cosserat(steps=36),
        models.CosseratDisks(steps=2),
        "piecewise-constant-curvature",
        "pseudo-rigid-body",
        models.FourBar(objective="strain-energy", length_rule="free"),
    ],
    ids=str,
)
@pytest.mark.parametrize(
    ("example", "parameter"),
    [("rubbing-finger", "cables[0].friction"), ("hysteresis-loop", "backbone.yield_moment")],
)
def test_derivatives_follow_all_steps_of_a_robot_that_remembers_them(
    model: models.Cosserat | models.CosseratDisks | models.FourBar | str, example: str, parameter: str
) -> None:
    case = whipcord.load(f"examples/{example}.toml")
    solution, derivatives = case.differentiate(parameters=[parameter], model=model)
    assert np.allclose(solution.position, case.solve_steps(model=model)[-1].position, atol=1e-9)
    value = case.parameter(parameter)
    h = 1e-4 * value
    ahead, behind = (
        case.with_parameters({parameter: value + step}).solve_steps(model=model)[-1].position for step in (h, -h)
    )
    expected = (ahead - behind) / (2 * h)
    got = derivatives.position_by_parameter[:, :, 0]
    assert np.abs(got - expected).max() < 1e-4 * np.abs(expected).max()


def test_pulling_back_is_the_transpose_of_pushing_forward() -> None:
    case = whipcord.load("examples/wall-mounted-arm.toml")
    parameters = ["backbone.young_modulus", "loads.mass[0].mass"]
    solution, derivatives = case.differentiate(parameters=parameters, stations=9)
    random = np.random.default_rng(3)
    position, rotation = random.normal(size=(2, *solution.position.shape))
    gradient = derivatives.pull_back(position=position, rotation=rotation)
    weights = np.concatenate([position, rotation], axis=1)
    forward = np.einsum("ni,nij->j", weights, derivatives.twist_by_command)
    assert np.allclose(gradient.commands, forward, rtol=1e-9)
    forward = np.einsum("ni,nij->j", weights, derivatives.twist_by_parameter())
    assert np.allclose(gradient.parameters, forward, rtol=1e-8)
    batch = case.pull_back_batch(
        [[6.0], [5.0]],
        position=np.stack([position, position]),
        rotation=np.stack([rotation, rotation]),
        parameters=parameters,
        stations=9,
    )
    assert np.array_equal(batch.commands[0], gradient.commands)
    assert np.array_equal(batch.parameters[0], gradient.parameters)
    assert batch.ok.all() and batch.commands[1] != batch.commands[0]


def test_the_four_bar_model_with_a_strain_energy_knows_all_derivatives(case: whipcord.Case) -> None:
    model = models.FourBar(objective="strain-energy", length_rule="free")
    solution, derivatives = case.differentiate(model=model)
    assert derivatives.compliance().shape == (6, 6)
    assert derivatives.length_by_tension[0, 0] < 0
    tip = case.stiffness(model=model)
    assert np.allclose(tip.jacobian, derivatives.twist_by_command[-1], rtol=1e-7, atol=1e-9)
    gradient = derivatives.pull_back(position=np.ones_like(solution.position))
    assert np.allclose(gradient.commands, derivatives.position_by_command.sum(axis=(0, 1)), rtol=1e-8)


def test_compliance_and_stiffness_are_inverse(segment: whipcord.Case) -> None:
    place = segment.stiffness("60 mm")
    assert place.stiffness is not None
    assert np.allclose(place.stiffness @ place.compliance, np.eye(6), atol=1e-8)
    _, derivatives = segment.differentiate(stations=[0.06])
    assert np.allclose(derivatives.compliance(0, "lengths"), place.compliance_lengths_held)
    assert derivatives.length_by_tension.shape == (3, 3)


def test_sections_say_how_they_move(case: whipcord.Case) -> None:
    shortening = np.array([0.006])
    solution, derivatives = case.differentiate(shortening=shortening, model="four-bar", stations=5)

    def change(of: Callable[[whipcord.Solution], Array], h: float = 2e-5) -> Array:
        def at(step: float) -> Array:
            return of(case.solve(shortening=shortening + step * h, model="four-bar", stations=5))

        difference: Array = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h)
        return difference

    assert derivatives.twist_by_command.shape == (5, 6, 1)
    assert np.allclose(derivatives.position_by_command[:, :, 0], change(lambda s: s.position), atol=1e-7)
    assert np.allclose(derivatives.length_by_command, [[-1]])
    assert np.allclose(change(lambda s: s.length), -1, atol=1e-9)
    # All else takes a model that knows forces.
    for unknown in (
        lambda: derivatives.length_by_tension,
        lambda: derivatives.twist_by_tension,
        derivatives.twist_by_parameter,
        derivatives.compliance,
        lambda: derivatives.pull_back(position=np.ones_like(solution.position)),
    ):
        with pytest.raises(InputError, match="known to models in equilibrium under loads, not to four-bar"):
            unknown()
    # The same frame as the rod's, and the same numbers at the tip.
    tip = case.stiffness(shortening=shortening, model="four-bar")
    assert np.allclose(tip.jacobian, derivatives.twist_by_command[-1])
    assert (tip.driven_by, tip.estimated_error) == (("shortening",), None)
    assert (tip.one_sided, tip.lengths_dependent) == ((), False)
    assert (derivatives.one_sided, derivatives.lengths_dependent) == ((), False)
    assert tip.length_jacobian == pytest.approx(-1)
    with pytest.raises(errors.ModelError, match="only lengths and no energy decide") as caught:
        _ = tip.stiffness
    assert caught.value.advice.startswith("take the objective strain-energy")
    sliding = whipcord.models.FourBar(objective="strain-energy", length_rule="free")
    tip = case.stiffness(shortening=shortening, model=sliding)
    assert case.stiffness(shortening=[0.0], model="cosserat").one_sided == ("cable",)
    assert case.differentiate(shortening=[0.0], model="cosserat")[1].one_sided == ("cable",)
    locked, free = np.diag(tip.compliance_lengths_held), np.diag(tip.compliance_tensions_held)
    assert tip.yield_unknown is None and (0 < locked[:3]).all() and (locked[:3] < free[:3]).all()


def test_lengths_follow_the_commands(segment: whipcord.Case) -> None:
    tension = np.array(segment.tension)
    _, derivatives = segment.differentiate(tension=tension)
    # By tensions alone the two are one.
    assert np.allclose(derivatives.length_by_command, derivatives.length_by_tension)
    lengths = segment.solve(tension=tension).length
    _, derivatives = segment.differentiate(shortening=lengths * 0 + 0.002)
    rate = derivatives.length_by_command
    assert rate.shape == (3, 3) and np.allclose(rate.sum(axis=1), -1, atol=1e-6)


@pytest.mark.parametrize("model", ["cosserat", "piecewise-constant-curvature", "pseudo-rigid-body"])
def test_a_buckled_column_has_three_equilibria(model: str) -> None:
    rod = Backbone(length=0.18, diameter=0.003, young_modulus=1.1e9, poisson_ratio=0.3)
    column = Case(Robot(backbone=rod, disks=Disks(count=10)), loads=Loads(tip_force=[0, 0, -0.5]))
    found = column.branches(model=model)
    assert [equilibrium.stable for equilibrium in found.equilibria] == [False, True, True]
    assert found.complete
    # Euler's load of a cantilever.
    euler = np.pi**2 * 1.1e9 * (np.pi * 0.003**4 / 64) / (4 * 0.18**2)
    loads = [p.load * 0.5 for p in found.critical_points if p.kind == "bifurcation"]
    assert any(abs(load / euler - 1) < 0.01 for load in loads)


def test_a_model_without_loads_has_no_branches(case: whipcord.Case) -> None:
    with pytest.raises(errors.ModelError, match="use cosserat"):
        case.branches(model="four-bar", shortening=[0.001] * len(case.robot.cables))


def test_models_are_compared(case: whipcord.Case) -> None:
    comparison = whipcord.compare(case)
    assert [run.model for run in comparison] == list(whipcord.models.NAMES)
    # Its cable winds round the backbone, which no single arc takes.
    assert isinstance(comparison["constant-curvature"].error, whipcord.ModelError)
    others = [name for name in whipcord.models.NAMES if name != "constant-curvature"]
    assert list(comparison.solutions) == others
    assert comparison["cosserat"].distance is None
    disks = comparison["cosserat-disks"].solution
    assert disks is not None
    apart = np.linalg.norm(disks.disks.position - case.solve().disks.position, axis=1)[1:]
    assert np.isclose(comparison["cosserat-disks"].distance, np.sqrt(np.mean(apart**2)))
    table = comparison.to_pandas()
    assert table.loc["four-bar", "distance"] == comparison["four-bar"].distance
    loaded = whipcord.compare(case.replace(loads=Loads(tip_force=[0.1, 0, 0])))
    assert isinstance(loaded["four-bar"].error, whipcord.ModelError)
    assert "four-bar" in repr(loaded)


def test_answers_become_tables(case: whipcord.Case, tmp_path: Path) -> None:
    import pandas
    import polars

    solution = case.solve(stations=5)
    frame = solution.to_pandas()
    assert frame[["x", "y", "z"]].to_numpy().tolist() == solution.position.tolist()
    assert solution.to_polars()["qw"].to_list() == solution.orientation[:, 0].tolist()
    data = solution.to_xarray()
    assert data["position"].sel(axis="z").values.tolist() == solution.position[:, 2].tolist()
    assert data["tension"].sel(cable="pull") == solution.tension[0]
    for thing in (solution, case.solve_batch([[1.0], [1e6]])):
        thing.to_parquet(str(tmp_path / "a.parquet"))
        assert pandas.read_parquet(tmp_path / "a.parquet").equals(thing.to_pandas())
        assert polars.read_parquet(tmp_path / "a.parquet").equals(thing.to_polars())


def test_pictures_show_what_they_are_of(case: whipcord.Case) -> None:
    import matplotlib.pyplot as pyplot

    solution = case.solve()
    axes = solution.plot()
    (line, *rest) = axes.get_lines()
    drawn = np.array(line.get_data_3d())
    assert np.allclose(drawn[:, -1], 1e3 * solution.tip)
    assert line.get_color() == whipcord.plot.MODELS["cosserat"]
    # The cable, in a color of its own, and the straight backbone.
    cable, before = rest
    assert cable.get_color() == whipcord.plot.CABLES[0]
    assert np.allclose(np.array(before.get_data_3d())[:, [0, -1]], [[0, 0], [0, 0], [0, 180]])
    labels = ["cosserat", "cable pull", "before actuation"]
    assert [text.get_text() for text in axes.get_legend().get_texts()] == labels
    # A backbone of 16 sides, ten disks of 36 and two faces, and a cable of 6 sides, closed at both ends.
    (solids,) = axes.collections
    assert len(solids.get_facecolor()) == (90 * 16 + 2) + 10 * (36 + 2) + (90 * 6 + 2)
    axes = whipcord.plot.compare(solution, case.solve(model="four-bar"), labels=["a", "b"])
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["a", "b"]
    # What is drawn later is inside as well.
    straight = case.solve(tension=[0.0])
    axes = whipcord.plot.compare(solution, straight)
    for name, tips in zip("xyz", 1e3 * np.array([solution.tip, straight.tip]).T):
        low, high = getattr(axes, f"get_{name}lim3d")()
        assert low < tips.min() and tips.max() < high
    with pytest.raises(whipcord.InputError, match="choose matplotlib or pyvista"):
        solution.plot(backend="gnuplot")
    pyplot.close("all")
    assert "<svg" in solution.svg()


def test_pictures_show_loads(case: whipcord.Case) -> None:
    import matplotlib.pyplot as pyplot

    loads = Loads(
        tip_force=[0.2, 0, 0],
        tip_moment=[0, 0.004, 0],
        follower=True,
        point=[whipcord.PointLoad(at=0.09, force=[0, -0.1, 0])],
        distributed=[whipcord.DistributedLoad(start=0.02, end=0.08, force=[0, 0.5, 0])],
        mass=[whipcord.PointMass(at=0.12, mass=0.003)],
        gravity=[0, 0, -9.81],
    )
    heavy = case.robot.replace(backbone=case.robot.backbone.replace(density=1200.0))
    loaded = case.replace(robot=heavy, loads=loads).solve()
    axes = loaded.plot()
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels[3:] == [
        "force 100 mN",
        "force 200 mN, follows the body",
        "moment 4 mN·m, follows the body",
        "load 500 mN/m",
        "mass 3 g",
        "gravity 9.81 m/s²",
    ]
    # Three single arrows, seven of the distributed load with the line of their tails, and gravity.
    assert len(axes.get_lines()) == 3 + 3 + 7 + 1 + 1
    # All of the robot is in the picture, which is not much larger.
    for name, drawn in zip("xyz", 1e3 * loaded.position.T):
        low, high = getattr(axes, f"get_{name}lim3d")()
        assert low < drawn.min() and drawn.max() < high and high - low < 300
    plain = loaded.plot(loads=False, unactuated=False)
    assert [text.get_text() for text in plain.get_legend().get_texts()] == labels[:2]
    contact = whipcord.load("examples/contact/catheter-in-pipe.toml").solve().plot()
    assert contact.get_legend().get_texts()[-1].get_text().startswith("contact forces up to ")
    # A backbone of strips, wider at the base; a body without disks, through which its cables are seen.
    whipcord.load("examples/composite-finger.toml").solve().plot()
    (solids,) = whipcord.load("examples/soft-finger.toml").solve().plot().collections
    assert solids.get_facecolor()[0, 3] == 0.25
    pyplot.close("all")


def test_an_unstable_answer_says_so_wherever_it_is_shown(case: whipcord.Case) -> None:
    import matplotlib.pyplot as pyplot

    # Euler's column at twice its buckling load, straight.
    rod = Backbone(length=0.18, diameter=0.003, young_modulus=1.1e9, poisson_ratio=0.3)
    column = Case(Robot(backbone=rod, disks=Disks(count=10)), loads=Loads(tip_force=[0, 0, -0.68]))
    straight = next(e.solution for e in column.branches().equilibria if not e.stable)
    assert straight.diagnostics.unstable
    (text,) = straight.plot().texts
    assert text.get_text() == "unstable"
    assert not case.solve().plot().texts
    legend = whipcord.plot.compare(straight, case.solve(), labels=["a", "b"]).get_legend()
    assert [text.get_text() for text in legend.get_texts()] == ["a (unstable)", "b"]
    pyplot.close("all")
    run = whipcord.Run("cosserat", straight, None, None, None)
    comparison = whipcord.Comparison(column, [run])
    assert repr(comparison).endswith(" mm, unstable>")
    assert comparison.to_pandas()["unstable"].tolist() == [True]
    assert comparison.to_polars()["unstable"].to_list() == [True]
    assert whipcord.compare(case).to_pandas()["unstable"].tolist() == [False] * len(whipcord.models.NAMES)


def test_a_comparison_without_measurements_is_a_table_of_numbers(case: whipcord.Case) -> None:
    frame = whipcord.compare(case.replace(loads=Loads(tip_force=[0.1, 0, 0]))).to_pandas()
    assert frame.dtypes[["x", "distance", "distance_to_measured"]].tolist() == [np.float64] * 3
    assert np.isnan(frame["distance_to_measured"]).all() and np.isnan(frame.loc["four-bar", "distance"])


def test_places_are_counted_as_in_arrays(case: whipcord.Case) -> None:
    _, derivatives = case.differentiate()
    last = len(derivatives.position_by_command) - 1
    assert np.array_equal(derivatives.compliance(-1), derivatives.compliance(last))
    assert np.array_equal(derivatives.compliance(np.int64(-last - 1)), derivatives.compliance(0))
    for wrong in (last + 1, -last - 2, 2**70, -(2**70)):
        with pytest.raises(whipcord.InputError, match="there is no station"):
            derivatives.compliance(wrong)


def test_parameters_are_set_exactly(case: whipcord.Case) -> None:
    path = "backbone.young_modulus"
    assert case.with_parameters({path: 1.1}).parameter(path) == 1.1


def test_an_obstacle_that_rubs_holds_on() -> None:
    case = whipcord.load("examples/contact/rubbing-wall.toml")
    (wall,) = case.obstacles
    assert wall.friction == 0.3
    (touch,) = case.solve().contacts
    assert touch.force is not None and touch.friction is not None and not touch.sticks
    # Let go again, it slides up the wall: friction pulls it down.
    assert np.allclose(touch.friction, [0.0, 0.0, -0.3 * touch.force], rtol=1e-6, atol=1e-9)
    smooth = case.replace(obstacles=[wall.replace(friction=0.0)])
    (slipping,) = smooth.solve().contacts
    assert slipping.friction is not None and np.all(slipping.friction == 0.0)


def test_lengths_that_contradict_each_other_have_a_least_squares_answer() -> None:
    robot = whipcord.Robot(
        backbone=whipcord.Backbone(
            length=0.2, diameter=1.2e-3, young_modulus=60e9, poisson_ratio=0.3, extensible=False
        ),
        disks=whipcord.Disks(count=5, hole_circle_radius=0.008, holes=3),
        cables=[whipcord.Cable(name=name, holes=5 * [k + 1]) for k, name in enumerate("abc")],
    )
    case = whipcord.Case(robot, shortening=[4.4e-3, -0.6e-3, -2.6e-3])
    with pytest.raises(whipcord.SolveError, match="least-squares answer"):
        case.solve()
    found = case.solve(least_squares_lengths=True)
    misses = dict(found.diagnostics.length_misses)
    assert set(misses) == {"a", "b", "c"} and np.allclose(list(misses.values()), 4e-4, atol=1e-6)
    assert found.stable and all(cable.tension is None for cable in found.cables)
    again = pickle.loads(pickle.dumps(found))
    assert again.diagnostics.length_misses == found.diagnostics.length_misses
    met = case.solve(shortening=[4e-3, -1.5e-3, -3.5e-3], least_squares_lengths=True)
    assert not met.diagnostics.length_misses
