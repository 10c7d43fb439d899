"""Materials: stored energy, first Piola-Kirchhoff stress and tangent, in plane strain and in space.

Materials from a formula are in `materials.formula`, which loads SymPy when one is made: a second.
"""

from isopeel.physics.materials.base import Material
from isopeel.physics.materials.isotropic import Isotropic, material
from isopeel.physics.materials.mooney_rivlin import MooneyRivlin
from isopeel.physics.materials.neo_hooke import NeoHooke
from isopeel.physics.materials.saint_venant_kirchhoff import SaintVenantKirchhoff
from isopeel.physics.materials.yeoh import Yeoh

__all__ = ["Isotropic", "Material", "MooneyRivlin", "NeoHooke", "SaintVenantKirchhoff", "Yeoh", "material"]
