"""The sections of a case file on materials and adhesion: what each key means, by law."""

from typing import Annotated, Literal

from pydantic import Field

from isopeel.case_values import Constants, Energy, Length, Number, Section, Stress, SurfaceEnergy
from isopeel.physics.adhesion import (
    AdhesionLaw,
    Bilinear,
    Dugdale,
    Exponential,
    LennardJones,
    Trapezoidal,
    VanDerWaals,
)
from isopeel.physics.materials import Material, MooneyRivlin, NeoHooke, SaintVenantKirchhoff, Yeoh
from isopeel.problem import Traction


class NeoHookeSection(Section):
    """The compressible neo-Hookean material; stresses in E0."""

    law: Literal["neo-hooke"]
    youngs_modulus: Stress
    poissons_ratio: Number

    def material(self) -> Material:
        """Build the material."""
        return NeoHooke(self.youngs_modulus, self.poissons_ratio)


class SaintVenantKirchhoffSection(Section):
    """The St. Venant-Kirchhoff material; stresses in E0."""

    law: Literal["saint-venant-kirchhoff"]
    youngs_modulus: Stress
    poissons_ratio: Number

    def material(self) -> Material:
        """Build the material."""
        return SaintVenantKirchhoff(self.youngs_modulus, self.poissons_ratio)


class MooneyRivlinSection(Section):
    """The Mooney-Rivlin material; stresses in E0."""

    law: Literal["mooney-rivlin"]
    c10: Stress
    c01: Stress
    bulk_modulus: Stress

    def material(self) -> Material:
        """Build the material."""
        return MooneyRivlin(self.c10, self.c01, self.bulk_modulus)


class YeohSection(Section):
    """The Yeoh material; stresses in E0."""

    law: Literal["yeoh"]
    c10: Stress
    c20: Stress
    c30: Stress
    bulk_modulus: Stress

    def material(self) -> Material:
        """Build the material."""
        return Yeoh(self.c10, self.c20, self.c30, self.bulk_modulus)


class FormulaMaterialSection(Section):
    """A material from the formula of its stored energy in E0; constants in E0, L0."""

    law: Literal["formula"]
    energy: Annotated[str, Field(description="a formula of I1, I2, J or F11 to F33 is needed")]
    constants: Constants = Field(default={})

    def material(self) -> Material:
        """Build the material."""
        from isopeel.physics.materials.formula import FormulaMaterial

        return FormulaMaterial(self.energy, self.constants)


class _AdhesionSection(Section):
    length: Length
    traction: Annotated[Traction, Field(description="'reference' or 'projected' is needed")] = "reference"
    irreversible: Annotated[bool, Field(strict=True, description="true or false is needed")] = False


class VanDerWaalsSection(_AdhesionSection):
    """Van der Waals adhesion on the lower face up to `length`; in E0 L0^3 and L0."""

    law: Literal["van-der-waals"]
    hamaker_constant: Energy
    equilibrium_distance: Length

    def adhesion_law(self) -> AdhesionLaw:
        """Build the law."""
        return VanDerWaals(self.hamaker_constant, self.equilibrium_distance)


class LennardJonesSection(_AdhesionSection):
    """Lennard-Jones adhesion with any exponents; in E0 L0 and L0."""

    law: Literal["lennard-jones"]
    work_of_adhesion: SurfaceEnergy
    equilibrium_gap: Length
    repulsive_exponent: Number = 9.0
    attractive_exponent: Number = 3.0

    def adhesion_law(self) -> AdhesionLaw:
        """Build the law."""
        exponents = self.repulsive_exponent, self.attractive_exponent
        return LennardJones(self.work_of_adhesion, self.equilibrium_gap, *exponents)


class _CohesiveSection(_AdhesionSection):
    strength: Stress
    work_of_adhesion: SurfaceEnergy
    equilibrium_gap: Length = 0.0


class ExponentialSection(_CohesiveSection):
    """The exponential cohesive law; in E0, E0 L0 and L0."""

    law: Literal["exponential"]

    def adhesion_law(self) -> AdhesionLaw:
        """Build the law."""
        return Exponential(self.strength, self.work_of_adhesion, self.equilibrium_gap)


class BilinearSection(_CohesiveSection):
    """The bilinear cohesive law; `rise` is a share of its final opening, `rounding` one of the rise."""

    law: Literal["bilinear"]
    rise: Number
    rounding: Number = 0.5

    def adhesion_law(self) -> AdhesionLaw:
        """Build the law."""
        shape = self.rise, self.rounding
        return Bilinear(self.strength, self.work_of_adhesion, *shape, self.equilibrium_gap)


class TrapezoidalSection(_CohesiveSection):
    """The trapezoidal cohesive law; `rise` and `plateau` are shares of its final opening."""

    law: Literal["trapezoidal"]
    rise: Number
    plateau: Number
    rounding: Number = 0.5

    def adhesion_law(self) -> AdhesionLaw:
        """Build the law."""
        shape = self.rise, self.plateau, self.rounding
        return Trapezoidal(self.strength, self.work_of_adhesion, *shape, self.equilibrium_gap)


class DugdaleSection(_CohesiveSection):
    """Dugdale's law; `transition` is the share of its critical opening in which it rises and falls."""

    law: Literal["dugdale"]
    transition: Number

    def adhesion_law(self) -> AdhesionLaw:
        """Build the law."""
        return Dugdale(self.strength, self.work_of_adhesion, self.transition, self.equilibrium_gap)


class FormulaAdhesionSection(_AdhesionSection):
    """Adhesion from the formula of its potential in E0 L0 over the gap r in L0."""

    law: Literal["formula"]
    potential: Annotated[str, Field(description="a formula of the gap r is needed")]
    constants: Constants = Field(default={})

    def adhesion_law(self) -> AdhesionLaw:
        """Build the law."""
        from isopeel.physics.adhesion.formula import FormulaAdhesion

        return FormulaAdhesion(self.potential, self.constants)


#: Every law of a material, and every one of adhesion, by the name that `law` gives it.
MaterialSection = Annotated[
    NeoHookeSection
    | SaintVenantKirchhoffSection
    | MooneyRivlinSection
    | YeohSection
    | FormulaMaterialSection,
    Field(discriminator="law"),
]
AdhesionSection = Annotated[
    VanDerWaalsSection
    | LennardJonesSection
    | ExponentialSection
    | BilinearSection
    | TrapezoidalSection
    | DugdaleSection
    | FormulaAdhesionSection,
    Field(discriminator="law"),
]
