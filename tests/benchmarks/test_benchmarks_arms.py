"""The benchmark of two arms: NGSolve finds the same gaps, energies, forces and equilibria."""

from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from isopeel import row_space
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
ELEMENTS = (12, 2)


@pytest.fixture(autouse=True)
def _importable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(BENCHMARKS)


def test_ngsolve_finds_the_same_gaps_and_forces() -> None:
    """Where both arms bend by different parabolas: sides that are inclined and curved."""
    ng = pytest.importorskip("ngsolve")
    from peers.isopeel_arms import two_arms
    from peers.laws import LENGTH
    from peers.ngsolve_arms import NgsolveArms

    theirs = NgsolveArms(2, ELEMENTS)
    space = row_space("L2", ELEMENTS)
    system = System(two_arms(), {"upper": space, "lower": space})
    x = system.spaces.control_points()[:, 0]
    width = LENGTH / ELEMENTS[0]
    # a Bernstein coefficient of x^2 on [a, b] is a^2, a b or b^2
    inner = ~np.isclose(x / width, np.round(x / width))
    square = (x**2 - inner * (width / 2) ** 2) / 100**2

    def moved(upper: float, lower: float, constant: float) -> tuple[FloatArray, FloatArray]:
        """Return displacements along y by shares of (x/100)^2 + constant, in NGSolve and in isopeel."""
        share = theirs.mesh.MaterialCF({"upper": upper, "lower": lower})
        theirs.held.Set(ng.CF((0, share * ((ng.x / 100) ** 2 + constant))))
        ours = np.zeros((system.spaces.size, 2))
        for body, factor in (("upper", upper), ("lower", lower)):
            place = system.spaces.places[body]
            ours[place, 1] = factor * (square[place] + constant)
        return theirs.held.vec.FV().NumPy().copy(), ours

    bent = moved(0.3, -0.2, 0.1)
    forces = theirs.all_forces(bent[0])
    found = system.equilibrium(bent[1])
    # NGSolve's four steps to a partner leave an error that the energy feels by its square
    assert theirs.joint.Energy(theirs.held.vec) == pytest.approx(found.adhesive_energy, rel=1e-12)
    assert found.adhesive_energy < -0.5
    for motion in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 0.0, 1.0)):
        their, our = moved(*motion)
        # the forces do too, because the gap is stationary at a partner: measured 3e-15
        assert their @ forces == pytest.approx(np.sum(our * found.forces), rel=1e-12)


def test_both_programs_find_the_same_forces() -> None:
    from peers.names import ARMS
    from programs import GoneError, Program

    forces = []
    for name in ARMS:
        try:
            program = Program(name, 2, (40, 2))
        except GoneError as error:
            pytest.skip(str(error))
        # the joint opens from 10 nm on
        program.begin(np.arange(0.0, 13.0, 1.0).tolist())
        found = program.finish()
        program.close()
        assert found.stopped is None
        forces.append([step.moment for step in found.steps])
    largest = max(forces[0])
    # both stop at the same energy residual, which leaves up to 6e-8 of the largest force on a mesh of 200x10
    np.testing.assert_allclose(forces[1], forces[0], rtol=0, atol=1e-6 * largest)


def test_the_deviation_is_that_of_the_step_where_forces_differ_most() -> None:
    arms = import_module("arms")
    from peers.newton import LoadStep

    one, other = (
        arms.Path(program=None, steps=[LoadStep(force, 2, 0.5) for force in forces])
        for forces in ([0.0, 3.0, 4.0], [0.0, 3.5, 4.25])
    )
    assert arms.deviation(one, other) == pytest.approx(0.5 / 4.25)
    assert one.seconds == 1.5
