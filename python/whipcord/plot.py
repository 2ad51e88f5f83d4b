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

from ._load_arrows import CONTACT, draw_loads, load_arrows
from ._packages import needed
from ._solids import Solids, circle, frames
from .errors import InputError, WhipcordError
from .robot import Along, Robot
from .solution import Shape, Solution

__all__ = ["compare", "solution"]

Array = npt.NDArray[np.float64]

MODELS = {
    "cosserat": "#0072b2",
    "cosserat-disks": "#d55e00",
    "four-bar": "#009e73",
    "constant-curvature": "#cc79a7",
    "piecewise-constant-curvature": "#e69f00",
    "pseudo-rigid-body": "#56b4e9",
}
"""The color of each model, as in all other pictures: told apart by all kinds of color vision."""
CABLES = ("#a0522d", "#8e5bd0", "#5c8f1f", "#ee6677", "#01665e", "#c51b7d")
"""The colors of cables."""
UNSTABLE = "#b00020"
"""Colour of the word."""
SMOOTH = 91
"""Stations that a curve is smooth with."""
BEFORE = "#8c8c8c"
"""Color of the shape before actuation."""
STYLES = ("-", (0, (5, 2)), (0, (1, 1.5)), (0, (6, 2, 1, 2)))
"""Of the lines of the first, second, … answer by the same model."""


def solution(
    answer: Solution,
    *,
    axes: Any = None,
    backend: str = "matplotlib",
    color: str | None = None,
    label: str | None = None,
    disks: bool = True,
    cables: bool = True,
    loads: bool = True,
    unactuated: bool = True,
) -> Any:
    """Draws a robot in space: the backbone with its cross-section and the disks with their thickness in the
    color of the model, the cables in colors of their own, the loads as arrows (moments with two heads, follower
    loads with hollow heads), the backbone before actuation as a thin dashed line, and the contacts with their
    normal forces. Obstacles are not drawn: :meth:`whipcord.Solution.svg` draws them.

    Parameters
    ----------
    answer
        The shape.
    axes
        Axes to draw into: three-dimensional ones of Matplotlib, or a plotter of PyVista; new ones by default.
    backend
        ``"matplotlib"`` or ``"pyvista"``.
    color
        Of the backbone and the disks; that of the model by default.
    label
        For the legend; the name of the model by default. At an unstable shape it says so.
    disks, cables, loads, unactuated
        Whether disks, cables, loads and the shape before actuation are drawn. PyVista draws disks and cables alone.

    Returns
    -------
    The axes, or the plotter.
    """
    color = color or _color(answer.model)
    if backend == "pyvista":
        return _pyvista(answer, axes, color, disks, cables)
    if backend != "matplotlib":
        raise InputError(f"there is no backend `{backend}`: choose matplotlib or pyvista", path="backend")
    axes = _axes(_azimuth(answer)) if axes is None else axes
    _draw_whole(answer, axes, color, label, disks, cables)
    handles, _ = axes.get_legend_handles_labels()
    if unactuated:
        handles += _draw_unactuated(answer, axes)
    if loads:
        handles += draw_loads(load_arrows(_smooth(answer)), axes)
    _equal(axes)
    look = {"facecolor": "white", "edgecolor": "none", "framealpha": 0.8, "fontsize": "small"}
    axes.legend(handles=handles, loc="upper right", bbox_to_anchor=(1.13, 1.01), **look)
    if answer.diagnostics.unstable:
        axes.text2D(0.02, 0.98, "unstable", transform=axes.transAxes, va="top", color=UNSTABLE)
    return axes


def _color(model: str) -> str:
    """Of a model; a variant has that of its model."""
    known = [name for name in MODELS if model == name or model.startswith(name + "-")]
    return MODELS[max(known, key=len)] if known else MODELS["cosserat"]


def _named(answer: Solution, label: str | None) -> str:
    return (label or answer.model) + (" (unstable)" if answer.diagnostics.unstable else "")


def _draw_whole(
    answer: Solution, axes: Any, color: str, label: str | None, disks: bool, cables: bool
) -> None:
    fine = _smooth(answer)
    axes.plot(*(1e3 * fine.position.T), color=color, linewidth=2.5, label=_named(answer, label))
    solids = Solids()
    # Through a body with cables in channels these are seen.
    alpha = 1.0 if answer.robot.disks is not None or not cables else 0.25
    solids.tube(fine.position, fine.rotation, _outlines(answer.robot, fine.arc_length), color, alpha)
    if disks:
        for plate in _plates(answer.robot, answer.disks):
            solids.plate(*plate, color)
    if cables:
        thin = 2e-3 * answer.robot.backbone.length
        for i, (path, cable) in enumerate(zip(fine.cable_paths(), answer.robot.cables)):
            own = CABLES[i % len(CABLES)]
            axes.plot(*(1e3 * path.T), color=own, linewidth=1.2, label=f"cable {cable.name}")
            if len(path) > 1:
                solids.tube(path, frames(path), np.broadcast_to(thin * circle(6), (len(path), 6, 2)), own)
    solids.draw(axes)
    if answer.contacts:
        points = 1e3 * np.array([touch.point for touch in answer.contacts])
        axes.scatter(*points.T, color=CONTACT, s=18, depthshade=False, label="contacts")


def _draw_unactuated(answer: Solution, axes: Any) -> list[Any]:
    """The backbone before actuation and without loads; its entry in the legend. Nothing where it is the shape itself."""
    before, shape = _unactuated(answer), _smooth(answer)
    length = answer.robot.backbone.length
    reach = [np.linalg.norm(line[-1] - line[0]) for line in (before, shape.position)]
    if (
        np.linalg.norm(before[-1] - shape.position[-1]) < 1e-3 * length
        and abs(reach[0] - reach[1]) < 1e-3 * length
    ):
        return []
    return list(
        axes.plot(
            *(1e3 * before.T), color=BEFORE, linewidth=1.0, linestyle=(0, (5, 3)), label="before actuation"
        )
    )


def _unactuated(answer: Solution) -> Array:
    """(n, 3) points in m."""
    from . import _core

    count = len(answer.robot.cables)
    commands: dict[str, Any] = {"tension": [0.0] * count, "shortening": None} if count else {}
    case = answer.case.replace(loads=None, obstacles=(), steps=(), **commands)
    try:
        return case._setup.solve(_core.Model(kind="cosserat", stations=SMOOTH), None, None, None).position
    except WhipcordError:
        # Without section or material the backbone is known to geometric models alone, for which it is straight.
        ends = np.array([[0.0], [answer.robot.backbone.length]])
        straight: Array = answer.disks.position[0] + ends * answer.disks.rotation[0][:, 2]
        return straight


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
    seen: dict[str, int] = {}
    for i, answer in enumerate(answers):
        fine, color = _smooth(answer), _color(answer.model)
        before = seen.setdefault(color, 0)
        seen[color] += 1
        # Where several run together, all are seen: each is thinner than what is below it.
        width, style = 1.6 + 0.6 * (len(answers) - 1 - i), STYLES[before % len(STYLES)]
        label = _named(answer, labels[i] if labels else None)
        axes.plot(*(1e3 * fine.position.T), color=color, linewidth=width, linestyle=style, label=label)
        if i == 0:
            for rim in _rims(answer.robot, answer.disks):
                axes.plot(*(1e3 * rim.T), color="0.6", linewidth=0.7)
            for k, path in enumerate(fine.cable_paths()):
                axes.plot(*(1e3 * path.T), color=CABLES[k % len(CABLES)], linewidth=0.9)
        _equal(axes)
    axes.legend(loc="upper left", frameon=False)
    return axes


def _along(quantity: Any, s: Array, disks: Array) -> Array:
    """A quantity of the backbone at arc lengths: one value, one for each disk, or :class:`Along`."""
    at, values = disks, np.asarray(quantity.values if isinstance(quantity, Along) else quantity, dtype=float)
    if isinstance(quantity, Along):
        at = np.asarray(quantity.at, dtype=float)
    return np.full_like(s, float(values)) if values.ndim == 0 else np.interp(s, at, values)


def _outlines(robot: Robot, s: Array) -> Array:
    """(n, k, 2) corners of the backbone's cross-section at arc lengths, in m."""
    backbone = robot.backbone
    given = backbone.diameter if backbone.diameter is not None else backbone.diameters
    disks = _stations(robot)
    if given is not None:
        return 0.5 * _along(given, s, disks)[:, None, None] * circle(16)
    if backbone.section is not None:
        at = disks if backbone.section.at is None else np.asarray(backbone.section.at, dtype=float)
        size = [_along(side, s, at) for side in (backbone.section.width, backbone.section.height)]
        square = 0.5 * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
        return np.stack(size, axis=1)[:, None, :] * square
    return np.broadcast_to(0.004 * backbone.length * circle(16), (len(s), 16, 2))


def _stations(robot: Robot) -> Array:
    """Arc lengths of the disks in m; both ends of a robot without disks."""
    disks = robot.disks
    if disks is None:
        return np.array([0.0, robot.backbone.length])
    if disks.positions is not None:
        return np.asarray(disks.positions, dtype=float)
    return np.linspace(0.0, robot.backbone.length, disks.count or 2)


def _axes(azimuth: float = -60.0) -> Any:
    figure = needed("matplotlib.pyplot").figure(figsize=(7.4, 5.4), layout="constrained")
    axes = figure.add_subplot(projection="3d")
    for name in "xyz":
        getattr(axes, f"{name}axis").pane.set_alpha(0.0)
    axes.view_init(elev=22, azim=azimuth)
    return axes


def _azimuth(answer: Solution) -> float:
    """One of eight directions in degrees from which the farthest excursion from the z axis is seen from the side."""
    farthest = max(_smooth(answer).position, key=lambda point: float(np.hypot(point[0], point[1])))
    if np.hypot(farthest[0], farthest[1]) < 0.02 * answer.robot.backbone.length:
        return -60.0
    bend = np.arctan2(farthest[1], farthest[0])
    return max(range(-60, 300, 45), key=lambda azimuth: float(np.cos(bend - np.radians(azimuth + 60))))


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
    axes.xaxis.labelpad, axes.yaxis.labelpad, axes.zaxis.labelpad = 10, 9, 14
    # So far away that the labels of a tall robot are inside the picture.
    axes.set_box_aspect(extent, zoom=0.77)


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
    return Solution._of(case, model, case._setup.solve(model, start=answer._answer), answer)


def _radii(robot: Robot, count: int) -> Array | None:
    """Radius of the rim of each disk in m; None where the robot has none."""
    disks = robot.disks
    if disks is None:
        return None
    if disks.outer_radius is not None:
        return np.full(count, disks.outer_radius)
    if disks.hole_circle_radius is None:
        return None
    # A little material outside the holes.
    return 1.2 * np.broadcast_to(np.asarray(disks.hole_circle_radius, dtype=float), count)


def _plates(robot: Robot, disks: Shape) -> list[tuple[Array, Array, float, float]]:
    """Place, frame, radius and thickness of each disk, in m: what the robot does not give is as in the SVG."""
    radii = _radii(robot, len(disks.position))
    if radii is None:
        return []
    least = float(np.min(np.diff(_stations(robot))))
    given = None if robot.disks is None else robot.disks.thickness
    thickness = np.minimum(0.1 * radii if given is None else given, 0.5 * least)
    sizes = np.broadcast_to(thickness, len(radii))
    return [
        (position, turn, float(radius), float(size))
        for position, turn, radius, size in zip(disks.position, disks.rotation, radii, sizes)
    ]


def _rims(robot: Robot, disks: Shape) -> list[Array]:
    """(37, 3) points on the rim of each disk, in m."""
    flat = np.concatenate([circle(36), np.zeros((36, 1))], axis=1)
    closed = np.vstack([flat, flat[:1]])
    return [position + radius * closed @ turn.T for position, turn, radius, _ in _plates(robot, disks)]


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
            plotter.add_mesh(pyvista.PolyData(fan, faces.ravel()), color=color, opacity=0.3)
    if cables:
        for i, path in enumerate(fine.cable_paths()):
            if len(path) > 1:
                line = pyvista.MultipleLines(1e3 * path).tube(radius=0.12e3 * width)
                plotter.add_mesh(line, color=CABLES[i % len(CABLES)])
    titles = {f"{name}title": f"{name} (mm)" for name in "xyz"}
    counts = {f"n_{name}labels": 3 for name in "xyz"}
    plotter.show_grid(**titles, **counts, fmt="%.0f", font_size=10, color="grey")
    plotter.view_vector((1.0, -1.7, 0.8), viewup=(0.0, 0.0, 1.0))
    plotter.camera.zoom(0.85)
    if answer.diagnostics.unstable:
        plotter.add_text("unstable", position="upper_left", font_size=12, color=UNSTABLE)
    return plotter
