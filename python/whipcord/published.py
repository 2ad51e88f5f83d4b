"""What others have measured and published."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["Measured", "Reference"]


@dataclass(frozen=True, eq=False)
class Measured:
    """Where the disks of the real robot were."""

    disks: tuple[int, ...]
    """Numbers of the disks that were measured, from 1."""
    position: npt.NDArray[np.float64]
    """(k, 3) positions in m, in the frame of the base."""
    path: str
    """The file they stand in."""


@dataclass(frozen=True)
class Reference:
    """What others have published for a case."""

    source: str
    """Where the values stand."""
    rms_four_bar: float | None = None
    """RMS error of the four-bar model against the measurement in m."""
    rms_cosserat: float | None = None
    """RMS error of the Cosserat model against the measurement in m."""
    time_four_bar: float | None = None
    """Solve time of the four-bar model in s."""
    time_cosserat: float | None = None
    """Solve time of the Cosserat model in s."""
