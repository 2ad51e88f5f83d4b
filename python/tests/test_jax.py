"""The solve as a differentiable function for JAX."""

from __future__ import annotations

import numpy as np
import pytest
import whipcord

from .differentiable import PATHS, agree, exact, loaded

jax = pytest.importorskip("jax", reason="JAX is not installed")
import jax.numpy as jnp  # noqa: E402
import whipcord.jax  # noqa: E402

TENSION = np.array([3.0, 0.5, 1.5])


@pytest.fixture(autouse=True)
def _float64() -> None:
    jax.config.update("jax_enable_x64", True)


def test_an_answer_is_that_of_the_case_to_the_bit() -> None:
    case = loaded()
    answer = whipcord.jax.Solver(case, stations=7)(TENSION)
    solution = case.solve(tension=TENSION, stations=7)
    assert (np.asarray(answer.position) == solution.position).all()
    assert (np.asarray(answer.rotation) == solution.rotation).all()
    assert (np.asarray(answer.length) == solution.length).all()
    assert (np.asarray(answer.tip) == solution.tip).all() and bool(answer.ok)


@pytest.mark.parametrize("compiled", [False, True])
def test_the_gradient_of_the_tip_is_the_exact_jacobian(compiled: bool) -> None:
    solve = whipcord.jax.Solver(loaded(), parameters=PATHS)
    jacobian = jax.jacrev(lambda t, p: solve(t, p).tip, argnums=(0, 1))
    by_tension, by_parameter = (jax.jit(jacobian) if compiled else jacobian)(TENSION, solve.values)
    expected = exact(loaded(), TENSION)
    agree(by_tension, expected[0])
    agree(by_parameter, expected[1])


def test_the_gradient_by_motors_is_that_by_their_parameters() -> None:
    robot = loaded().robot
    spool = whipcord.Motor(name="m", cables=[robot.cables[0].name], spool_radius="5 mm", stiffness="9 N/mm")
    robot = robot.replace(cables=robot.cables[:1], motors=[spool])
    case = whipcord.Case(robot, motors=[0.8])
    solve = whipcord.jax.Solver(case, parameters=["motors[0].stiffness"], actuation="motors")
    by_angle, by_stiffness = jax.jacrev(lambda a, p: solve(a, p).tip, argnums=(0, 1))(np.array([0.8]), solve.values)
    _, derivatives = case.differentiate(parameters=["motors[0].angle", "motors[0].stiffness"])
    agree(np.hstack([by_angle, by_stiffness]), derivatives.position_by_parameter[-1], 1e-11)


def test_a_whole_batch_has_the_gradients_of_its_rows() -> None:
    solve = whipcord.jax.Solver(loaded(), parameters=PATHS)
    rows = TENSION * np.linspace(0.2, 1.0, 6)[:, None]

    def heights(tension: jax.Array, parameters: jax.Array) -> jax.Array:
        return solve(tension, parameters).tip[..., 2].sum()

    expected = [exact(loaded(), row) for row in rows]
    by_tension, by_parameter = jax.grad(heights, argnums=(0, 1))(jnp.array(rows), solve.values)
    agree(by_tension.T, np.array([tension[2] for tension, _ in expected]).T)
    summed = np.sum([parameter[2] for _, parameter in expected], axis=0)
    agree(by_parameter[None], summed[None], 1e-11)
    # Parameters of their own for each row, and rows by vmap.
    own = jnp.broadcast_to(solve.values, (6, len(PATHS)))
    every = jax.jit(jax.vmap(jax.grad(heights, argnums=1)))(rows, own)
    agree(every.T, np.array([parameter[2] for _, parameter in expected]).T)


def test_rows_with_their_own_parameters_are_those_of_their_own_robots() -> None:
    case = loaded()
    solve = whipcord.jax.Solver(case, parameters=PATHS[:2])
    values = solve.values * np.array([[1.0, 1.0], [1.5, 1.0], [1.0, 1.0], [0.8, 0.9]])
    tips = np.asarray(jax.vmap(lambda v: solve(TENSION, v).tip)(values))
    for tip, value in zip(tips, values):
        robot = case.with_parameters(dict(zip(PATHS, value.tolist())))
        # Batches under load agree with single solves to the residual and the error of the steps.
        assert np.allclose(tip, robot.solve(tension=TENSION).tip, rtol=0, atol=1e-9)
    grid = solve(TENSION * np.ones((5, 1, 3)), values)
    assert grid.position.shape == (5, 4, 11, 3)
    assert (np.asarray(grid.tip[3]) == tips).all()


def test_rotations_lengths_and_tensions_have_gradients() -> None:
    case = loaded()
    random = np.random.default_rng(1)
    turns, weights = random.normal(size=(11, 3, 3)), random.normal(size=3)

    def loss(tension: jax.Array, solve: whipcord.jax.Solver) -> jax.Array:
        answer = solve(tension)
        return (turns * answer.rotation).sum() + weights @ (answer.tension + 100 * answer.length)

    solve = whipcord.jax.Solver(case)
    gradient = jax.grad(loss)(jnp.array(TENSION), solve)
    h = 1e-4
    for i, step in enumerate(h * np.eye(3)):
        difference = (loss(TENSION + step, solve) - loss(TENSION - step, solve)) / (2 * h)
        assert abs(gradient[i] - difference) < 1e-6 * np.abs(gradient).max()


def test_a_loss_over_shape_and_parameter_is_that_of_differences() -> None:
    case = whipcord.load("examples/helical-finger.toml")
    path = "cables[0].routing.turns"
    solve = whipcord.jax.Solver(case, parameters=[path], stations=9)
    target = case.with_parameters({path: 0.4}).solve(stations=9).position
    tension = np.array([[1.0], [3.0]])

    @jax.jit
    def loss(turns: jax.Array) -> jax.Array:
        return 1e4 * jnp.mean((solve(tension, turns).position - target) ** 2)

    turns = np.array([0.25])
    h = 1e-4
    difference = (loss(turns + h) - loss(turns - h)) / (2 * h)
    assert abs(jax.grad(loss)(turns)[0] - difference) < 1e-6 * abs(difference)


def test_cables_from_hole_to_hole_are_differentiated_too() -> None:
    case = whipcord.load("examples/helical-finger.toml")
    paths = ["backbone.young_modulus", "cables[0].routing.turns"]
    solve = whipcord.jax.Solver(case, parameters=paths, model="cosserat-disks")
    _, derivatives = case.differentiate(parameters=paths, tension=[2.0], model="cosserat-disks")
    by_tension, by_parameter = jax.jacrev(lambda t, p: solve(t, p).tip, argnums=(0, 1))(jnp.array([2.0]), solve.values)
    agree(by_tension, derivatives.position_by_command[-1])
    agree(by_parameter, derivatives.position_by_parameter[-1])


def test_shortenings_drive_as_well() -> None:
    case = whipcord.load("examples/table1/case-3.toml")
    solve = whipcord.jax.Solver(case, actuation="shortening")
    _, derivatives = case.differentiate(shortening=[0.008])
    agree(jax.jacrev(lambda s: solve(s).tip)(jnp.array([0.008])), derivatives.position_by_command[-1])


def test_a_row_without_an_answer_raises_or_is_flagged() -> None:
    case = whipcord.load("examples/table1/case-3.toml")
    rows = jnp.array([[2.0], [1e6], [3.0]])
    solve = whipcord.jax.Solver(case)
    with pytest.raises(whipcord.errors.SectionFoldsError, match="row 1") as raised:
        solve(rows)
    assert raised.value.row == 1 and raised.value.cable == "pull"
    with pytest.raises(jax.errors.JaxRuntimeError, match="SectionFoldsError: row 1"):
        jax.block_until_ready(jax.jit(solve)(rows))
    flagged = whipcord.jax.Solver(case, on_failure="flag")
    answer, pull_back = jax.vjp(jax.jit(lambda t: flagged(t)[:4]), rows)
    assert flagged(rows).ok.tolist() == [True, False, True]
    assert jnp.isnan(answer[0][1]).all() and jnp.isnan(answer[1][1]).all()
    (gradient,) = pull_back(jax.tree.map(jnp.ones_like, answer))
    assert gradient[1, 0] == 0 and gradient[0, 0] != 0 and jnp.isfinite(gradient).all()

    # A mask on the rows leaves the row out of the loss and of its gradient.
    def loss(tensions: jax.Array) -> jax.Array:
        answer = flagged(tensions)
        return jnp.where(answer.ok, (answer.tip**2).sum(axis=-1), 0.0).sum()

    value, gradient = jax.value_and_grad(loss)(rows)
    assert jnp.isfinite(value) and gradient[1, 0] == 0 and jnp.isfinite(gradient).all()


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (lambda solve: solve(np.ones(2)), r"tension must have the shape \(\.\.\., 3\)"),
        (lambda solve: solve(1.0), r"but has \(\)"),
        (lambda solve: solve(np.ones(3), np.ones(2)), r"parameters must have the shape \(\.\.\., 1\)"),
        (lambda solve: solve(np.ones((2, 3)), np.ones((3, 1))), "do not go together"),
        (lambda solve: solve([1.0, 2.0, -1.0]), "must not be negative"),
        (lambda solve: solve([1.0, np.nan, 1.0]), "must be a finite number"),
    ],
)
def test_what_cannot_be_is_refused(given, says: str) -> None:  # type: ignore[no-untyped-def]
    solve = whipcord.jax.Solver(loaded(), parameters=PATHS[:1])
    with pytest.raises(whipcord.InputError, match=says):
        given(solve)


def test_what_has_no_gradient_is_refused_at_once() -> None:
    with pytest.raises(whipcord.InputError, match="four-bar"):
        whipcord.jax.Solver(loaded(), model="four-bar")
    with pytest.raises(whipcord.InputError, match=r"there is no parameter `backbone\.color`"):
        whipcord.jax.Solver(loaded(), parameters=["backbone.color"])
    with pytest.raises(whipcord.InputError, match="list of paths"):
        whipcord.jax.Solver(loaded(), parameters="backbone.diameter")
    with pytest.raises(whipcord.InputError, match="'raise' or 'flag'"):
        whipcord.jax.Solver(loaded(), on_failure="nan")  # type: ignore[arg-type]


def test_single_precision_is_refused_with_the_remedy() -> None:
    solve = whipcord.jax.Solver(loaded())
    jax.config.update("jax_enable_x64", False)
    with pytest.raises(whipcord.InputError, match="jax_enable_x64"):
        solve(TENSION)


def test_motions_have_the_gradients_of_their_steps() -> None:
    plain = whipcord.Motions(whipcord.load("examples/released-arm.toml"), "5 ms", initial="rest")
    motions = whipcord.jax.Motions(plain)
    commands = np.random.default_rng(5).uniform(0.5, 1.5, (3, 4, 2))

    def number(given: jax.Array) -> jax.Array:
        motion = motions(given)
        return (motion.tip**2).sum() + 1e-2 * (motion.velocity**2).sum() + (motion.strain[..., 3:] ** 2).sum()

    batch = plain(commands)
    assert np.array_equal(motions(commands).position, batch.position)
    seeds = {"position": np.zeros_like(batch.position), "velocity": 2e-2 * batch.velocity}
    seeds["position"][..., -1, :] = 2 * batch.tip
    seeds["strain"] = 2 * batch.strain * np.array([0, 0, 0, 1, 1, 1])
    expected = plain.pull_back(commands, **seeds).command
    for gradient in (jax.grad(number), jax.jit(jax.grad(number)), jax.vmap(jax.grad(number))):
        np.testing.assert_allclose(gradient(commands), expected, rtol=1e-12, atol=1e-14)


def test_motions_have_changes_along_a_direction() -> None:
    plain = whipcord.Motions(whipcord.load("examples/released-arm.toml"), "5 ms", initial="rest")
    motions = whipcord.jax.Motions(plain)
    random = np.random.default_rng(6)
    commands, along = random.uniform(0.5, 1.5, (2, 3, 4, 2))
    expected = plain.push_forward(commands, command=along)
    for push in (jax.jvp, jax.jit(jax.jvp, static_argnums=0)):
        motion, change = push(motions, (commands,), (along,))
        assert np.array_equal(motion.position, plain(commands).position)
        for name in ("position", "velocity", "strain"):
            np.testing.assert_allclose(getattr(change, name), getattr(expected, name), rtol=1e-12, atol=1e-15)
        assert not change.tension.any() and not change.length.any()
    forward = jax.jacfwd(lambda given: motions(given).tip[-1])(commands[0])
    reverse = jax.jacrev(lambda given: motions(given).tip[-1])(commands[0])
    np.testing.assert_allclose(forward, reverse, rtol=1e-9, atol=1e-14)
    # Where one of both is not mapped.
    for of in (jax.vmap(motions.__call__), motions):
        _, change = jax.jvp(lambda given: of(given).position, (commands,), (along,))
        np.testing.assert_allclose(change, expected.position, rtol=1e-12, atol=1e-15)
    one = jax.vmap(lambda given: jax.jvp(motions, (jnp.asarray(commands[0]),), (given,))[1].position)(along)
    many = plain.push_forward(np.broadcast_to(commands[0], along.shape), command=along).position
    np.testing.assert_allclose(one, many, rtol=1e-12, atol=1e-15)
