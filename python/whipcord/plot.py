"""Pictures with Matplotlib, or with PyVista where it is asked for. Millimetres, as in all pictures here.

>>> import whipcord
>>> import matplotlib; matplotlib.use("Agg")
>>> case = whipcord.load("examples/table1/case-3.toml")
>>> axes = case.solve(stations=91).plot()
>>> axes.get_xlabel()
'x (mm)'
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from ._packages import needed
from .errors import InputError
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
CONTACT = "#c41a1a"
"""Color of contacts."""
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
) -> Any:
    """Draws a robot in space: the backbone with its cross-section and the disks with their thickness in the
    color of the model, the cables in colors of their own, and where it touches obstacles.

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
    disks, cables
        Whether they are drawn.

    Returns
    -------
    The axes, or the plotter.
    """
    color = color or _color(answer.model)
    if backend == "pyvista":
        return _pyvista(answer, axes, color, disks, cables)
    if backend != "matplotlib":
        raise InputError(f"there is no backend `{backend}`: choose matplotlib or pyvista", path="backend")
    axes = _axes() if axes is None else axes
    _draw_whole(answer, axes, color, label, disks, cables)
    axes.legend(loc="upper right", frameon=False, fontsize="small")
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
    solids = _Solids()
    solids.tube(fine.position, fine.rotation, _outlines(answer.robot, fine.arc_length), color)
    if disks:
        for plate in _plates(answer.robot, answer.disks):
            solids.plate(*plate, color)
    if cables:
        thin = 2e-3 * answer.robot.backbone.length
        for i, (path, cable) in enumerate(zip(fine.cable_paths(), answer.robot.cables)):
            own = CABLES[i % len(CABLES)]
            axes.plot(*(1e3 * path.T), color=own, linewidth=1.2, label=f"cable {cable.name}")
            if len(path) > 1:
                frames = _frames(path)
                solids.tube(path, frames, np.broadcast_to(thin * _circle(6), (len(path), 6, 2)), own)
    solids.draw(axes)
    if answer.touches:
        points = 1e3 * np.array([touch.point for touch in answer.touches])
        axes.scatter(*points.T, color=CONTACT, s=18, depthshade=False, label="contacts")
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


class _Solids:
    """Flat faces in mm, all in one collection, so that Matplotlib puts them in the order of their depth."""

    def __init__(self) -> None:
        self.faces: list[Array] = []
        self.colors: list[tuple[float, float, float, float]] = []
        self.edges: list[tuple[float, float, float, float]] = []

    def add(self, face: Array, color: str, alpha: float, *, rim: bool = False) -> None:
        """A face, the darker the more it is turned away from the light; faint ones are lighter."""
        to_rgb = needed("matplotlib.colors").to_rgb
        normal = np.cross(face[1] - face[0], face[2] - face[1])
        size = float(np.linalg.norm(normal))
        light = abs(float(normal @ LIGHT)) / size if size > 0.0 else 1.0
        red, green, blue = (float((0.7 + 0.3 * light) * part) for part in to_rgb(color))
        self.faces.append(1e3 * face)
        self.colors.append((red, green, blue, alpha))
        self.edges.append((red, green, blue, 1.0 if rim else 0.0))

    def tube(self, position: Array, rotation: Array, outlines: Array, color: str) -> None:
        """Cross-sections, (n, k, 2) in their own frames, joined along a line."""
        flat = np.concatenate([outlines, np.zeros_like(outlines[..., :1])], axis=2)
        corners = position[:, None, :] + np.einsum("nij,nkj->nki", rotation, flat)
        for here, there in pairwise(corners):
            for k in range(len(here)):
                self.add(np.array([here[k - 1], here[k], there[k], there[k - 1]]), color, 1.0)
        for end in (corners[0], corners[-1]):
            self.add(end, color, 1.0)

    def plate(self, position: Array, turn: Array, radius: float, thickness: float, color: str) -> None:
        """A disk."""
        flat = np.concatenate([radius * _circle(36), np.zeros((36, 1))], axis=1)
        lower, upper = (
            position + (flat + np.array([0.0, 0.0, z])) @ turn.T for z in (-0.5 * thickness, 0.5 * thickness)
        )
        for face in (lower, upper):
            self.add(face, color, 0.3, rim=True)
        for k in range(36):
            self.add(np.array([lower[k - 1], lower[k], upper[k], upper[k - 1]]), color, 0.3)

    def draw(self, axes: Any) -> None:
        collection = needed("mpl_toolkits.mplot3d.art3d").Poly3DCollection(
            self.faces, facecolors=self.colors, edgecolors=self.edges, linewidths=0.6
        )
        axes.add_collection3d(collection)
        points = np.concatenate(self.faces)
        axes.auto_scale_xyz(*points.T)


LIGHT = np.array([0.36, -0.48, 0.8])
"""Direction to the light."""


def _circle(corners: int) -> Array:
    angle = 2 * np.pi * np.arange(corners) / corners
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


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
        return 0.5 * _along(given, s, disks)[:, None, None] * _circle(16)
    if backbone.section is not None:
        size = [_along(side, s, disks) for side in (backbone.section.width, backbone.section.height)]
        square = 0.5 * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
        return np.stack(size, axis=1)[:, None, :] * square
    return np.broadcast_to(0.004 * backbone.length * _circle(16), (len(s), 16, 2))


def _stations(robot: Robot) -> Array:
    """Arc lengths of the disks in m; both ends of a robot without disks."""
    disks = robot.disks
    if disks is None:
        return np.array([0.0, robot.backbone.length])
    if disks.positions is not None:
        return np.asarray(disks.positions, dtype=float)
    return np.linspace(0.0, robot.backbone.length, disks.count or 2)


def _frames(path: Array) -> Array:
    """(n, 3, 3) frames along a line, the third axis its tangent."""
    tangent = np.gradient(path, axis=0)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-300)
    # Beside whichever axis is farthest from the tangent.
    helper = np.eye(3)[np.argmin(np.abs(tangent), axis=1)]
    first = np.cross(helper, tangent)
    first /= np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-300)
    return np.stack([first, np.cross(tangent, first), tangent], axis=2)


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
    circle = np.concatenate([_circle(36), np.zeros((36, 1))], axis=1)
    closed = np.vstack([circle, circle[:1]])
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
