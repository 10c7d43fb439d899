"""The closed form of a strip, read off its problem."""

from dataclasses import dataclass
from math import degrees

import numpy as np

from isopeel.physics.adhesion import Contact
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.physics.substrates import Flat
from isopeel.post.closed_form.beams import beam_moment
from isopeel.problem import Boundary, Problem, RotatedSide
from isopeel.splines.nurbs import NurbsSurface, Side


@dataclass(frozen=True)
class BeamPeeling:
    """A thin elastic strip peeled from a flat substrate by a pure moment, per unit width."""

    moment: float  # on the plateau
    radius: float  # of the arc that the peeled part forms
    onset_deg: float  # rotation at which peeling begins

    length: float  # of the strip

    def period_deg(self, elements: int) -> float:
        """Return the rotation in which the front passes one of equal elements: the period of oscillation."""
        return degrees(self.length / elements / self.radius)


@dataclass(frozen=True)
class FreeStrip:
    """A straight strip that adheres to a flat substrate, and is driven at one of its ends."""

    length: float
    height: float
    free_length: float  # between the adhering part and the driven end


def free_strip(problem: Problem) -> FreeStrip | None:
    """Measure a strip; None where shape, law, substrate, driven side or bodies are others."""
    if not problem.is_single:
        return None
    adhesion, driven, shape = problem.adhesion, problem.driven_side, problem.body.shape
    if (
        driven not in ("left", "right")
        or adhesion.side not in ("bottom", "top")
        or not isinstance(adhesion.substrate, Flat)
        or adhesion.substrate.angle != Flat().angle
        or problem.loads
        or isinstance(adhesion.law, Contact)
    ):
        return None
    return strip_of(shape, adhesion.boundary, driven)


def strip_of(shape: NurbsSurface, boundary: Boundary, driven: Side) -> FreeStrip | None:
    """Measure a strip along the x axis that adheres with a boundary and is driven at its left or right side.

    Returns None for other shapes.
    """
    side = shape.boundary(boundary.side)
    ends = side.evaluate([0.0, boundary.start, boundary.end, 1.0])
    corners = shape.control_points.reshape(-1, 2)
    length, height = np.ptp(corners, axis=0)
    # only a rectangle along the axes fills the box around its control points
    if abs(length * height - shape.area()) > 1e-9 * length * height or np.ptp(ends[:, 1]) > 1e-9 * height:
        return None
    free = np.diff(ends[:, 0])[0 if driven == "left" else 2]
    return FreeStrip(float(length), float(height), abs(float(free)))


def beam_peeling(problem: Problem) -> BeamPeeling | None:
    """Return the closed form of a straight strip peeled by a rotated end; None for other problems.

    A length dl that peels takes W dl to part and M^2/(2 E' I) dl to bend, while the moment does the work
    M dl/rho, 1/rho = M/(E' I). Hence M = sqrt(2 E' I W), with E' = E/(1 - nu^2) and I = h^3/12 of a strip in
    plane strain. Peeling begins at the angle (free length)/rho; the free length is that between the adhering
    part and the driven end.
    """
    strip = free_strip(problem)
    if strip is None or not isinstance(problem.drive, RotatedSide):
        return None
    stiffness = plane_strain_modulus(problem.body.material) * strip.height**3 / 12
    moment = beam_moment(problem.adhesion.law.work_of_adhesion, stiffness)
    radius = stiffness / moment
    return BeamPeeling(moment, radius, degrees(strip.free_length / radius), strip.length)
