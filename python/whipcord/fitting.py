"""What a robot is, from what was measured of it."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Union

import numpy as np
import numpy.typing as npt

from . import _core, models
from ._commands import whole
from ._files import write
from ._packages import needed
from ._suggest import suggests
from .case import Case
from .errors import InputError
from .models import ModelLike
from .warning import WhipcordWarning, tell

__all__ = [
    "CrossValidation",
    "Estimate",
    "Fit",
    "HeldOut",
    "ModelFit",
    "Profile",
    "Rung",
    "Suspect",
    "Unknown",
    "Unresolved",
    "UnstableAnswer",
    "fit",
]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Unknown:
    """What is estimated, and what is known of it besides. Numbers in SI.

    Examples
    --------
    >>> Unknown("backbone.young_modulus", start=1.2e9, least=1e9).least
    1000000000.0
    """

    parameter: str
    """Path of a quantity, as in ``[fit]``: ``"backbone.diameter"``, ``"cables[0].tension_offset"``."""
    start: float | None = None
    """Where the search starts; by default where robot and case have it."""
    least: float | None = None
    """Least value."""
    greatest: float | None = None
    """Greatest value."""
    prior: tuple[float, float] | None = None
    """What it is known to be, and its standard deviation."""

    def _asked(self) -> tuple[Any, ...]:
        numbers = [_number(getattr(self, name), name) for name in ("start", "least", "greatest")]
        prior = None
        if self.prior is not None:
            if isinstance(self.prior, str) or len(self.prior) != 2:
                message = f"prior must be a value and its standard deviation, but is {self.prior!r}"
                raise InputError(message, path="prior")
            prior = [_number(value, "prior") for value in self.prior]
        return (self.parameter, False, *numbers, prior)


@dataclass(frozen=True)
class Estimate:
    """An estimate, in SI."""

    parameter: str
    """Its path."""
    case: str | None
    """Name of the one case that it belongs to; None where all share it."""
    unit: str
    """Its unit; empty for a plain number."""
    value: float
    """The estimate."""
    deviation: float | None
    """Standard deviation; None where the measurements say nothing of it, and at a bound."""
    interval: tuple[float, float] | None
    """Interval that holds the true value with the probability asked for, 95 % by default."""
    at_bound: bool
    """Whether it lies at a bound."""
    derivatives: str
    """``"exact"`` or ``"differences"``."""


@dataclass(frozen=True)
class Unresolved:
    """What the measurements cannot tell apart."""

    what: str
    """In words."""
    parameters: tuple[str, ...]
    """The unknowns that can change together while little or nothing that was measured does."""
    collinearity: float | None
    """How many times less sure they are than each would be alone; None where nothing at all is seen of the change."""


@dataclass(frozen=True)
class HeldOut:
    """A part of the measurements that was held out."""

    case: str | None
    """Name of its case; None for a group of rows."""
    step: int | None
    """Its step, from 1; None where the whole case, or several rows, were held out."""
    group: str | None
    """The group of rows that was held out, where rows have groups."""
    rows: int
    """How many rows were held out."""
    values: tuple[float, ...]
    """The estimates without it."""
    rms_distance: float | None
    """RMS distance in m of its markers from where the fit without them has them."""
    rms_pixels: float | None
    """The same in pixels of those in images."""


@dataclass(frozen=True)
class CrossValidation:
    """How far off fits are from what they have not seen."""

    held_out: tuple[HeldOut, ...]
    """One for each part that was held out in turn."""
    rms_distance: float | None
    """RMS distance in m over all of them."""
    rms_pixels: float | None
    """The same in pixels."""


@dataclass(frozen=True)
class ModelFit:
    """The same measurements fitted by a model."""

    model: str
    """The model."""
    error: str | None
    """Why it has no fit."""
    rms_distance: float | None
    """RMS distance in m."""
    rms_pixels: float | None
    """RMS distance in pixels."""
    aic_above_best: float | None
    """By how much Akaike's criterion is above that of the best."""
    bic_above_best: float | None
    """By how much the Bayesian criterion is."""
    held_out_rms_distance: float | None
    """RMS distance in m of what was held out, where that was asked for."""


@dataclass(frozen=True)
class Rung:
    """The first parameters of a list, fitted without those after them."""

    parameters: tuple[str, ...]
    """What was estimated; nothing on the first rung."""
    rms_distance: float | None
    """RMS distance in m of the fit."""
    rms_pixels: float | None
    """The same in pixels."""
    held_out_rms_distance: float | None
    """RMS distance in m of what was held out in turn."""
    held_out_rms_pixels: float | None
    """The same in pixels."""


@dataclass(frozen=True)
class Profile:
    """The profile likelihood of a parameter."""

    parameter: str
    """Its path."""
    values: tuple[float, ...]
    """Values, in ascending order."""
    rise: tuple[float, ...]
    """By how much the sum of squares in units of the noise is above that of the estimate, all others fitted anew."""
    limit: float
    """Values below this rise agree with the measurements."""
    interval: tuple[float | None, float | None]
    """Ends of the interval; None where no value on that side contradicts the measurements."""


@dataclass(frozen=True)
class Suspect:
    """The zero or the angle of a single cable that is not estimated."""

    parameter: str
    """Its path."""
    unit: str
    """Its unit."""
    change: float
    """By how much it is off, to first order."""
    deviation: float
    """Standard deviation of that."""
    share: float
    """Part of the sum of squares that its estimate would take away, to first order."""
    alike: Sequence[Mapping[str, Any]]
    """Where it stands out, the same numbers of other cables that the measurements hardly tell from it, such as that of an antagonist. Each has
    its path, ``parameter``, and ``same_way``, whether it would be off the same way."""
    confirmed: Mapping[str, Any] | None
    """Where it stands out from the other cables: change, deviation and RMS distance without and with it, by a fit."""


@dataclass(frozen=True)
class UnstableAnswer:
    """An unstable equilibrium that measurements are compared with: the real robot leaves such a shape."""

    case: str
    """Name of its case."""
    step: int
    """Its step, from 1."""
    stability: float
    """Least eigenvalue of the tangent stiffness relative to the bare rod's, which is negative."""


@dataclass(frozen=True, eq=False)
class Fit:
    """What was estimated. It has converged: one that has not is an exception."""

    model: str
    """The model."""
    status: str
    """How the search ended."""
    iterations: int
    """Steps of the search."""
    evaluations: int
    """How often all shapes were computed."""
    starts: Mapping[str, int]
    """From how many places the search started (``tried``), and how many ended at these estimates (``agree``)."""
    estimates: tuple[Estimate, ...]
    """The estimates, in the order of the unknowns."""
    correlations: Array
    """(n, n) correlations of the estimates; NaN where one of them is not sure at all."""
    noise: float
    """Standard deviation of a coordinate in m or pixels, where it is estimated; else how many times as large as said
    the deviations turn out to be."""
    noise_estimated: bool
    """Whether the measurements did not say how exact they are."""
    degrees_of_freedom: int
    """Numbers that were measured less unknowns."""
    rms_distance: float | None
    """RMS distance in m of the markers whose position was measured."""
    rms_pixels: float | None
    """RMS distance in pixels of those that were seen in images."""
    aic: float | None
    """Akaike's criterion, up to a constant of the measurements."""
    bic: float | None
    """The Bayesian criterion, up to the same constant."""
    unresolved: tuple[Unresolved, ...]
    """What the measurements cannot tell apart."""
    residuals: Array
    """(k, 3) model less measurement of each marker: x, y, z in m, or column and row in pixels, and zero."""
    weights: Array
    """(k,) weights that a robust loss gave them, from 0 to 1."""
    residual_case: npt.NDArray[np.int64]
    """(k,) numbers of their cases, from 0."""
    residual_step: npt.NDArray[np.int64]
    """(k,) their steps, from 1."""
    residual_arc_length: Array
    """(k,) where on the backbone they sit, in m."""
    residual_in_image: npt.NDArray[np.bool_]
    """(k,) whether they were seen in an image."""
    cases: tuple[Case, ...]
    """The cases with the estimates."""
    cross_validation: CrossValidation | None
    """What was held out in turn, where that was asked for."""
    models: tuple[ModelFit, ...]
    """The fits of all models, where that was asked for."""
    answers: int
    """How many answers, one for each step in which something was measured, the measurements are compared with."""
    unstable: tuple[UnstableAnswer, ...]
    """Which of these answers are unstable equilibria at the estimates."""
    loss: str
    """How much measurements counted that are far off."""
    skipped: tuple[Mapping[str, Any], ...]
    """Rows that were left out because the model has no answer to them: case, step (from 1) and reason."""
    over_determined: tuple[Mapping[str, Any], ...]
    """Rows whose cable lengths contradict each other and are met in the least-squares sense: case, step (from 1) and misses, the
    cables that take part and by how much in m each is longer than commanded."""
    ladder: tuple[Rung, ...]
    """The first parameters alone, more and more of them, where that was asked for."""
    profiles: tuple[Profile, ...]
    """Profile likelihoods, where they were asked for."""
    suspects: tuple[Suspect, ...]
    """The zeros and angles of single cables that are not estimated, the one that would take most away first."""
    repeatability: Mapping[str, Any] | None
    """How far the robot is from itself at equal or nearly equal commands: pairs of rows, RMS distance in m about their mean, and
    the RMS distance between those approached from the same side and from opposite sides. None where no commands come back."""
    drift: Mapping[str, Any] | None
    """Slope in m/s of what is left against time, with its standard deviation. None where rows have no times."""
    test: Mapping[str, Any] | None
    """RMS distance of the measurements that were not fitted, all and by rows, and the median of the rows, where there are such."""
    sensitivity: Mapping[str, Any] | None
    """What one more measurement of each disk would be worth: the best ones, and the mean over all rows."""
    warnings: tuple[WhipcordWarning, ...]
    """What to look at, such as markers that fit far better in opposite order, or unstable equilibria."""
    _fitted: _core.Fitted = field(repr=False)

    @property
    def values(self) -> Array:
        """(n,) the estimates."""
        return np.array([estimate.value for estimate in self.estimates])

    def __getitem__(self, parameter: str) -> Estimate:
        """The estimate of this path, the first where each case has its own."""
        for estimate in self.estimates:
            if estimate.parameter == parameter:
                return estimate
        raise KeyError(parameter)

    def save_robot(self, path: str | os.PathLike[str], case: int = 0) -> None:
        """Writes the robot file of a case with the estimates: of a case that was loaded, its own text with other
        numbers, units and comments kept, where the file has a place for each.

        Parameters
        ----------
        path
            The file, which is replaced if it exists.
        case
            Number of the case among :attr:`cases`.
        """
        number = range(len(self.cases))[whole(case, "case")]
        folder = os.path.dirname(os.path.abspath(path))
        text = self._fitted.text(number, folder)
        if text is None:
            self.cases[number].save(path)
        else:
            write(path, text)

    def report(self, folder: str | os.PathLike[str]) -> str:
        """Writes a report in HTML with figures and CSV to a folder, as ``whipcord fit --out``; returns its path.

        Parameters
        ----------
        folder
            The folder, which is made if it is missing.
        """
        return str(self._fitted.report(os.fspath(folder)))

    def to_json(self) -> str:
        """What ``whipcord fit --json`` prints."""
        return self._fitted.json()

    def plot_residuals(self, axes: Any = None) -> Any:
        """Draws the distance of each marker along the backbone with Matplotlib: mm, or pixels of what images show.

        Parameters
        ----------
        axes
            Axes of Matplotlib to draw into; new ones by default.
        """
        if axes is None:
            _, axes = needed("matplotlib.pyplot").subplots()
        pixels = bool(self.residual_in_image.all())
        shown = self.residual_in_image == pixels
        distance = np.linalg.norm(self.residuals, axis=1) * (1 if pixels else 1e3)
        for number, case in enumerate(self.cases):
            own = shown & (self.residual_case == number)
            axes.scatter(1e3 * self.residual_arc_length[own], distance[own], s=14, label=case.title)
        axes.set_xlabel("arc length (mm)")
        axes.set_ylabel(f"model less measurement ({'pixels' if pixels else 'mm'})")
        axes.set_ylim(bottom=0)
        axes.legend()
        return axes

    def __repr__(self) -> str:
        lines = [f"<Fit by {self.model}: {len(self.residuals)} markers"]
        for estimate in self.estimates:
            of = "" if estimate.case is None else f" ({estimate.case})"
            sure = "at its bound" if estimate.at_bound else "not seen"
            if estimate.deviation is not None:
                sure = f"± {estimate.deviation:.2g}"
            lines.append(f"  {estimate.parameter}{of} {estimate.value:.6g} {sure} {estimate.unit}".rstrip())
        lines += [f"  ! {each.what}" for each in self.unresolved]
        if self.unstable:
            lines.append(f"  ! {len(self.unstable)} of {self.answers} answers are unstable equilibria")
        return "\n".join(lines) + ">"


@suggests
def fit(
    cases: Case | Sequence[Case],
    parameters: Sequence[Union[str, Unknown]] = (),
    *,
    each: Sequence[Union[str, Unknown]] = (),
    model: ModelLike = "cosserat",
    actuation: str | None = None,
    loss: Literal["squares", "huber", "soft-l1", "cauchy"] = "squares",
    confidence: float = 0.95,
    iterations: int = 100,
    cross_validate: bool = False,
    compare_models: bool = False,
    test: Case | Sequence[Case] = (),
    split: float | None = None,
    seed: int = 1,
    ladder: bool = False,
    profile: bool = False,
    skip_rows: bool = True,
    one_frame: bool = False,
    starts: int = 1,
    threads: int | None = None,
    timeout: float | None = None,
) -> Fit:
    """Estimates parameters of a robot from what was measured, with their uncertainty.

    Parameters
    ----------
    cases
        Cases of one robot, each with what was measured.
    parameters
        What is estimated, once for all cases: paths, or :class:`Unknown` with bounds and priors. By default what
        ``[fit]`` of the cases says. ``"cables[*].friction"`` is one number for all cables, ``"cables[segment 1].friction"`` one
        for a group of them.
    each
        What is estimated for each case by itself, such as ``"base.position[0]"``.
    model, actuation
        As for :meth:`Case.solve`.
    loss
        How much measurements count that are far off: by their square; linearly beyond the noise (``"huber"``, smoothly
        ``"soft-l1"``); hardly at all (``"cauchy"``).
    confidence
        Probability that an interval holds the true value.
    iterations
        Steps that the search may take.
    cross_validate
        Whether to fit again without each case, or each step, in turn.
    compare_models
        Whether to fit by the other models too.
    test
        Cases of the same robot with measurements that are not fitted, on which the fit is scored.
    split
        Part of the rows, such as 0.2, that is not fitted and on which the fit is scored; groups of rows stay together.
    seed
        Of the random choice of `split`.
    ladder
        Whether to fit the first parameter alone, then the first two, and so on, with the prediction error of each.
    profile
        Whether to compute the profile likelihood of each parameter, for what the measurements hardly determine.
    skip_rows
        Whether rows that the model has no answer to are left out, with a warning; else there is no fit then.
    one_frame
        Whether all cases were measured in one frame, as by a tracker that was never moved: a rigid registration is then one motion for
        all of them, and for those of `test`; else each case has its own.
    starts
        Places from which the search starts: the values of the case and, between the bounds or around these values, others. The best
        end counts.
    threads
        How many threads share the cases and rows; by default as many as there are processors. The result is the same for any number.
    timeout
        Seconds after which all of it is ended, with :class:`whipcord.errors.WhipcordTimeout`.

    Raises
    ------
    FitError
        Where the model has no answer to start from, or the search has not converged.
    InputError
        Where the measurements are not enough or contradict robot and case.

    Examples
    --------
    The robot is stiffer than its file says:

    >>> import pathlib, tempfile, whipcord
    >>> case = whipcord.load("examples/table1/case-3.toml")
    >>> real = case.with_parameters({"backbone.young_modulus": 1.3e9}).solve()
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     lines = [f"{i + 1},{x},{y},{z}" for i, (x, y, z) in enumerate(real.position)]
    ...     table = pathlib.Path(folder, "disks.csv")
    ...     _ = table.write_text("\\n".join(["disk,x,y,z", *lines]))
    ...     measured = case.with_measured(table)
    >>> found = fit(measured, ["backbone.young_modulus"])
    >>> bool(abs(found["backbone.young_modulus"].value - 1.3e9) < 1e3)
    True
    """
    listed = [cases] if isinstance(cases, Case) else list(cases)
    for i, case in enumerate(listed):
        if not isinstance(case, Case):
            raise InputError(f"cases[{i}] must be a Case, but is {case!r}", path=f"cases[{i}]")
    tested = [test] if isinstance(test, Case) else list(test)
    for i, case in enumerate(tested):
        if not isinstance(case, Case):
            raise InputError(f"test[{i}] must be a Case, but is {case!r}", path=f"test[{i}]")
    if split is not None and tested:
        raise InputError("give test or split, not both", path="split")
    if split is not None and not 0 < float(split) < 1:
        raise InputError(f"split must be a part between 0 and 1, such as 0.2, but is {split!r}", path="split")
    chosen = models.core(model, None, actuation, timeout)
    others = [models.core(name, None, actuation) for name in models.NAMES] if compare_models else []
    fitted = _core.fit(
        [case._setup for case in listed],
        chosen,
        _asked(parameters, "parameters"),
        _asked(each, "each"),
        loss,
        float(confidence),
        max(whole(iterations, "iterations"), 0),
        bool(cross_validate),
        others,
        [case._setup for case in tested],
        None if split is None else (float(split), max(whole(seed, "seed"), 0)),
        bool(ladder),
        bool(profile),
        bool(skip_rows),
        bool(one_frame),
        max(whole(starts, "starts"), 1),
        None if threads is None else max(whole(threads, "threads"), 1),
    )
    return _told(fitted, json.loads(fitted.json()))


def _asked(given: Sequence[Union[str, Unknown]], name: str) -> list[tuple[Any, ...]]:
    if isinstance(given, (str, Unknown)):
        message = f"{name} must be a list of paths or Unknowns, but is {given!r}"
        raise InputError(message, path=name)
    asked = []
    for unknown in given:
        if isinstance(unknown, Unknown):
            asked.append(unknown._asked())
        elif isinstance(unknown, str):
            asked.append((unknown, True, None, None, None, None))
        else:
            message = f"{name} must be a list of paths or Unknowns, but has {unknown!r}"
            raise InputError(message, path=name)
    return asked


def _number(value: Any, name: str) -> float | None:
    if value is None:
        return None
    try:
        return float(value)
    except (TypeError, ValueError):
        raise InputError(f"{name} must be a number in SI, but is {value!r}", path=name) from None


def _with_tuples(said: dict[str, Any]) -> dict[str, Any]:
    return {name: tuple(value) if isinstance(value, list) else value for name, value in said.items()}


def _told(fitted: _core.Fitted, said: dict[str, Any]) -> Fit:
    estimates = [
        {**one, "interval": None if one["interval"] is None else tuple(one["interval"])}
        for one in said["estimates"]
    ]
    validation = said["cross_validation"]
    if validation is not None:
        folds = [HeldOut(**{**fold, "values": tuple(fold["values"])}) for fold in validation["held_out"]]
        validation = CrossValidation(tuple(folds), validation["rms_distance"], validation["rms_pixels"])
    unresolved = [
        Unresolved(one["what"], tuple(one["parameters"]), one["collinearity"]) for one in said["unresolved"]
    ]
    number, step, arc_length, camera = zip(*fitted.places())
    left = said["residuals"]
    # What is odd about the files themselves was said when they were read.
    found = [
        WhipcordWarning(one["code"], one["message"], one["help"])
        for one in said["warnings"]
        if one["place"] is None or one["code"] == "yield-strain"
    ]
    tell(found)
    return Fit(
        model=said["model"],
        status=said["status"],
        iterations=said["iterations"],
        evaluations=said["evaluations"],
        starts=said["starts"],
        estimates=tuple(Estimate(**one) for one in estimates),
        correlations=np.array(said["correlations"], dtype=np.float64),
        noise=said["noise"]["level"],
        noise_estimated=said["noise"]["estimated"],
        degrees_of_freedom=said["noise"]["degrees_of_freedom"],
        rms_distance=said["rms_distance"],
        rms_pixels=said["rms_pixels"],
        aic=said["aic"],
        bic=said["bic"],
        unresolved=tuple(unresolved),
        residuals=np.array([one["difference"] for one in left]),
        weights=np.array([one["weight"] for one in left]),
        residual_case=np.array(number),
        residual_step=np.array(step) + 1,
        residual_arc_length=np.array(arc_length),
        residual_in_image=np.array([of is not None for of in camera]),
        cases=tuple(Case._of(setup) for setup in fitted.setups()),
        cross_validation=validation,
        models=tuple(ModelFit(**one) for one in said["models"]),
        answers=said["answers"],
        unstable=tuple(UnstableAnswer(**one) for one in said["unstable"]),
        loss=said["loss"],
        skipped=tuple(said["skipped"]),
        over_determined=tuple(said["over_determined"]),
        ladder=tuple(Rung(**_with_tuples(one)) for one in said["ladder"]),
        profiles=tuple(Profile(**_with_tuples(one)) for one in said["profiles"]),
        suspects=tuple(Suspect(**one) for one in said["suspects"]),
        repeatability=said["repeatability"],
        drift=said["drift"],
        test=said["test"],
        sensitivity=said["sensitivity"],
        warnings=tuple(found),
        _fitted=fitted,
    )
