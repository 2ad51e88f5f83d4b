"""Where the tip of a robot can go."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._tables import Quantity
from .errors import InputError
from .reaching import in_si

__all__ = ["Boundary", "Workspace"]

Array = npt.NDArray[np.float64]
MAPS = ("dexterity", "accuracy", "stiffness")


@dataclass(frozen=True, eq=False, repr=False)
class Boundary:
    """Points of the boundary of a workspace."""

    tip: Array
    """(B, 3) where the tip is, in m."""
    normal: Array
    """(B, 3) unit vectors out of the workspace."""
    limits: tuple[tuple[str, ...], ...]
    """For each point the limits that hold the tip back, in words; none where no command moves the tip outward."""

    def __len__(self) -> int:
        return len(self.tip)

    def __repr__(self) -> str:
        return f"<Boundary of {len(self)} points>"


@dataclass(frozen=True, eq=False, repr=False)
class Workspace:
    """The voxels that the tip can be brought into, with the commands that bring it there, and the boundary.

    Examples
    --------
    >>> import whipcord
    >>> case = whipcord.load("examples/three-cable-segment.toml")
    >>> where = case.workspace(voxel="10 mm", limits={"tension": [0, "4 N"]})
    >>> where.dimension, where.complete
    (2, True)
    >>> bool(np.allclose(case.solve(tension=where.command[0]).tip, where.tip[0], atol=1e-5))
    True
    """

    voxel: float
    """Edge of a voxel in m."""
    index: npt.NDArray[np.int64]
    """(N, 3) number of each voxel along x, y and z; the voxel of the number 0 begins at 0."""
    tip: Array
    """(N, 3) where the tip is in each voxel, in m."""
    axis: Array
    """(N, 3) direction of the backbone at the tip there."""
    command: Array
    """(N, a) commands that bring the tip there: N, m or rad."""
    actuators: tuple[tuple[str, str], ...]
    """What each of them commands: ``"tension"``, ``"shortening"`` or ``"motor"``, and the name of the cable or motor."""
    full: npt.NDArray[np.bool_]
    """(N,) whether the tip can be brought to the centre of the voxel."""
    directions: npt.NDArray[np.int64]
    """(N,) in how many directions commands move the tip."""
    condition: Array
    """(N,) ratio of the greatest to the least of these motions; NaN where nothing moves."""
    motion: Array
    """(N, 2) least and greatest motion of the tip in m for commands that bend the straight robot by half a turn."""
    stiffness: Array
    """(N, 2) least and greatest stiffness of the tip in N/m against a force, with the commands held; NaN where it was not asked
    for or is not known."""
    boundary: Boundary
    """Points of the boundary, with what holds the tip back."""
    dimension: int
    """3 of a body, 2 of a surface, 1 of a curve, which are no thicker than a voxel."""
    measure: float
    """Volume in m³, area in m² or length in m, by the dimension."""
    extent: Array
    """(2, 3) least and greatest coordinates of the tip in m."""
    complete: bool
    """Whether the survey came to its end. If not, the workspace may be larger."""
    solves: int
    """Solves of the model."""

    @property
    def centre(self) -> Array:
        """(N, 3) centres of the voxels in m."""
        return np.asarray((self.index + 0.5) * self.voxel, dtype=np.float64)

    def map(self, name: str) -> Array:
        """One number for each voxel.

        Parameters
        ----------
        name
            ``"dexterity"``, the least motion of the tip in m for commands that bend the straight robot by half a turn;
            ``"accuracy"``, by how many m the tip is off at most if the commands are off by 1 % of those; ``"stiffness"``, the least
            stiffness of the tip in N/m.

        Returns
        -------
        numpy.ndarray
            (N,) values.
        """
        if name not in MAPS:
            raise InputError(
                f"there is no map {name!r}: choose dexterity, accuracy or stiffness", path="name"
            )
        if name == "dexterity":
            return self.motion[:, 0]
        return 0.01 * self.motion[:, 1] if name == "accuracy" else self.stiffness[:, 0]

    def section(self, axis: str, at: Quantity = 0.0) -> npt.NDArray[np.bool_]:
        """The voxels that a plane passes through.

        Parameters
        ----------
        axis
            ``"x"``, ``"y"`` or ``"z"``: the normal of the plane.
        at
            Coordinate of the plane along this axis in m.

        Returns
        -------
        numpy.ndarray
            (N,) whether the plane passes through the voxel.

        Examples
        --------
        >>> import whipcord
        >>> case = whipcord.load("examples/three-cable-segment.toml")
        >>> where = case.workspace(voxel="10 mm", limits={"tension": [0, "4 N"]})
        >>> plane = where.section("y", "1 mm")
        >>> set(where.index[plane, 1].tolist())
        {0}
        """
        if axis not in ("x", "y", "z"):
            raise InputError(f"axis must be x, y or z, but is {axis!r}", path="axis")
        number = np.floor(in_si(at, "at", "length") / self.voxel)
        found: npt.NDArray[np.bool_] = self.index[:, "xyz".index(axis)] == number
        return found

    def grid(self, values: npt.ArrayLike | None = None) -> tuple[Array, Array]:
        """The voxels as an array in space.

        Parameters
        ----------
        values
            (N,) a number for each voxel, such as :meth:`map` gives; by default 1.

        Returns
        -------
        tuple
            (3,) corner of the array with the least coordinates in m, and the array of the shape (nx, ny, nz), NaN where the tip does not
            get to.
        """
        given = np.ones(len(self)) if values is None else np.asarray(values, dtype=np.float64)
        if given.shape != (len(self),):
            raise InputError(
                f"values must have the shape ({len(self)},), one for each voxel, but has {given.shape}",
                path="values",
            )
        least = self.index.min(axis=0)
        array = np.full(tuple(self.index.max(axis=0) - least + 1), np.nan)
        array[tuple((self.index - least).T)] = given
        return least * self.voxel, array

    def __len__(self) -> int:
        return len(self.index)

    def _columns(self) -> dict[str, npt.NDArray[Any]]:
        """The columns of voxels.csv of the command, without units in their names."""
        triples = (("", self.centre), ("tip_", self.tip), ("axis_", self.axis))
        columns: dict[str, npt.NDArray[Any]] = {
            f"{name}{axis}": values[:, k].copy() for name, values in triples for k, axis in enumerate("xyz")
        }
        columns |= {
            "full": self.full,
            "directions": self.directions,
            "condition": self.condition,
            "least_motion": self.motion[:, 0].copy(),
            "greatest_motion": self.motion[:, 1].copy(),
            "least_stiffness": self.stiffness[:, 0].copy(),
            "greatest_stiffness": self.stiffness[:, 1].copy(),
        }
        for k, (kind, name) in enumerate(self.actuators):
            columns[f"{kind}:{name}"] = self.command[:, k].copy()
        return columns

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` with a line for each voxel: its centre, a place of the tip in it, the direction of the
        backbone there, what the maps show, and the commands; SI."""
        from .export import to_pandas

        return to_pandas(self._columns())

    def to_polars(self) -> Any:
        """A ``polars.DataFrame`` with the same lines."""
        from .export import to_polars

        return to_polars(self._columns())

    def to_arrow(self) -> Any:
        """A ``pyarrow.Table`` with the same lines."""
        from .export import to_arrow

        return to_arrow(self._columns())

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes the same lines as CSV.

        Parameters
        ----------
        path
            The file, which is replaced if it exists.
        """
        from .export import to_csv

        to_csv(self._columns(), path)

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Writes the same lines as Parquet (needs the package pyarrow).

        Parameters
        ----------
        path
            The file, which is replaced if it exists.
        """
        from .export import to_parquet

        to_parquet(self._columns(), path)

    def __repr__(self) -> str:
        power, unit = {3: (1e6, "cm³"), 2: (1e4, "cm²")}.get(self.dimension, (1e3, "mm"))
        size = f"{power * self.measure:.4g} {unit}"
        return f"<Workspace of {len(self)} voxels of {1e3 * self.voxel:.4g} mm: {size}>"


def workspace(
    setup: _core.Setup,
    model: _core.Model,
    asked: dict[str, Any],
    voxel: Quantity | None,
    stiffness: bool,
    budget: tuple[int, int] | None,
) -> Workspace:
    edge = None if voxel is None else in_si(voxel, "voxel", "length")
    values = _core.workspace(setup, model, asked, edge, stiffness, budget)
    limits = tuple(tuple(words) for words in values.pop("boundary_limits"))
    boundary = Boundary(values.pop("boundary_tip"), values.pop("boundary_normal"), limits)
    return Workspace(boundary=boundary, actuators=tuple(values.pop("actuators")), **values)
