"""Pictures with Matplotlib, or with PyVista where it is asked for. Millimetres, as in all pictures here.

>>> import whipcord
>>> import matplotlib; matplotlib.use("Agg")
>>> case = whipcord.load("examples/table1/case-3.toml")
>>> axes = case.solve(stations=91).plot()
>>> axes.get_xlabel()
'x (mm)'
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ._packages import needed
from .errors import InputError
from .robot import Robot
from .solution import Shape, Solution

__all__ = ["compare", "solution"]

Array = npt.NDArray[np.float64]

PALETTE = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""Colours that are told apart by everyone."""
UNSTABLE = "#b00020"
"""Colour of the word."""
SMOOTH = 91
"""Stations that a curve is smooth with."""


def solution(
    answer: Solution,
    *,
    axes: Any = None,
    backend: str = "matplotlib",
    color: str | None = None,
    label: str | None = None,
    disks: bool = True,
    cables: bool = True,
) -> Any:
    """Draws a robot in space.

    Parameters
    ----------
    answer
        The shape.
    axes
        Axes to draw into: three-dimensional ones of Matplotlib, or a plotter of PyVista; new ones by default.
    backend
        ``"matplotlib"`` or ``"pyvista"``.
    color
        Of the backbone.
    label
        For the legend; the name of the model by default. At an unstable shape it says so.
    disks, cables
        Whether they are drawn.

    Returns
    -------
    The axes, or the plotter.
    """
    if backend == "pyvista":
        return _pyvista(answer, axes, color or PALETTE[0], disks, cables)
    if backend != "matplotlib":
        raise InputError(f"there is no backend `{backend}`: choose matplotlib or pyvista", path="backend")
    axes = _axes() if axes is None else axes
    _draw(answer, axes, color or PALETTE[0], label, disks, cables)
    if answer.diagnostics.unstable:
        axes.text2D(0.02, 0.98, "unstable", transform=axes.transAxes, va="top", color=UNSTABLE)
    return axes


def _draw(answer: Solution, axes: Any, color: str, label: str | None, disks: bool, cables: bool) -> None:
    fine = _smooth(answer)
    label = (label or answer.model) + (" (unstable)" if answer.diagnostics.unstable else "")
    axes.plot(*(1e3 * fine.position.T), color=color, linewidth=2.5, label=label)
    if disks:
        for rim in _rims(answer.robot, answer.disks):
            axes.plot(*(1e3 * rim.T), color="0.55", linewidth=0.8)
    if cables:
        for path in fine.cable_paths():
            axes.plot(*(1e3 * path.T), color="0.15", linewidth=0.9)
    _equal(axes)


def compare(*answers: Solution, axes: Any = None, labels: list[str] | None = None) -> Any:
    """Draws several answers into one picture, with a legend.

    Parameters
    ----------
    answers
        The shapes, for example those of several models.
    axes
        Three-dimensional axes of Matplotlib; new ones by default.
    labels
        One for each; the names of the models by default. At an unstable shape they say so.

    Examples
    --------
    >>> import whipcord
    >>> case = whipcord.load("examples/table1/case-3.toml")
    >>> axes = compare(case.solve(), case.solve(model="four-bar"))
    >>> len(axes.get_legend().get_texts())
    2
    """
    if not answers:
        raise InputError("there is no answer to draw", path="answers")
    if labels is not None and len(labels) != len(answers):
        message = f"labels must be one for each of {len(answers)} answers, but are {labels!r}"
        raise InputError(message, path="labels")
    axes = _axes() if axes is None else axes
    for i, answer in enumerate(answers):
        label = labels[i] if labels else None
        _draw(answer, axes, PALETTE[i % len(PALETTE)], label, disks=i == 0, cables=i == 0)
    axes.legend(loc="upper left", frameon=False)
    return axes


def _axes() -> Any:
    figure = needed("matplotlib.pyplot").figure(figsize=(6.4, 5.6), layout="constrained")
    axes = figure.add_subplot(projection="3d")
    for name in "xyz":
        getattr(axes, f"{name}axis").pane.set_alpha(0.0)
    axes.view_init(elev=22, azim=-60)
    return axes


def _equal(axes: Any) -> None:
    """One scale for all directions, with room for everything that is drawn."""
    from matplotlib.ticker import MultipleLocator

    # Limits that were set for an earlier answer do not follow what is drawn; its extent does.
    flat, high = axes.xy_dataLim, axes.zz_dataLim
    limits = np.array([flat.intervalx, flat.intervaly, high.intervalx])
    middle, extent = limits.mean(axis=1), 1.04 * np.ptp(limits, axis=1)
    # A thin box has no room for the numbers on its edges.
    extent = np.maximum(extent, 0.35 * extent.max())
    for name, at, width in zip("xyz", middle, extent):
        getattr(axes, f"set_{name}lim3d")(at - 0.5 * width, at + 0.5 * width)
        getattr(axes, f"{name}axis").set_major_locator(MultipleLocator(_step(extent.max())))
        getattr(axes, f"set_{name}label")(f"{name} (mm)")
    # Beyond the numbers, also on the axes of small and of tall boxes.
    axes.xaxis.labelpad, axes.yaxis.labelpad, axes.zaxis.labelpad = 6, 8, 14
    # So far away that the labels of a tall robot are inside the picture.
    axes.set_box_aspect(extent, zoom=0.8)


def _step(extent: float) -> float:
    """The number 1, 2 or 5 by a power of ten of which about five are the extent."""
    power = 10.0 ** np.floor(np.log10(extent / 5))
    return float(min((power * factor for factor in (1, 2, 5, 10)), key=lambda s: abs(s - extent / 5)))


def _smooth(answer: Solution) -> Solution:
    """The same answer at stations that a curve is smooth with; itself where it has as many."""
    if len(answer.position) >= SMOOTH:
        return answer
    arguments = {**answer._model.arguments, "stations": SMOOTH}
    from . import _core

    model = _core.Model(**arguments)
    case = answer.case
    return Solution._of(case, model, case._setup.solve(model, None, None, answer._answer), answer)


def _rims(robot: Robot, disks: Shape) -> list[Array]:
    """(37, 3) points on the rim of each disk, in m."""
    radius = robot.disks.hole_circle_radius
    if radius is None:
        return []
    angle = np.linspace(0.0, 2 * np.pi, 37)
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=1)
    radii = np.broadcast_to(np.asarray(radius), len(disks.position))
    # A little material outside the holes.
    return [
        position + 1.15 * r * circle @ turn.T
        for position, turn, r in zip(disks.position, disks.rotation, radii)
    ]


def _pyvista(answer: Solution, plotter: Any, color: str, disks: bool, cables: bool) -> Any:
    pyvista = needed("pyvista")
    plotter = pyvista.Plotter() if plotter is None else plotter
    fine = _smooth(answer)
    backbone = answer.robot.backbone
    given = backbone.diameter or backbone.diameters
    width = float(np.max(given)) if isinstance(given, (int, float, tuple)) else 0.01 * backbone.length
    tube = pyvista.MultipleLines(1e3 * fine.position).tube(radius=0.5e3 * width)
    plotter.add_mesh(tube, color=color, smooth_shading=True)
    if disks:
        for rim, center in zip(_rims(answer.robot, answer.disks), 1e3 * answer.disks.position):
            fan = np.vstack([center, 1e3 * rim])
            faces = np.array([[3, 0, i, i + 1] for i in range(1, len(rim))])
            plotter.add_mesh(pyvista.PolyData(fan, faces.ravel()), color="lightgrey", opacity=0.6)
    if cables:
        for path in fine.cable_paths():
            if len(path) > 1:
                line = pyvista.MultipleLines(1e3 * path).tube(radius=0.12e3 * width)
                plotter.add_mesh(line, color="black")
    titles = {f"{name}title": f"{name} (mm)" for name in "xyz"}
    counts = {f"n_{name}labels": 3 for name in "xyz"}
    plotter.show_grid(**titles, **counts, fmt="%.0f", font_size=10, color="grey")
    plotter.view_vector((1.0, -1.7, 0.8), viewup=(0.0, 0.0, 1.0))
    plotter.camera.zoom(0.85)
    if answer.diagnostics.unstable:
        plotter.add_text("unstable", position="upper_left", font_size=12, color=UNSTABLE)
    return plotter
