"""Two arms that peel off each other in NGSolve, by its `ContactBoundary`.

NGSolve finds the partners of the integration points when the contact is updated, and holds them until the
next update. The gap along the normal of the other side at a partner that was found at the same displacement
has the gradient of the distance to the closest point, and nearly its second derivative.
"""

from collections.abc import Iterator

import netgen.meshing as netgen
import ngsolve as ng
import numpy as np

from peers.grid import Grid, gauss
from peers.laws import (
    ADHERING_LENGTH,
    EQUILIBRIUM_GAP,
    EQUILIBRIUM_STIFFNESS,
    HEIGHT,
    INTERACTION_DISTANCE,
    LENGTH,
    TRACTION_SCALE,
    FloatArray,
    IntArray,
)
from peers.newton import LoadStep, by_processor_time, trace
from peers.ngsolve_strip import compiled, higher_along_x, stress

#: A point that is farther away has no partner; the traction there is 1e-13 of the largest one.
_MOST_DISTANT = 5 * LENGTH


class NgsolveArms:
    """Both arms, with the interface that Newton's method needs.

    NGSolve makes a matrix with a new pattern after each update of the contact. So the contact has a form of
    its own, and its entries are added to those of the bodies in a matrix with a pattern that only grows. The
    factorization analyses this pattern again only after it has grown.
    """

    def __init__(self, degree: int, elements: tuple[int, int]) -> None:
        self.mesh = mesh = _mesh(elements)
        component = higher_along_x(mesh, degree)
        space, count = component**2, component.ndof
        self._order = 2 * degree  # Gauss's rule of degree + 1 points
        self._solid = _solid(space, degree)
        self.held = ng.GridFunction(space)
        self._contact = ng.ContactBoundary(mesh.Boundaries("integrated"), mesh.Boundaries("faced"))
        self._contact.AddEnergy(_potential(_gap(space)).Compile())
        self.joint = ng.BilinearForm(space)
        self._forces = [self.held.vec.CreateVector() for _ in range(2)]
        right_upper, right_lower, left_upper, left_lower = (
            np.flatnonzero(np.array(list(component.GetDofs(mesh.Boundaries(name)))))
            for name in ("upper right", "lower right", "upper left", "lower left")
        )
        # all x are numbered before all y
        self._driven = {1.0: right_upper + count, -1.0: right_lower + count}
        fixed = [left_upper, left_lower, left_lower + count, *self._driven.values()]
        self._free = np.setdiff1d(np.arange(2 * count), np.concatenate(fixed))
        self.unknowns = self._free.size
        self._unknown = np.full(2 * count, -1)
        self._unknown[self._free] = np.arange(self.unknowns)
        self._solid.AssembleLinearization(self.held.vec)
        self._inverse: ng.BaseMatrix | None = None
        self._keys = self._of_solid = np.empty(0, dtype=np.int64)

    def displacement(self, state: FloatArray, apart: float) -> FloatArray:
        u = np.zeros(self._unknown.size)
        u[self._free] = state[:-1]
        for factor, driven in self._driven.items():
            u[driven] = factor * apart
        return u

    def assemble(self, u: FloatArray) -> tuple[FloatArray, ng.BaseMatrix]:
        residual = self.all_forces(u)[self._free]
        self._solid.AssembleLinearization(self.held.vec)
        self.joint.AssembleLinearization(self.held.vec)
        keys, entries = self._entries(self.joint)
        places = np.searchsorted(self._keys, keys)
        if not (self._keys.size and np.array_equal(self._keys.take(places, mode="clip"), keys)):
            self._grow(keys)
            places = np.searchsorted(self._keys, keys)
        self._values[:] = 0.0
        self._values[self._of_solid] = self._entries(self._solid)[1]
        self._values[places] += entries
        return residual, self._tangent

    def solve(self, tangent: ng.BaseMatrix, right_hand_side: FloatArray) -> FloatArray:
        if self._inverse is None:
            self._inverse = tangent.Inverse(inverse="sparsecholesky")
        else:
            self._inverse.Update()
        given, solution = tangent.CreateColVector(), tangent.CreateRowVector()
        given.FV().NumPy()[:] = right_hand_side
        solution.data = self._inverse * given
        return np.array(solution.FV().NumPy())

    def moment(self, u: FloatArray, apart: float) -> float:  # noqa: ARG002 (the interface of a strip)
        """Return the force: the work of both ends per displacement."""
        forces = self.all_forces(u)
        return float(sum(factor * forces[driven].sum() for factor, driven in self._driven.items()))

    def all_forces(self, u: FloatArray) -> FloatArray:
        """Find the partners at a displacement, and return the forces of the bodies and of the contact."""
        self.held.vec.FV().NumPy()[:] = u
        self._contact.Update(self.held, self.joint, self._order, _MOST_DISTANT)
        for form, forces in zip((self._solid, self.joint), self._forces, strict=True):
            form.Apply(self.held.vec, forces)
        total: FloatArray = sum(forces.FV().NumPy() for forces in self._forces)
        return total

    def _entries(self, form: ng.BilinearForm) -> tuple[IntArray, FloatArray]:
        """Return the places of a form's entries, row times unknowns plus column, and the entries."""
        entries, columns, starts = (np.asarray(part) for part in form.mat.CSR())
        counts: IntArray = np.diff(starts).astype(np.int64)
        row = self._unknown[np.repeat(np.arange(starts.size - 1), counts)]
        column = self._unknown[columns]
        kept = (row >= 0) & (column >= 0)
        return row[kept] * self.unknowns + column[kept], entries[kept]

    def _grow(self, keys: IntArray) -> None:
        """Make a matrix that has also these places."""
        of_solid = self._entries(self._solid)[0]
        self._keys = np.unique(np.concatenate([self._keys, of_solid, keys]))
        self._of_solid = np.searchsorted(self._keys, of_solid)
        rows, columns = np.divmod(self._keys, self.unknowns)
        self._tangent = ng.la.SparseMatrixd.CreateFromCOO(
            rows.tolist(), columns.tolist(), [0.0] * rows.size, self.unknowns, self.unknowns
        )
        self._values = self._tangent.AsVector().FV().NumPy()
        self._inverse = None


def _mesh(elements: tuple[int, int]) -> ng.Mesh:
    """Return both arms, with the names of their sides. All boundaries run anticlockwise."""
    grid = Grid(1, elements)
    rows = elements[1] + 1
    sticking = round(elements[0] * ADHERING_LENGTH / LENGTH)
    mesh = netgen.Mesh(dim=2)
    names: dict[str, int] = {}
    for body, (arm, y) in enumerate((("lower", -HEIGHT - EQUILIBRIUM_GAP), ("upper", 0.0)), start=1):
        mesh.SetMaterial(body, arm)
        mesh.Add(netgen.FaceDescriptor(surfnr=body, domin=body, bc=body))
        points = [mesh.Add(netgen.MeshPoint(netgen.Pnt(x, y + over, 0))) for x, over in grid.points]
        for a, b, d, c in grid.cells:
            mesh.Add(netgen.Element2D(body, [points[corner] for corner in (a, b, c, d)]))
        first = np.arange(elements[0]) * rows
        bottom, top = np.stack([first, first + rows], 1), np.stack([first + rows, first], 1) + rows - 1
        left = np.stack([np.arange(1, rows), np.arange(rows - 1)], 1)
        sides = {f"{arm} left": left, f"{arm} right": left[:, ::-1] + elements[0] * rows}
        sides |= {"faced": top} if arm == "lower" else {"integrated": bottom[:sticking]}
        for name, ends in sides.items():
            number = names.setdefault(name, len(names) + 1)
            for a, b in ends:
                mesh.Add(netgen.Element1D([points[a], points[b]], index=number))
    for name, number in names.items():
        mesh.SetBCName(number - 1, name)
    return ng.Mesh(mesh)


def _solid(space: ng.FESpace, degree: int) -> ng.BilinearForm:
    (x, weight_x), (y, weight_y) = gauss(degree + 1), gauss(2)
    points = [(a, b) for b in y for a in x]
    rule = {ng.ET.QUAD: ng.IntegrationRule(points, np.outer(weight_y, weight_x).ravel().tolist())}
    u, v = space.TnT()
    form = ng.BilinearForm(space)
    form += compiled(ng.InnerProduct(stress(ng.Grad(u)), ng.Grad(v))) * ng.dx(intrules=rule)
    return form


def _gap(space: ng.FESpace) -> ng.CoefficientFunction:
    """Return the distance of a point to the tangent of the other side at its partner."""
    u = space.TrialFunction()
    X = ng.CF((ng.x, ng.y))
    apart = X + u - X.Other() - u.Other()
    along = ng.specialcf.tangential(2).Other()
    along = along + ng.Grad(u).Trace().Other() * along
    # the side runs anticlockwise, so that its outward normal is to the right
    return (apart[0] * along[1] - apart[1] * along[0]) / ng.Norm(along)


def _potential(gap: ng.CoefficientFunction) -> ng.CoefficientFunction:
    """Return Phi with Phi' = -T, zero at infinity."""

    def beyond(gap: ng.CoefficientFunction | float) -> ng.CoefficientFunction | float:
        square = (INTERACTION_DISTANCE / gap) ** 2
        return TRACTION_SCALE * INTERACTION_DISTANCE * square * (square**3 / 360 - 1 / 6)

    opening = gap - EQUILIBRIUM_GAP
    closed = beyond(EQUILIBRIUM_GAP) - EQUILIBRIUM_STIFFNESS / 2 * opening**2
    return ng.IfPos(opening, beyond(gap), closed)


def start(degree: int, elements: tuple[int, int], displacements: Iterator[float]) -> Iterator[LoadStep]:
    """Return the path of NGSolve."""
    ng.SetNumThreads(1)
    return by_processor_time(trace(NgsolveArms(degree, elements), displacements))
