"""Materials against closed forms and finite differences."""

import numpy as np
import pytest

from isopeel import FormulaMaterial, InputError, NeoHooke
from isopeel.common.arrays import FloatArray
from isopeel.physics.batch import evaluate_material
from isopeel.physics.materials import Material

NEO_HOOKE = NeoHooke(youngs_modulus=2.0, poissons_ratio=0.3)
AS_FORMULA = FormulaMaterial(
    "mu/2*(I1 - 3 - 2*log(J)) + lam/2*log(J)**2",
    {"mu": NEO_HOOKE.shear_modulus, "lam": NEO_HOOKE.lame_lambda},
)
MOONEY_RIVLIN = FormulaMaterial(
    "a*(I1 - 3) + b*(I2 - 3) - (2*a + 4*b)*log(J) + c*(J - 1)**2", {"a": 0.3, "b": 0.1, "c": 1.5}
)


def material_at(material: Material, F: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    return evaluate_material(material.kernel, material.parameters, F)


def random_deformations(count: int) -> FloatArray:
    F = np.eye(2) + 0.25 * np.random.default_rng(1).uniform(-1, 1, (count, 2, 2))
    assert np.all(np.linalg.det(F) > 0)
    return F


def test_neo_hooke_equals_its_energy_as_a_formula() -> None:
    F = random_deformations(20)
    for ours, derived in zip(material_at(NEO_HOOKE, F), material_at(AS_FORMULA, F), strict=True):
        # two orders of the same dozen operations on numbers of size 1
        np.testing.assert_allclose(ours, derived, rtol=0, atol=1e-14)


@pytest.mark.parametrize("material", [NEO_HOOKE, MOONEY_RIVLIN])
def test_stress_and_tangent_are_derivatives(material: Material) -> None:
    F = random_deformations(5)
    _, P, A = material_at(material, F)
    step = 1e-6
    for k in range(2):
        for L in range(2):
            change = np.zeros((2, 2))
            change[k, L] = step
            ahead, behind = material_at(material, F + change), material_at(material, F - change)
            # central differences: step^2 of truncation, 1e-16/step of round-off
            np.testing.assert_allclose((ahead[0] - behind[0]) / (2 * step), P[:, k, L], rtol=0, atol=1e-9)
            np.testing.assert_allclose((ahead[1] - behind[1]) / (2 * step), A[..., k, L], rtol=0, atol=1e-9)


def test_neo_hooke_cauchy_stress_is_the_published_one() -> None:
    F = random_deformations(10)
    _, P, _ = material_at(NEO_HOOKE, F)
    J = np.linalg.det(F)[:, None, None]
    left = F @ F.transpose(0, 2, 1)
    mu, lam = NEO_HOOKE.shear_modulus, NEO_HOOKE.lame_lambda
    expected = lam / J * np.log(J) * np.eye(2) + mu / J * (left - np.eye(2))
    np.testing.assert_allclose(P @ F.transpose(0, 2, 1) / J, expected, rtol=0, atol=1e-14)  # round-off


def test_moduli_at_rest() -> None:
    # exact but for the round-off of a few operations
    assert AS_FORMULA.youngs_modulus == pytest.approx(2.0, rel=1e-14)
    assert AS_FORMULA.poissons_ratio == pytest.approx(0.3, rel=1e-14)
    # Mooney-Rivlin: mu = 2 (a + b); lambda from psi = ... at small strain: 4 b + 2 c
    mu, lam = 2 * (0.3 + 0.1), 4 * 0.1 + 2 * 1.5
    assert MOONEY_RIVLIN.youngs_modulus == pytest.approx(mu * (3 * lam + 2 * mu) / (lam + mu), rel=1e-13)


def test_uniaxial_small_strain_follows_hooke() -> None:
    # plane strain: sigma_11 = E (1 - nu)/((1 + nu)(1 - 2 nu)) eps, sigma_33 = nu/(1 - nu) sigma_11
    strain = 1e-6
    F = np.array([[[1 + strain, 0.0], [0.0, 1.0]]])
    modulus = 2.0 * 0.7 / (1.3 * 0.4)
    _, P, _ = material_at(NEO_HOOKE, F)
    assert P[0, 0, 0] == pytest.approx(modulus * strain, rel=1e-5)  # next order is strain itself
    assert NEO_HOOKE.out_of_plane_stress(F)[0] == pytest.approx(0.3 / 0.7 * modulus * strain, rel=1e-5)


def test_an_inverted_point_has_no_energy() -> None:
    energy, P, _ = material_at(NEO_HOOKE, np.array([[[-1.0, 0.0], [0.0, 1.0]]]))
    assert np.isnan(energy[0])
    assert np.isnan(P[0, 0, 0])


@pytest.mark.parametrize(
    ("modulus", "ratio", "field"),
    [(-1.0, 0.2, "youngs_modulus"), (0.0, 0.2, "youngs_modulus"), (1.0, 0.5, "ratio"), (1.0, -1.0, "ratio")],
)
def test_neo_hooke_refuses_unstable_constants(modulus: float, ratio: float, field: str) -> None:
    with pytest.raises(InputError, match=field):
        NeoHooke(modulus, ratio)


@pytest.mark.parametrize(
    ("energy", "reason"),
    [
        ("mu*(I1 - 3)", "stress at F = I must vanish"),
        ("-mu/2*(I1 - 3 - 2*log(J))", "stiffness at F = I must be positive"),
        ("mu*sqrt(I1 - 3)", "finite at F = I"),
        ("mu*(I1 - 3", "a formula uses"),
        ("mu/2*(I1 - 3 - 2*log(J)) + mu*F12**2*F11", "the names I1, I2, J, mu"),
        ("mu", "stiffness at F = I must be positive"),
        ("mu/2*(I1 - 3 - 2*log(J)) + sqrt((J - 1)**2)**3", "without jumps"),
        ("kappa*(J - 1)**2", "a formula uses"),
    ],
)
def test_formula_material_refuses_what_is_no_solid(energy: str, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        FormulaMaterial(energy, {"mu": 1.0})
