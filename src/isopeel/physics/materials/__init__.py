"""Materials: stored energy, first Piola-Kirchhoff stress and tangent in plane strain."""

from isopeel.physics.materials.base import Material
from isopeel.physics.materials.formula import FormulaMaterial
from isopeel.physics.materials.neo_hooke import NeoHooke

__all__ = ["FormulaMaterial", "Material", "NeoHooke"]
