"""The adhesive traction that acts on a side of a body, and the gap to the substrate."""

from dataclasses import dataclass

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion.irreversible import with_history
from isopeel.physics.adhesion.sliding import with_slip
from isopeel.physics.batch import evaluate_law, evaluate_substrate
from isopeel.post.fields import SideFields, sample_side
from isopeel.problem import Problem
from isopeel.splines.rows import RowSpace


@dataclass(frozen=True, eq=False)
class AdhesiveTraction:
    """What the substrate does to a side at points (n, k), in the units of the problem.

    Tractions are forces per reference area, also where the law acts on the projected area.
    """

    gap: FloatArray  # (n, k)
    normal_traction: FloatArray  # along the substrate's normal, repulsion positive (n, k)
    traction: FloatArray  # the whole vector (n, k, 2), with what holds along the substrate
    opening: FloatArray  # largest ones so far, beyond the equilibrium gap (n, k)


def adhesive_traction(
    problem: Problem,
    space: RowSpace,
    displacement: FloatArray,
    parameters: FloatArray,
    opening: FloatArray | None = None,
) -> AdhesiveTraction:
    """Traction on the adhesive side in coefficients (size, 2) at parameters (n, k) along it.

    It is T n_o, with -n_o . F^-T N_o where it is `projected` (`AdhesiveSide`), and -V_s t_o of a joint that
    also holds along the substrate (`physics.adhesion.sliding`). An irreversible joint has opened by `opening`
    (n, k) before, which matters where it has closed since. Each row of parameters is a part of one element.
    Raises InputError for coefficients of another space.
    """
    adhesion = problem.adhesion
    law, substrate = adhesion.law, adhesion.substrate
    fields = sample_side(problem, space, displacement, adhesion.side, parameters)
    gap, normal, curvature = evaluate_substrate(substrate.kernel, substrate.parameters, fields.position)
    seen = curvature if substrate.constant_curvature else np.zeros_like(curvature)
    opened = np.maximum(gap - law.equilibrium_gap, 0.0 if opening is None else opening)
    if adhesion.irreversible:
        results = np.empty((4, gap.size))
        with_history(
            law.kernel,
            gap.flatten(),
            seen.flatten(),
            opened.flatten(),
            law.equilibrium_gap,
            law.parameters,
            gap.size,
            results[0],
            results[1],
            results[2],
            results[3],
        )
        T = results[1].reshape(gap.shape)
    else:
        T = evaluate_law(law.kernel, law.parameters, gap, seen)[1]
    along = np.zeros_like(normal)
    if adhesion.sliding_length is not None:
        T, along = _held_along(problem, space, adhesion.sliding_length, fields, gap, seen, parameters)
    if adhesion.traction == "projected":
        T = T * projection(fields, normal)
    return AdhesiveTraction(gap, T, T[..., None] * normal + along, opened)


def projection(fields: SideFields, normal: FloatArray) -> FloatArray:
    """-n_o . F^-T N (n, k): the projected area of a unit reference area, for normals n_o (n, k, 2)."""
    inverse = np.linalg.inv(fields.deformation_gradient)
    area: FloatArray = -np.einsum("...i,...Ji,...J->...", normal, inverse, fields.normal)
    return area


def _held_along(
    problem: Problem,
    space: RowSpace,
    sliding_length: float,
    fields: SideFields,
    gap: FloatArray,
    curvature: FloatArray,
    parameters: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Traction along the normal (n, k) and vector along the substrate (n, k, 2) of a joint that slides."""
    adhesion = problem.adhesion
    law, substrate = adhesion.law, adhesion.substrate
    rest = np.zeros((space.size, 2))
    first = sample_side(problem, space, rest, adhesion.side, parameters).position
    _, normal, _ = evaluate_substrate(substrate.kernel, substrate.parameters, first)
    tangent = np.stack([-normal[..., 1], normal[..., 0]], axis=-1)
    slip = np.einsum("...i,...i->...", tangent, fields.position - first)
    potential, T, derivative = (
        values.ravel() for values in evaluate_law(law.kernel, law.parameters, gap, curvature)
    )
    bottom, _, _ = evaluate_law(
        law.kernel, law.parameters, np.full(gap.shape, law.equilibrium_gap), curvature
    )
    shear = np.empty((3, gap.size))
    with_slip(
        gap.flatten(),
        slip.ravel(),
        sliding_length,
        law.equilibrium_gap,
        bottom.ravel(),
        gap.size,
        potential,
        T,
        derivative,
        shear[0],
        shear[1],
        shear[2],
    )
    return T.reshape(gap.shape), -shear[0].reshape(gap.shape)[..., None] * tangent
