"""A law between a body and its mirror image against the law itself, quadrature and finite differences."""

import pickle

import numpy as np
import pytest
from scipy.integrate import quad

from isopeel import Bilinear, Dugdale, Exponential, FormulaAdhesion, LennardJones, Trapezoidal, VanDerWaals
from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion import AdhesionLaw
from isopeel.physics.adhesion.irreversible import secant_unloading
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.batch import evaluate_law
from isopeel.post.law import law_character

LAWS: list[AdhesionLaw] = [
    VanDerWaals(hamaker_constant=0.05, equilibrium_distance=0.4),
    LennardJones(work_of_adhesion=0.03, equilibrium_gap=0.3),
    Exponential(0.1, 0.03),
    Bilinear(0.1, 0.03, 0.2),
    Trapezoidal(0.1, 0.03, 0.2, 0.4),
    Dugdale(0.1, 0.03, 0.2, 0.1),
    FormulaAdhesion("W*((s/r)**8/3 - 4/3*(s/r)**2)", {"W": 0.01, "s": 0.25}),
]
NAMES = [type(law).__name__ for law in LAWS]


def law_at(law: AdhesionLaw, gap: FloatArray, curvature: float = 0.0) -> tuple[FloatArray, ...]:
    return evaluate_law(law.kernel, law.parameters, gap, np.full(gap.shape, curvature))


@pytest.mark.parametrize("law", LAWS, ids=NAMES)
def test_it_is_the_law_over_both_distances(law: AdhesionLaw) -> None:
    gaps = np.linspace(0.05, 1.5, 40)
    potential, traction, derivative = law_at(Mirrored(law), gaps)
    whole = law_at(law, 2 * gaps)
    # doubling and halving are exact
    np.testing.assert_array_equal(potential, whole[0] / 2)
    np.testing.assert_array_equal(traction, whole[1])
    np.testing.assert_array_equal(derivative, 2 * whole[2])


@pytest.mark.parametrize("law", LAWS, ids=NAMES)
def test_traction_and_derivative_are_slopes(law: AdhesionLaw) -> None:
    mirrored = Mirrored(law)
    gaps = mirrored.equilibrium_gap + np.linspace(0.013, 0.4, 30)
    _, traction, derivative = law_at(mirrored, gaps)
    step = 1e-6
    ahead, behind = law_at(mirrored, gaps + step), law_at(mirrored, gaps - step)
    # central differences: step^2/6 of truncation times third derivatives, the steepest 4e4 of Dugdale's cubic
    np.testing.assert_allclose((behind[0] - ahead[0]) / (2 * step), traction, rtol=0, atol=1e-9)
    np.testing.assert_allclose((ahead[1] - behind[1]) / (2 * step), derivative, rtol=0, atol=1e-8)


@pytest.mark.parametrize("law", LAWS, ids=NAMES)
def test_parting_from_the_mirror_takes_half_the_work(law: AdhesionLaw) -> None:
    mirrored = Mirrored(law)
    start = mirrored.equilibrium_gap
    assert abs(law_at(mirrored, np.array([start]))[1][0]) < 1e-12  # a root, or where the law begins

    def attraction(gap: float) -> float:
        return -float(law_at(mirrored, np.array([gap]))[1][0])

    # the kinks of the cohesive laws lie within the first length
    near, _ = quad(attraction, start, start + 1.0, epsabs=1e-11, limit=200)
    far, _ = quad(attraction, start + 1.0, np.inf, epsabs=1e-11)
    assert mirrored.work_of_adhesion == pytest.approx(law.work_of_adhesion / 2, rel=1e-15)
    assert near + far == pytest.approx(mirrored.work_of_adhesion, abs=1e-9)


def test_all_laws_share_a_kernel_which_is_passed_the_address_of_theirs() -> None:
    first, second = Mirrored(LAWS[0]), Mirrored(LAWS[1])
    assert first.kernel is second.kernel
    for mirrored in (first, second):
        # as a float, exactly
        assert int(mirrored.parameters[0]) == mirrored.law.kernel.address


def test_its_peak_is_that_of_the_law_at_half_the_gap() -> None:
    law = LAWS[0]
    whole, half = law_character(law), law_character(Mirrored(law))
    # a peak is found to the root of the round-off, its height to round-off
    assert half.strength == pytest.approx(whole.strength, rel=1e-12)
    assert half.strongest_gap == pytest.approx(whole.strongest_gap / 2, rel=1e-6)
    assert half.stiffness == pytest.approx(2 * whole.stiffness, rel=1e-12)


def test_damage_of_the_half_is_half_the_damage() -> None:
    law = Bilinear(0.1, 0.03, 0.2)
    openings, history = np.linspace(-0.05, 0.6, 27), 0.2
    half = secant_unloading(Mirrored(law), openings / 2, np.array(history / 2))
    whole = secant_unloading(law, openings, np.array(history))
    # round-off of energies up to 0.03
    np.testing.assert_allclose(half.traction, whole.traction, rtol=0, atol=1e-16)
    np.testing.assert_allclose(half.stored, whole.stored / 2, rtol=0, atol=1e-16)
    np.testing.assert_allclose(half.dissipated, whole.dissipated / 2, rtol=0, atol=1e-16)
    np.testing.assert_allclose(half.derivative, 2 * whole.derivative, rtol=1e-13)


def test_a_curvature_is_passed_on() -> None:
    gaps = np.array([0.2, 0.4])
    np.testing.assert_array_equal(law_at(Mirrored(LAWS[0]), gaps, 0.7)[1], law_at(LAWS[0], 2 * gaps, 0.7)[1])


def test_it_travels_to_other_processes() -> None:
    mirrored = Mirrored(LAWS[0])
    assert pickle.loads(pickle.dumps(mirrored)) == mirrored
