"""The interface of a material."""

from typing import Protocol

from isopeel.common.arrays import FloatArray
from isopeel.physics.batch import BatchFunction


class Material(Protocol):
    """What the assembly and the figures need of a material. All stresses share one unit."""

    @property
    def youngs_modulus(self) -> float:
        """Young's modulus at small strain (stress)."""
        ...

    @property
    def poissons_ratio(self) -> float:
        """Poisson's ratio at small strain."""
        ...

    @property
    def parameters(self) -> FloatArray:
        """Numbers handed to the kernel."""
        ...

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of `MATERIAL_SIGNATURE`, plane strain: psi, P = dpsi/dF and, on request, dP/dF."""
        ...

    def solid_response(self, deformation_gradient: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Energy density (...), P (..., 3, 3) and dP/dF (..., 3, 3, 3, 3) at F (..., 3, 3)."""
        ...

    def out_of_plane_stress(self, deformation_gradient: FloatArray) -> FloatArray:
        """Cauchy stress sigma_33 (...) that keeps F_33 = 1, for F (..., 2, 2)."""
        ...


def plane_strain_modulus(material: Material) -> float:
    """E' = E / (1 - nu^2), the modulus of a strip bent in plane strain."""
    return material.youngs_modulus / (1 - material.poissons_ratio**2)
