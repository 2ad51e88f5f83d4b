"""The solve as a differentiable function for JAX.

Its gradients are the exact derivatives of the answer, not differences. It goes through ``jax.jit``, ``jax.vmap`` and
reverse differentiation of first order (``jax.grad``, ``jax.vjp``, ``jax.jacrev``); the mechanics run on the processor. Needs
the package jax (``pip install "whipcord[jax]"``) and its 64-bit mode.

>>> import jax
>>> import jax.numpy as jnp
>>> import whipcord
>>> import whipcord.jax
>>> jax.config.update("jax_enable_x64", True)
>>> case = whipcord.load("examples/table1/case-3.toml")
>>> solve = whipcord.jax.Solver(case, parameters=["backbone.diameter"])
>>> height = lambda tension, diameter: solve(tension, diameter).tip[2]
>>> slopes = jax.grad(height, argnums=(0, 1))(jnp.array([2.0]), jnp.array([0.003]))
>>> [slope.shape for slope in slopes]
[(1,), (1,)]
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

try:
    import jax
    import jax.numpy as jnp
except ImportError as error:
    raise ImportError('whipcord.jax needs the package jax: pip install "whipcord[jax]"') from error

from ._differentiable import Problem, SolverBase
from .errors import InputError

if TYPE_CHECKING:
    import whipcord

__all__ = ["Answer", "Motions", "Solver", "Trajectory"]


class Answer(NamedTuple):
    """What :class:`Solver` returns, with the leading dimensions of what was asked."""

    position: jax.Array
    """(..., n, 3) positions of the stations in m."""
    rotation: jax.Array
    """(..., n, 3, 3) rotation matrices of the stations; their columns are the axes of the cross-sections."""
    tension: jax.Array
    """(..., c) tensions of the cables in N; zero from a model that knows no forces."""
    length: jax.Array
    """(..., c) lengths of the cables inside the robot in m."""
    ok: jax.Array
    """(...) whether there is an answer; the others are NaN where there is none."""

    @property
    def tip(self) -> jax.Array:
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
        ``ok``: their numbers are NaN and their gradients zero. Where JAX runs the solve, within ``jit``, ``vmap`` or a
        gradient, the error comes as a ``jax.errors.JaxRuntimeError`` that quotes it.

    Examples
    --------
    >>> import whipcord
    >>> solve = Solver(whipcord.load("examples/table1/case-3.toml"), stations=37)
    >>> answer = solve(np.linspace(1, 4, 100)[:, None])
    >>> answer.position.shape
    (100, 37, 3)
    """

    @property
    def values(self) -> npt.NDArray[np.float64]:
        """(p,) the values of the parameters in the case: where an optimisation may start."""
        return self._problem.values.copy()

    def __call__(self, commands: Any, parameters: Any = None) -> Answer:
        """Solves.

        Parameters
        ----------
        commands
            (..., c) tension in N or shortening in m of each cable, or (..., m) command of each motor.
        parameters
            (..., p) values of the parameters; those of the case by default. Leading dimensions are broadcast.
            Rows with the same parameters are solved as one batch: prefer (p,) to many copies of it.
        """
        commands = _commands(commands)
        given = self._problem.values if parameters is None else parameters
        parameters = jnp.asarray(given, dtype=jnp.float64)
        self._problem.check(commands.shape, parameters.shape)
        if not isinstance(commands, jax.core.Tracer) and not isinstance(parameters, jax.core.Tracer):
            # Outside of any transformation errors arrive as they are.
            return Answer(*map(jnp.asarray, self._problem.solve(commands, parameters)))
        rowwise = jnp.vectorize(partial(_solve, self._problem), signature="(m),(p)->(n,i),(n,j,k),(c),(c),()")
        return Answer(*rowwise(commands, parameters))


class Trajectory(NamedTuple):
    """What :class:`Motions` returns, with the leading dimensions of its commands: a row for each state, the first of them at the start."""

    position: jax.Array
    """(..., N + 1, n, 3) positions of the nodes in m, in the world."""
    velocity: jax.Array
    """(..., N + 1, n, 6) velocities of the nodes in their own frames, in m/s and rad/s."""
    strain: jax.Array
    """(..., N + 1, q, 6) strains at the two points of each element, of translation and in 1/m."""
    tension: jax.Array
    """(..., N + 1, c) tensions of the cables in N; without gradients."""
    length: jax.Array
    """(..., N + 1, c) lengths of the cables inside the robot in m; without gradients."""

    @property
    def tip(self) -> jax.Array:
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
    >>> jax.config.update("jax_enable_x64", True)
    >>> motions = Motions(whipcord.Motions(whipcord.load("examples/released-arm.toml"), "10 ms"))
    >>> slope = jax.grad(lambda tension: motions(tension).tip[-1, 0])(jnp.full((10, 2), 1.0))
    >>> slope.shape
    (10, 2)
    """

    def __init__(self, motions: whipcord.Motions) -> None:
        self._motions = motions

    def __call__(self, commands: Any) -> Trajectory:
        """Simulates.

        Parameters
        ----------
        commands
            (..., N, c) command of each cable in each step, or (..., N, m) of each motor.
        """
        move = jnp.vectorize(partial(_move, self._motions), signature="(s,c)->(t,n,i),(t,n,j),(t,q,j),(t,k),(t,k)")
        return Trajectory(*move(_commands(commands)))


def _commands(commands: Any) -> jax.Array:
    if not jax.config.jax_enable_x64:  # type: ignore[attr-defined]
        message = (
            "whipcord.jax computes in float64, which JAX has not switched on: call "
            'jax.config.update("jax_enable_x64", True) before anything else'
        )
        raise InputError(message, path="commands")
    return jnp.asarray(commands, dtype=jnp.float64)


@partial(jax.custom_vjp, nondiff_argnums=(0,))
def _move(motions: whipcord.Motions, commands: jax.Array) -> Any:
    def simulate(given: Any) -> Any:
        found = motions(given)
        return found.position, found.velocity, found.strain, found.tension, found.length

    return _ask(simulate, tuple(map(_floats, motions.shapes(commands.shape[-2]))), commands)


def _forward_motion(motions: whipcord.Motions, commands: jax.Array) -> Any:
    return _move(motions, commands), commands


def _backward_motion(motions: whipcord.Motions, commands: jax.Array, weights: Any) -> Any:
    def pull_back(given: Any, position: Any, velocity: Any, strain: Any) -> Any:
        arrays = [np.asarray(array) for array in (given, position, velocity, strain)]
        # What is not mapped has one row where the others have many.
        inner = (2, 3, 3, 3)
        lead = np.broadcast_shapes(*(array.shape[: array.ndim - k] for array, k in zip(arrays, inner)))
        whole = [np.broadcast_to(a, (*lead, *a.shape[a.ndim - k :])) for a, k in zip(arrays, inner)]
        return motions.pull_back(whole[0], position=whole[1], velocity=whole[2], strain=whole[3]).command

    return (_ask(pull_back, _floats(commands.shape), commands, *weights[:3]),)


_move.defvjp(_forward_motion, _backward_motion)


@partial(jax.custom_vjp, nondiff_argnums=(0,))
def _solve(problem: Problem, commands: jax.Array, parameters: jax.Array) -> Any:
    """One row; batches come by vmap, which hands the callback all rows at once."""
    stations, cables = len(problem.arc_length), problem.cables
    sizes = ((stations, 3), (stations, 3, 3), (cables,), (cables,))
    shapes = (*map(_floats, sizes), jax.ShapeDtypeStruct((), jnp.bool_))  # type: ignore[no-untyped-call]
    return _ask(lambda *given: tuple(problem.solve(*given)), shapes, commands, parameters)


def _forward(problem: Problem, commands: jax.Array, parameters: jax.Array) -> Any:
    answer = _solve(problem, commands, parameters)
    _, turns, _, _, ok = answer
    return answer, (commands, parameters, ok, turns)


def _backward(problem: Problem, kept: Any, weights: Any) -> Any:
    commands, parameters, _, _ = kept
    shapes = (_floats(commands.shape), _floats(parameters.shape))
    return _ask(problem.pull_back, shapes, *kept, *weights[:4])


def _floats(shape: tuple[int, ...]) -> Any:
    return jax.ShapeDtypeStruct(shape, jnp.float64)  # type: ignore[no-untyped-call]


def _ask(function: Callable[..., Any], shapes: Any, *arguments: jax.Array) -> Any:
    # With dimensions of one for what is not mapped, rows that share their parameters stay together.
    return jax.pure_callback(function, shapes, *arguments, vmap_method="expand_dims")


_solve.defvjp(_forward, _backward)
