"""Closed forms at finite strain and of lifted arms, against solvers from outside and their limits."""

from dataclasses import astuple
from math import cos, radians, sin, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_bvp, solve_ivp
from scipy.optimize import brentq, root

from isopeel.common.arrays import FloatArray
from isopeel.physics.materials import NeoHooke
from isopeel.physics.materials.formula import FormulaMaterial
from isopeel.physics.materials.prestretched import Prestretched
from isopeel.post.closed_form import beam_moment, double_cantilever_force, kendall_force, sliding_tape_force
from isopeel.post.closed_form.finite_strain import bent_strip, peeled_tape
from isopeel.post.closed_form.opening import LiftedArm

E, NU, HEIGHT = 1.0, 0.3, 0.2
MU, LAMBDA = E / (2 * (1 + NU)), E * NU / ((1 + NU) * (1 - 2 * NU))
PLANE = E / (1 - NU**2)
MATERIAL = NeoHooke(E, NU)


def psi(one: float, two: float) -> float:
    """Compressible neo-Hooke in plane strain at diag(one, two), written out."""
    log = float(np.log(one * two))
    return MU / 2 * (one**2 + two**2 - 2 - 2 * log) + LAMBDA / 2 * log**2


def stress(one: float, two: float) -> float:
    """P_11 there; the other one with exchanged arguments."""
    return MU * (one - 1 / one) + LAMBDA * float(np.log(one * two)) / one


@pytest.mark.parametrize("work", [0.001, 0.02, 0.12, 0.3])
@pytest.mark.parametrize("angle_deg", [40.0, 90.0, 150.0])
def test_a_held_tape_against_a_solver_of_its_equations(work: float, angle_deg: float) -> None:
    angle = radians(angle_deg)

    def equations(z: FloatArray) -> list[float]:
        one, two = z
        balance = HEIGHT * (stress(one, two) * (one - cos(angle)) - psi(one, two)) - work
        return [balance, stress(two, one)]

    found = root(equations, [1.0 + 3 * work**0.7, 0.95], tol=1e-13)
    assert found.success
    tape = peeled_tape(MATERIAL, HEIGHT, work, angle)
    assert tape is not None
    assert tape.stretch == pytest.approx(found.x[0], rel=1e-9)
    assert tape.force == pytest.approx(HEIGHT * stress(*found.x), rel=1e-9)
    assert tape.rate == pytest.approx(tape.stretch - cos(angle), rel=1e-12)


def test_the_soft_tape_of_the_faults() -> None:
    tape = peeled_tape(MATERIAL, 0.2, 0.12, np.pi / 2)
    assert tape is not None
    assert tape.stretch == pytest.approx(1.61, abs=0.005)
    assert tape.force == pytest.approx(0.094167, abs=5e-7)  # what the run gave
    assert kendall_force(0.12, PLANE * 0.2, np.pi / 2) == pytest.approx(0.098104, abs=5e-7)


@pytest.mark.parametrize("angle_deg", [30.0, 60.0, 120.0])
def test_a_sliding_tape_against_the_potential_energy_of_both_its_parts(angle_deg: float) -> None:
    """The total energy of a tape, of which a part `peeled` is off, has no slope at the steady force."""
    angle, work = radians(angle_deg), 0.05
    tape = peeled_tape(MATERIAL, HEIGHT, work, angle, held=False)
    assert tape is not None

    def free(one: float) -> float:
        return brentq(lambda two: stress(two, one), 0.2, 3.0, xtol=1e-15)  # type: ignore[no-any-return]

    def stretched(force: float) -> float:
        return brentq(lambda one: HEIGHT * stress(one, free(one)) - force, 0.7, 4.0, xtol=1e-15)  # type: ignore[no-any-return]

    def potential(peeled: float) -> float:
        behind, ahead = stretched(tape.force * cos(angle)), stretched(tape.force)
        stored = HEIGHT * ((1 - peeled) * psi(behind, free(behind)) + peeled * psi(ahead, free(ahead)))
        moved = (1 - peeled) * behind * cos(angle) + peeled * ahead
        return stored + work * peeled - tape.force * moved

    assert potential(0.6) == pytest.approx(potential(0.4), abs=1e-12)


@pytest.mark.parametrize("angle_deg", [15.0, 60.0, 90.0, 180.0])
def test_at_small_strain_the_forms_are_those_of_small_strain(angle_deg: float) -> None:
    work, stiff, angle = 0.012, NeoHooke(1e5, NU), radians(angle_deg)
    stiffness = 1e5 / (1 - NU**2) * HEIGHT
    held, sliding = (peeled_tape(stiff, HEIGHT, work, angle, held=held) for held in (True, False))
    assert held is not None
    assert sliding is not None
    # the strain, 1e-5 to 1e-6, is what they differ by
    assert held.force == pytest.approx(kendall_force(work, stiffness, angle), rel=1e-4)
    assert sliding.force == pytest.approx(sliding_tape_force(work, stiffness, angle), rel=1e-4)


def test_a_tape_laid_under_tension_and_one_that_comes_off_by_itself() -> None:
    tense = Prestretched(NeoHooke(1.0, 0.2), 1.005)
    tape = peeled_tape(tense, 4.0, 0.0153, np.pi / 3)
    assert tape is not None
    tension = 4.0 / (1 - 0.04) * 0.005
    assert tape.force == pytest.approx(kendall_force(0.0153, 4.0 / 0.96, np.pi / 3, tension), rel=2e-3)
    assert peeled_tape(Prestretched(NeoHooke(1.0, 0.2), 1.2), 4.0, 0.0153, np.pi / 3) is None


@pytest.mark.parametrize("work", [0.001, 0.02, 0.03])
def test_a_bent_section_against_a_boundary_value_solver(work: float) -> None:
    """d(P_22)/dY = kappa P_11 with free faces, and M kappa - U = W, by solve_bvp instead of polynomials."""
    stiffness = PLANE * HEIGHT**3 / 12
    guess = beam_moment(work * HEIGHT, stiffness) / stiffness
    found = bent_strip(MATERIAL, HEIGHT, work * HEIGHT, guess)
    assert found is not None
    kappa = found.curvature

    def slope(radius: float, normal: float) -> float:
        """The r' that has a stress P_22."""
        return brentq(lambda two: stress(two, kappa * radius) - normal, 0.2, 4.0, xtol=1e-14)  # type: ignore[no-any-return]

    def equations(_: FloatArray, z: FloatArray) -> FloatArray:
        rates = [slope(r, p) for r, p in z.T]
        return np.array([rates, [kappa * stress(kappa * r, s) for (r, _), s in zip(z.T, rates, strict=True)]])

    y = np.linspace(0, HEIGHT, 21)
    start = np.array([1 / kappa + y - HEIGHT / 2, np.zeros_like(y)])
    solved = solve_bvp(equations, lambda a, b: np.array([a[1], b[1]]), y, start, tol=1e-8)
    assert solved.success
    fine = np.linspace(0, HEIGHT, 401)
    radius, normal = solved.sol(fine)
    rates = [slope(r, p) for r, p in zip(radius, normal, strict=True)]
    pairs = list(zip(kappa * radius, rates, strict=True))
    moment = np.trapezoid([stress(*pair) * r for pair, r in zip(pairs, radius, strict=True)], fine)
    energy = np.trapezoid([psi(*pair) for pair in pairs], fine)
    assert found.moment == pytest.approx(moment, rel=1e-5)  # the trapezoidal rule
    assert moment * kappa - energy == pytest.approx(work * HEIGHT, rel=1e-4)


def test_bending_at_finite_strain_takes_off_what_the_validation_measured() -> None:
    """The runs of the validation follow -0.177 (h/(2 rho))^2 of beam theory, for nu = 0.2."""
    stiffness, work = 1 / 0.96 / 12, 1e-3
    moment = beam_moment(work, stiffness)
    found = bent_strip(NeoHooke(1.0, 0.2), 1.0, work, moment / stiffness)
    assert found is not None
    strain = moment / stiffness / 2
    assert (found.moment / moment - 1) / strain**2 == pytest.approx(-0.18, abs=0.005)


@pytest.mark.parametrize("lift", [0.02, 0.3, 1.0, 3.0])
def test_a_lifted_arm_against_an_integration_of_its_elastica(lift: float) -> None:
    """From the end, theta = phi, back to the front: theta = 0, M = sqrt(2 E'I W), y = the lift."""
    arm = LiftedArm(1.0, 1.0)
    force = arm.force(lift)
    angle = np.arcsin(min(1.0, arm.work / force))

    def clamped(_: float, z: list[float]) -> float:
        return z[0]

    clamped.terminal = True  # type: ignore[attr-defined]
    # z = angle, its rate, x and y along the arm from its end to its front
    path = solve_ivp(
        lambda _, z: [-z[1], force * cos(z[0]), cos(z[0]), sin(z[0])],
        (0, 50),
        [angle, 0.0, 0.0, 0.0],
        events=clamped,
        rtol=1e-10,
        atol=1e-12,
    )
    end = path.y[:, -1]
    assert end[1] ** 2 / 2 == pytest.approx(1.0, rel=1e-6)
    assert end[3] == pytest.approx(lift, rel=1e-5)


def test_small_lifts_are_those_of_a_double_cantilever_and_high_ones_of_a_tape() -> None:
    arm = LiftedArm(0.2, 5e-4)
    assert arm.force(0.02) == pytest.approx(double_cantilever_force(1e-3, 0.2, 0.04), rel=1e-3)
    assert arm.force(200.0) == pytest.approx(kendall_force(5e-4, 1e9, np.pi / 2), rel=1e-6)
    # P a = sqrt(2 E'I W) and d = P a^3/(3 E'I)
    length = arm.crack_length(1.0)
    force = sqrt(2 * 0.2 * 5e-4) / length
    assert force * length**3 / (3 * 0.2) == pytest.approx(1.0, rel=1e-12)
    assert arm.crack_by_compliance(1.0, force) == pytest.approx(length, rel=1e-12)
    # the wedge of the faults: (3 E'h^3 d^2/(8 W))^(1/4)
    plane = 2 / (1 - 0.45**2)
    assert LiftedArm(plane / 12, 5e-4).crack_length(2.0) == pytest.approx(
        (3 * plane * 4 / (8 * 5e-4)) ** 0.25
    )


def test_the_energy_of_the_reference_shape_does_not_count() -> None:
    """A formula need not set it to zero; sums with it differ in round-off alone."""
    zero, other = (
        FormulaMaterial(f"c/2*({trace} - 2*log(J)) + c/2*log(J)**2", {"c": 0.4}) for trace in ("I1 - 3", "I1")
    )
    one = peeled_tape(zero, HEIGHT, 0.02, 1.0)
    assert one is not None
    same = peeled_tape(other, HEIGHT, 0.02, 1.0)
    assert same is not None
    assert astuple(same) == pytest.approx(astuple(one), rel=1e-9)
    bent = bent_strip(zero, HEIGHT, 0.001, 1.5)
    assert bent is not None
    found = bent_strip(other, HEIGHT, 0.001, 1.5)
    assert found is not None
    # a moment is a difference of energies over a tenth of them, by a root found to 1e-10
    assert astuple(found) == pytest.approx(astuple(bent), rel=1e-8)


@pytest.mark.parametrize("work", [0.02, 1.0, 1e3])
def test_a_material_that_is_no_number_when_stretched_far_has_a_form_or_none(work: float) -> None:
    """Gent's material locks at I1 - 3 = 0.5; beyond it the logarithm is no number."""
    gent = FormulaMaterial("-c/4*log(1 - (I1 - 3)/0.5) - c*log(J) + c/2*log(J)**2", {"c": 0.4})
    for found in (peeled_tape(gent, HEIGHT, work, 1.0), bent_strip(gent, HEIGHT, work, 3.0)):
        assert found is None or all(np.isfinite(number) for number in astuple(found))
