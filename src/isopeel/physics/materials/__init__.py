"""Materials: stored energy, first Piola-Kirchhoff stress and tangent in plane strain.

Materials from a formula are in `materials.formula`, which loads SymPy: a second that most runs can save.
"""

from isopeel.physics.materials.base import Material
from isopeel.physics.materials.neo_hooke import NeoHooke

__all__ = ["Material", "NeoHooke"]
