"""Assembly as in scikit-fem's examples of hyperelasticity: vector-valued, with the laws inside the forms."""

import numpy as np
from pypardiso import spsolve
from scipy.sparse import csr_matrix
from skfem import BilinearForm, CellBasis, DiscreteField, ElementVector, FacetBasis, LinearForm
from skfem.assembly.form.form import FormExtraParams
from skfem.helpers import ddot, grad, identity, mul, trace, transpose

from peers.laws import (
    EQUILIBRIUM_GAP,
    LAME_LAMBDA,
    SHEAR_MODULUS,
    FloatArray,
    adhesion,
    invert,
    stress,
)
from peers.scikit_fem.element import NumberedDofs
from peers.scikit_fem.program import starter
from peers.scikit_fem.strip import Strip


class PlainAssembly:
    """Residual and tangent of a strip, condensed by a matrix of zeros and ones."""

    def __init__(self, strip: Strip) -> None:
        count = strip.unknown.size
        mesh, element = strip.bulk.mesh, ElementVector(strip.bulk.elem)
        # the components of one node follow each other in the element, not in a displacement (2, nodes)
        numbers = np.stack([strip.nodes, strip.nodes + count // 2], axis=1)
        dofs = NumberedDofs(mesh, element, numbers.reshape(-1, mesh.nelements), count)
        self._bulk = CellBasis(mesh, element, quadrature=strip.bulk.quadrature, dofs=dofs)
        self._contact = FacetBasis(
            mesh, element, quadrature=strip.contact.quadrature, facets=strip.contact.find, dofs=dofs
        )
        ones, places = np.ones(count), (np.arange(count), strip.unknown.ravel())
        self._condensation = csr_matrix((ones, places), shape=(count, strip.unknowns + 1))[:, :-1]

    def __call__(self, displacement: FloatArray) -> tuple[FloatArray, csr_matrix]:
        u = displacement.ravel()
        bulk, contact = self._bulk.interpolate(u), self._contact.interpolate(u)
        residual = INTERNAL_FORCE.assemble(self._bulk, u_k=bulk)
        residual += ADHESIVE_FORCE.assemble(self._contact, u_k=contact)
        tangent = TANGENT.assemble(self._bulk, u_k=bulk)
        tangent += ADHESIVE_TANGENT.assemble(self._contact, u_k=contact)
        C = self._condensation
        return C.T @ residual, (C.T @ tangent @ C).tocsr()


def _deformation_gradient(u: DiscreteField) -> FloatArray:
    F: FloatArray = grad(u) + identity(grad(u))
    return F


def _internal_force(v: DiscreteField, w: FormExtraParams) -> FloatArray:
    F = _deformation_gradient(w.u_k)
    work: FloatArray = ddot(stress(F, *invert(F)), grad(v))
    return work


def _tangent(u: DiscreteField, v: DiscreteField, w: FormExtraParams) -> FloatArray:
    inverse, factor = invert(_deformation_gradient(w.u_k))
    du, dv = mul(grad(u), inverse), mul(grad(v), inverse)
    work: FloatArray = SHEAR_MODULUS * ddot(grad(u), grad(v)) - factor * ddot(transpose(du), dv)
    work += LAME_LAMBDA * trace(du) * trace(dv)
    return work


def _adhesion(u: DiscreteField) -> tuple[FloatArray, FloatArray]:
    return adhesion(EQUILIBRIUM_GAP + u[1])


INTERNAL_FORCE, TANGENT = LinearForm(_internal_force), BilinearForm(_tangent)
ADHESIVE_FORCE = LinearForm(lambda v, w: -_adhesion(w.u_k)[0] * v[1])
ADHESIVE_TANGENT = BilinearForm(lambda u, v, w: -_adhesion(w.u_k)[1] * u[1] * v[1])

start = starter(PlainAssembly, lambda: spsolve)
