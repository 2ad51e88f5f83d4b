"""How far is each model from a reference, how long does it take, and which is to be used for what?"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from typing import Any

from . import _core, models
from ._commands import seconds
from ._files import write_bytes
from ._html import picture
from ._packages import needed
from ._suggest import suggests
from .case import Case
from .errors import InputError

__all__ = ["Benchmark", "Finding", "Row", "Standing", "benchmark", "suite"]


@dataclass(frozen=True)
class Row:
    """A model, in one of its presets, on a case. Lengths in m, times in s."""

    case: str
    """Title of the case."""
    name: str
    """What tells it from others: of a case of a suite its name there."""
    sections: int
    """Number of sections between disks."""
    routing: str | None
    """How the cables of a case of a suite run,"""
    bending: float | None
    """by how much it is bent, in rad,"""
    burden: str | None
    """and what else acts on it: ``"none"``, ``"force at the tip"``, ``"wall"``, ``"ball"``, ``"pipe"``."""
    reference: str | None
    """What errors are measured against; None where there is nothing."""
    reference_uncertainty: float | None
    """Its own estimate of its error in m."""
    model: str
    """The model."""
    preset: str
    """``"usual"``, or what it trades: ``"step-per-section"``, ``"sliding"``, ``"strain-energy"``."""
    commands: str
    """``"case"``, or ``"reference"`` where the model got the reference's cable lengths."""
    driven_by: str
    """What drove it, in words."""
    rms: float | None
    """RMS distance over the disks, without the base, or over the markers, and over all steps; None where there is no
    answer."""
    greatest: float | None
    """The greatest distance."""
    tip: float | None
    """That of the tip."""
    rms_over_length: float | None
    """The error: RMS distance relative to the length of the backbone."""
    solve_time: float | None
    """Median time of a cold solve by a model that is built."""
    build_time: float | None
    """Building the model, once for a robot."""
    iterations: int | None
    """Newton iterations."""
    unstable: bool
    """Whether the robot leaves this shape, or that of one of the steps."""
    stable: bool | None
    """Whether it is stable in all steps; None where there is no answer, or that is not known."""
    stability_absent: str | None
    """Why that is not known."""
    compared_steps: int | None
    """Number of steps that the error is over."""
    compared_points: int | None
    """Number of disks or markers that it is over, each counted once in each step."""
    failure: str | None
    """Why there is no answer, or none that can be compared."""

    @classmethod
    def _of(cls, case: dict[str, Any], run: dict[str, Any]) -> Row:
        tags, reference, error = case["tags"] or {}, case["reference"] or {}, run.get("error", {})
        numbers: dict[str, Any] = {
            **{key: error.get(key) for key in ("rms", "greatest", "tip", "rms_over_length")},
            **{key: run.get(key) for key in ("solve_time", "build_time", "iterations")},
        }
        return cls(
            case=case["title"],
            name=case["stem"],
            sections=case["sections"],
            routing=tags.get("routing"),
            bending=tags.get("bending"),
            burden=tags.get("burden"),
            reference=reference.get("name"),
            reference_uncertainty=reference.get("uncertainty"),
            **{key: run[key] for key in ("model", "preset", "commands", "driven_by")},
            **numbers,
            unstable=run.get("unstable", False),
            stable=run.get("stable"),
            stability_absent=run.get("stability_absent"),
            compared_steps=error.get("steps"),
            compared_points=error.get("points"),
            failure=run.get("failure", run.get("not_compared")),
        )


@dataclass(frozen=True)
class Standing:
    """How a model, in one of its presets, did on all cases that there is a reference for."""

    model: str
    """The model."""
    preset: str
    """How it is set."""
    cases: int
    """Number of cases."""
    answered: int
    """Number of those that it answered."""
    unstable: int
    """Number of answers that the robot leaves."""
    within_tolerance: int
    """Number of cases on which it is within 2 % of the length."""
    median_error: float | None
    """Median error, relative to the length of the backbone."""
    worst_error: float | None
    """Greatest error,"""
    worst_case: str | None
    """and the title of its case."""
    solve_time: float | None
    """Median over the cases of the time of a solve in s."""
    iterations: float | None
    """Median of the Newton iterations."""
    derivatives: str
    """``"exact"`` or ``"differences"``: where its derivatives by the commands come from."""
    without_material: bool
    """Whether it answered without section and material."""


@dataclass(frozen=True)
class Finding:
    """A sentence or two of the recommendation."""

    topic: str
    """``"control"``, ``"design"``, ``"unknown-material"``, ``"many-sections"``, ``"obstacles"``, or ``"paper"``."""
    model: str | None
    """The model to use, where there is one,"""
    preset: str | None
    """and how it is to be set."""
    confirmed: bool | None
    """Of the paper's conclusion: whether it was confirmed."""
    text: str
    """In words, with the figures."""


class Benchmark:
    """A benchmark of the models: what ``whipcord compare`` says of them.

    Printed, it is the tables, notes and recommendation of the command. In a notebook it shows error against time.

    Examples
    --------
    >>> import whipcord
    >>> case = whipcord.load("examples/table1/case-3.toml")
    >>> found = whipcord.benchmark(case, by=["cosserat", "four-bar"], reference="cosserat:fine")
    >>> found.standings[0].model, found.standings[0].median_error < 1e-6
    ('cosserat', True)
    >>> [finding.topic for finding in found.recommendation][:3]
    ['control', 'design', 'unknown-material']
    """

    rows: tuple[Row, ...]
    """Every model on every case."""
    many_sections: tuple[Row, ...]
    """The same on some of the robots cut into 100 sections, where none has many of its own."""
    standings: tuple[Standing, ...]
    """Every model on all cases together."""
    recommendation: tuple[Finding, ...]
    """Which model to use for what, and whether the paper's conclusion holds; empty where nothing has an error."""
    no_reference: dict[str, str]
    """Why there is nothing to measure against, by the titles of the cases of which that is so."""
    svg: str | None
    """Error against time, as ``whipcord compare --plot`` draws it; None where no model has an error."""

    def __init__(self, told: str, text: str, svg: str | None) -> None:
        self._json, self._text, self.svg = told, text, svg
        found = json.loads(told)
        self.rows = tuple(Row._of(case, run) for case in found["cases"] for run in case["runs"])
        many = found["with_many_sections"]
        self.many_sections = tuple(Row._of(case, run) for case in many for run in case["runs"])
        self.standings = tuple(Standing(**model) for model in found["models"])
        self.recommendation = tuple(Finding(**finding) for finding in found["recommendation"])
        lacking = (case for case in found["cases"] if case["no_reference"] is not None)
        self.no_reference = {case["title"]: case["no_reference"] for case in lacking}

    def save_plot(self, path: str | os.PathLike[str]) -> None:
        """Writes error against time as ``.svg`` or ``.png``.

        Parameters
        ----------
        path
            The file, whose name ends in ``.svg`` or ``.png``.
        """
        if not os.fspath(path).lower().endswith((".svg", ".png")):
            raise InputError(f"the name must end in .svg or .png, but is {os.fspath(path)!r}", path="path")
        if self.svg is None:
            raise InputError("there is nothing to draw: no model has an error", path="reference")
        write_bytes(path, _core.picture(self.svg, os.fspath(path)))

    def to_json(self) -> str:
        """What ``whipcord compare --json`` prints."""
        return self._json

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` with the rows, in SI."""
        return needed("pandas").DataFrame(self._columns())

    def to_polars(self) -> Any:
        """A ``polars.DataFrame`` with the rows, in SI."""
        return needed("polars").DataFrame(self._columns())

    def _columns(self) -> dict[str, list[Any]]:
        return {of.name: [getattr(row, of.name) for row in self.rows] for of in fields(Row)}

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        cases = len({row.name for row in self.rows})
        return f"<Benchmark of {len(self.standings)} models and presets on {cases} cases>"

    def _repr_html_(self) -> str | None:
        return None if self.svg is None else picture(self.svg)


@suggests
def benchmark(
    cases: Case | Iterable[Case] | str,
    *,
    by: Sequence[str] = models.NAMES,
    reference: str = "trusted",
    only: Sequence[str] = (),
    timeout: float | None = None,
) -> Benchmark:
    """Tries models, and those of their presets that trade accuracy for time, on cases.

    Parameters
    ----------
    cases
        A case, several, or the name of a suite that the package brings along: ``"routing"``.
    by
        Names of the models; all of them by default.
    reference
        What errors are measured against: a model, ``"cosserat"``, or ``"cosserat:fine"`` for fine resolution;
        ``"measured"``, what was measured in space; or ``"trusted"``: what was measured, without it the rod with
        cables from hole to hole where the file gives the holes, else the rod, at fine resolution.
    only
        Of a suite, only the cases whose names contain one of these texts.
    timeout
        Seconds after which the benchmark is ended; by default as long as it takes. Ctrl-C ends it, too.

    Raises
    ------
    WhipcordTimeout
        Where the time limit was reached.
    InputError
        For models, references and suites that there are not.
    """
    if isinstance(by, str) or not isinstance(by, Iterable) or not all(isinstance(name, str) for name in by):
        message = f"by must be a list of names of models, whose presets are tried too, but is {by!r}"
        raise InputError(message, path="by")
    ends = seconds(timeout)
    if isinstance(cases, str):
        return Benchmark(*_core.benchmark([], list(by), reference, cases, _texts(only), ends))
    given = [cases] if isinstance(cases, Case) else list(cases)
    for case in given:
        if not isinstance(case, Case):
            raise InputError(f"cases must be of the class Case, but one is {case!r}", path="cases")
    if not given:
        raise InputError("there is no case to try models on", path="cases")
    if only:
        raise InputError("only picks cases of a suite", path="only")
    return Benchmark(*_core.benchmark([case._setup for case in given], list(by), reference, timeout=ends))


@suggests
def suite(name: str = "routing", *, only: Sequence[str] = ()) -> dict[str, Case]:
    """The cases of a suite that the package brings along, by their names.

    Parameters
    ----------
    name
        Name of the suite.
    only
        Only the cases whose names contain one of these texts; by default all.

    Examples
    --------
    >>> len(suite()), list(suite(only=["ball-9"]))
    (152, ['ball-9-30', 'ball-9-90'])
    """
    return {stem: Case._of(setup) for stem, setup in _core.suite(name, _texts(only))}


def _texts(only: Sequence[str]) -> list[str]:
    if isinstance(only, str) or not all(isinstance(text, str) for text in only):
        raise InputError(f"only must be a list of texts, but is {only!r}", path="only")
    return list(only)
