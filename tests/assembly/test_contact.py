"""Contact without adhesion: its law, the stiffness that is chosen, and a load that two bodies pass on."""

from dataclasses import replace

import numpy as np
import pytest

from isopeel import (
    Body,
    Contact,
    Flat,
    InputError,
    Interface,
    Mirrored,
    NeoHooke,
    Problem,
    PulledSide,
    RowSpace,
    Step,
    Support,
    row_space,
    trace,
)
from isopeel.assembly.interface import InterfacePoints
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.physics.batch import evaluate_law
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.problem.place import placed
from isopeel.splines.nurbs import rectangle

PRESSURE = 0.01
SOFT, STIFF = NeoHooke(1.0, 0.3), NeoHooke(3.0, 0.0)
UPPER = Body(rectangle(4.0, 2.0), SOFT, "upper")
LOWER = Body(placed(rectangle(4.0, 1.0), (0.0, -1.0), 0.0), STIFF, "lower")
PRESS = PulledSide(UPPER.side("top"), -np.pi / 2, control="force")
ON_LINES = tuple(Support(body.side("left"), (0,)) for body in (UPPER, LOWER))
SPACES = {"upper": row_space("N2", (5, 2), 2), "lower": row_space("N2", (8, 2), 2)}


def alone(law: Contact | Mirrored) -> Problem:
    return Problem("one", (UPPER,), (Interface(UPPER.side("bottom"), law, Flat()),), ON_LINES[:1], PRESS)


def both(law: Contact, scheme: str = "unbiased") -> Problem:
    joint = Interface(UPPER.side("bottom"), law, LOWER.side("top"), scheme=scheme)  # type: ignore[arg-type]
    return Problem("two", (UPPER, LOWER), (joint,), (*ON_LINES, Support(LOWER.side("bottom"), (1,))), PRESS)


def stiffness_in(problem: Problem) -> float:
    system = System(problem, {body.name: SPACES[body.name] for body in problem.bodies})
    return float(system.interfaces[0].adhesion.law.parameters[-1])


def test_the_traction_is_the_derivative_of_the_potential_and_only_repels() -> None:
    law = Contact(30.0, 0.2)
    gaps = 0.2 + np.array([-0.5, -1e-3, 1e-3, 0.5])
    step = 1e-6

    def at(gap: FloatArray) -> tuple[FloatArray, ...]:
        return evaluate_law(law.kernel, law.parameters, gap, np.zeros(gap.shape))

    potential, traction, derivative = at(gaps)
    above, below = at(gaps + step), at(gaps - step)
    # differences of a square are exact to their round-off, 1e-16 potential/step
    np.testing.assert_allclose(traction, (below[0] - above[0]) / (2 * step), atol=1e-8)
    np.testing.assert_allclose(derivative, (above[1] - below[1]) / (2 * step), atol=1e-7)
    assert (traction[:2] > 0).all()
    np.testing.assert_array_equal(traction[2:], 0.0)
    np.testing.assert_array_equal(potential[2:], 0.0)
    assert law.work_of_adhesion == 0.0


def test_the_stiffness_is_that_of_the_softer_of_two_elements() -> None:
    upper, lower = plane_strain_modulus(SOFT) / (4 / 5), plane_strain_modulus(STIFF) / (4 / 8)
    # the lengths of elements are sums of weights
    assert stiffness_in(both(Contact())) == pytest.approx(10 * min(upper, lower), rel=1e-12)
    for law in (Contact(), Mirrored(Contact())):
        assert stiffness_in(alone(law)) == pytest.approx(10 * upper, rel=1e-12)
    # one that is given stays, and a law without one says so
    assert stiffness_in(both(Contact(7.0))) == 7.0
    with pytest.raises(InputError, match=r"adhesion\.stiffness: it is chosen where bodies have meshes"):
        _ = Contact().parameters


@pytest.mark.parametrize("scheme", ["unbiased", "biased", "two-half-pass", "substrate"])
def test_bodies_overlap_by_the_pressure_over_the_stiffness(scheme: str) -> None:
    problem = alone(Contact()) if scheme == "substrate" else both(Contact(), scheme)
    spaces: dict[str, RowSpace] = {body.name: SPACES[body.name] for body in problem.bodies}
    steps: list[Step] = list(trace(problem, spaces, [0.0, 4 * PRESSURE]))
    points = InterfacePoints.of_contact(problem, spaces, interface=problem.interface_names[0])
    state = points.state(steps[-1].displacement)
    stiffness = points._term.adhesion.law.parameters[1]
    # the quadrature error of sides that do not match, see `test_facing.py`
    assert np.average(state.normal_traction, weights=points.lengths) == pytest.approx(PRESSURE, rel=0.01)
    np.testing.assert_allclose(state.gap, -state.normal_traction / stiffness, rtol=1e-9)
    # what pulls them apart meets no resistance but that of a body that nothing holds
    apart = replace(problem, drive=replace(PRESS, angle=np.pi / 2))
    with pytest.raises(Exception, match="no equilibrium"):
        list(trace(apart, spaces, [0.0, 4 * PRESSURE]))
