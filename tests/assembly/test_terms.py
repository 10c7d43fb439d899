"""Data of terms: packed as two arrays, it is read back as it was, and serves any list of terms."""

import sys
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from numba import njit
from numba.core.dispatcher import Dispatcher

from isopeel.assembly.equations import Iterate, evaluate
from isopeel.assembly.load_kernel import add_load
from isopeel.assembly.loops import Sums, TermList, add_terms, compile_loops
from isopeel.assembly.packing import Flags2, Floats1, Floats3, Integers2, packed, reader
from isopeel.assembly.spaces import SpaceOfBodies
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.common.quantities import Length, Number
from isopeel.physics.adhesion import Exponential, NormalLaw, normal_law
from isopeel.physics.materials import SaintVenantKirchhoff
from isopeel.physics.substrates import RigidSubstrate, substrate
from isopeel.problem import HeldLoad, Problem, PulledSide, Support, strip
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.path import Path
from isopeel.solve.step import Found
from isopeel.splines.rows import row_space


@normal_law
class Springs(NormalLaw):
    stiffness: Number
    equilibrium_gap: Length = 0.25
    work_of_adhesion = 0.01

    @staticmethod
    def at_point(opening: float, stiffness: float) -> tuple[float, float, float]:
        return 0.5 * stiffness * opening**2, -stiffness * opening, -stiffness


@substrate
class Plane(RigidSubstrate):
    height: Length

    @staticmethod
    def graph(x: float, height: float) -> tuple[float, float, float]:
        return height + 0.0 * x, 0.0, 0.0


class Sample(NamedTuple):
    number: int
    numbers: Integers2
    size: float
    values: Floats3
    empty: Floats1
    chosen: Flags2
    known: bool


def test_data_is_read_back_bit_for_bit() -> None:
    rng = np.random.default_rng(0)
    data = Sample(
        7,
        rng.integers(-9, 9, (3, 5)),
        np.pi,
        rng.random((2, 3, 4)).transpose(1, 0, 2),
        np.empty(0),
        rng.random((4, 3)) > 0.5,
        True,
    )
    read = reader(Sample)
    compiled = njit(lambda integers, floats: read(integers, floats))
    for found in (compiled(*packed(data)), read.py_func(*packed(data))):
        for one, other in zip(found, data, strict=True):
            np.testing.assert_array_equal(np.asarray(one), np.asarray(other))
            assert np.asarray(one).shape == np.asarray(other).shape


def test_an_array_of_other_dimensions_is_refused() -> None:
    values, chosen = np.zeros((1, 1, 1)), np.zeros((1, 1), bool)
    data = Sample(7, np.zeros(3, np.int64), 0.0, values, np.zeros(1), chosen, True)
    with pytest.raises(TypeError, match="Sample: an array of 1 dimensions, not 2"):
        packed(data)


def test_terms_of_a_list_add_up() -> None:
    system = System(strip(irreversible=True), row_space("N2", (12, 2)))
    terms, u = system.equations.terms, system.state(np.full(system.count, 0.01), 0.1)[0]
    history = system.maximum_openings.ravel()

    def forces(listed: TermList) -> tuple[FloatArray, tuple[float, ...]]:
        found = np.zeros(u.shape)
        return found, add_terms(listed, history, np.zeros(1), u, Sums(found, np.empty((0, 0)), 0, False))

    body, stored = forces(terms.only([0]))
    side, adhesive = forces(terms.only([1]))
    found, energies = forces(terms.only([1, 0, 1]))
    # sums in another order
    np.testing.assert_allclose(found, body + 2 * side, rtol=0, atol=1e-14 * np.abs(found).max())
    assert energies == (stored[0], 2 * adhesive[1], 2 * adhesive[2], stored[3])
    assert np.abs(side).max() > 0


def test_no_solver_function_is_compiled_anew_for_other_terms() -> None:
    def signatures() -> dict[tuple[str, str], int]:
        return {
            (value.py_func.__module__, value.py_func.__name__): len(value.signatures)
            for name, module in list(sys.modules.items())
            if name.startswith(("isopeel.solve", "isopeel.matrix", "isopeel.assembly"))
            for value in vars(module).values()
            if isinstance(value, Dispatcher)
        }

    def go(problem: Problem, spaces: SpaceOfBodies) -> None:
        path = Path(System(problem, spaces), NewtonSettings(), ())
        for degrees in (0.0, 0.1, 0.2, 0.3):
            path.accept(Found(path.solver.equilibrium(np.radians(degrees))), 0.0)
        system = path.system
        y, (u, _) = np.zeros(system.count), system.state(np.zeros(system.count), 0.1)
        at = Iterate(y, u, np.zeros(u.shape), np.zeros(system.count))
        moved, scalars = system.constraints.moved(0.1), np.zeros(1)
        for kept in ([], [0], [1, 1, 0]):
            some = system.equations._replace(terms=system.equations.terms.only(kept))
            evaluate(some, system.maximum_openings.ravel(), moved, scalars, at)

    go(strip(), row_space("N2.1", (40, 2)))
    # if the loops of loads are not cached, the functions that they call are compiled with them, once
    compile_loops(add_load)
    known = signatures()
    # for factors in single precision, and for those in double precision where an earlier test needed them
    assert known["isopeel.solve.corrections", "corrected"] <= 2
    material, law = SaintVenantKirchhoff(1.0, 0.3), Exponential(0.06, 0.015, 0.25)
    go(strip(material=material, law=law, irreversible=True), row_space("N2.1", (40, 2)))
    assert signatures() == known
    # formulas of one's own
    own = strip(law=Springs(0.1))
    go(replace(own, interfaces=(replace(own.adhesion, against=Plane(-0.25)),)), row_space("N2.1", (40, 2)))
    assert signatures() == known
    # two bodies, one of them on two sides
    problem, beside = strip(), replace(strip().body, name="beside")
    joints = [
        replace(problem.adhesion, boundary=beside.side("bottom", *part)) for part in ((0.0, 0.3), (0.6, 1.0))
    ]
    two = replace(
        problem,
        bodies=(problem.body, beside),
        interfaces=(problem.adhesion, *joints),
        supports=(*problem.supports, Support(beside.side("left"), (0,))),
    )
    space = row_space("N2.1", (40, 2))
    go(two, {"body": space, "beside": space})
    assert signatures() == known
    # loads, of the drive and held
    raised = PulledSide("right", np.pi / 2, control="force")
    go(replace(problem, drive=raised, loads=(HeldLoad(problem.body.side("top"), 1e-4, 1.0),)), space)
    assert signatures() == known
