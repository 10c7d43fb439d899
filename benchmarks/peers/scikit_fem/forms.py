"""Assembly by scikit-fem's forms, written for speed.

Each component of the displacement has its own basis, numbered by its unknowns. The nodes of the rotated face
share a number, so that the assembly condenses. All x come before all y, so that block xy is above the
diagonal.
"""

import numpy as np
from scipy.sparse import csr_matrix
from skfem import BilinearForm, DiscreteField, LinearForm
from skfem.assembly.form.coo_data import COOData
from skfem.assembly.form.form import FormExtraParams
from skfem.helpers import dot, grad

from peers.laws import EQUILIBRIUM_GAP, FloatArray, adhesion, invert, moduli, stress
from peers.pardiso import SymmetricSolver
from peers.scikit_fem.program import starter
from peers.scikit_fem.strip import Strip, deformation_gradient, interpolate


class FormsAssembly:
    """Residual and tangent of a strip: laws once per iteration, then one form per component or block."""

    def __init__(self, strip: Strip) -> None:
        self._strip = strip
        (self._x, _), (self._y, self._contact) = (
            strip.bases(numbers, strip.unknowns + 1) for numbers in strip.unknown
        )
        _, entries = self._assemble(np.zeros(strip.unknown.shape))
        rows, columns = entries.indices
        self._upper = np.flatnonzero((rows <= columns) & (columns < strip.unknowns))
        self._places = rows[self._upper], columns[self._upper]

    def __call__(self, displacement: FloatArray) -> tuple[FloatArray, csr_matrix]:
        residual, entries = self._assemble(displacement)
        # COOData.tocsr omits entries that are zero by chance: then PARDISO could not use its analysis again
        tangent = csr_matrix((entries.data[self._upper], self._places), shape=(self._strip.unknowns,) * 2)
        return residual[:-1], tangent

    def _assemble(self, displacement: FloatArray) -> tuple[FloatArray, COOData]:
        """Return the residual, and the entries of the tangent that are summed, without block yx."""
        F = deformation_gradient(self._strip.bulk, displacement)
        inverse, factor = invert(F)
        P = stress(F, inverse, factor)
        rise = interpolate(self._strip.contact, displacement[1])
        traction, stiffness = adhesion(EQUILIBRIUM_GAP + rise)
        x, y, contact = self._x, self._y, self._contact
        residual = (
            INTERNAL_FORCE.assemble(x, P=P[0])
            + INTERNAL_FORCE.assemble(y, P=P[1])
            + ADHESIVE_FORCE.assemble(contact, traction=traction)
        )
        entries = (
            _tangent(moduli(0, 0, inverse, factor)).elemental(x)
            + _tangent(moduli(0, 1, inverse, factor)).elemental(y, x)
            + _tangent(moduli(1, 1, inverse, factor)).elemental(y)
            + ADHESIVE_TANGENT.elemental(contact, stiffness=stiffness)
        )
        return residual, entries


def _tangent(block: FloatArray) -> BilinearForm:
    """Return the form of one block of the moduli (2, 2, elements, points)."""
    trial, increment = None, np.empty(0)

    def tangent(u: DiscreteField, v: DiscreteField, _: FormExtraParams) -> FloatArray:
        nonlocal trial, increment
        # scikit-fem takes one trial function after the other, each with all test functions
        if u is not trial:
            trial, increment = u, np.einsum("JL...,L...->J...", block, grad(u))
        work: FloatArray = dot(increment, grad(v))
        return work

    return BilinearForm(tangent)


INTERNAL_FORCE = LinearForm(lambda v, w: dot(w.P, grad(v)))
ADHESIVE_FORCE = LinearForm(lambda v, w: -w.traction * v)
ADHESIVE_TANGENT = BilinearForm(lambda u, v, w: -w.stiffness * u * v)

start = starter(FormsAssembly, SymmetricSolver)
