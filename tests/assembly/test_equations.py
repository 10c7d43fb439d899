"""The compiled forces of a state are those of the system."""

from dataclasses import replace

import numpy as np
import pytest

from isopeel.assembly.equations import Iterate, evaluate
from isopeel.assembly.system import System
from isopeel.problem import Boundary, Drive, PulledSide, RotatedSide, strip
from isopeel.splines.rows import row_space


@pytest.mark.parametrize(
    "drive",
    [RotatedSide("right"), PulledSide(Boundary("body", "top", 0.5), 1.0, control="force")],
    ids=["angle", "force"],
)
def test_a_state_has_the_forces_and_energies_of_the_system(drive: Drive) -> None:
    system = System(replace(strip(), drive=drive), row_space("N2.1", (12, 2)))
    parameter, shape = 0.05, system.constraints.unknowns.shape
    y = 0.01 * np.random.default_rng(0).standard_normal(system.count)
    u, load = system.state(y, parameter)
    expected = system.equilibrium(u, load)
    at = Iterate(y, np.full(shape, np.nan), np.full(shape, np.nan), np.full(system.count, np.nan))
    moved, scalars = system.constraints.moved(parameter), np.array([load])
    energies = evaluate(system.equations, system.maximum_openings.ravel(), moved, scalars, at)
    np.testing.assert_array_equal(at.displacement, u)
    # sums in another order
    largest = np.abs(expected.forces).max()
    np.testing.assert_allclose(at.forces, expected.forces, rtol=0, atol=1e-14 * largest)
    np.testing.assert_allclose(at.residual, expected.residual, rtol=0, atol=1e-14 * largest)
    assert energies == pytest.approx(
        (
            expected.stored_energy,
            expected.adhesive_energy,
            expected.dissipated_energy,
            expected.lowest_determinant,
        ),
        rel=1e-14,
    )
    # a load acts
    unloaded = system.equilibrium(u, 0.0).residual
    assert (np.abs(expected.residual - unloaded).max() > 0) == system.control.raises_load
