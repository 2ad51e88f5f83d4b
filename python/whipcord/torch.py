"""The solve as a differentiable function for PyTorch.

Its gradients are the exact derivatives of the answer, not differences, of first order, by ``backward`` and
``torch.autograd``. :class:`Motions` has forward differentiation as well, by ``torch.autograd.forward_ad``, and from PyTorch 2.0 on
by ``torch.func`` (``jvp``, ``jacfwd``, ``jacrev``, ``vmap``), which cannot see through :class:`Solver`. Computed in float64 on the processor;
other tensors are converted, and their gradients come back in their own type and on their own device. Needs the
package torch (``pip install "whipcord[torch]"``).

>>> import torch
>>> import whipcord
>>> import whipcord.torch
>>> case = whipcord.load("examples/table1/case-3.toml")
>>> solve = whipcord.torch.Solver(case)
>>> tension = torch.tensor([2.0], dtype=torch.float64, requires_grad=True)
>>> solve(tension).tip[2].backward()
>>> tension.grad.shape
torch.Size([1])
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

try:
    import torch
    from torch.autograd.function import once_differentiable
except ImportError as error:
    raise ImportError('whipcord.torch needs the package torch: pip install "whipcord[torch]"') from error

from ._differentiable import Problem, SolverBase

if TYPE_CHECKING:
    import whipcord

__all__ = ["Answer", "Motions", "Solver", "Trajectory"]


class Answer(NamedTuple):
    """What :class:`Solver` returns, with the leading dimensions of what was asked."""

    position: torch.Tensor
    """(..., n, 3) positions of the stations in m."""
    rotation: torch.Tensor
    """(..., n, 3, 3) rotation matrices of the stations; their columns are the axes of the cross-sections."""
    tension: torch.Tensor
    """(..., c) tensions of the cables in N; zero from a model that knows no forces."""
    length: torch.Tensor
    """(..., c) lengths of the cables inside the robot in m."""
    ok: torch.Tensor
    """(...) whether there is an answer; the others are NaN where there is none."""

    @property
    def tip(self) -> torch.Tensor:
        """(..., 3) position of the last station in m: of the tip, where the stations reach it."""
        return self.position[..., -1, :]


class Solver(SolverBase):
    """A case as a function of its commands and of chosen parameters.

    Parameters
    ----------
    case
        The case; its loads and base hold for all answers.
    parameters
        Paths of quantities of robot and loads (:meth:`whipcord.Case.parameter`).
    actuation
        ``"tension"`` in N, ``"shortening"`` in m, or ``"motors"`` in rad or m: what the commands are.
    model, stations
        As for :meth:`whipcord.Case.solve`.
    on_failure
        ``"raise"`` a :class:`whipcord.SolveError` that names the row, or ``"flag"`` the rows without an answer in
        ``ok``: their numbers are NaN and their gradients zero.

    Examples
    --------
    >>> import whipcord
    >>> solve = Solver(whipcord.load("examples/table1/case-3.toml"), stations=37)
    >>> answer = solve(torch.linspace(1, 4, 100)[:, None])
    >>> answer.position.shape
    torch.Size([100, 37, 3])
    """

    @property
    def values(self) -> torch.Tensor:
        """(p,) the values of the parameters in the case: where an optimisation may start."""
        return torch.tensor(self._problem.values)

    def __call__(self, commands: torch.Tensor, parameters: torch.Tensor | None = None) -> Answer:
        """Solves.

        Parameters
        ----------
        commands
            (..., c) tension in N or shortening in m of each cable, or (..., m) command of each motor.
        parameters
            (..., p) values of the parameters; those of the case by default. Leading dimensions are broadcast.
            Rows with the same parameters are solved as one batch: prefer (p,) to many copies of it.
        """
        given = self.values if parameters is None else parameters
        arguments = (torch.as_tensor(value).to("cpu", torch.float64) for value in (commands, given))
        answer = _Solve.apply(self._problem, *arguments)
        return Answer(*(part.to(torch.as_tensor(commands).device) for part in answer))


class _Solve(torch.autograd.Function):  # type: ignore[misc, unused-ignore]
    @staticmethod
    def forward(ctx: Any, problem: Problem, commands: torch.Tensor, parameters: torch.Tensor) -> Any:
        answer = problem.solve(commands.detach().numpy(), parameters.detach().numpy())
        parts = tuple(map(torch.from_numpy, map(np.asarray, answer)))
        ctx.problem = problem
        ctx.save_for_backward(commands, parameters, parts[4], parts[1])
        ctx.mark_non_differentiable(parts[4])
        return parts

    @staticmethod
    @once_differentiable  # type: ignore[untyped-decorator]
    def backward(ctx: Any, *weights: torch.Tensor) -> Any:
        kept = ctx.saved_tensors
        arrays = (tensor.detach().numpy() for tensor in (*kept, *weights[:4]))
        gradients = ctx.problem.pull_back(*arrays)
        by_commands, by_parameters = (
            torch.from_numpy(gradient).sum_to_size(of.shape) for gradient, of in zip(gradients, kept)
        )
        return None, by_commands, by_parameters


class Trajectory(NamedTuple):
    """What :class:`Motions` returns, with the leading dimensions of its commands: a row for each state, the first of them at the start."""

    position: torch.Tensor
    """(..., N + 1, n, 3) positions of the nodes in m, in the world."""
    velocity: torch.Tensor
    """(..., N + 1, n, 6) velocities of the nodes in their own frames, in m/s and rad/s."""
    strain: torch.Tensor
    """(..., N + 1, q, 6) strains at the two points of each element, of translation and in 1/m."""
    tension: torch.Tensor
    """(..., N + 1, c) tensions of the cables in N; without gradients."""
    length: torch.Tensor
    """(..., N + 1, c) lengths of the cables inside the robot in m; without gradients."""

    @property
    def tip(self) -> torch.Tensor:
        """(..., N + 1, 3) positions of the tip in m."""
        return self.position[..., -1, :]


class Motions:
    """How a robot moves, as a function of its commands, which are constant in each step.

    Parameters
    ----------
    motions
        The robot in motion.

    Examples
    --------
    >>> import whipcord
    >>> motions = Motions(whipcord.Motions(whipcord.load("examples/released-arm.toml"), "10 ms"))
    >>> tension = torch.ones((10, 2), dtype=torch.float64, requires_grad=True)
    >>> motions(tension).tip[-1, 0].backward()
    >>> tension.grad.shape
    torch.Size([10, 2])

    Along one direction, here of the second cable, by forward differentiation:

    >>> import torch.autograd.forward_ad
    >>> direction = torch.zeros(10, 2, dtype=torch.float64)
    >>> direction[:, 1] = 1.0
    >>> with torch.autograd.forward_ad.dual_level():
    ...     motion = motions(torch.autograd.forward_ad.make_dual(tension.detach(), direction))
    ...     change = torch.autograd.forward_ad.unpack_dual(motion.tip).tangent
    >>> change.shape
    torch.Size([11, 3])
    """

    def __init__(self, motions: whipcord.Motions) -> None:
        self._motions = motions

    def __call__(self, commands: torch.Tensor) -> Trajectory:
        """Simulates.

        Parameters
        ----------
        commands
            (..., N, c) command of each cable in each step, or (..., N, m) of each motor.
        """
        given = torch.as_tensor(commands)
        motion = _Move.apply(self._motions, given.to("cpu", torch.float64))
        return Trajectory(*(part.to(given.device) for part in motion))


# From 2.0 on both parts of ``forward`` are apart, so that ``torch.func`` sees through it.
_IS_SPLIT = hasattr(torch.autograd.Function, "setup_context")


def _arrays(*tensors: torch.Tensor) -> tuple[Any, ...]:
    return tuple(tensor.detach().numpy() for tensor in tensors)


def _tensors(*arrays: Any) -> tuple[torch.Tensor, ...]:
    return tuple(torch.from_numpy(np.array(array)) for array in arrays)


def _of_motions(cls: Any) -> Any:
    """A function of motions and of tensors with any leading dimensions, from what it computes; its inputs are kept for its derivatives."""
    compute = cls.compute

    def keep(ctx: Any, inputs: Any, output: Any) -> None:
        ctx.motions, *given = inputs
        ctx.save_for_backward(*given)
        ctx.save_for_forward(*given)
        if cls.constant:
            ctx.mark_non_differentiable(*output[-cls.constant :])

    def whole(ctx: Any, *inputs: Any) -> Any:
        output = compute(*inputs)
        keep(ctx, inputs, output)
        return output

    def mapped(info: Any, dims: Any, motions: whipcord.Motions, *given: torch.Tensor) -> Any:
        rows = [
            of.expand(info.batch_size, *of.shape) if dim is None else of.movedim(dim, 0)
            for of, dim in zip(given, dims[1:])
        ]
        found = cls.apply(motions, *rows)
        return found, (0,) * len(found) if isinstance(found, tuple) else 0

    if _IS_SPLIT:
        cls.forward, cls.setup_context, cls.vmap = map(staticmethod, (compute, keep, mapped))
    else:
        cls.forward = staticmethod(whole)
    return cls


@_of_motions
class _Move(torch.autograd.Function):  # type: ignore[misc, unused-ignore]
    # Tensions and lengths have no derivatives.
    constant = 2

    @staticmethod
    def compute(motions: whipcord.Motions, commands: torch.Tensor) -> Any:
        found = motions(*_arrays(commands))
        return _tensors(found.position, found.velocity, found.strain, found.tension, found.length)

    @staticmethod
    def backward(ctx: Any, *weights: torch.Tensor) -> Any:
        return None, _Pull.apply(ctx.motions, *ctx.saved_tensors, *weights[:3])

    @staticmethod
    def jvp(ctx: Any, _: Any, changes: torch.Tensor) -> Any:
        (commands,) = ctx.saved_tensors
        *lead, steps, _ = commands.shape
        # What has no derivatives has no change, or before 2.0 one of zero.
        shapes = ctx.motions.shapes(steps)[3:]
        still = [None if _IS_SPLIT else changes.new_zeros((*lead, *shape)) for shape in shapes]
        return *_Push.apply(ctx.motions, commands, changes), *still


@_of_motions
class _Push(torch.autograd.Function):  # type: ignore[misc, unused-ignore]
    """What a motion changes by, for commands and their changes."""

    constant = 0

    @staticmethod
    def compute(motions: whipcord.Motions, *given: torch.Tensor) -> Any:
        commands, changes = _arrays(*given)
        found = motions.push_forward(commands, command=changes)
        return _tensors(found.position, found.velocity, found.strain)

    @staticmethod
    def backward(ctx: Any, *weights: torch.Tensor) -> Any:
        raise NotImplementedError(_FIRST_ORDER)


@_of_motions
class _Pull(torch.autograd.Function):  # type: ignore[misc, unused-ignore]
    """The transpose: derivatives by the commands, for these and the derivatives by the motion."""

    constant = 0

    @staticmethod
    def compute(motions: whipcord.Motions, *given: torch.Tensor) -> Any:
        commands, position, velocity, strain = _arrays(*given)
        found = motions.pull_back(commands, position=position, velocity=velocity, strain=strain)
        return torch.from_numpy(found.command.copy())

    @staticmethod
    def backward(ctx: Any, *weights: torch.Tensor) -> Any:
        raise NotImplementedError(_FIRST_ORDER)


_FIRST_ORDER = "whipcord.torch has derivatives of first order; take differences of them for those of second order"
