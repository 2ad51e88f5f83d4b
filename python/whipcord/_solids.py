"""Shaded solids in the three-dimensional axes of Matplotlib. Lengths in m; drawn in mm."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from ._packages import needed

Array = npt.NDArray[np.float64]


class Solids:
    """Flat faces in mm, all in one collection, so that Matplotlib puts them in the order of their depth."""

    def __init__(self) -> None:
        self.faces: list[Array] = []
        self.colors: list[tuple[float, float, float, float]] = []
        self.edges: list[tuple[float, float, float, float]] = []

    def add(
        self, face: Array, color: str, alpha: float, *, rim: bool = False, edge: str | None = None
    ) -> None:
        """A face, the darker the more it is turned away from the light; faint ones are lighter. Its edge is not drawn,
        in the color of the face (`rim`), or in that of `edge`."""
        to_rgb = needed("matplotlib.colors").to_rgb
        normal = np.cross(face[1] - face[0], face[2] - face[1])
        size = float(np.linalg.norm(normal))
        light = abs(float(normal @ LIGHT)) / size if size > 0.0 else 1.0
        red, green, blue = (float((0.7 + 0.3 * light) * part) for part in to_rgb(color))
        self.faces.append(1e3 * face)
        self.colors.append((red, green, blue, alpha))
        self.edges.append((red, green, blue, 1.0 if rim else 0.0) if edge is None else (*to_rgb(edge), 1.0))

    def tube(self, position: Array, rotation: Array, outlines: Array, color: str, alpha: float = 1.0) -> None:
        """Cross-sections, (n, k, 2) in their own frames, joined along a line."""
        flat = np.concatenate([outlines, np.zeros_like(outlines[..., :1])], axis=2)
        corners = position[:, None, :] + np.einsum("nij,nkj->nki", rotation, flat)
        for here, there in pairwise(corners):
            for k in range(len(here)):
                self.add(np.array([here[k - 1], here[k], there[k], there[k - 1]]), color, alpha)
        for end in (corners[0], corners[-1]):
            self.add(end, color, alpha)

    def plate(self, position: Array, turn: Array, radius: float, thickness: float, color: str) -> None:
        """A disk."""
        flat = np.concatenate([radius * circle(36), np.zeros((36, 1))], axis=1)
        lower, upper = (
            position + (flat + np.array([0.0, 0.0, z])) @ turn.T for z in (-0.5 * thickness, 0.5 * thickness)
        )
        for face in (lower, upper):
            self.add(face, color, 0.3, rim=True)
        for k in range(36):
            self.add(np.array([lower[k - 1], lower[k], upper[k], upper[k - 1]]), color, 0.3)

    def arrow_heads(
        self, tail: Array, head: Array, size: float, count: int, color: str, edge: str | None = None
    ) -> Array:
        """Cones at the head of an arrow; returns where the last of them begins."""
        along = (head - tail) / float(np.linalg.norm(head - tail))
        turn = frames(np.array([tail, head]))[0]
        rim = 0.38 * size * np.concatenate([circle(12), np.zeros((12, 1))], axis=1) @ turn.T
        for k in range(count):
            tip, base = head - k * size * along, head - (k + 1) * size * along
            for j in range(12):
                self.add(
                    np.array([base + rim[j - 1], base + rim[j], tip]),
                    color,
                    1.0,
                    edge=edge,
                )
            self.add(base + rim, color, 1.0, edge=edge)
        neck: Array = head - count * size * along
        return neck

    def draw(self, axes: Any) -> None:
        collection = needed("mpl_toolkits.mplot3d.art3d").Poly3DCollection(
            self.faces, facecolors=self.colors, edgecolors=self.edges, linewidths=0.6
        )
        # Some versions of Matplotlib would take limits from memory that they have not set for faces of few corners.
        axes.add_collection(collection, autolim=False)
        points = np.concatenate(self.faces)
        axes.auto_scale_xyz(*points.T, had_data=True)


LIGHT = np.array([0.36, -0.48, 0.8])
"""Direction to the light."""


def circle(corners: int) -> Array:
    angle = 2 * np.pi * np.arange(corners) / corners
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def frames(path: Array) -> Array:
    """(n, 3, 3) frames along a line, the third axis its tangent."""
    tangent = np.gradient(path, axis=0)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-300)
    # Beside whichever axis is farthest from the tangent.
    helper = np.eye(3)[np.argmin(np.abs(tangent), axis=1)]
    first = np.cross(helper, tangent)
    first /= np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-300)
    return np.stack([first, np.cross(tangent, first), tangent], axis=2)
