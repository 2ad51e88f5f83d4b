"""Materials that a backbone may be made of, by name."""

from __future__ import annotations

from dataclasses import dataclass

from . import _core

__all__ = ["Material", "materials"]


@dataclass(frozen=True)
class Material:
    """A material that `material` of a :class:`Backbone` names. Along the fibres where there are any."""

    name: str
    """Its name."""
    young_modulus: float
    """Young's modulus in Pa."""
    young_modulus_range: tuple[float, float]
    """Least and greatest Young's modulus in Pa of what is sold under the name."""
    poisson_ratio: float | None
    """Poisson's ratio; None where `shear_modulus` is given."""
    shear_modulus: float | None
    """Shear modulus in Pa, of rods with fibres along them."""
    density: float
    """Density in kg/m³."""
    yield_strain: float | None
    """Strain up to which it springs back, where that is known."""
    source: str
    """Where the values stand, and what to mind."""


def materials() -> dict[str, Material]:
    """All materials by their names.

    Examples
    --------
    >>> import whipcord
    >>> nitinol = whipcord.materials()["nitinol"]
    >>> nitinol.young_modulus, nitinol.young_modulus_range
    (60000000000.0, (40000000000.0, 83000000000.0))
    """
    return {entries["name"]: Material(**entries) for entries in _core.materials()}
