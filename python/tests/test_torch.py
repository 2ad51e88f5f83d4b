"""The solve as a differentiable function for PyTorch."""

from __future__ import annotations

import numpy as np
import pytest
import whipcord

from .differentiable import PATHS, agree, exact, loaded

torch = pytest.importorskip("torch", reason="PyTorch is not installed")

import whipcord.torch  # noqa: E402

TENSION = [3.0, 0.5, 1.5]


def wanted(values: object) -> torch.Tensor:
    return torch.tensor(values, dtype=torch.float64, requires_grad=True)


def test_an_answer_is_that_of_the_case_to_the_bit() -> None:
    case = loaded()
    answer = whipcord.torch.Solver(case, stations=7)(torch.tensor(TENSION))
    solution = case.solve(tension=TENSION, stations=7)
    assert (answer.position.numpy() == solution.position).all()
    assert (answer.rotation.numpy() == solution.rotation).all()
    assert (answer.length.numpy() == solution.length).all()
    assert (answer.tip.numpy() == solution.tip).all() and bool(answer.ok)


def test_the_gradient_of_the_tip_is_the_exact_jacobian() -> None:
    solve = whipcord.torch.Solver(loaded(), parameters=PATHS)
    arguments = (wanted(TENSION), solve.values.requires_grad_())
    jacobian = torch.autograd.functional.jacobian(lambda t, p: solve(t, p).tip, arguments)
    for found, expected in zip(jacobian, exact(loaded(), np.array(TENSION))):
        agree(found.numpy(), expected)


def test_a_batch_has_the_gradients_of_its_rows() -> None:
    solve = whipcord.torch.Solver(loaded(), parameters=PATHS)
    rows = wanted(np.array(TENSION) * np.linspace(0.2, 1.0, 6)[:, None])
    parameters = solve.values.requires_grad_()
    solve(rows, parameters).tip[:, 2].sum().backward()
    expected = [exact(loaded(), row) for row in rows.detach().numpy()]
    agree(rows.grad.numpy().T, np.array([tension[2] for tension, _ in expected]).T)
    summed = np.sum([parameter[2] for _, parameter in expected], axis=0)
    agree(parameters.grad.numpy()[None], summed[None], 1e-11)
    own = wanted(np.broadcast_to(solve.values.numpy(), (6, len(PATHS))))
    solve(rows, own).tip[:, 2].sum().backward()
    agree(own.grad.numpy().T, np.array([parameter[2] for _, parameter in expected]).T)


def test_all_outputs_pass_the_check_of_pytorch_itself() -> None:
    # Tensions and a force: one step of differences suits them all.
    solve = whipcord.torch.Solver(loaded(), parameters=["loads.tip_force[0]"])
    inputs = (wanted(TENSION), solve.values.requires_grad_())
    assert torch.autograd.gradcheck(lambda t, p: solve(t, p)[:4], inputs, eps=1e-5, rtol=1e-5, atol=1e-7)


def test_a_loss_goes_down_along_its_gradient() -> None:
    case = whipcord.load("examples/helical-finger.toml")
    path = "cables[0].routing.turns"
    solve = whipcord.torch.Solver(case, parameters=[path])
    target = torch.tensor(case.with_parameters({path: 0.4}).solve(tension=[3.0]).position.copy())
    turns = solve.values.requires_grad_()
    optimizer = torch.optim.LBFGS([turns], tolerance_grad=1e-12, line_search_fn="strong_wolfe")

    def loss() -> torch.Tensor:
        optimizer.zero_grad()
        value = 1e4 * ((solve(torch.tensor([3.0]), turns).position - target) ** 2).mean()
        value.backward()
        return value

    optimizer.step(loss)
    assert abs(turns.item() - 0.4) < 1e-6


def test_single_precision_is_converted_and_its_gradient_comes_back_in_kind() -> None:
    solve = whipcord.torch.Solver(loaded())
    tension = torch.tensor(TENSION, dtype=torch.float32, requires_grad=True)
    tip = solve(tension).tip
    tip[2].backward()
    assert tip.dtype == torch.float64 and tension.grad.dtype == torch.float32
    expected = exact(loaded(), np.array(TENSION))[0][2]
    assert np.allclose(tension.grad.numpy(), expected, rtol=1e-6)


def test_a_row_without_an_answer_raises_or_is_flagged() -> None:
    case = whipcord.load("examples/table1/case-3.toml")
    rows = wanted([[2.0], [1e6], [3.0]])
    with pytest.raises(whipcord.errors.SectionFoldsError, match="row 1") as raised:
        whipcord.torch.Solver(case)(rows)
    assert raised.value.row == 1
    answer = whipcord.torch.Solver(case, on_failure="flag")(rows)
    assert answer.ok.tolist() == [True, False, True]
    (answer.tip.sum() + answer.length.sum() + answer.rotation.sum()).backward()
    assert rows.grad[1, 0] == 0 and rows.grad[0, 0] != 0 and torch.isfinite(rows.grad).all()
    assert torch.isnan(answer.tip[1]).all() and torch.isnan(answer.length[1]).all()
    # A mask on the rows leaves the row out of the loss and of its gradient.
    rows.grad = None
    answer = whipcord.torch.Solver(case, on_failure="flag")(rows)
    loss = torch.where(answer.ok, (answer.tip**2).sum(dim=-1), 0.0).sum()
    loss.backward()
    assert torch.isfinite(loss) and rows.grad[1, 0] == 0 and torch.isfinite(rows.grad).all()


def test_what_cannot_be_is_refused() -> None:
    solve = whipcord.torch.Solver(loaded())
    for given, says in (
        (torch.ones(2), r"tension must have the shape \(\.\.\., 3\)"),
        (torch.tensor([1.0, float("nan"), 1.0]), "must be a finite number"),
        (torch.tensor([1.0, 1.0, -1.0]), "must not be negative"),
    ):
        with pytest.raises(whipcord.InputError, match=says):
            solve(given)


def test_motions_have_the_gradients_of_their_steps() -> None:
    plain = whipcord.Motions(whipcord.load("examples/released-arm.toml"), "5 ms", initial="rest")
    commands = np.random.default_rng(5).uniform(0.5, 1.5, (3, 4, 2))
    given = wanted(commands)
    motion = whipcord.torch.Motions(plain)(given)
    batch = plain(commands)
    assert np.array_equal(motion.position.detach().numpy(), batch.position)
    (motion.tip[..., 0].sum() + motion.velocity.square().sum()).backward()
    position = np.zeros_like(batch.position)
    position[..., -1, 0] = 1.0
    expected = plain.pull_back(commands, position=position, velocity=2 * batch.velocity).command
    np.testing.assert_allclose(given.grad.numpy(), expected, rtol=1e-12, atol=1e-14)


def test_motions_have_changes_along_a_direction() -> None:
    from torch.autograd import forward_ad

    plain = whipcord.Motions(whipcord.load("examples/released-arm.toml"), "5 ms", initial="rest")
    motions = whipcord.torch.Motions(plain)
    commands, along = np.random.default_rng(6).uniform(0.5, 1.5, (2, 3, 4, 2))
    expected = plain.push_forward(commands, command=along)
    with forward_ad.dual_level():
        motion = motions(forward_ad.make_dual(torch.tensor(commands), torch.tensor(along)))
        assert np.array_equal(motion.position.numpy(), plain(commands).position)
        for name in ("position", "velocity", "strain"):
            change = forward_ad.unpack_dual(getattr(motion, name)).tangent.numpy()
            np.testing.assert_allclose(change, getattr(expected, name), rtol=1e-12, atol=1e-15)
        still = forward_ad.unpack_dual(motion.tension).tangent
        assert still is None or not still.any()
    given = wanted(commands)
    (slope,) = torch.autograd.grad(motions(given).tip.sum(), given, create_graph=True)
    with pytest.raises(NotImplementedError, match="first order"):
        slope.sum().backward()


@pytest.mark.skipif(not hasattr(torch, "func"), reason="torch.func comes with PyTorch 2.0")
def test_torch_func_sees_through_motions() -> None:
    plain = whipcord.Motions(whipcord.load("examples/released-arm.toml"), "5 ms", initial="rest")
    motions = whipcord.torch.Motions(plain)
    commands, along = (torch.tensor(of) for of in np.random.default_rng(7).uniform(0.5, 1.5, (2, 3, 4, 2)))
    expected = plain.push_forward(commands.numpy(), command=along.numpy()).position
    _, change = torch.func.jvp(lambda given: motions(given).position, (commands,), (along,))
    np.testing.assert_allclose(change.numpy(), expected, rtol=1e-12, atol=1e-15)
    each = torch.func.vmap(lambda a, b: torch.func.jvp(lambda given: motions(given).position, (a,), (b,))[1])
    np.testing.assert_allclose(each(commands, along).numpy(), expected, rtol=1e-12, atol=1e-15)
    forward = torch.func.jacfwd(lambda given: motions(given).tip[-1])(commands[0])
    reverse = torch.func.jacrev(lambda given: motions(given).tip[-1])(commands[0])
    np.testing.assert_allclose(forward.numpy(), reverse.numpy(), rtol=1e-9, atol=1e-14)
