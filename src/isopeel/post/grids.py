"""A deformed body and its adhesive side as grids for ParaView, of Bezier cells or of straight ones.

Points are those of the undeformed body; its displacement deforms it (in ParaView, "Warp By Vector"). Names of
fields contain their units. Data in cells are those at their centres.

Displacements are exact in Bezier cells. Other fields are not rational: they are exact at the Gauss points of
a cell and interpolated in between (`BezierMesh`). In straight cells all fields are exact at the points, and
nan where two sides of a shape meet smoothly. Where an element is inverted, stresses are nan.
"""

from collections.abc import Iterable, Iterator

import numpy as np

from isopeel.assembly.interface import InterfacePoints, InterfaceState
from isopeel.assembly.spaces import SpaceOfBodies, part_of_body, spaces_by_name
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.post.bezier_cells import BezierMesh, Ends, StraightMesh, cell_ends
from isopeel.post.fields import SampledFields, fields_at
from isopeel.problem import Problem
from isopeel.results import vtk
from isopeel.results.fields import StoredState
from isopeel.splines.nurbs import NurbsSurface
from isopeel.splines.rows import RowSpace

Mesh = BezierMesh | StraightMesh

#: Components of a symmetric tensor in VTK's order.
_SYMMETRIC = ([0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2])


def body_mesh(problem: Problem, space: SpaceOfBodies, pieces: int | None, body: str = "") -> Mesh:
    """Return a body as a Bezier cell for each element of shape and space, or as straight `pieces` of them.

    Of several bodies one is chosen by its name.
    """
    name = body or problem.body.name
    shape, own = problem.body_of(name).shape, spaces_by_name(problem, space)[name]
    return _mesh(shape, own, pieces, _ends(own, shape))


def side_mesh(problem: Problem, space: SpaceOfBodies, pieces: int | None, interface: str = "") -> Mesh:
    """Return the adhering part of a side as Bezier curves, or as straight `pieces` of them.

    Of several interfaces one is chosen by its name.
    """
    boundary = problem.interface_of(interface).boundary
    shape, own = problem.body_of(boundary.body).shape, spaces_by_name(problem, space)[boundary.body]
    ends = _ends(own, shape)
    along = 1 if boundary.side in ("left", "right") else 0
    part = cell_ends(np.array(boundary.part), ends[along])
    # one cell across is enough, that at the side
    across = ends[1 - along][:2] if boundary.side in ("left", "bottom") else ends[1 - along][-2:]
    return _mesh(shape, own, pieces, (across, part) if along else (part, across)).edge(boundary.side)


def body_grids(
    problem: Problem, space: SpaceOfBodies, mesh: Mesh, states: Iterable[StoredState], body: str = ""
) -> Iterator[vtk.Grid]:
    """Return the grids of a body in states; of several bodies one is chosen by its name.

    Raises InputError for coefficients of another space.
    """
    kind, cells, centres = _cells(mesh)
    name = body or problem.body.name
    for state in states:
        u = state.displacement
        fields, central = (fields_at(problem, space, u, *at, name) for at in (mesh.places, centres))
        data = {key: mesh.interpolated(values) for key, values in _body_data(fields).items()}
        own = part_of_body(problem, space, u, name)[1]
        yield _grid(kind, cells, mesh, own, data, _body_data(central))


def side_grids(
    problem: Problem, space: SpaceOfBodies, mesh: Mesh, states: Iterable[StoredState], interface: str = ""
) -> Iterator[vtk.Grid]:
    """Return the grids of an adhering side in states; of several interfaces one is chosen by its name.

    Raises as `body_grids` does, and InputError where maximum openings of an irreversible joint are missing.
    """
    kind, cells, centres = _cells(mesh)
    boundary = problem.interface_of(interface).boundary
    along = 1 if boundary.side in ("left", "right") else 0
    at_points, central = (
        InterfacePoints(problem, space, at[along], interface=interface) for at in (mesh.places, centres)
    )
    shape = mesh.points.shape[:-1]
    for state in states:
        u, openings = state.displacement, state.maximum_openings
        data = {
            name: mesh.interpolated(values.reshape(*shape, *values.shape[2:]))
            for name, values in _side_data(at_points.state(u, openings)).items()
        }
        own = part_of_body(problem, space, u, boundary.body)[1]
        yield _grid(kind, cells, mesh, own, data, _side_data(central.state(u, openings)))


def _mesh(shape: NurbsSurface, space: RowSpace, pieces: int | None, ends: Ends) -> Mesh:
    return (
        BezierMesh.of(shape, space, ends) if pieces is None else StraightMesh.of(shape, space, ends, pieces)
    )


def _ends(space: RowSpace, shape: NurbsSurface) -> Ends:
    along, across = (one.breakpoints for one in shape.spaces)
    return cell_ends(space.rows[0].breakpoints, along), cell_ends(space.across.breakpoints, across)


def _cells(mesh: Mesh) -> tuple[int, IntArray, Ends]:
    """Return the kind of the cells, numbers (m, c) of their points, and where their centres are."""
    n_x, n_y, a, b = mesh.points.shape[:-1]
    numbers = np.arange(n_x * n_y * a * b).reshape(n_x * n_y, a * b)
    curves = 1 in (a, b)
    if isinstance(mesh, BezierMesh):
        order = vtk.curve_order(a * b - 1) if curves else vtk.quadrilateral_order(a - 1, b - 1)
        xi, eta = ((ends[:-1, None] + ends[1:, None]) / 2 for ends in mesh.ends)
        return vtk.BEZIER_CURVE if curves else vtk.BEZIER_QUADRILATERAL, numbers[:, order], (xi, eta)
    local = np.arange(a * b).reshape(a, b)
    if curves:
        flat = local.ravel()
        corners = np.stack([flat[:-1], flat[1:]], axis=-1)
    else:
        corners = np.stack([local[:-1, :-1], local[1:, :-1], local[1:, 1:], local[:-1, 1:]], axis=-1)
    xi, eta = (at if at.shape[1] == 1 else (at[:, :-1] + at[:, 1:]) / 2 for at in mesh.places)
    size = corners.shape[-1]
    return (
        vtk.LINE if curves else vtk.QUAD,
        numbers[:, corners.reshape(-1, size)].reshape(-1, size),
        (xi, eta),
    )


def _grid(
    kind: int,
    cells: IntArray,
    mesh: Mesh,
    displacement: FloatArray,
    data: dict[str, FloatArray],
    central: dict[str, FloatArray],
) -> vtk.Grid:
    bezier = mesh if isinstance(mesh, BezierMesh) else None
    u = mesh.displacement(displacement)
    return vtk.Grid(
        kind,
        _in_space(mesh.points.reshape(-1, 2)),
        cells,
        {
            "displacement [L0]": _in_space(u.reshape(-1, 2)),
            **{name: _rows(values, mesh.points[..., 0].size) for name, values in data.items()},
        },
        {name: _rows(values, len(cells)) for name, values in central.items()},
        bezier.degrees if bezier and kind == vtk.BEZIER_QUADRILATERAL else None,
        bezier.weights.ravel() if bezier and bezier.rational else None,
    )


def _body_data(fields: SampledFields) -> dict[str, FloatArray]:
    F = np.zeros(fields.nominal_stress.shape)
    F[..., :2, :2], F[..., 2, 2] = fields.deformation_gradient, 1.0
    return {
        "deformation gradient [1]": _flat(F),
        "first Piola-Kirchhoff stress [E0]": _flat(fields.nominal_stress),
        "Cauchy stress [E0]": fields.cauchy_stress[..., *_SYMMETRIC],
        "I1 [1]": fields.first_invariant,
    }


def _side_data(found: InterfaceState) -> dict[str, FloatArray]:
    return {
        "gap [L0]": found.gap,
        "normal adhesive traction [E0]": found.normal_traction,
        "adhesive traction [E0]": _in_space(found.traction),
    }


def _flat(tensors: FloatArray) -> FloatArray:
    return tensors.reshape(*tensors.shape[:-2], 9)


def _rows(values: FloatArray, count: int) -> FloatArray:
    """Return values (..., c) or (...) at so many points or cells as (count, c) or (count,)."""
    components = values.size // count
    return values.reshape(count) if components == 1 else values.reshape(count, components)


def _in_space(vectors: FloatArray) -> FloatArray:
    """Return vectors (..., 2) as (..., 3)."""
    return np.concatenate([vectors, np.zeros_like(vectors[..., :1])], axis=-1)
