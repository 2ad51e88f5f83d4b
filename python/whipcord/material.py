"""Material presets of backbones."""

from __future__ import annotations

from dataclasses import dataclass

from . import _core

__all__ = ["Material", "materials"]


@dataclass(frozen=True)
class Material:
    """A preset for `material` of a :class:`Backbone`. Moduli of rods with fibres are those along the fibres."""

    name: str
    """Its name."""
    young_modulus: float
    """Young's modulus in Pa."""
    young_modulus_range: tuple[float, float]
    """Least and greatest Young's modulus in Pa of materials of this name."""
    poisson_ratio: float | None
    """Poisson's ratio; None where `shear_modulus` is given."""
    shear_modulus: float | None
    """Shear modulus in Pa, of rods with fibres along them."""
    density: float
    """Density in kg/m³."""
    yield_strain: float | None
    """Largest strain without permanent deformation or fracture; None if it is not known."""
    source: str
    """Source of the values, and remarks."""


def materials() -> dict[str, Material]:
    """All material presets by name.

    Examples
    --------
    >>> import whipcord
    >>> nitinol = whipcord.materials()["nitinol"]
    >>> nitinol.young_modulus, nitinol.young_modulus_range
    (60000000000.0, (40000000000.0, 83000000000.0))
    """
    return {entries["name"]: Material(**entries) for entries in _core.materials()}
