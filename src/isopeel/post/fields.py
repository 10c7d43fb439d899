"""Fields of a deformed body: positions, deformation gradient and stress at points of every element."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from isopeel.assembly.interface import InterfacePoints
from isopeel.assembly.spaces import SpaceOfBodies, part_of_body, spaces_by_name
from isopeel.assembly.tables import FLAT
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.errors import InputError
from isopeel.physics.batch import evaluate_material
from isopeel.problem import Body, Boundary, Problem
from isopeel.results.fields import StoredState
from isopeel.splines.nurbs import NurbsSurface, Side
from isopeel.splines.rows import RowSpace
from isopeel.splines.space import SplineSpace


@dataclass(frozen=True, eq=False)
class SampledFields:
    """Fields at k x l points in each of the elements, in the units of the problem.

    Arrays are (n_x, n_y, k, l, ...): elements along xi and eta, then points along xi and eta. Elements do not
    share the points on their edges, so that fields may jump there. Where an element is inverted its stresses
    are nan. At a corner of the parameter domain where two sides of the shape meet smoothly, as on a cylinder,
    all fields but the positions are nan.
    """

    reference_position: FloatArray  # X (..., 2)
    position: FloatArray  # x = X + u (..., 2)
    deformation_gradient: FloatArray  # F (..., 2, 2)
    nominal_stress: FloatArray  # first Piola-Kirchhoff, P (..., 3, 3)
    cauchy_stress: FloatArray  # sigma (..., 3, 3)
    first_invariant: FloatArray  # I1 = tr(sigma) / E (...)


class Depth(NamedTuple):
    """How deep a part of a side lies inside of something, by its name: the substrate, or another body."""

    depth: float
    inside: str


@dataclass(frozen=True, eq=False)
class SideFields:
    """Fields at points (n, k) along a side, in the elements next to it, in the problem's units."""

    position: FloatArray  # x = X + u (..., 2)
    deformation_gradient: FloatArray  # F (..., 2, 2)
    nominal_stress: FloatArray  # first Piola-Kirchhoff, P (..., 2, 2); nan where an element is inside out
    normal: FloatArray  # N, outward and of unit length on the reference side (..., 2)


def sample_fields(
    problem: Problem,
    space: SpaceOfBodies,
    displacement: FloatArray,
    per_element: tuple[int, int] = (1, 1),
    body: str = "",
) -> SampledFields:
    """Return the fields of a displacement, coefficients (size, 2), at the nodes of cells in each element.

    An element has `per_element` = (a, b) equal cells, and (a + 1) x (b + 1) nodes. Of several bodies one is
    chosen by its name. Raises InputError for less than one cell, and for coefficients of another space.
    """
    if min(per_element) < 1:
        raise InputError("per_element", per_element, "it must be at least one cell in each direction")
    own = spaces_by_name(problem, space)[_chosen(problem, body).name]
    xi, eta = (
        nodes(along.breakpoints, cells)
        for along, cells in zip((own.rows[0], own.across), per_element, strict=True)
    )
    return fields_at(problem, space, displacement, xi, eta, body)


def fields_at(
    problem: Problem,
    space: SpaceOfBodies,
    displacement: FloatArray,
    xi: FloatArray,
    eta: FloatArray,
    body: str = "",
) -> SampledFields:
    """Return the fields of a displacement, coefficients (size, 2), at all xi (n_x, k) and eta (n_y, l).

    Each row of xi and of eta spans a part of one element, in which it is evaluated. Of several bodies one is
    chosen by its name.
    F = 1 + du/dX and sigma = P F^T / J, with sigma_33 that of plane strain (Bonet and Wood, Nonlinear
    Continuum Mechanics for Finite Element Analysis, 2nd ed., Sec. 5.5). Raises InputError for coefficients
    of another space.
    """
    chosen = _chosen(problem, body)
    material = chosen.material
    X, x, F, _ = deformation(problem, space, displacement, xi, eta, chosen)
    nominal, stress = np.zeros((2, *F.shape[:-2], 3, 3))
    _, P, _ = evaluate_material(material.kernel, material.parameters, F)
    with np.errstate(invalid="ignore", divide="ignore"):  # J <= 0 gives nan
        J = np.linalg.det(F)
        nominal[..., :2, :2] = P
        stress[..., :2, :2] = P @ np.swapaxes(F, -1, -2) / J[..., None, None]
        stress[..., 2, 2] = material.out_of_plane_stress(F)
        nominal[..., 2, 2] = J * stress[..., 2, 2]
    # for all materials, also those that stay finite there
    nominal[J <= 0] = stress[J <= 0] = np.nan
    invariant = np.trace(stress, axis1=-2, axis2=-1) / material.youngs_modulus
    return SampledFields(X, x, F, nominal, stress, invariant)


def sample_side(
    problem: Problem,
    space: SpaceOfBodies,
    displacement: FloatArray,
    side: Side,
    parameters: FloatArray,
    body: str = "",
) -> SideFields:
    """Return the fields of a displacement, coefficients (size, 2), at parameters (n, k) along a side.

    The parameters lie in [0, 1]. Each of the n rows spans a part of one element, in which it is evaluated. Of
    several bodies one is chosen by its name. Raises InputError for coefficients of another space.
    """
    chosen = _chosen(problem, body)
    _, x, F, inverse = deformation(problem, space, displacement, *_side_grid(side, parameters), chosen)
    _, P, _ = evaluate_material(chosen.material.kernel, chosen.material.parameters, F)
    # the gradient of the parameter that is constant on the side points into the body at its start
    gradient = inverse[..., 0 if side in ("left", "right") else 1, :]
    outwards = gradient * (-1 if side in ("left", "bottom") else 1)
    normal = outwards / np.linalg.norm(outwards, axis=-1, keepdims=True)
    fields = (values.reshape(*parameters.shape, *values.shape[4:]) for values in (x, F, P, normal))
    return SideFields(*fields)


def side_positions(
    problem: Problem,
    space: SpaceOfBodies,
    displacement: FloatArray,
    side: Side,
    parameters: FloatArray,
    body: str = "",
) -> FloatArray:
    """Return the deformed positions (n, 2) at parameters (n,) in [0, 1] along a side of a body."""
    along = np.asarray(parameters, dtype=np.float64)[:, None]
    _, x, _, _ = deformation(problem, space, displacement, *_side_grid(side, along), _chosen(problem, body))
    return x.reshape(-1, 2)


def depths_inside(problem: Problem, space: SpaceOfBodies, states: Iterable[StoredState]) -> dict[str, Depth]:
    """Return the largest depths of the parts of adhesive sides that do not adhere, in what they lie against.

    The adhering part is repelled; the rest feels no force. Sides are named as `body.bottom`; one that is
    outside is left out.
    """
    spaces, deepest = spaces_by_name(problem, space), dict[str, Depth]()
    rests: dict[str, InterfacePoints] = {}
    for name, interface in zip(problem.interface_names, problem.faces, strict=True):
        along = np.linspace(0.0, 1.0, 10 * max(spaces[interface.boundary.body].elements) + 1)
        others = [other.boundary for other in problem.faces]
        beside = [one for one in others if _side_of(one) == _side_of(interface.boundary)]
        adheres = [(along >= one.start) & (along <= one.end) for one in beside]
        rest = along[~np.any(adheres, axis=0)]
        if rest.size:
            rests[name] = InterfacePoints(problem, space, rest[:, None], interface=name)
    for state in states:
        for name, points in rests.items():
            interface = problem.interface_of(name)
            shape, against = problem.body_of(interface.boundary.body).shape, interface.against
            inside = f"body {against.body}" if isinstance(against, Boundary) else "substrate"
            depth = float(-points.gap(state.displacement).min(initial=0.0))
            if depth > 1e-6 * float(np.ptp(shape.control_points)):
                side = ".".join(_side_of(interface.boundary))
                deepest[side] = max(deepest.get(side, Depth(depth, inside)), Depth(depth, inside))
    return deepest


def _side_of(boundary: Boundary) -> tuple[str, Side]:
    return boundary.body, boundary.side


def _chosen(problem: Problem, body: str) -> Body:
    return problem.body_of(body) if body else problem.body


def _side_grid(side: Side, parameters: FloatArray) -> tuple[FloatArray, FloatArray]:
    end = np.array([[0.0 if side in ("left", "bottom") else 1.0]])
    return (end, parameters) if side in ("left", "right") else (parameters, end)


def deformation(
    problem: Problem,
    space: SpaceOfBodies,
    displacement: FloatArray,
    xi: FloatArray,
    eta: FloatArray,
    body: Body,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return X, x = X + u, F = 1 + du/dX and d(xi, eta)/dX at xi (n_x, k) and eta (n_y, l) of a body.

    The arrays are (n_x, n_y, k, l, ...) for coefficients (size, 2) of all bodies.
    """
    own, part = part_of_body(problem, space, displacement, body.name)
    shape = body.shape
    X, reference_derivatives = on_grid(*as_rows(shape), xi, eta)
    u, derivatives = on_grid(own.weighted(shape), part, xi, eta)
    determinant = np.linalg.det(reference_derivatives)
    flat = np.abs(determinant) <= FLAT * np.abs(determinant).max()
    inverse = np.linalg.inv(np.where(flat[..., None, None], np.eye(2), reference_derivatives))
    inverse[flat] = np.nan
    return X, X + u, np.eye(2) + derivatives @ inverse, inverse


def nodes(breakpoints: FloatArray, cells: int) -> FloatArray:
    """Return the ends (elements, cells + 1) of equal cells between all breakpoints."""
    return np.linspace(breakpoints[:-1], breakpoints[1:], cells + 1, axis=1)


def as_rows(shape: NurbsSurface) -> tuple[RowSpace, FloatArray]:
    """Return the shape as a space whose rows are alike, and its control points (size, 2) in it."""
    along, across = shape.spaces
    # equal weights are left out: a displacement on the shape then has none either
    weights = None if np.ptp(shape.weights) == 0 else tuple(shape.weights.T)
    space = RowSpace("shape", across, (along,) * across.size, weights)
    return space, np.swapaxes(shape.control_points, 0, 1).reshape(-1, 2)


def on_grid(
    space: RowSpace, coefficients: FloatArray, xi: FloatArray, eta: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return values (n_x, n_y, k, l, 2) of a field at xi (n_x, k), eta (n_y, l), and derivatives (..., 2, 2).

    Each row of xi and of eta is evaluated in the interval that it spans. Derivatives of rational fields
    follow from the quotient rule (Piegl and Tiller, The NURBS Book, Eq. 4.20).
    """
    parts = np.split(coefficients, space.offsets[1:-1])
    weights = space.weights or tuple(np.ones(row.size) for row in space.rows)
    curves = []
    for row, part, w in zip(space.rows, parts, weights, strict=True):
        functions, active = _functions(row, xi)
        homogeneous = np.column_stack([w[:, None] * part, w])
        curves.append(np.einsum("dxki,xkic->dxkc", functions, homogeneous[active]))
    functions, active = _functions(space.across, eta)
    # orders of derivation d, e; rows j; elements x, y and their nodes k, l; homogeneous components c
    A = np.einsum("eylj,yljdxkc->dexyklc", functions, np.stack(curves)[active])
    weight = A[0, 0, ..., 2:]
    value = A[0, 0, ..., :2] / weight
    partial = [(part[..., :2] - part[..., 2:] * value) / weight for part in (A[1, 0], A[0, 1])]
    return value, np.stack(partial, axis=-1)


def _functions(space: SplineSpace, points: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return functions, derivatives (2, elements, nodes, p + 1) at points (elements, nodes), and indices."""
    # a point on a knot belongs to the side on which the rest of its interval lies
    inwards = points.mean(axis=1, keepdims=True) - points
    elements = space.element_of((points + 1e-6 * inwards).ravel())
    values, first = space.basis(points.ravel(), 1, elements=elements)
    numbers = first[:, None] + np.arange(space.degree + 1)
    return values.reshape(2, *points.shape, -1), numbers.reshape(*points.shape, -1)
