"""What the wrappers of JAX and PyTorch are both asked."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import whipcord

Array = npt.NDArray[np.float64]

PATHS = ["backbone.young_modulus", "disks.hole_circle_radius", "loads.tip_force[0]"]


def loaded() -> whipcord.Case:
    """A robot with three cables and a force on its tip, which its cables hold against."""
    case = whipcord.load("examples/three-cable-segment.toml")
    return case.replace(loads=whipcord.Loads(tip_force=["0.3 N", "-0.2 N", "0.1 N"]))


def exact(case: whipcord.Case, tension: Array) -> tuple[Array, Array]:
    """(3, c) and (3, p) derivatives of the tip's position."""
    _, derivatives = case.differentiate(tension=tension, parameters=PATHS)
    return derivatives.position_by_command[-1], derivatives.position_by_parameter[-1]


def agree(found: npt.ArrayLike, expected: Array, tolerance: float = 1e-12) -> None:
    """To a tolerance relative to the greatest entry of each column."""
    found = np.asarray(found)
    assert found.shape == expected.shape
    scale = np.abs(expected).max(axis=-2, keepdims=True)
    assert (np.abs(found - expected) <= tolerance * scale).all(), (found - expected) / scale
