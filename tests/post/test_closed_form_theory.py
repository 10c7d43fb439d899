"""Closed forms against energies minimised by SciPy, and against integrals over their pressures."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq, minimize, minimize_scalar
from scipy.special import gamma

from isopeel import Dugdale, InputError, LennardJones
from isopeel.common.arrays import FloatArray
from isopeel.post.closed_form import (
    BondedBeams,
    CohesiveCylinder,
    beam_moment,
    double_cantilever_force,
    double_cantilever_moment,
    hertz_line,
    jkr_line_load,
    jkr_line_pull_off,
    kendall_force,
    maugis_cylinder,
    maugis_cylinder_pull_off,
    sliding_tape_force,
    t_peel_force,
)
from isopeel.post.closed_form.rigid_cylinder import rigid_cylinder_pull_off

# a soft tape and a soft half space in which no term of an equation is negligible
WORK, STIFFNESS = 0.3, 20.0
MODULUS, RADIUS = 1.7, 2.3
ANGLES = np.radians([10, 45, 90, 130, 180])


def peel_force(potential_energy: Callable[[float, float], float], largest: float) -> float:
    """Force F at which d Pi/da = 0, Pi(F, a) the energy of a tape that adheres over a length a."""

    def slope(force: float) -> float:
        # Pi is linear in a: differences have no truncation
        return potential_energy(force, 0.75) - potential_energy(force, 0.25)

    # the balance holds once above the least of its energies
    return float(brentq(slope, 0.0, largest, xtol=1e-13))


def minimum(energy: Callable[[FloatArray], float], unknowns: int) -> float:
    return float(minimize(energy, np.zeros(unknowns), method="BFGS", options={"gtol": 1e-9}).fun)


@pytest.mark.parametrize("angle", ANGLES)
def test_a_sliding_tape_minimises_its_energy(angle: float) -> None:
    """Tape of length 1, held at x = 0, its adhering part a free to slide; both strains are unknown."""

    def potential_energy(force: float, adhering: float) -> float:
        def energy(strains: FloatArray) -> float:
            on, off = strains
            front = adhering * (1 + on)
            travel = front * np.cos(angle) + (1 - adhering) * (1 + off)
            stored = STIFFNESS / 2 * (adhering * on**2 + (1 - adhering) * off**2)
            return float(stored - force * travel - WORK * adhering)

        return minimum(energy, 2)

    expected = peel_force(potential_energy, 60.0)
    # minima are known to round-off, their difference quotients to 1e-9 of energies up to 1e2
    assert sliding_tape_force(WORK, STIFFNESS, angle) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("prestrain_force", [0.0, 2.0, -1.0])
@pytest.mark.parametrize("angle", ANGLES)
def test_a_tape_that_holds_minimises_its_energy(angle: float, prestrain_force: float) -> None:
    """Tape that adheres with the tension P_0, lengths measured along it; the free strain is unknown."""

    def potential_energy(force: float, adhering: float) -> float:
        def energy(strain: FloatArray) -> float:
            travel = adhering * np.cos(angle) + (1 - adhering) * (1 + strain[0])
            stored = (1 - adhering) * (prestrain_force * strain[0] + STIFFNESS / 2 * strain[0] ** 2)
            return float(stored - force * travel - WORK * adhering)

        return minimum(energy, 1)

    expected = peel_force(potential_energy, 60.0)
    force = kendall_force(WORK, STIFFNESS, angle, prestrain_force)
    assert force == pytest.approx(expected, rel=1e-7)  # as above


def test_two_tapes_that_are_pulled_apart_minimise_their_energy() -> None:
    """At right angles; the strains of both free parts are unknown. The force on each is half of the slope."""

    def potential_energy(force: float, adhering: float) -> float:
        def energy(strains: FloatArray) -> float:
            free = 1 - adhering
            stored = free * STIFFNESS / 2 * np.sum(strains**2)
            return float(stored - force * free * np.sum(1 + strains) - WORK * adhering)

        return minimum(energy, 2)

    expected = peel_force(potential_energy, 60.0)
    assert t_peel_force(WORK, STIFFNESS) == pytest.approx(expected, rel=1e-7)  # as above


def test_limits_of_tapes() -> None:
    # inextensible: Rivlin's F = W/(1 - cos angle); the next order is W/(E' h)
    for angle in ANGLES:
        rivlin = WORK / (1 - np.cos(angle))
        assert kendall_force(WORK, 1e13, angle) == pytest.approx(rivlin, rel=1e-9)
        assert sliding_tape_force(WORK, 1e13, angle) == pytest.approx(rivlin, rel=1e-9)
    # the peel test along the tape, F^2 = 2 E' h W
    assert kendall_force(WORK, STIFFNESS, 0.0) == pytest.approx(np.sqrt(2 * STIFFNESS * WORK), rel=1e-15)
    # at a right angle the sliding part bears no tension, as if it were held with none
    right = np.pi / 2
    assert sliding_tape_force(WORK, STIFFNESS, right) == pytest.approx(
        kendall_force(WORK, STIFFNESS, right), rel=1e-15
    )
    # at 180 degrees it bears as much as the free part: nothing is gained
    assert sliding_tape_force(WORK, STIFFNESS, np.pi) == pytest.approx(WORK / 2, rel=1e-15)


def test_a_tense_tape_rests_between_two_forces() -> None:
    # P_0^2/(2 E' h) = 0.4 > W: it comes off at no force, and rests at those between both roots
    tension, angle = 4.0, 0.2

    def released(force: float) -> float:
        return float((force - tension) ** 2 / (2 * STIFFNESS) + force * (1 - np.cos(angle)) - WORK)

    force = kendall_force(WORK, STIFFNESS, angle, tension)
    least = tension - STIFFNESS * (1 - np.cos(angle))
    assert released(0.0) > 0 > released(least)
    assert force == pytest.approx(brentq(released, least, 20.0, xtol=1e-14), rel=1e-13)  # round-off


@pytest.mark.parametrize(
    ("angle", "tension", "field"),
    [
        (-0.1, 0.0, "angle"),
        (3.2, 0.0, "angle"),
        (1.0, 4.0, "prestrain_force"),
        (1.0, -4.0, "prestrain_force"),
    ],
)
def test_tapes_without_a_peel_force(angle: float, tension: float, field: str) -> None:
    with pytest.raises(InputError, match=field):
        kendall_force(WORK, STIFFNESS, angle, tension)


@pytest.mark.parametrize("angle", [0.0, 3.2, np.nan])
def test_no_force_peels_a_sliding_tape_along_itself(angle: float) -> None:
    with pytest.raises(InputError, match="angle"):
        sliding_tape_force(WORK, STIFFNESS, angle)


def test_a_double_cantilever_minimises_its_energy() -> None:
    bending, opening = 5.0, 0.4
    # arms of length a bent by D/2 each: P = 3 E'I (D/2)/a^3, energy P D/2 of both
    crack = minimize_scalar(
        lambda a: 3 * bending * opening**2 / (4 * a**3) + WORK * a, bounds=(0.1, 10.0), method="bounded"
    )
    expected = 3 * bending * opening / 2 / crack.x**3
    # a minimum is found to the root of round-off
    assert double_cantilever_force(WORK, bending, opening) == pytest.approx(expected, rel=1e-5)
    # the moment at the tip is the moment that peels under moments
    assert expected * crack.x == pytest.approx(double_cantilever_moment(WORK, bending), rel=1e-5)


def test_moments() -> None:
    """Potential energy per length of crack, M^2/(2 E'I) - M (M/(E'I)) in each arm, against the work."""
    moment = beam_moment(WORK, 5.0)
    assert moment**2 / 10 == pytest.approx(WORK, rel=1e-15)
    # two arms share the work of their interface
    assert double_cantilever_moment(WORK, 5.0) == pytest.approx(beam_moment(WORK / 2, 5.0), rel=1e-15)


def integral(function: Callable[[float], float], ends: list[float]) -> float:
    """Integral over pieces between `ends`, at which a function may begin as a root or a logarithm."""
    total = 0.0
    for low, high in pairwise(ends):
        middle, half = (low + high) / 2, (high - low) / 2

        def over_angle(angle: float, middle: float = middle, half: float = half) -> float:
            return function(middle - half * float(np.cos(angle))) * half * float(np.sin(angle))

        total += quad(over_angle, 0.0, np.pi, epsabs=1e-12, epsrel=1e-12, limit=200)[0]
    return total


def half_space_slope(pressure: Callable[[float], float], ends: list[float], x: float) -> float:
    """Slope (2/(pi E*)) PV int p(t)/(x - t) dt of a half space over pieces between `ends`: x/R in a contact.

    Johnson, Contact Mechanics, Eq. (2.25).
    """
    total = 0.0
    for low, high in pairwise(ends):
        if low < x < high:
            total -= quad(pressure, low, high, weight="cauchy", wvar=x, limit=200)[0]
        else:
            total += integral(lambda t: pressure(t) / (x - t), [low, high])
    return 2 / (np.pi * MODULUS) * total


def test_hertz() -> None:
    contact = hertz_line(0.8, MODULUS, RADIUS)
    a = contact.half_width

    def pressure(x: float) -> float:
        return float(contact.pressure(np.array(x)))

    assert integral(pressure, [-a, a]) == pytest.approx(0.8, rel=1e-12)
    for x in np.array([0.1, 0.5, 0.9]) * a:
        # the quadrature's own 1e-8, at worst
        assert half_space_slope(pressure, [-a, a], x) == pytest.approx(x / RADIUS, rel=1e-8)
    assert contact.pressure(np.array([-1.1, 0.0, 1.1]) * a).tolist() == [0.0, contact.peak_pressure, 0.0]


def test_jkr_pull_off_is_the_least_load() -> None:
    least = minimize_scalar(
        lambda a: jkr_line_load(a, WORK, MODULUS, RADIUS), bounds=(1e-3, 10.0), method="bounded"
    )
    assert -least.fun == pytest.approx(jkr_line_pull_off(WORK, MODULUS, RADIUS), rel=1e-10)
    assert least.x**3 == pytest.approx(2 * WORK * RADIUS**2 / (np.pi * MODULUS), rel=1e-4)
    # without adhesion it is Hertz's contact
    load = jkr_line_load(0.7, 0.0, MODULUS, RADIUS)
    assert hertz_line(load, MODULUS, RADIUS).half_width == pytest.approx(0.7, rel=1e-14)


@pytest.mark.parametrize("ratio", [1.05, 1.2, 2.0, 30.0])
@pytest.mark.parametrize("strength", [0.1, 0.6, 3.0])
def test_maugis_pressure_bends_the_half_space_to_the_cylinder(ratio: float, strength: float) -> None:
    state = maugis_cylinder(ratio, strength, WORK, MODULUS, RADIUS)
    a, c = state.half_width, state.attracted_half_width
    assert c / a == pytest.approx(ratio, rel=1e-14)

    def pressure(x: float) -> float:
        return float(state.pressure(np.array(x)))

    # the load is what is left of a larger push and pull, each to the accuracy of the quadrature
    push = np.pi * MODULUS * a**2 / (4 * RADIUS)
    assert integral(pressure, [-c, -a, a, c]) == pytest.approx(state.load, rel=1e-12, abs=1e-12 * push)
    # the pressure goes on from the attraction without a jump, as the root of the distance, and ends at c
    assert pressure(a * (1 - 1e-14)) == pytest.approx(-strength, abs=1e-6 * MODULUS * a / RADIUS + 1e-5)
    assert pressure((a + c) / 2) == pytest.approx(-strength, rel=1e-15)
    assert pressure(1.01 * c) == 0.0
    for x in np.array([0.1, 0.5, 0.9]) * a:
        slope = half_space_slope(pressure, [-c, -a, a, c], x)
        # relative to the slopes of cylinder and attraction, whose sum it is
        assert slope == pytest.approx(x / RADIUS, abs=1e-9 * (a / RADIUS + strength / MODULUS))
    # the gap at the end of the attraction has taken the work; it is a difference of larger displacements
    gaps = [gap_at(state, a + share * (c - a)) for share in (0.0, 0.25, 0.5, 0.75, 1.0)]
    assert gaps[0] == 0.0
    assert np.all(np.diff(gaps) > 0)
    assert gaps[-1] == pytest.approx(WORK / strength, rel=1e-9, abs=1e-12 * c**2 / RADIUS)


def gap_at(state: CohesiveCylinder, x: float) -> float:
    """Gap at x >= a, zero at a: parabola and displacement -(2/(pi E*)) int p ln|x - t| dt of a half space."""
    a, c = state.half_width, state.attracted_half_width

    def displacement(at: float) -> float:
        def integrand(t: float) -> float:
            return float(state.pressure(np.array(t)) * np.log(np.abs(at**2 - t**2)))

        return -2 / (np.pi * MODULUS) * integral(integrand, sorted({0.0, a, x, c}))

    return (x**2 - a**2) / (2 * RADIUS) + displacement(x) - displacement(a)


@pytest.mark.parametrize("strength", [0.02, 0.1, 0.5, 2.0, 10.0])
def test_maugis_pull_off_is_the_least_load(strength: float) -> None:
    constants = strength, WORK, MODULUS, RADIUS
    ratios = 1 + np.geomspace(1e-5, 1e6, 2000)
    least = min(maugis_cylinder(ratio, *constants).load for ratio in ratios)
    # a grid of 1.3 % around a minimum misses it by less than the square of that
    assert maugis_cylinder_pull_off(*constants) == pytest.approx(-least, rel=1e-4)
    assert maugis_cylinder_pull_off(*constants) >= -least * (1 - 1e-12)


def test_maugis_joins_both_limits() -> None:
    jkr = jkr_line_pull_off(WORK, MODULUS, RADIUS)
    # strong attraction: a crack. The difference falls with the fourth power of the strength
    strengths = np.array([4.0, 8.0, 16.0])
    short = np.array([1 - maugis_cylinder_pull_off(s, WORK, MODULUS, RADIUS) / jkr for s in strengths])
    assert 0 < short[0] < 1e-4
    np.testing.assert_allclose(short[:-1] / short[1:], 16, rtol=0.03)  # the next power is left out
    assert maugis_cylinder_pull_off(1e4, WORK, MODULUS, RADIUS) == pytest.approx(jkr, rel=1e-9)
    # weak attraction: rigid bodies, over the width where the parabola's gap is less than W/s
    for strength in (1e-6, 1e-4, 1e-2):
        rigid = 2 * strength * np.sqrt(2 * RADIUS * WORK / strength)
        # a half space that touches along a line and is drawn closer by 4 ln 2 s c/(pi E*) at c
        drawn = 4 * np.log(2) * strength / (np.pi * MODULUS)
        c = np.roots([1 / (2 * RADIUS), drawn, -WORK / strength]).max()
        pull = maugis_cylinder_pull_off(strength, WORK, MODULUS, RADIUS)
        assert pull == pytest.approx(2 * strength * c, rel=1e-6)
        assert pull < rigid
    assert maugis_cylinder_pull_off(1e-6, WORK, MODULUS, RADIUS) == pytest.approx(
        2e-6 * np.sqrt(2e6 * RADIUS * WORK), rel=1e-6
    )


@pytest.mark.parametrize("ratio", [1.0, 0.5, np.inf, np.nan])
def test_maugis_theory_needs_an_attracted_zone(ratio: float) -> None:
    with pytest.raises(InputError, match="ratio"):
        maugis_cylinder(ratio, 1.0, WORK, MODULUS, RADIUS)


@pytest.mark.parametrize(("m", "n"), [(9.0, 3.0), (7.0, 4.0)])
def test_a_rigid_cylinder_under_two_powers(m: float, n: float) -> None:
    """2 int_0^inf (z + x^2/(2 R))^-k dx = sqrt(2 pi R) z^(1/2 - k) gamma(k - 1/2)/gamma(k)."""
    law = LennardJones(WORK, 0.3, m, n)
    stress = WORK / 0.3 * (m - 1) * (n - 1) / (m - n)
    near, far = gamma(m - 0.5) / gamma(m), gamma(n - 0.5) / gamma(n)

    def pull(z: float) -> float:
        shape = far * (0.3 / z) ** n - near * (0.3 / z) ** m
        return float(stress * np.sqrt(2 * np.pi * RADIUS * z) * shape)

    # d pull/dz = 0
    z = 0.3 * ((m - 0.5) * near / ((n - 0.5) * far)) ** (1 / (m - n))
    assert z > 0.3
    # the quadrature's 1e-9, and a maximum found to 1e-6 of its width
    assert rigid_cylinder_pull_off(law, RADIUS) == pytest.approx(pull(z), rel=1e-8)


@pytest.mark.parametrize("transition", [1e-2, 1e-5])
def test_a_rigid_cylinder_under_constant_attraction(transition: float) -> None:
    strength = 0.6
    pull = rigid_cylinder_pull_off(Dugdale(strength, WORK, transition), RADIUS)
    # smooth ends shift the opening by less than their own share of it, whose root gives the width
    assert 0 < 1 - pull / (2 * strength * np.sqrt(2 * RADIUS * WORK / strength)) < transition / 2


def test_a_rigid_cylinder_needs_a_law_with_a_peak() -> None:
    with pytest.raises(InputError, match="attract most"):
        rigid_cylinder_pull_off(Dugdale(0.6, WORK, 1e-9), RADIUS)


@pytest.mark.parametrize("lever", [0.0, 4.0, 7.5])
def test_bonded_beams_release_the_energy_of_beams(lever: float) -> None:
    """G = P^2/2 dC/da, with the energy of bending of the parts by quadrature; without shear and root."""
    L, h, modulus, shear = 10.0, 0.7, MODULUS, 1e9
    beams = BondedBeams(modulus, shear, h, L, lever)
    rigid = modulus * h**3 / 12
    # forces at the cracked ends: half of the support's force each, and what opens the beams
    support = (1 + lever / L) / 2 - lever / L
    lifted = lever / L if 3 * lever > L else -support / 2

    def compliance(crack: float) -> float:
        arms = (lifted, support) if 3 * lever > L else (support / 2, support / 2)
        open_ends = sum((force * crack) ** 2 * crack / 3 / rigid for force in arms)

        def moment(x: float) -> float:
            return (support + lever / L) * x if x < L else (1 + lever / L) / 2 * (2 * L - x)

        bonded = quad(lambda x: moment(x) ** 2, crack, 2 * L, points=[L])[0] / (8 * rigid)
        return float(open_ends + bonded)

    a, step = 6.0, 1e-4
    slope = (compliance(a + step) - compliance(a - step)) / (2 * step)
    turned = beams.root_rotation
    # a crack that the root does not lengthen in one of the modes
    opening, sliding = beams.release(1.0, a)
    opening *= (a / (a + turned)) ** 2
    sliding *= (a / (a + 0.42 * turned)) ** 2
    # central differences err by 1e-8 of the second power
    assert opening + sliding == pytest.approx(slope / 2, rel=1e-6)
    # the derivative of the compliance, with both corrections
    slope = (beams.compliance(a + step) - beams.compliance(a - step)) / (2 * step)
    assert sum(beams.release(1.0, a)) == pytest.approx(slope / 2, rel=1e-6)
    # an isotropic beam in plane strain, Poisson's ratio 0.2: 0.654 heights, by hand
    assert BondedBeams(1 / 0.96, 1 / 2.4, 1.0, L).root_rotation == pytest.approx(0.654, abs=1e-3)
