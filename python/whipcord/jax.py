"""The solve as a differentiable function for JAX.

Its gradients are the exact derivatives of the answer, not differences. It goes through ``jax.jit``, ``jax.vmap`` and
reverse differentiation of first order (``jax.grad``, ``jax.vjp``, ``jax.jacrev``), motions through forward
differentiation as well (``jax.jvp``, ``jax.jacfwd``); the mechanics run on the processor. Needs
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
    from jax.extend.core import Primitive
    from jax.interpreters import ad, batching, mlir
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

    Along one direction, here of the second cable, by forward differentiation:

    >>> tension, direction = jnp.full((10, 2), 1.0), jnp.zeros((10, 2)).at[:, 1].set(1.0)
    >>> motion, change = jax.jvp(motions, (tension,), (direction,))
    >>> change.tip.shape
    (11, 3)
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


@partial(jax.custom_jvp, nondiff_argnums=(0,))
def _move(motions: whipcord.Motions, commands: jax.Array) -> Any:
    def simulate(given: Any) -> Any:
        found = motions(given)
        return found.position, found.velocity, found.strain, found.tension, found.length

    return _ask(simulate, tuple(map(_floats, motions.shapes(commands.shape[-2]))), commands)


@_move.defjvp
def _change_of_motion(motions: whipcord.Motions, commands: Any, changes: Any) -> Any:
    answer = _move(motions, *commands)
    # Tensions and lengths have no derivatives.
    still = [jnp.zeros_like(of) for of in answer[3:]]
    return answer, (*_push_p.bind(*commands, *changes, motions=motions), *still)  # type: ignore[no-untyped-call]


# What a motion changes by, for commands and their changes, and its transpose: derivatives by the commands, for these
# and the derivatives by the motion. Both are primitives, linear in what follows the commands, and take any leading
# dimensions; so forward and reverse differentiation go through the same rule.
_push_p = Primitive("whipcord_motion_push_forward")
_push_p.multiple_results = True
_pull_p = Primitive("whipcord_motion_pull_back")


def _push(commands: jax.Array, changes: jax.Array, *, motions: whipcord.Motions) -> Any:
    def push(given: Any, along: Any) -> Any:
        found = motions.push_forward(np.asarray(given), command=np.asarray(along))
        return found.position, found.velocity, found.strain

    return jax.pure_callback(push, _of_motion(motions, commands.shape), commands, changes)


def _pull(commands: jax.Array, *weights: jax.Array, motions: whipcord.Motions) -> jax.Array:
    def pull(given: Any, *by: Any) -> Any:
        position, velocity, strain = (np.asarray(of) for of in by)
        return motions.pull_back(np.asarray(given), position=position, velocity=velocity, strain=strain).command

    found: jax.Array = jax.pure_callback(pull, _floats(commands.shape), commands, *weights)
    return found


def _of_motion(motions: whipcord.Motions, shape: tuple[int, ...]) -> list[Any]:
    """Position, velocity and strain of a motion under commands of this shape."""
    *lead, steps, _ = shape
    return [_floats((*lead, *of)) for of in motions.shapes(steps)[:3]]


def _batched(primitive: Any, args: Any, dims: Any, **parameters: Any) -> Any:
    size = next(of.shape[dim] for of, dim in zip(args, dims) if dim is not None)

    def moved(of: Any, dim: Any) -> Any:
        return jnp.broadcast_to(of, (size, *of.shape)) if dim is None else jnp.moveaxis(of, dim, 0)

    found = primitive.bind(*map(moved, args, dims), **parameters)
    return found, [0] * len(found) if primitive.multiple_results else 0


def _abstract(of: Any) -> Any:
    return jax.core.ShapedArray(of.shape, of.dtype)


def _push_transposed(weights: Any, commands: Any, changes: Any, *, motions: whipcord.Motions) -> Any:
    shapes = _of_motion(motions, commands.shape)
    whole = [jnp.zeros(of.shape) if isinstance(by, ad.Zero) else by for of, by in zip(shapes, weights)]
    return None, _pull_p.bind(commands, *whole, motions=motions)  # type: ignore[no-untyped-call]


for _primitive, _work in ((_push_p, _push), (_pull_p, _pull)):
    _primitive.def_impl(_work)  # type: ignore[no-untyped-call]
    batching.primitive_batchers[_primitive] = partial(_batched, _primitive)
    mlir.register_lowering(_primitive, mlir.lower_fun(_work, multiple_results=_primitive.multiple_results))
_push_p.def_abstract_eval(  # type: ignore[no-untyped-call]
    lambda commands, _, *, motions: [*map(_abstract, _of_motion(motions, commands.shape))]
)
_pull_p.def_abstract_eval(lambda commands, *_, motions: _abstract(commands))  # type: ignore[no-untyped-call]
ad.primitive_transposes[_push_p] = _push_transposed


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
