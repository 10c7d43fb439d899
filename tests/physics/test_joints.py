"""Joint laws: published potentials, mixed-mode work and damage."""

from dataclasses import replace

import numpy as np
import pytest
import sympy
from scipy.integrate import quad

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.physics.batch import JointValues, evaluate_joint, evaluate_law
from isopeel.physics.joints import JointLaw, MixedModeBilinear, XuNeedleman
from isopeel.physics.joints.mixed_mode_bilinear import UNKNOWN

EXPONENTIAL = XuNeedleman(2.0, 3.0, 0.5, 0.7, 0.3)
#: A carbon-epoxy laminate's ratios of strengths and works.
BILINEAR = MixedModeBilinear(0.8, 1.2, 0.1, 0.4, 0.2, 2.284)
LAWS = (EXPONENTIAL, BILINEAR)


def at(law: JointLaw, jump: FloatArray, history: FloatArray) -> JointValues:
    return evaluate_joint(law.joint_kernel, law.joint_parameters, jump, history)


def history_of(law: JointLaw, points: int, *values: float) -> FloatArray:
    known = np.array(values or law.initial_history())
    return np.repeat(known[:, None], points, axis=1)


def walk(law: JointLaw, path: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the slopes (n, 2), energies (n, 2) and the last history along jumps (n, 2), step by step."""
    history = history_of(law, 1)
    slopes, energies = [], []
    for jump in path:
        found = at(law, jump[:, None], history)
        history = found.history
        slopes.append(found.slopes[:, 0])
        energies.append(found.energies[:, 0])
    return np.array(slopes), np.array(energies), history[:, 0]


def work_along(slopes: FloatArray, path: FloatArray) -> float:
    return float(np.sum((slopes[1:] + slopes[:-1]) / 2 * np.diff(path, axis=0)))


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_slopes_and_stiffness_are_derivatives_of_the_energy(law: JointLaw) -> None:
    rng = np.random.default_rng(0)
    jump = rng.uniform(-0.3, 0.7, (2, 200))
    known = (0.3, 0.4, 0.02)[: len(law.history)]
    history = history_of(law, 200, *known) if known else np.empty((0, 200))
    found, step = at(law, jump, history), 1e-6
    for axis in (0, 1):
        change = np.zeros((2, 1))
        change[axis] = step
        up, down = (at(law, jump + sign * change, history) for sign in (1, -1))
        slope = (up.energies - down.energies).sum(axis=0) / (2 * step)
        # central differences: 1e-12 of the third derivative, and 1e-16/1e-6 of the energies
        np.testing.assert_allclose(found.slopes[axis], slope, atol=1e-8)
        stiffness = (up.slopes - down.slopes) / (2 * step)
        # none of the points is within a step of a kink
        np.testing.assert_allclose(found.stiffness[axis : axis + 2], stiffness, atol=1e-7)


def test_the_exponential_energy_is_the_published_one() -> None:
    x, z, q, r, W = sympy.symbols("x z q r W")
    energy = W + W * sympy.exp(-x) * (
        (1 - r + x) * (1 - q) / (r - 1) - (q + (r - q) / (r - 1) * x) * sympy.exp(-(z**2))
    )
    law = EXPONENTIAL
    published = sympy.lambdify((x, z), energy.subs({q: law.q, r: law.r, W: law.work_of_adhesion}))
    _, delta_n, delta_t, *_ = law.constants()
    jump = np.random.default_rng(1).uniform(-0.3, 0.7, (2, 50))
    found = at(law, jump, np.empty((0, 50)))
    np.testing.assert_allclose(found.energies[0], published(jump[0] / delta_n, jump[1] / delta_t), atol=1e-14)
    # strengths in the pure modes, at the opening delta_n and the sliding delta_t/2^(1/2)
    top = at(law, np.array([[delta_n, 0.0], [0.0, delta_t / np.sqrt(2)]]), np.empty((0, 2)))
    assert top.slopes[0, 0] == pytest.approx(law.strength, rel=1e-14)
    assert top.slopes[1, 1] == pytest.approx(law.shear_strength, rel=1e-14)

    def pull(size: float, axis: int) -> float:
        one = np.zeros((2, 1))
        one[axis] = size
        return float(at(law, one, np.empty((0, 1))).slopes[axis, 0])

    works = [quad(pull, 0.0, 40 * (delta_n, delta_t)[axis], (axis,), limit=200)[0] for axis in (0, 1)]
    np.testing.assert_allclose(works, [law.work_of_adhesion, law.q * law.work_of_adhesion], rtol=1e-8)


def turon(law: MixedModeBilinear, opening: float, sliding: float) -> tuple[float, float]:
    """Tractions of first loading by the formulas of Turon et al. (2010), with jumps of onset and end."""
    K_n, K_t = law.stiffnesses
    onset = law.strength / K_n, law.shear_strength / K_t
    final = 2 * law.work_of_adhesion / law.strength, 2 * law.shear_work / law.shear_strength
    B = K_t * sliding**2 / (K_n * opening**2 + K_t * sliding**2)
    K_B = K_n * (1 - B) + B * K_t
    first, last = K_n * onset[0] ** 2, K_t * onset[1] ** 2
    jump_0 = np.sqrt((first + (last - first) * B**law.exponent) / K_B)
    first, last = K_n * onset[0] * final[0], K_t * onset[1] * final[1]
    jump_f = (first + (last - first) * B**law.exponent) / (K_B * jump_0)
    energy = K_n * opening**2 + K_t * sliding**2
    jump = energy / np.sqrt(K_n**2 * opening**2 + K_t**2 * sliding**2)
    damage = float(min(max(jump_f * (jump - jump_0) / (jump * (jump_f - jump_0)), 0.0), 1.0))
    return (1 - damage) * K_n * opening, (1 - damage) * K_t * sliding


def direction(law: MixedModeBilinear, mixity: float) -> FloatArray:
    """Return the unit jump (2,) of a mixity."""
    K_n, K_t = law.stiffnesses
    jump = np.array([np.sqrt((1 - mixity) / K_n), np.sqrt(mixity / K_t)])
    unit: FloatArray = jump / np.linalg.norm(jump)
    return unit


@pytest.mark.parametrize("mixity", [0.0, 0.2, 0.5, 0.8, 1.0])
def test_first_loading_at_a_fixed_mode_ratio_is_that_of_turon_and_takes_the_work_of_benzeggagh_and_kenane(
    mixity: float,
) -> None:
    law, work = BILINEAR, BILINEAR.work_at(mixity)
    path = np.linspace(0.0, 1.0, 2001)[:, None] * direction(law, mixity)
    slopes, energies, history = walk(law, path)
    published = np.array([turon(law, *jump) for jump in path[1:]])
    np.testing.assert_allclose(slopes[1:], published, atol=1e-13)
    np.testing.assert_allclose(slopes[-1], 0.0, atol=1e-15)
    np.testing.assert_allclose(history, [1.0, mixity, work], atol=1e-13)
    assert energies[-1].sum() == pytest.approx(work, rel=1e-13)
    # the trapezoidal rule errs at the two kinks: by the square of the step 1/2000
    assert work_along(slopes, path) == pytest.approx(work, rel=1e-5)


@pytest.mark.parametrize("mixity", [0.0, 0.3, 1.0])
def test_damaged_faces_unload_and_reload_along_the_secant(mixity: float) -> None:
    law, way = BILINEAR, direction(BILINEAR, mixity)
    out = np.linspace(0.0, 0.15, 301)[:, None] * way
    there, energies, history = walk(law, out)
    loop = np.concatenate([out, out[::-1], out])
    slopes, after, again = walk(law, loop)
    np.testing.assert_allclose(again, history, rtol=1e-12)
    back = slopes[301:602]
    np.testing.assert_allclose(back, loop[301:602] * (there[-1] / out[-1].clip(1e-300)), atol=1e-13)
    # all that is lost is lost in the first loading
    np.testing.assert_allclose(after[301:, 1], energies[-1, 1], rtol=1e-12)
    # round-off of sums over 600 steps
    assert work_along(slopes[301:], loop[301:]) == pytest.approx(0.0, abs=1e-13)
    assert 0.1 < history[0] < 0.95


def test_compression_is_linear_whatever_the_damage() -> None:
    law, stiffness = BILINEAR, BILINEAR.stiffnesses[0]
    jump = np.array([[-0.1] * 3, [0.0] * 3])
    history = np.array([[0.0, 0.5, 1.0], [UNKNOWN, 0.0, 1.0], [0.0] * 3])
    found = at(law, jump, history)
    np.testing.assert_allclose(found.slopes[0], -0.1 * stiffness, rtol=1e-14)
    np.testing.assert_allclose(found.stiffness, [[stiffness] * 3, [0.0] * 3, found.stiffness[2]], rtol=1e-14)
    cracked = replace(law, initial_damage=1.0)
    apart = at(cracked, np.array([[0.1, -0.1], [0.2, 0.2]]), history_of(cracked, 2))
    np.testing.assert_allclose(apart.slopes, [[0.0, -0.1 * stiffness], [0.0, 0.0]], atol=1e-15)
    np.testing.assert_allclose(apart.energies[1], 0.0)


def test_parted_faces_keep_the_mixity_with_which_they_parted() -> None:
    law = BILINEAR
    out = np.linspace(0.0, 1.0, 201)[:, None] * direction(law, 0.3)
    _, _, parted = walk(law, out)
    _, _, later = walk(law, np.concatenate([out, [[1.0, 2.0], [-0.1, 3.0]]]))
    assert parted[0] == 1.0
    np.testing.assert_array_equal(later, parted)


def test_a_point_that_is_pressed_together_and_hardly_slides_has_the_mixity_of_opening() -> None:
    K_n, K_t = BILINEAR.stiffnesses
    onset = BILINEAR.strength / K_n
    jump = np.array([[-0.1 * onset, -0.1 * onset, 0.0], [1e-8 * onset, 0.5 * onset, 0.0]])
    found = at(BILINEAR, jump, history_of(BILINEAR, 3)).history[1]
    np.testing.assert_allclose(found, [K_t * 1e-16 / (K_n * 1e-2), 1.0, UNKNOWN], rtol=1e-12)


def dissipated_as_the_mode_changes(steps: int) -> float:
    """Part the faces along an arc from opening to sliding, in a number of steps."""
    turn = np.linspace(0.0, 1.0, steps + 1)
    size = 0.8 * turn
    path = size[:, None] * np.stack([np.cos(turn * np.pi / 2), np.sin(turn * np.pi / 2)], axis=1)
    _, energies, history = walk(BILINEAR, path)
    assert history[0] == 1.0
    return float(energies[-1, 1])


def test_the_error_of_the_last_mixity_is_of_first_order_in_the_step() -> None:
    exact = dissipated_as_the_mode_changes(128000)
    errors = np.array([abs(dissipated_as_the_mode_changes(steps) / exact - 1) for steps in (250, 500, 1000)])
    assert errors[-1] < 0.01
    np.testing.assert_allclose(errors[:-1] / errors[1:], 2.0, atol=0.1)


def test_pure_opening_is_an_adhesion_law() -> None:
    gap = np.linspace(-0.1, 0.4, 51)
    for law in LAWS:
        found = evaluate_law(law.kernel, law.parameters, gap, np.zeros(gap.size))
        history = np.zeros((len(law.history), gap.size))
        expected = at(law, np.stack([gap, 0 * gap]), history)
        energy = expected.energies.sum(axis=0) - law.work_of_adhesion
        np.testing.assert_array_equal(found, [energy, -expected.slopes[0], -expected.stiffness[0]])


def test_constants_out_of_bounds_are_refused() -> None:
    with pytest.raises(InputError, match=r"adhesion\.r: 1\.0 .*must not be 1"):
        XuNeedleman(1.0, 1.0, 1.0, 1.0, 1.0)
    with pytest.raises(InputError, match=r"adhesion\.initial_damage: 1\.5"):
        replace(BILINEAR, initial_damage=1.5)
    with pytest.raises(InputError, match=r"adhesion\.rise: 1"):
        replace(BILINEAR, rise=1.0)
    with pytest.raises(InputError, match=r"adhesion\.shear_strength: -1"):
        replace(BILINEAR, shear_strength=-1.0)
