"""Pre-stretched materials against their energies, Hooke's law and neo-Hooke in plane strain."""

import pickle

import numpy as np
import pytest
from scipy.optimize import brentq

from isopeel import FormulaMaterial, InputError, MooneyRivlin, NeoHooke, SaintVenantKirchhoff, Yeoh
from isopeel.common.arrays import FloatArray
from isopeel.physics.batch import evaluate_material
from isopeel.physics.materials import Material
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.physics.materials.prestretched import Prestretched

NEO_HOOKE = NeoHooke(youngs_modulus=2.0, poissons_ratio=0.3)
MATERIALS: list[Material] = [
    NEO_HOOKE,
    SaintVenantKirchhoff(youngs_modulus=2.0, poissons_ratio=0.3),
    MooneyRivlin(c10=0.3, c01=0.1, bulk_modulus=1.5),
    Yeoh(c10=0.3, c20=-0.05, c30=0.02, bulk_modulus=1.5),
    FormulaMaterial("mu/2*(I1 - 3 - 2*log(J)) + lam/2*(J - 1)**2", {"mu": 0.8, "lam": 1.1}),
]
NAMES = [type(material).__name__ for material in MATERIALS]
AT_REST = np.eye(2)


def material_at(material: Material, F: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    return evaluate_material(material.kernel, material.parameters, F)


def random_deformations(count: int) -> FloatArray:
    F = np.eye(2) + 0.25 * np.random.default_rng(7).uniform(-1, 1, (count, 2, 2))
    assert np.all(np.linalg.det(F) > 0)
    return F


@pytest.mark.parametrize("stretch", [0.85, 1.3])
@pytest.mark.parametrize("material", MATERIALS, ids=NAMES)
def test_stress_and_tangent_are_derivatives_of_the_energy(material: Material, stretch: float) -> None:
    taut = Prestretched(material, stretch)
    F = random_deformations(5)
    energy, P, A = material_at(taut, F)
    before = np.diag([stretch, taut.transverse_stretch])
    # per volume of the reference shape; the product F F_0 and the quotient cost round-off
    expected = material_at(material, F @ before)[0] / np.linalg.det(before)
    np.testing.assert_allclose(energy, expected, rtol=1e-12, atol=1e-15)
    step = 1e-6
    for k in range(2):
        for L in range(2):
            change = np.zeros((2, 2))
            change[k, L] = step
            ahead, behind = material_at(taut, F + change), material_at(taut, F - change)
            # central differences: step^2 of truncation times up to 100, 1e-16/step of round-off
            np.testing.assert_allclose((ahead[0] - behind[0]) / (2 * step), P[:, k, L], rtol=0, atol=2e-9)
            np.testing.assert_allclose((ahead[1] - behind[1]) / (2 * step), A[..., k, L], rtol=0, atol=2e-9)


@pytest.mark.parametrize("stretch", [0.8, 0.999, 1.001, 1.25, 1.6])
@pytest.mark.parametrize("material", MATERIALS, ids=NAMES)
def test_no_stress_across_the_reference_shape(material: Material, stretch: float) -> None:
    taut = Prestretched(material, stretch)
    P = material_at(taut, AT_REST)[1]
    # round-off of moduli up to 4
    np.testing.assert_allclose([P[1, 1], P[0, 1], P[1, 0]], 0.0, rtol=0, atol=1e-14)
    assert np.sign(P[0, 0]) == np.sign(stretch - 1)  # taut pulls, slack pushes
    assert np.sign(taut.transverse_stretch - 1) == -np.sign(stretch - 1)


@pytest.mark.parametrize("material", MATERIALS, ids=NAMES)
def test_small_strains_follow_hooke(material: Material) -> None:
    strain = 1e-5
    taut = Prestretched(material, 1 + strain)
    # a free thickness in plane strain: sigma_11 = E' strain; the next order is strain itself, times up to 5
    P = material_at(taut, AT_REST)[1]
    assert P[0, 0] == pytest.approx(plane_strain_modulus(material) * strain, rel=5 * strain)
    nu = material.poissons_ratio
    assert taut.transverse_stretch - 1 == pytest.approx(-nu / (1 - nu) * strain, rel=5 * strain)
    # plane strain without stress across: sigma_33 = nu sigma_11
    assert taut.out_of_plane_stress(AT_REST) == pytest.approx(nu * P[0, 0], rel=5 * strain)


@pytest.mark.parametrize("stretch", [0.7, 1.4, 2.5])
def test_neo_hooke_in_plane_strain(stretch: float) -> None:
    """sigma_22 = 0 gives mu (s^2 - 1) + lambda ln(a s) = 0, with which J sigma_11 = mu (a^2 - s^2)."""
    mu, lam = NEO_HOOKE.shear_modulus, NEO_HOOKE.lame_lambda
    s = brentq(lambda s: mu * (s * s - 1) + lam * np.log(stretch * s), 0.01, 10.0, xtol=1e-15)
    taut = Prestretched(NEO_HOOKE, stretch)
    assert taut.transverse_stretch == pytest.approx(s, rel=1e-14)  # two roots to round-off
    # at F = I, P is Cauchy's stress
    expected = mu * (stretch**2 - s**2) / (stretch * s)
    assert material_at(taut, AT_REST)[1][0, 0] == pytest.approx(expected, rel=1e-13)
    sigma_33 = lam * np.log(stretch * s) / (stretch * s)
    assert taut.out_of_plane_stress(AT_REST) == pytest.approx(sigma_33, rel=1e-13)


@pytest.mark.parametrize("material", MATERIALS, ids=NAMES)
def test_release_returns_to_rest(material: Material) -> None:
    taut = Prestretched(material, 1.3)
    release = np.diag([1 / 1.3, 1 / taut.transverse_stretch])
    energy, P, _ = material_at(taut, release)
    # round-off of a rest with energy and stress zero
    np.testing.assert_allclose(P, 0.0, rtol=0, atol=1e-14)
    assert abs(energy) < 1e-15


@pytest.mark.parametrize("material", MATERIALS, ids=NAMES)
def test_a_stretch_of_one_is_the_material(material: Material) -> None:
    taut = Prestretched(material, 1.0)
    F = random_deformations(20)
    for ours, plain in zip(material_at(taut, F), material_at(material, F), strict=True):
        # the transverse stretch is 1 to round-off
        np.testing.assert_allclose(ours, plain, rtol=0, atol=1e-14)
    np.testing.assert_allclose(taut.out_of_plane_stress(F), material.out_of_plane_stress(F), atol=1e-14)


def test_stretched_twice_is_stretched_once() -> None:
    """Each leaves it free of stress across, and stretches along x multiply."""
    twice = Prestretched(Prestretched(NEO_HOOKE, 1.2), 1.1)
    once = Prestretched(NEO_HOOKE, 1.2 * 1.1)
    F = random_deformations(10)
    for ours, plain in zip(material_at(twice, F), material_at(once, F), strict=True):
        np.testing.assert_allclose(ours, plain, rtol=0, atol=1e-14)  # round-off


def test_an_inverted_point_has_no_energy() -> None:
    energy, P, _ = material_at(Prestretched(NEO_HOOKE, 1.2), np.diag([-1.0, 1.0]))
    assert np.isnan(energy)
    assert np.isnan(P[0, 0])


def test_it_travels_to_other_processes() -> None:
    taut = Prestretched(NEO_HOOKE, 1.2)
    assert pickle.loads(pickle.dumps(taut)) == taut


@pytest.mark.parametrize("stretch", [0.0, -1.0, np.inf, np.nan])
def test_it_refuses_what_is_no_stretch(stretch: float) -> None:
    with pytest.raises(InputError, match=r"material\.prestretch: .*it must be positive"):
        Prestretched(NEO_HOOKE, stretch)


def test_it_refuses_a_stretch_without_rest_across() -> None:
    # Saint Venant-Kirchhoff: s^2 = 1 - nu/(1 - nu) (a^2 - 1), none left beyond a = sqrt(1/nu)
    soft = SaintVenantKirchhoff(youngs_modulus=2.0, poissons_ratio=0.3)
    s = Prestretched(soft, 1.8).transverse_stretch
    assert s**2 == pytest.approx(1 - 3 / 7 * (1.8**2 - 1), rel=1e-13)
    with pytest.raises(InputError, match=r"material\.prestretch: 1\.9 .*free of stress across"):
        Prestretched(soft, 1.9)
