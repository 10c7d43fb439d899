"""The work of the drive in both halves of a step, by the parabola through its three rates."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from isopeel.case import Case, load_case
from isopeel.solve.balance import simpson_misfits
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.step import AcceptedState
from isopeel.solve.trace import trace

#: A stiff quarter cylinder is pressed on a weak joint: the round-off of its energy is 1e-4 of the work of
#: adhesion (trial 498 of seed 3).
WEAK = """
name = "weak"
units = { length = "1 um", stress = "1 MPa" }
body = { shape = "quarter-cylinder", radius = "32.61 um" }
material = { law = "neo-hooke", youngs_modulus = "11.78 GPa", poissons_ratio = 0.35 }
discretization = { mesh = "7x4" }
drive = { kind = "displacement", side = "top", angle = "90 deg", to = "-0.11875 nm", step = "0.01484375 nm" }
[adhesion]
law = "exponential"
strength = "3.422 MPa"
work_of_adhesion = "1.062e-5 J/m^2"
length = "1.483 um"
"""


def states(energy: np.polynomial.Polynomial, jump: float = 0.0) -> list[AcceptedState]:
    """States of an energy at 1, 1.3 and 1.6; the last one has released some by a jump."""
    rate = energy.deriv()
    nothing = np.zeros(0)
    places = (1.0, 1.3, 1.6)
    return [
        AcceptedState(p, nothing, energy(p) - (jump if p == places[-1] else 0.0), rate(p), 0.0)
        for p in places
    ]


def test_an_energy_of_third_order_comes_from_the_work_to_round_off() -> None:
    one, half, other = states(np.polynomial.Polynomial([0.3, -1.0, 2.0, 0.7]))
    # energies are of the order 1, their round-off a few 1e-16
    assert simpson_misfits(one, half, other) == pytest.approx((0.0, 0.0), abs=1e-14)


def test_the_halves_add_up_to_the_rule_of_simpson_beside_the_integral() -> None:
    """Of fifth order: its error is h^5/90 times the fourth derivative of the rate, h half of the step."""
    energy = np.polynomial.Polynomial([0.0, 1.0, 0.0, 0.0, 0.0, 0.2])
    path = states(energy)
    work = sum(quad(energy.deriv(), a.parameter, b.parameter)[0] for a, b in pairwise(path))
    assert work == pytest.approx(path[-1].energy - path[0].energy, rel=1e-13)
    expected = -(0.3**5) / 90 * 24.0
    # both are differences of energies of the order 1
    assert sum(simpson_misfits(*path)) == pytest.approx(expected, abs=1e-14)


def test_a_jump_shows_in_its_half_alone() -> None:
    first, second = simpson_misfits(*states(np.polynomial.Polynomial([0.0, 1.0, 1.0]), jump=0.01))
    assert first == pytest.approx(0.0, abs=1e-14)
    assert second == pytest.approx(-0.01, rel=1e-12)


def test_the_round_off_of_the_energy_cuts_no_step() -> None:
    """The work of these steps is less than it; each was cut some hundred times."""
    stage = (case := Case.parse(WEAK)).stages()[0]
    path = trace(stage.problem, case.space(), stage.parameters, NewtonSettings(path_control="auto"))
    assert [step.kind for step in path] == ["requested"] * 9


def test_a_path_may_begin_with_an_arm_that_is_open_under_an_unknown_load() -> None:
    """The body at rest has another displacement of the load: its energy says nothing about a gain."""
    case = load_case("double-cantilever").with_values({"discretization.mesh": "60x2"})
    problem, values = case.problem(), case.stages()[0].parameters[:3]
    from_rest, opened = (
        [step.reaction for step in trace(problem, case.space(), some)] for some in (values, values[1:])
    )
    # the accuracy of reactions that the solver states
    assert opened == pytest.approx(from_rest[1:], rel=1e-8)
