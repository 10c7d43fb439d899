"""The discretization of a body: its elements and degrees, where a case names none, and its space."""

import re

import numpy as np

from isopeel.case.sections import HIGHEST_ACROSS, DiscretizationSection
from isopeel.common.errors import InputError
from isopeel.common.units import UnitSystem, shown
from isopeel.problem import Body
from isopeel.problem.shapes import Shape
from isopeel.problem.shapes.quarter_cylinder import QuarterCylinder
from isopeel.splines.nurbs import NurbsSurface, Side
from isopeel.splines.rows import RowSpace, row_space

#: More, and the stiffnesses along and across an element, its square apart, leave double precision.
LARGEST_ASPECT = 1e4
#: Elements along where a case names none, and the fewest and the most across.
USUAL_ELEMENTS = 200, 2, 10
#: Those of a quarter cylinder, and the ratio of the last one to the first.
CYLINDER_ELEMENTS, CYLINDER_GRADING = (120, 16), 20.0


def space_of(shape: Shape, body: Body, chosen: DiscretizationSection, units: UnitSystem) -> RowSpace:
    """Build the space of the displacement of a body of a shape, as it is chosen.

    Raises InputError whose field is a key of `discretization`; `units` are those that it states sizes in.
    """
    mesh, usual_grading = usual_mesh(shape)
    if chosen.mesh is not None:
        mesh, usual_grading = parse_mesh("discretization.mesh", chosen.mesh), (1.0, 1.0)
    grading = chosen.grading or usual_grading
    usual = usual_across_degree(body.material.poissons_ratio, body.shape)
    try:
        space = row_space(chosen.space, mesh, chosen.across_degree or usual, grading, body.shape)
    except InputError as error:
        raise InputError(f"discretization.{error.field}", error.value, error.allowed) from error
    sides: tuple[tuple[Side, Side], ...] = ("bottom", "top"), ("left", "right")
    lengths = [max(body.shape.boundary(side).length() for side in pair) for pair in sides]
    along, across = (
        length * np.diff(directional.breakpoints)
        for length, directional in zip(lengths, (space.rows[0], space.across), strict=True)
    )
    for one, other in ((along.max(), across.min()), (along.min(), across.max())):
        if max(one, other) > LARGEST_ASPECT * min(one, other):
            sizes = " x ".join(shown(size, units, length=1) for size in (one, other))
            allowed = (
                f"it has elements of {sizes}; one side may be {LARGEST_ASPECT:g} times the other at most"
            )
            raise InputError("discretization.mesh", "{}x{}".format(*mesh), allowed)
    return space


def usual_mesh(shape: Shape) -> tuple[tuple[int, int], tuple[float, float]]:
    """Return the elements along the length and the height where a case names none, and their grading.

    Of most bodies 200, and 2 to 10 across: they are about as high as they are long, as the stresses of a
    front are as wide in both directions, and two are enough for bending, with the degree across that is
    usual. A quarter cylinder touches around one corner: 120x16, graded to 1:20 both ways, is within 0.4 % of
    the pull-off force of Johnson, Kendall and Roberts, and of the load of Hertz, where 200x10 is off by 4 %
    (cases 124, 151 and 188 of `benchmarks/trial.py`).
    """
    if shape.name == QuarterCylinder.name:
        return CYLINDER_ELEMENTS, (CYLINDER_GRADING, CYLINDER_GRADING)
    surface = shape.surface()
    length, height = (
        max(surface.boundary(side).length() for side in pair)
        for pair in (("bottom", "top"), ("left", "right"))
    )
    along, fewest, most = USUAL_ELEMENTS
    return (along, min(max(round(along * height / length), fewest), most)), (1.0, 1.0)


def usual_across_degree(poissons_ratio: float, shape: NurbsSurface) -> int:
    """The degree across where a case names none: 2, 3 of nearly incompressible bodies, or that of the shape.

    A strip that bends shortens and lifts by squares of the height, which a linear space does not contain. At
    finite strain a change of volume in the fourth power is left by degree 2, which the bulk modulus makes
    stiff: a moment of 3.6 % more at nu = 0.499 of a strip bent to 15 times its height, with one element
    across, and of 0.4 % at 0.49 (`benchmarks/locking.py`). It grows with the square of the curvature.
    """
    bending = 2 if poissons_ratio <= 0.45 else 3
    return min(max(bending, shape.spaces[1].degree), HIGHEST_ACROSS)


def parse_mesh(field: str, text: str) -> tuple[int, int]:
    """Read a number of elements along the length x the height, such as 200x10; InputError names the field."""
    parts = re.fullmatch(r"(\d{1,15})x(\d{1,15})", text)
    if not parts:
        raise InputError(field, text, "elements along length x height are needed, such as 200x10")
    return int(parts[1]), int(parts[2])
