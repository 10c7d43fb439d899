"""The sections of a case file: what each key means, and the values it takes in L0 and E0."""

from collections.abc import Callable
from typing import Annotated, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from isopeel.physics.adhesion import AdhesionLaw, VanDerWaals
from isopeel.physics.materials import Material, NeoHooke
from isopeel.problem import Traction
from isopeel.units import parse_quantity

#: Magnitudes, in L0 and E0 or degrees, between which products of a few powers of them stay finite.
SMALLEST, LARGEST = 1e-12, 1e12


def _quantity(needed: str, stress: int = 0, length: int = 0) -> Callable[[object], float]:
    """Return the reader of a quantity in E0^stress L0^length, or in degrees if both are 0."""

    def read(written: object) -> float:
        try:
            quantity = parse_quantity(str(written))
        except ValueError as error:
            raise ValueError(f"{error}; {needed}") from error
        if quantity.stress != stress or quantity.length != length:
            raise ValueError(needed)
        if quantity.value and not SMALLEST <= abs(quantity.value) <= LARGEST:
            unit = "degrees" if quantity.angle else "units made of 1 nm and 2 GPa"
            raise ValueError(f"it must lie between {SMALLEST:g} and {LARGEST:g} in {unit}")
        return quantity.value

    return read


def _constant(written: object) -> float:
    """Read a constant of a formula: a plain number, or a text with a unit made of stresses and lengths."""
    if isinstance(written, int | float) and not isinstance(written, bool):
        try:
            return float(written)
        except OverflowError as error:
            raise ValueError("it must be finite") from error
    quantity = parse_quantity(str(written))
    if quantity.angle:
        raise ValueError("write angles as plain numbers, in radians")
    return quantity.value


def _window(written: object) -> tuple[float, float]:
    if not isinstance(written, list) or len(written) != 2:
        raise ValueError(_A_WINDOW)
    start, end = map(_quantity(_A_WINDOW), written)
    if not start < end:
        raise ValueError(_A_WINDOW)
    return start, end


_A_LENGTH = "a length is needed, such as '200 nm'"
_A_STRESS = "a stress is needed, such as '2 GPa'"
_AN_ENERGY = "an energy is needed, such as '1e-19 J'"
_AN_ANGLE = "an angle is needed, such as '0.1 deg'"
_A_WINDOW = "two angles are needed, the smaller one first, such as ['98 deg', '101 deg']"
# The descriptions say what each key needs; messages about missing or unusable values end with them.
_Length = Annotated[float, BeforeValidator(_quantity(_A_LENGTH, length=1)), Field(description=_A_LENGTH)]
_Stress = Annotated[float, BeforeValidator(_quantity(_A_STRESS, stress=1)), Field(description=_A_STRESS)]
_Energy = Annotated[
    float, BeforeValidator(_quantity(_AN_ENERGY, stress=1, length=3)), Field(description=_AN_ENERGY)
]
_Angle = Annotated[float, BeforeValidator(_quantity(_AN_ANGLE)), Field(description=_AN_ANGLE)]
_Constants = dict[str, Annotated[float, BeforeValidator(_constant)]]
_Number = Annotated[float, Field(strict=True, description="a number is needed, without quotes")]


class Section(BaseModel):
    """A table of known keys."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class BodySection(Section):
    """The strip's size, in L0."""

    length: _Length
    height: _Length


class NeoHookeSection(Section):
    """The compressible neo-Hookean material; stresses in E0."""

    law: Literal["neo-hooke"]
    youngs_modulus: _Stress
    poissons_ratio: _Number

    def material(self) -> Material:
        """Build the material."""
        return NeoHooke(self.youngs_modulus, self.poissons_ratio)


class FormulaMaterialSection(Section):
    """A material from the formula of its stored energy in E0; constants in E0, L0."""

    law: Literal["formula"]
    energy: Annotated[str, Field(description="a formula of I1, I2, J or F11 to F33 is needed")]
    constants: _Constants = {}

    def material(self) -> Material:
        """Build the material."""
        from isopeel.physics.materials.formula import FormulaMaterial

        return FormulaMaterial(self.energy, self.constants)


class _AdhesionSection(Section):
    length: _Length
    traction: Annotated[Traction, Field(description="'reference' or 'projected' is needed")] = "reference"


class VanDerWaalsSection(_AdhesionSection):
    """Van der Waals adhesion on the lower face up to `length`; in E0 L0^3 and L0."""

    law: Literal["van-der-waals"]
    hamaker_constant: _Energy
    equilibrium_distance: _Length

    def adhesion_law(self) -> AdhesionLaw:
        """Build the law."""
        return VanDerWaals(self.hamaker_constant, self.equilibrium_distance)


class FormulaAdhesionSection(_AdhesionSection):
    """Adhesion from the formula of its potential in E0 L0 over the gap r in L0."""

    law: Literal["formula"]
    potential: Annotated[str, Field(description="a formula of the gap r is needed")]
    constants: _Constants = {}

    def adhesion_law(self) -> AdhesionLaw:
        """Build the law."""
        from isopeel.physics.adhesion.formula import FormulaAdhesion

        return FormulaAdhesion(self.potential, self.constants)


class DiscretizationSection(Section):
    """The spline space, its elements along the length and the height, and the adhesive force's points."""

    space: Annotated[str, Field(description="the name of a space is needed, such as 'N2.1'")] = "N2.1"
    mesh: Annotated[str, Field(description="elements along length x height are needed, such as '200x10'")] = (
        "200x10"
    )
    contact_points: Annotated[
        int | None,
        Field(strict=True, ge=1, description="a number of Gauss points on an element is needed"),
    ] = None


class DriveSection(Section):
    """How far the right face is turned, and in which steps, in degrees."""

    to: _Angle = 120.0
    step: _Angle = 0.1


class ReadingSection(Section):
    """The window of angles, in degrees, that the plateau is read in."""

    window: Annotated[tuple[float, float], BeforeValidator(_window), Field(description=_A_WINDOW)]


class OutputSection(Section):
    """The angles, in degrees, that the displacement is kept at: multiples of one, and the last."""

    fields_every: Annotated[
        _Angle, Field(gt=0, description="a positive angle is needed, such as '10 deg'")
    ] = 10.0
