"""The solve and its vector–Jacobian product on arrays: what the wrappers of JAX and PyTorch share."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Union

import numpy as np
import numpy.typing as npt

from ._commands import paths
from .batch import Batch, Gradients
from .errors import InputError
from .models import ModelLike, StationsLike
from .solution import rotation

if TYPE_CHECKING:
    from .case import Case

__all__ = ["Arrays", "Problem", "SolverBase"]

Array = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]


class Arrays(NamedTuple):
    """Answers with the leading dimensions of what was asked; NaN where there is none."""

    position: Array
    """(..., n, 3) in m."""
    rotation: Array
    """(..., n, 3, 3)."""
    tension: Array
    """(..., c) in N."""
    length: Array
    """(..., c) in m."""
    ok: Flags
    """(...) whether there is an answer."""


class Problem:
    """What is solved, and by what it is differentiated.

    Leading dimensions of commands and parameters are broadcast as in NumPy. Rows that share their
    parameters are solved as one batch.
    """

    def __init__(
        self,
        case: Case,
        parameters: Sequence[str],
        actuation: Literal["tension", "shortening", "motors"],
        model: ModelLike,
        stations: StationsLike,
        on_failure: Literal["raise", "flag"],
    ) -> None:
        for name, value, choices in (
            ("actuation", actuation, ("tension", "shortening", "motors")),
            ("on_failure", on_failure, ("raise", "flag")),
        ):
            if value not in choices:
                message = f"{name} must be {' or '.join(map(repr, choices))}, but is {value!r}"
                raise InputError(message, path=name)
        self.case, self.parameters, self.actuation = case, tuple(paths(parameters)), actuation
        self.model, self.stations, self.raises = model, stations, on_failure == "raise"
        self.cables = len(case.robot.cables)
        self.commands = len(case.robot.motors) if actuation == "motors" else self.cables
        self.values = np.array([case.parameter(path) for path in self.parameters], dtype=np.float64)
        # A model without derivatives, and a path that cannot change, are refused now rather than by a gradient.
        nothing = np.zeros((0, self.commands))
        self.arc_length = self._batch(self._case(self.values), nothing).arc_length
        driven: dict[str, Any] = {actuation: nothing}
        case.pull_back_batch(**driven, parameters=self.parameters, model=model, stations=stations)

    def check(self, commands: tuple[int, ...], parameters: tuple[int, ...]) -> tuple[int, ...]:
        """The leading dimensions of the answer to arrays of these shapes."""
        for name, shape, width, what in (
            (self.actuation, commands, self.commands, "motor" if self.actuation == "motors" else "cable"),
            ("parameters", parameters, len(self.parameters), "path"),
        ):
            if len(shape) < 1 or shape[-1] != width:
                message = f"{name} must have the shape (..., {width}), one for each {what}, but has {shape}"
                raise InputError(message, path=name)
        try:
            return np.broadcast_shapes(commands[:-1], parameters[:-1])
        except ValueError:
            message = f"the leading dimensions of {commands} and {parameters} do not go together"
            raise InputError(message, path="parameters") from None

    def solve(self, commands: npt.ArrayLike, parameters: npt.ArrayLike) -> Arrays:
        """The answers to commands (..., c) and parameters (..., p)."""
        commands, parameters = np.asarray(commands), np.asarray(parameters)
        lead = self.check(commands.shape, parameters.shape)
        count, stations = int(np.prod(lead)), len(self.arc_length)
        position = np.full((count, stations, 3), np.nan)
        turns = np.full((count, stations, 3, 3), np.nan)
        tension, length = np.full((2, count, self.cables), np.nan)
        ok = np.zeros(count, dtype=np.bool_)
        everywhere = np.arange(count)
        for rows, case, given in self._groups(lead, everywhere, commands, parameters):
            batch = self._batch(case, given)
            if self.raises:
                self._raise(batch, rows, lead)
            ok[rows] = batch.ok
            position[rows], tension[rows], length[rows] = batch.position, batch.tension, batch.length
            turns[rows] = rotation(batch.orientation)
        return Arrays(
            position.reshape(*lead, stations, 3),
            turns.reshape(*lead, stations, 3, 3),
            tension.reshape(*lead, self.cables),
            length.reshape(*lead, self.cables),
            ok.reshape(lead),
        )

    def pull_back(
        self,
        commands: npt.ArrayLike,
        parameters: npt.ArrayLike,
        answered: npt.ArrayLike,
        turns: npt.ArrayLike,
        position: npt.ArrayLike,
        rotation: npt.ArrayLike,
        tension: npt.ArrayLike,
        length: npt.ArrayLike,
    ) -> tuple[Array, Array]:
        """The gradients of a scalar by the commands (..., c) and parameters (..., p) of each row.

        `answered` and `turns` are the flags and rotations of the answers, the others the derivatives of the
        scalar by what is in them. Rows without an answer have the gradient zero, whatever the
        derivatives of the scalar are there (NaN, where it was computed from NaN): a mask on the rows of a loss then
        leaves them out of the gradients of what rows share; a row with an answer but no derivatives raises.
        """
        commands, parameters = np.asarray(commands), np.asarray(parameters)
        answered, turns = np.asarray(answered), np.asarray(turns)
        weights = [np.asarray(w) for w in (position, rotation, tension, length)]
        core = (2, 3, 1, 1)
        leads = (commands.shape[:-1], parameters.shape[:-1], answered.shape)
        lead = np.broadcast_shapes(*leads, *(w.shape[: w.ndim - k] for w, k in zip(weights, core)))
        count = int(np.prod(lead))

        def flat(array: npt.NDArray[np.generic], core: int) -> Array:
            inner = array.shape[array.ndim - core :]
            return np.broadcast_to(array, (*lead, *inner)).reshape(count, *inner).astype(np.float64)

        position, rotation, tension, length = (flat(w, k) for w, k in zip(weights, core))
        # dR = φ̂ R turns each column r of R by φ × r, which changes the scalar by φ · (r × w).
        about = np.cross(flat(turns, 3), rotation, axis=2).sum(axis=3)
        asked = [w.reshape(count, -1).any(axis=1) for w in (position, about, tension, length)]
        some = np.flatnonzero(np.logical_or.reduce(asked) & (flat(answered, 0) != 0.0))
        by_commands = np.zeros((count, self.commands))
        by_parameters = np.zeros((count, len(self.parameters)))
        for rows, case, given in self._groups(lead, some, commands, parameters):
            gradients = self._gradients(case, given, position[rows], about[rows], tension[rows], length[rows])
            self._raise(gradients, rows, lead)
            by_commands[rows], by_parameters[rows] = gradients.commands, gradients.parameters
        return by_commands.reshape(*lead, self.commands), by_parameters.reshape(*lead, len(self.parameters))

    def _groups(
        self,
        lead: tuple[int, ...],
        rows: npt.NDArray[np.intp],
        commands: npt.NDArray[np.generic],
        parameters: npt.NDArray[np.generic],
    ) -> Iterator[tuple[npt.NDArray[np.intp], Case, Array]]:
        """Those of `rows` that have the same parameters, the case with them, and their commands."""
        if not rows.size:
            return
        every = np.broadcast_to(commands, (*lead, self.commands)).reshape(-1, self.commands)
        given = every[rows].astype(np.float64)
        width = len(self.parameters)
        if parameters.size == width:
            yield rows, self._case(parameters.reshape(width)), given
            return
        values = np.broadcast_to(parameters, (*lead, width)).reshape(-1, width)[rows]
        distinct, group = np.unique(values, axis=0, return_inverse=True)
        for number, value in enumerate(distinct):
            own = np.flatnonzero(group.reshape(-1) == number)
            yield rows[own], self._case(value), given[own]

    def _case(self, values: npt.NDArray[np.generic]) -> Case:
        if not self.parameters:
            return self.case
        return self.case.with_parameters(dict(zip(self.parameters, values.tolist())))

    def _batch(self, case: Case, commands: Array) -> Batch:
        driven: dict[str, Any] = {self.actuation: commands}
        return case.solve_batch(**driven, model=self.model, stations=self.stations)

    def _gradients(
        self, case: Case, commands: Array, position: Array, about: Array, tension: Array, length: Array
    ) -> Gradients:
        driven: dict[str, Any] = {self.actuation: commands}
        return case.pull_back_batch(
            **driven,
            parameters=self.parameters,
            position=position,
            rotation=about,
            cable_tension=tension,
            cable_length=length,
            model=self.model,
            stations=self.stations,
        )

    def _raise(
        self, answers: Union[Batch, Gradients], rows: npt.NDArray[np.intp], lead: tuple[int, ...]
    ) -> None:
        """Raises the error of the first row that failed, with its number among all rows."""
        if not answers.failed.size:
            return
        first = int(answers.failed[0])
        error = answers.error(first)
        assert error is not None
        if not lead:
            raise error
        place = tuple(int(i) for i in np.unravel_index(rows[first], lead))
        row = place[0] if len(place) == 1 else place
        raise type(error)(f"row {row}: {error}", **{**vars(error), "row": row})


class SolverBase:
    """What a solver is, whichever framework it is called from."""

    def __init__(
        self,
        case: Case,
        *,
        parameters: Sequence[str] = (),
        actuation: Literal["tension", "shortening", "motors"] = "tension",
        model: ModelLike = "cosserat",
        stations: StationsLike = None,
        on_failure: Literal["raise", "flag"] = "raise",
    ) -> None:
        self._problem = Problem(case, parameters, actuation, model, stations, on_failure)

    @property
    def case(self) -> Case:
        """The case."""
        return self._problem.case

    @property
    def parameters(self) -> tuple[str, ...]:
        """Paths of the parameters."""
        return self._problem.parameters

    @property
    def arc_length(self) -> Array:
        """(n,) arc lengths of the stations in m."""
        return self._problem.arc_length

    def __repr__(self) -> str:
        return f"<Solver of {self.case.title!r} by {self._problem.actuation} and {list(self.parameters)}>"
