"""Isotropic materials, stated by their stored energy in three dimensions."""

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self, TypeVar, dataclass_transform

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.components import Component, named_dataclass
from isopeel.common.quantities import Limit, Meaning, Number, Positive, Stress
from isopeel.physics.batch import BatchFunction
from isopeel.physics.materials import invariants
from isopeel.physics.materials.plane_strain import plane_strain_kernel
from isopeel.physics.points import check_arguments

Kind = TypeVar("Kind", bound="type[Isotropic]")


class Isotropic(Component):
    """The base of a material, which `material` makes of its fields and its energy.

    `stored_energy` returns the energy per reference volume. Its arguments are what it needs of `I1`, `I2` and
    `J`, see `invariants`, and the numbers of `constants`, under names of their own. It is called once, with
    objects that record its operations, which are differentiated and compiled: it may use + - * / ** and
    functions of NumPy, and must not compare numbers. Energies of J are nan where J <= 0.

    A material has a `youngs_modulus` and a `poissons_ratio`, at small strain, as fields or from its energy.
    """

    table: ClassVar[str] = "material"
    needed: ClassVar[tuple[tuple[str, ...], ...]] = (("stored_energy",),)
    stored_energy: ClassVar[Callable[..., Any]]

    if TYPE_CHECKING:

        @property
        def youngs_modulus(self) -> float:
            """Young's modulus at small strain (stress)."""

        @property
        def poissons_ratio(self) -> float:
            """Poisson's ratio at small strain."""

    @classmethod
    def like(cls, youngs_modulus: float, poissons_ratio: float) -> Self:
        """The material of these constants at small strain; here for one with these fields."""
        known: Any = {"youngs_modulus": youngs_modulus, "poissons_ratio": poissons_ratio}
        return cls(**known)

    def constants(self) -> tuple[float, ...]:
        """Numbers that the energy needs, in the order of its arguments: by default the fields."""
        return tuple(getattr(self, field.name) for field in fields(self))  # type: ignore[arg-type]

    @property
    def parameters(self) -> FloatArray:
        """Numbers handed to the kernel: the constants."""
        return np.array(self.constants(), dtype=np.float64)

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of energy density, stress and tangent in plane strain."""
        check_arguments(self.stored_energy, invariants.INVARIANTS, self.parameters.tolist())
        return plane_strain_kernel(self.stored_energy)

    def solid_response(self, deformation_gradient: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Energy density (...), P (..., 3, 3) and dP/dF (..., 3, 3, 3, 3) at F (..., 3, 3)."""
        return invariants.solid_response(self.stored_energy, self.parameters, deformation_gradient)

    def out_of_plane_stress(self, deformation_gradient: FloatArray) -> FloatArray:
        """Cauchy stress sigma_33 (...) that keeps F_33 = 1, for F (..., 2, 2)."""
        return invariants.out_of_plane_stress(self.stored_energy, self.parameters, deformation_gradient)


@dataclass(frozen=True)
class Hookean(Isotropic):
    """The base of a material with the constants of Hooke's law, E and nu; its energy has mu and lambda."""

    youngs_modulus: Annotated[Positive[Stress], Meaning("Young's modulus E", "4 GPa")]
    poissons_ratio: Annotated[
        Number, Limit("it must lie in (-1, 0.5)", lambda nu: -1 < nu < 0.5), Meaning("Poisson's ratio", 0.38)
    ]

    @property
    def shear_modulus(self) -> float:
        """mu = E / (2 (1 + nu))."""
        return self.youngs_modulus / (2 * (1 + self.poissons_ratio))

    @property
    def lame_lambda(self) -> float:
        """lambda = E nu / ((1 + nu) (1 - 2 nu))."""
        nu = self.poissons_ratio
        return self.youngs_modulus * nu / ((1 + nu) * (1 - 2 * nu))

    def constants(self) -> tuple[float, ...]:
        """mu and lambda."""
        return self.shear_modulus, self.lame_lambda


@dataclass_transform(frozen_default=True)
def material(kind: Kind) -> Kind:
    """Make a subclass of `Isotropic` a material: a frozen dataclass with a name for case files.

    Without fields for Young's modulus and Poisson's ratio it gets those of its energy at F = 1.
    """
    made = named_dataclass(kind)
    for name, value in (("youngs_modulus", _youngs_modulus), ("poissons_ratio", _poissons_ratio)):
        if name not in {field.name for field in fields(made)}:  # type: ignore[arg-type]
            setattr(made, name, property(value))
    return made


def _youngs_modulus(material: Isotropic) -> float:
    """E = mu (3 lambda + 2 mu)/(lambda + mu) at small strain."""
    mu, lame = invariants.lame_constants(material.stored_energy, material.parameters)
    return mu * (3 * lame + 2 * mu) / (lame + mu)


def _poissons_ratio(material: Isotropic) -> float:
    """nu = lambda/(2 (lambda + mu)) at small strain."""
    mu, lame = invariants.lame_constants(material.stored_energy, material.parameters)
    return lame / (2 * (lame + mu))
