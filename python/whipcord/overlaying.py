"""The models over a photograph of the robot."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from . import _core, models
from ._commands import seconds, whole
from ._files import write_bytes
from ._html import picture as shown
from ._suggest import suggests
from .camera import Camera
from .case import Case
from .errors import InputError, WhipcordError
from .photographs import Marks, PhotoLike, picture
from .solution import Solution

__all__ = ["Overlaid", "Overlay", "overlay"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Overlaid:
    """A model over a photograph. Its arrays have a row for each marker that was seen; NaN where the camera does not
    see it where the model has it."""

    model: str
    """Its name."""
    solution: Solution | None
    """Its answer."""
    error: WhipcordError | None
    """Or why it has none."""
    pixel: Array
    """(k, 2) column and row at which it has each marker."""
    pixels: Array
    """(k,) distance in the image from where each was seen, in pixels."""
    distance: Array
    """(k,) distance in m from the line of sight."""
    rms_pixels: float | None
    """RMS of `pixels` over the markers that are not at the base; None where there are none."""
    rms_distance: float | None
    """RMS of `distance` over them, in m."""
    rms_fraction: float | None
    """The same as a fraction of the length."""


@dataclass(frozen=True, eq=False)
class Overlay:
    """Models over a photograph.

    Examples
    --------
    >>> import numpy as np, whipcord
    >>> case = whipcord.load("examples/table1/case-3.toml")
    >>> camera = whipcord.Camera.orthographic(scale=2000, centre=(320, 100), size=(640, 480))
    >>> over = overlay(np.full((480, 640), 180, dtype=np.uint8), case, camera=camera)
    >>> [run.model for run in over][:3]
    ['cosserat', 'cosserat-disks', 'four-bar']
    >>> over.svg.startswith("<svg")
    True
    """

    runs: tuple[Overlaid, ...]
    """One for each model."""
    disk: tuple[int | None, ...]
    """Numbers of the disks, from 1, on which the markers sit that were seen; None between disks."""
    arc_length: Array
    """(k,) where on the backbone they sit, in m."""
    seen: Array
    """(k, 2) column and row at which they were seen."""
    svg: str
    """The picture: the models in different colours, backbone, disks and cables, over the photograph."""

    def __iter__(self) -> Iterator[Overlaid]:
        return iter(self.runs)

    def __len__(self) -> int:
        return len(self.runs)

    def __getitem__(self, model: str) -> Overlaid:
        for run in self.runs:
            if run.model == model:
                return run
        raise KeyError(model)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the picture as ``.svg`` or ``.png``.

        Parameters
        ----------
        path
            The file, whose name ends in ``.svg`` or ``.png``.
        """
        if not os.fspath(path).lower().endswith((".svg", ".png")):
            raise InputError(f"the name must end in .svg or .png, but is {os.fspath(path)!r}", path="path")
        write_bytes(path, _core.picture(self.svg, os.fspath(path)))

    def _repr_html_(self) -> str:
        return shown(self.svg)

    def __repr__(self) -> str:
        lines = [f"<Overlay with {len(self.disk)} markers"]
        for run in self.runs:
            if run.rms_distance is not None and run.rms_fraction is not None:
                rms = f"RMS {1e3 * run.rms_distance:.2f} mm, {1e2 * run.rms_fraction:.2f} % of the length"
                lines.append(f"  {run.model:<15} {rms}")
            else:
                lines.append(f"  {run.model:<15} {run.error or ''}".rstrip())
        return "\n".join(lines) + ">"


@suggests
def overlay(
    photo: PhotoLike,
    case: Case,
    *,
    camera: Camera | str | None = None,
    marks: Marks | str | os.PathLike[str] | None = None,
    models: Sequence[str] | None = None,
    step: int | None = None,
    width: float = 980.0,
    timeout: float | None = None,
) -> Overlay:
    """Lays the models over a photograph, and says how far each is from what was seen there.

    Parameters
    ----------
    photo
        PNG or JPEG file, or its pixels: (h, w) or (h, w, 3) bytes.
    case
        The case that it shows.
    camera
        What took it, in its place: a camera, or the name of one in ``[[measured.cameras]]``; by default the only one
        there.
    marks
        What :func:`measure` found, or the CSV file that it was written to; by default what ``[measured]`` says this camera saw.
    models
        Their names; by default all, of which those without an answer are runs with their error.
    step
        Step of actuation that it shows, from 1; by default the last.
    width
        Of the picture, in px.
    timeout
        Seconds after which the solves are ended; by default as long as they take. Ctrl-C ends them, too.

    Raises
    ------
    SolveError
        Where a model that was asked for by name, or every one, has no answer.
    WhipcordTimeout
        Where the time limit was reached.
    """
    if not isinstance(case, Case):
        raise InputError(f"case must be a Case, but is {case!r}", path="case")
    opened = picture(photo, "photo")
    view, number = _camera(case, camera)
    last = max(len(case.steps), 1)
    asked = last if step is None else whole(step, "step")
    if not 1 <= asked <= last:
        raise InputError(f"there is no step {asked}: the case has steps 1 to {last}", path="step")
    table = os.fspath(marks) if isinstance(marks, (str, os.PathLike)) else None
    if marks is not None and table is None and not isinstance(marks, Marks):
        raise InputError(f"marks must be Marks or a file with them, but is {marks!r}", path="marks")
    found = list(zip(marks.disk, marks.pixel.tolist())) if isinstance(marks, Marks) else None
    svg, markers, runs = _core.overlay(
        opened,
        case._setup,
        view._camera,
        number,
        found,
        table,
        asked - 1,
        _names(models),
        case.title,
        float(width),
        seconds(timeout),
    )
    told = tuple(_told(case, *run) for run in runs)
    failed = [run.error for run in told if run.error is not None]
    if failed and (models is not None or svg is None):
        raise failed[0]
    assert svg is not None
    return Overlay(
        told,
        tuple(disk for disk, _, _, _ in markers),
        np.array([arc_length for _, arc_length, _, _ in markers]),
        np.array([pixel for _, _, _, pixel in markers]).reshape(-1, 2),
        svg,
    )


def _names(given: Sequence[str] | None) -> list[str]:
    if given is None:
        return list(models.NAMES)
    if isinstance(given, str) or not given or not all(isinstance(name, str) for name in given):
        raise InputError(f"models must be a list of names, but is {given!r}", path="models")
    return list(given)


def _camera(case: Case, camera: Camera | str | None) -> tuple[Camera, int | None]:
    """The camera, and its number among those of the measurement."""
    measured = case.measured
    names = [] if measured is None else [name for name, _ in measured.cameras]
    views = () if measured is None else measured.views
    if isinstance(camera, Camera):
        return camera, views.index(camera) if camera in views else None
    if camera is None and len(views) == 1:
        return views[0], 0
    if isinstance(camera, str) and camera in names:
        return views[names.index(camera)], names.index(camera)
    known = f": the case has {', '.join(names)}" if names else ", as the case names none"
    if camera is None:
        raise InputError(f"which camera took the photograph? Give camera{known}", path="camera")
    raise InputError(f"there is no camera {camera!r}{known}", path="camera")


def _told(
    case: Case,
    model: str,
    answer: _core.Solution | None,
    values: Array,
    rms: list[float] | None,
    error: WhipcordError | None,
) -> Overlaid:
    solution = None if answer is None else Solution._of(case, models.core(model), answer, None)
    pixels, distance = (None, None) if rms is None else rms
    length = case.robot.backbone.length
    assert isinstance(length, float)
    return Overlaid(
        model,
        solution,
        error,
        values[:, :2],
        values[:, 2],
        values[:, 3],
        pixels,
        distance,
        None if distance is None else distance / length,
    )
