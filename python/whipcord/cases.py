"""Many cases at once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from . import _core, models
from .batch import solve_setups
from .case import Case
from .errors import InputError, SolveError
from .models import ModelLike, StationsLike
from .solution import Solution

__all__ = ["solve_cases"]


def solve_cases(
    cases: Sequence[Case],
    *,
    model: ModelLike = "cosserat",
    stations: StationsLike = None,
    actuation: str | None = None,
    threads: int | None = None,
    progress: bool = False,
    timeout: float | None = None,
) -> list[Solution | SolveError | InputError]:
    """Solves many cases at once: other robots, other loads.

    Parameters
    ----------
    cases
        The cases, each solved from cold. Many commands of one case are faster by :meth:`Case.solve_batch`.
    model, stations, actuation
        As for :meth:`Case.solve`.
    threads, progress, timeout
        As for :meth:`Case.solve_batch`.

    Returns
    -------
    list
        For each case its solution, or the exception that says why there is none.

    Examples
    --------
    >>> import whipcord
    >>> case = whipcord.load("examples/table1/case-3.toml")
    >>> forces = [whipcord.Loads(tip_force=[0, 0, f]) for f in (-0.1, 0.0, 0.1)]
    >>> [s.bend > 1.1 for s in solve_cases([case.replace(loads=load) for load in forces])]
    [True, True, False]
    """
    listed = list(cases) if isinstance(cases, Iterable) else None
    if listed is None or not all(isinstance(case, Case) for case in listed):
        raise InputError(f"cases must be a list of cases, but is {cases!r}", path="cases")
    chosen = models.core(model, stations, actuation, timeout)
    answers = solve_setups([case._setup for case in listed], chosen, threads, progress)
    return [
        Solution._of(case, chosen, answer, None) if isinstance(answer, _core.Solution) else answer
        for case, answer in zip(listed, answers)
    ]
