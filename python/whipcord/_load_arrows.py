"""The loads on a shape as arrows in space: how long they are, where they begin, and how they are drawn."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from ._packages import needed
from ._solids import Solids
from .loads import DistributedLoad, Loads
from .solution import Solution

Array = npt.NDArray[np.float64]

LOAD, WEIGHT, CONTACT = "#1c1c1c", "#7a7a7a", "#c41a1a"
"""Colors of loads, of gravity, and of contacts."""
FORCE, MOMENT, LINE = 0.2, 0.15, 0.1
"""Lengths of the longest arrows of forces, of moments and of distributed loads, relative to the extent of the robot, as in the SVG."""
SHORTEST = 0.3
"""No arrow is shorter than this part of the longest of its kind."""
PLACES = 16
"""Arrows along a load that is distributed over the whole backbone."""
PRESSES = -0.5
"""A force with a smaller cosine to the tangent of the tip presses on the tip: its arrow ends there."""


@dataclass(frozen=True)
class Arrow:
    """From `tail` to `head`, in m."""

    tail: Array
    head: Array
    heads: int
    """1 for forces, 2 for moments."""
    follows: bool
    """Whether the load turns with the cross-section."""
    thin: bool
    """Whether it is one of many arrows of a distributed load."""
    contact: bool = False
    """Whether it is the normal force of a contact."""


@dataclass
class LoadArrows:
    """What is drawn of the loads."""

    arrows: list[Arrow] = field(default_factory=list)
    lines: list[Array] = field(default_factory=list)
    """(n, 3) lines that join the tails of the arrows of a distributed load."""
    masses: list[Array] = field(default_factory=list)
    """(3,) places of the masses."""
    gravity: Array | None = None
    """(3,) unit vector."""
    labels: list[tuple[str, str]] = field(default_factory=list)
    """Texts of the legend, each with what it is for: ``"single"``, ``"follower"``, ``"line"``, ``"mass"``, ``"gravity"`` or
    ``"contact"``."""


def load_arrows(shape: Solution) -> LoadArrows:
    """The arrows of the loads of a case on its shape, which has many stations, and of the normal forces of contacts."""
    result, loads = LoadArrows(), shape.case.loads
    extent = float(np.ptp(shape.position, axis=0).max())
    forces = [(touch, touch.force) for touch in shape.contacts if touch.force]
    for touch, force in forces:
        # From within the obstacle.
        share = max(force / max(size for _, size in forces), SHORTEST)
        tail = touch.point - touch.normal * LINE * 1.5 * extent * share
        result.arrows.append(Arrow(tail, touch.point, 1, False, False, True))
    if forces:
        result.labels.append((_sized([force for _, force in forces], "contact force", "N"), "contact"))
    if loads is None:
        return result
    single: dict[int, list[tuple[Array, Array, bool, bool]]] = {1: [], 2: []}
    for s, vectors, follows in _single(shape, loads):
        at, turn = _place(shape, s)
        for heads, vector in zip((1, 2), vectors):
            if vector is None or not np.any(vector):
                continue
            turned = _turned(shape, loads, np.asarray(vector), turn, follows)
            along = float(turn[:, 2] @ turned) / float(np.linalg.norm(turned))
            presses = heads == 1 and s >= shape.robot.backbone.length and along < PRESSES
            single[heads].append((at, turned, follows, presses))
    for heads, longest, name, unit in ((1, FORCE, "force", "N"), (2, MOMENT, "moment", "N·m")):
        sizes = [float(np.linalg.norm(vector)) for _, vector, _, _ in single[heads]]
        for size, (at, turned, follows, presses) in zip(sizes, single[heads]):
            reach = turned / size * longest * extent * max(size / max(sizes), SHORTEST)
            tail, head = (at - reach, at) if presses else (at, at + reach)
            result.arrows.append(Arrow(tail, head, heads, follows, False))
        for follower in (False, True):
            alike = [size for size, load in zip(sizes, single[heads]) if load[2] == follower]
            if alike:
                words = ", follows the body" if follower else ""
                result.labels.append(
                    (_sized(alike, name, unit) + words, "follower" if follower else "single")
                )
    for load in loads.distributed:
        _distributed(result, shape, loads, load, LINE * extent)
    result.masses = [_place(shape, mass.at)[0] for mass in loads.mass]
    if result.masses:
        weights = [mass.mass for mass in loads.mass]
        result.labels.append((_sized(weights, "mass", "kg"), "mass"))
    if loads.gravity is not None and np.any(loads.gravity):
        size = float(np.linalg.norm(loads.gravity))
        result.gravity = _turned(shape, loads, np.asarray(loads.gravity) / size, np.eye(3), False)
        result.labels.append((f"gravity {size:.4g} m/s²", "gravity"))
    return result


def _single(
    shape: Solution, loads: Loads
) -> Iterator[tuple[float, tuple[tuple[float, ...] | None, tuple[float, ...] | None], bool]]:
    """Arc length, force and moment, and whether they follow, of each load at one place."""
    yield shape.robot.backbone.length, (loads.tip_force, loads.tip_moment), loads.follower
    for point in loads.point:
        yield point.at, (point.force, point.moment), point.follower


def _distributed(
    result: LoadArrows, shape: Solution, loads: Loads, load: DistributedLoad, longest: float
) -> None:
    length = shape.robot.backbone.length
    for given, heads, name, unit in (
        (load.force, 1, "load", "N/m"),
        (load.moment, 2, "line moment", "N·m/m"),
    ):
        if given is None or not np.any(given):
            continue
        values = np.atleast_2d(np.asarray(given, dtype=float))
        if load.at is None:
            knots = np.array([load.start or 0.0, length if load.end is None else load.end])
            values = np.broadcast_to(values[0], (2, 3))
        else:
            knots = np.asarray(load.at, dtype=float)
        count = max(2, 1 + int(np.ceil(PLACES * (knots[-1] - knots[0]) / length)))
        tails, sizes = [], np.linalg.norm(values, axis=1)
        for s in np.linspace(knots[0], knots[-1], count):
            vector = np.array([np.interp(s, knots, part) for part in values.T])
            at, turn = _place(shape, float(s))
            vector = _turned(shape, loads, vector, turn, load.follower)
            tails.append(at - vector / sizes.max() * longest)
            result.arrows.append(Arrow(tails[-1], at, heads, load.follower, True))
        result.lines.append(np.array(tails))
        result.labels.append((_sized(sizes.tolist(), name, unit), "line"))


def _place(shape: Solution, s: float) -> tuple[Array, Array]:
    """Position in m and rotation matrix at an arc length."""
    stations = shape.arc_length
    at = np.array([np.interp(s, stations, part) for part in shape.position.T])
    return at, shape.rotation[int(np.argmin(np.abs(stations - s)))]


def _turned(shape: Solution, loads: Loads, vector: Array, turn: Array, follows: bool) -> Array:
    """A vector of the loads in the world."""
    if follows:
        return turn @ vector
    return vector if loads.frame == "world" else shape.disks.rotation[0] @ vector


def _sized(sizes: list[float], name: str, unit: str) -> str:
    """``force 50 mN``; ``forces up to 3 N`` of several that differ."""
    largest = max(sizes)
    plural = name if "load" in name or "line" in name else "masses" if name == "mass" else f"{name}s"
    same = min(sizes) > (1 - 1e-9) * largest
    words = (name if len(sizes) == 1 else plural) + ("" if same else " up to")
    if unit == "kg":
        return f"{words} {1e3 * largest:.3g} g" if largest < 1 else f"{words} {largest:.3g} kg"
    return f"{words} {1e3 * largest:.3g} m{unit}" if largest < 1 else f"{words} {largest:.3g} {unit}"


def draw_loads(loads: LoadArrows, axes: Any) -> list[Any]:
    """Arrows, squares for masses, and gravity in a corner; entries of the legend."""
    line = needed("matplotlib.lines").Line2D
    low, high = np.array([axes.xy_dataLim.min, axes.xy_dataLim.max]), axes.zz_dataLim.intervalx
    extent = 1e-3 * float(max(np.ptp(low, axis=0).max(), np.ptp(high)))
    heads = Solids()
    for arrow in loads.arrows:
        size = min(
            (0.018 if arrow.thin else 0.035) * extent,
            0.6 * float(np.linalg.norm(arrow.head - arrow.tail)) / arrow.heads,
        )
        if size <= 0.0:
            continue
        color = CONTACT if arrow.contact else LOAD
        fill, edge = ("white", color) if arrow.follows else (color, None)
        neck = heads.arrow_heads(arrow.tail, arrow.head, size, arrow.heads, fill, edge)
        points = 1e3 * np.array([arrow.tail, neck])
        axes.plot(*points.T, color=color, linewidth=0.8 if arrow.thin else 1.6)
    for joined in loads.lines:
        axes.plot(*(1e3 * joined.T), color=LOAD, linewidth=0.8)
    if heads.faces:
        heads.draw(axes)
    if loads.masses:
        axes.scatter(*(1e3 * np.array(loads.masses).T), color=LOAD, marker="s", s=22, depthshade=False)
    if loads.gravity is not None:
        _draw_gravity(loads.gravity, axes)
    looks = {
        "follower": {
            "color": LOAD,
            "linewidth": 1.6,
            "marker": ">",
            "markevery": [1],
            "markerfacecolor": "white",
        },
        "contact": {"color": CONTACT, "linewidth": 1.6, "marker": ">", "markevery": [1]},
        "single": {"color": LOAD, "linewidth": 1.6, "marker": ">", "markevery": [1]},
        "line": {"color": LOAD, "linewidth": 0.8, "marker": ">", "markevery": [1], "markersize": 4},
        "mass": {"color": LOAD, "linewidth": 0.0, "marker": "s", "markevery": [1], "markersize": 5},
        "gravity": {"color": WEIGHT, "linewidth": 1.6, "marker": ">", "markevery": [1]},
    }
    return [line([0, 1], [0, 0], label=label, **looks[kind]) for label, kind in loads.labels]


def _draw_gravity(direction: Array, axes: Any) -> None:
    """An arrow at the edge of what is drawn, where it covers nothing."""
    flat, high = axes.xy_dataLim, axes.zz_dataLim
    limits = 1e-3 * np.array([flat.intervalx, flat.intervaly, high.intervalx])
    length = 0.15 * float(np.ptp(limits, axis=1).max())
    start = np.array([limits[0, 0] - 0.5 * length, limits[1, 1], limits[2].mean()]) - 0.5 * length * direction
    heads = Solids()
    neck = heads.arrow_heads(start, start + length * direction, 0.25 * length, 1, WEIGHT)
    axes.plot(*(1e3 * np.array([start, neck]).T), color=WEIGHT, linewidth=1.6)
    heads.draw(axes)
