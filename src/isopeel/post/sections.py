"""Forces, moments and energy that pass through the sections of a straight body."""

from dataclasses import dataclass

import numpy as np

from isopeel.assembly.spaces import SpaceOfBodies, spaces_by_name
from isopeel.assembly.tables import element_ends, gauss_points
from isopeel.common.arrays import FloatArray
from isopeel.physics.batch import evaluate_material
from isopeel.post.fields import deformation
from isopeel.problem import Boundary, Problem


@dataclass(frozen=True, eq=False)
class SectionMeans:
    """Means over the sections of a stretch of a body, per width, in the units of the problem.

    A section is a line across the undeformed body, with the normal N that points along e. P is the first
    Piola-Kirchhoff stress, F the deformation gradient, and psi the stored energy per volume.
    """

    force: FloatArray  # int P N dA (2,), on what lies before the section
    moment: float  # int (x - x_0) x P N dA, anticlockwise about the point x_0 in the present state
    energy: float  # int [psi N . e - e . (F - 1)^T P N] dA (Eshelby, J. Elast. 5, 1975)


def section_means(
    problem: Problem,
    space: SpaceOfBodies,
    displacement: FloatArray,
    stretch: Boundary,
    along: FloatArray,
    about: FloatArray,
) -> SectionMeans:
    """Return the means over the sections that begin on a part of a side of a body.

    `displacement` are coefficients (size, 2), `along` is the unit vector e (2,) and `about` the point x_0
    (2,). A mean over sections with the parameter s from a to b along the side is a volume integral,
    int T N dA -> int T grad(s) dV/(b - a), which is more accurate than a single section.
    """
    body, own = problem.body_of(stretch.body), spaces_by_name(problem, space)[stretch.body]
    upright = stretch.side in ("left", "right")
    start, end = stretch.part
    points = max(own.degree, own.across.degree) + 1
    lengthwise = gauss_points(element_ends(own, stretch.side, stretch.part), points)
    across = gauss_points((own.rows[0] if upright else own.across).breakpoints, points)
    (xi, xi_weights), (eta, eta_weights) = (across, lengthwise) if upright else (lengthwise, across)
    _, x, F, inverse = deformation(problem, space, displacement, xi, eta, body)
    psi, P, _ = evaluate_material(body.material.kernel, body.material.parameters, F)
    areas = np.einsum("xk,yl->xykl", xi_weights, eta_weights) / np.linalg.det(inverse)
    gradient = inverse[..., int(upright), :] * areas[..., None] / (end - start)
    towards = 1.0 if float(np.sum(gradient @ along)) > 0 else -1.0
    gradient *= towards
    flow = np.einsum("...iJ,...J->...i", P, gradient)
    arm = x - about
    stretched = (F - np.eye(2)) @ along
    energy = psi * (gradient @ along) - np.sum(stretched * flow, axis=-1)
    return SectionMeans(
        flow.reshape(-1, 2).sum(axis=0),
        float(np.sum(arm[..., 0] * flow[..., 1] - arm[..., 1] * flow[..., 0])),
        float(energy.sum()),
    )
