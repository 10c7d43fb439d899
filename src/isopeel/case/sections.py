"""The sections of a case file: what each key means, but for the keys that dataclasses bring."""

from pathlib import Path
from typing import Annotated, ClassVar, Literal, get_args

from pydantic import BeforeValidator, Field, field_validator

from isopeel.case.kinds import KindSection
from isopeel.case.text import size_of
from isopeel.case.values import (
    LARGEST,
    SMALLEST,
    FlagKey,
    LengthKey,
    Needed,
    NumberKey,
    Section,
    list_of,
    means,
    quantity_of,
    several,
)
from isopeel.common.errors import InputError
from isopeel.common.quantities import ANGLE, FORCE_PER_WIDTH, LENGTH, NUMBER, STRESS
from isopeel.common.units import E0, L0, UnitSystem
from isopeel.physics.adhesion import AdhesionLaw
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.materials import Material
from isopeel.physics.materials.prestretched import Prestretched
from isopeel.physics.substrates import Flat, Substrate
from isopeel.problem import Body, Boundary, Interface, Scheme, Support, Traction
from isopeel.problem.shapes import Shape
from isopeel.splines.nurbs import Side


class BodySection(KindSection):
    """The shape of the body, in L0, and its width across the plane, which only scales what is shown."""

    table, packages, chooser, usual = "body", ("isopeel.problem.shapes",), "shape", "strip"

    width: Annotated[
        LengthKey | None,
        means(
            "extent of the body across the plane, which must be positive; forces are then in N, not in N/m",
            "25 mm",
            usual="none",
        ),
    ] = None

    @field_validator("width")
    @classmethod
    def _positive(cls, width: float | None) -> float | None:
        if width is not None and width <= 0:
            raise InputError("body.width", width, "it must be positive; leave it out for values per width")
        return width

    def body_shape(self) -> Shape:
        """Build the shape."""
        shape: Shape = self.made()
        return shape

    def files(self, key: str) -> dict[str, str]:
        """Return the paths of files, by their keys. Raises InputError for paths that are not UTF-8."""
        files = {name: str(value) for name, value in self if isinstance(value, Path)}
        for name, path in files.items():
            if size_of(path) is None:
                # as Python reads names of other encodings
                raise InputError(
                    f"{key}.{name}", path, "the path of a file, and of its folders, must be UTF-8 text"
                )
        return files


class MaterialSection(KindSection):
    """The material, with the stretch that it is laid at; stresses in E0."""

    table, packages, chooser = "material", ("isopeel.physics.materials",), "law"
    example_kind = "neo-hooke"

    prestretch: Annotated[
        float | None,
        NUMBER,
        Field(strict=True),
        Needed(NUMBER.needed),
        means("stretch along the body with which it is laid on the substrate", 1.05, usual="none"),
    ] = None

    def material(self) -> Material:
        """Build the material."""
        material: Material = self.made()
        return material if self.prestretch is None else Prestretched(material, self.prestretch)


class AdhesionSection(KindSection):
    """Adhesion of the lower face up to `length`, or of all of it; in E0 and L0."""

    table, chooser, example_kind = "adhesion", "law", "exponential"
    packages: ClassVar[tuple[str, ...]] = ("isopeel.physics.adhesion",)

    length: Annotated[
        LengthKey | None,
        means(
            "length of the lower face that adheres, from its left end; of a cylinder about its lowest point",
            "80 nm",
            usual="the whole face",
        ),
    ] = None
    traction: Annotated[
        Traction,
        Needed("'reference' or 'projected' is needed"),
        means(
            "the area that the traction acts on: that at rest, or its projection on the substrate",
            "projected",
        ),
    ] = "reference"
    irreversible: Annotated[FlagKey, means("whether damage is permanent", True)] = False
    sliding_length: Annotated[
        LengthKey | None,
        means(
            "length over which a reversible joint with the reference area also resists sliding",
            "0.3 nm",
            usual="slides freely",
        ),
    ] = None
    symmetric: Annotated[
        FlagKey,
        means(
            "whether the body adheres to its mirror image; on a flat substrate, without `sliding_length`",
            True,
        ),
    ] = False

    def adhesion_law(self) -> AdhesionLaw:
        """Build the law."""
        law: AdhesionLaw = self.made()
        return Mirrored(law) if self.symmetric else law

    def interface(
        self,
        boundary: Boundary,
        law: AdhesionLaw,
        against: Substrate | Boundary,
        scheme: Scheme = "unbiased",
        *,
        smoothed: bool = False,
    ) -> Interface:
        """Build the interface on a boundary. Raises InputError for what cannot be combined."""
        if self.symmetric and not isinstance(against, Flat):
            allowed = "a body meets its mirror image at a plane, so that the substrate must be flat"
            raise InputError("adhesion.symmetric", True, allowed)
        if self.symmetric and self.sliding_length is not None:
            allowed = "a body and its mirror image do not slip past each other; leave out sliding_length"
            raise InputError("adhesion.symmetric", True, allowed)
        return Interface(
            boundary,
            law=law,
            against=against,
            traction=self.traction,
            irreversible=self.irreversible,
            sliding_length=self.sliding_length,
            scheme=scheme,
            smoothed=smoothed,
        )


class SubstrateSection(KindSection):
    """The substrate, and the gap to it at the start where that is not the equilibrium gap; in L0."""

    table, packages, chooser, usual = "substrate", ("isopeel.physics.substrates",), "kind", "flat"

    gap: Annotated[LengthKey | None, means("gap at the start", "0.5 nm", usual="the equilibrium gap")] = None

    def surface(self) -> Substrate:
        """Build the substrate as it lies before it recedes by the gap."""
        surface: Substrate = self.made()
        return surface

    def substrate(self, equilibrium_gap: float) -> Substrate:
        """Build the substrate."""
        return self.surface().receded(equilibrium_gap if self.gap is None else self.gap)


class UnitsSection(Section):
    """What the run measures in, L0 and E0."""

    length: Annotated[
        str,
        LENGTH,
        Needed("a length is needed, such as '1 nm'"),
        means("unit of length L0 of the run", "1 um"),
    ] = "1 nm"
    stress: Annotated[
        str,
        STRESS,
        Needed("a stress is needed, such as '2 GPa'"),
        means("unit of stress E0 of the run", "1 MPa"),
    ] = "2 GPa"

    def system(self) -> UnitSystem:
        """Build the unit system. Raises InputError where one is not a positive length or stress."""
        sizes = []
        for key, dimension, usual, si in (("length", LENGTH, L0, "m"), ("stress", STRESS, E0, "Pa")):
            written = getattr(self, key)
            try:
                size = quantity_of(dimension, written).exact
            except ValueError as error:
                raise InputError(f"units.{key}", written, str(error)) from error
            if size <= 0:
                raise InputError(f"units.{key}", written, "it must be positive")
            least, most = SMALLEST * float(usual), LARGEST * float(usual)
            if not least <= size <= most:
                allowed = f"it must lie between {least:g} {si} and {most:g} {si}"
                raise InputError(f"units.{key}", written, allowed)
            sizes.append(size)
        return UnitSystem(*sizes)


A_BOUNDARY = "a boundary is needed, BODY.SIDE, such as 'upper.bottom'"
A_WINDOW = "two values are needed, the smaller one first"
_RATIOS = several(2, "the size of the last element over that of the first is needed")
_Held = Annotated[
    Literal["x", "y", "xy"] | None,
    Needed("'x', 'y' or 'xy' is needed"),
    means("components of the displacement that are held on this side", "xy", usual="none"),
]
#: The dimensions of a parameter of a drive: one of them.
PARAMETER = (ANGLE, LENGTH, FORCE_PER_WIDTH)


class HeldSection(Section):
    """The components of the displacement that are held at zero, by side."""

    left: _Held = None
    right: _Held = None
    bottom: _Held = None
    top: _Held = None

    def supports(self, body: Body) -> tuple[Support, ...]:
        """Build the held sides of a body."""
        held: dict[Side, str | None] = {side: getattr(self, side) for side in get_args(Side)}
        return tuple(
            Support(body.side(side), tuple("xy".index(component) for component in components))
            for side, components in held.items()
            if components is not None
        )


#: Highest degree across the height.
HIGHEST_ACROSS = 8
SpaceKey = Annotated[str, Needed("the name of a space is needed, such as 'N2.1'")]
MeshKey = Annotated[str | None, Needed("elements along length x height are needed, such as '200x10'")]
AcrossDegreeKey = Annotated[
    int | None,
    Field(strict=True, ge=1, le=HIGHEST_ACROSS),
    Needed(f"a degree across the height is needed, from 1 to {HIGHEST_ACROSS}"),
]
GradingKey = Annotated[
    tuple[NumberKey, NumberKey] | None, BeforeValidator(list_of(2, _RATIOS)), Needed(_RATIOS)
]


class DiscretizationSection(Section):
    """The spline space, its elements along the length and the height, and the adhesive force's points.

    Without a mesh it is that of `discretization.usual_mesh`, with its grading. Without a degree across it is
    that of `discretization.usual_across_degree`: linear elements are too stiff in bending.
    """

    space: Annotated[
        SpaceKey, means("name of the spline space", "N2.1", see="theory/geometry.md#row-wise-spaces")
    ] = "N2.1"
    mesh: Annotated[
        MeshKey,
        means(
            "elements along length x height",
            "200x10",
            usual="200 along, 2 to 10 across; 120x16 for a quarter cylinder",
        ),
    ] = None
    contact_points: Annotated[
        int | None,
        Field(strict=True, ge=1),
        Needed("a number of Gauss points on an element is needed"),
        means("Gauss points of the adhesive force on an element", 4, usual="highest degree + 1"),
    ] = None
    across_degree: Annotated[
        AcrossDegreeKey,
        means("degree across the height", 2, usual="2, or 3 for nearly incompressible bodies"),
    ] = None
    grading: Annotated[
        GradingKey,
        means(
            "size of the last element over that of the first one, along and across",
            [0.1, 1.0],
            usual="`[1.0, 1.0]`; `[20.0, 20.0]` for a quarter cylinder without a `mesh`",
        ),
    ] = None


class ReadingSection(Section):
    """The window that the plateau is read in, in degrees, or in L0 and E0."""

    window: Annotated[
        tuple[Annotated[float, *PARAMETER], Annotated[float, *PARAMETER]],
        Needed(A_WINDOW),
        means("first and last parameter of the plateau", ["98 deg", "101 deg"]),
    ]


class OutputSection(Section):
    """The parameters that the displacement is kept at, in degrees, or in L0 and E0: multiples of one.

    Where it is left out, each stage has its own (`DriveSection.usual_fields_every`).
    """

    fields_every: Annotated[
        float | None,
        *PARAMETER,
        means(
            "the parameter between stored displacements, of all stages with such a parameter",
            "10 deg",
            usual="10 deg, or a tenth of the path",
        ),
    ] = None
