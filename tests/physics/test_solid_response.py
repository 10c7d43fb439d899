"""Every material in three dimensions, as its energy states it, and its plane-strain kernel against that."""

import subprocess
import sys
from inspect import getsource
from pathlib import Path

import numpy as np
import pytest

from isopeel import FormulaMaterial, NeoHooke, SaintVenantKirchhoff, Yeoh, row_space, strip, trace
from isopeel.common.arrays import FloatArray
from isopeel.common.quantities import Positive, Stress
from isopeel.common.registry import discover
from isopeel.physics.batch import evaluate_material
from isopeel.physics.differentiation import Scalar
from isopeel.physics.materials import Isotropic, Material, material
from isopeel.physics.materials.prestretched import Prestretched

KINDS = discover("isopeel.physics.materials")
NEO_HOOKE = NeoHooke(2.0, 0.3)
YEOH = Yeoh(c10=0.3, c20=-0.05, c30=0.02, bulk_modulus=1.5)
ISOTROPIC = [*(kind.like(2.0, 0.3) for kind in KINDS.values()), YEOH]
MATERIALS: list[Material] = [*ISOTROPIC, Prestretched(NEO_HOOKE, 1.3)]
NAMES = [*KINDS, "yeoh that softens first", "prestretched"]
RNG = np.random.default_rng(20)


def deformations(count: int, size: int) -> FloatArray:
    """Strains and rotations of some tenths."""
    F = np.eye(size) + 0.3 * RNG.uniform(-1, 1, (count, size, size))
    assert np.linalg.det(F).min() > 0.2
    return F


def rotation() -> FloatArray:
    """Any rotation in three dimensions."""
    Q, _ = np.linalg.qr(RNG.standard_normal((3, 3)))
    turned: FloatArray = Q * np.linalg.det(Q)
    return turned


def in_space(F: FloatArray) -> FloatArray:
    """Plane deformations (n, 2, 2) with F_33 = 1."""
    F3 = np.zeros((len(F), 3, 3))
    F3[:, :2, :2], F3[:, 2, 2] = F, 1.0
    return F3


@pytest.mark.parametrize("material", MATERIALS, ids=NAMES)
def test_the_plane_strain_kernel_is_the_solid_without_stretch_across_the_plane(material: Material) -> None:
    F = deformations(50, 2)
    energy, P, A = material.solid_response(in_space(F))
    response = evaluate_material(material.kernel, material.parameters, F)
    for plane, solid in zip(response, (energy, P[:, :2, :2], A[:, :2, :2, :2, :2]), strict=True):
        # a hundred operations in other orders; stiffnesses are of size 1 to 10
        np.testing.assert_allclose(plane, solid, rtol=1e-13, atol=1e-13)
    # no shear along the third axis, by symmetry exactly
    np.testing.assert_array_equal(P[:, :2, 2], 0.0)
    stress = P[:, 2, 2] / np.linalg.det(F)
    np.testing.assert_allclose(material.out_of_plane_stress(F), stress, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("material", MATERIALS, ids=NAMES)
def test_stress_and_tangent_are_derivatives_in_space(material: Material) -> None:
    F = deformations(5, 3)
    _, P, A = material.solid_response(F)
    step = 1e-6
    for k in range(3):
        for L in range(3):
            change = np.zeros((3, 3))
            change[k, L] = step
            ahead, behind = material.solid_response(F + change), material.solid_response(F - change)
            # central differences: step^2 of truncation, up to 1e-15/step of round-off
            np.testing.assert_allclose((ahead[0] - behind[0]) / (2 * step), P[:, k, L], rtol=0, atol=4e-9)
            np.testing.assert_allclose((ahead[1] - behind[1]) / (2 * step), A[..., k, L], rtol=0, atol=4e-9)
    np.testing.assert_allclose(A, A.transpose(0, 3, 4, 1, 2), rtol=0, atol=1e-14)  # round-off


@pytest.mark.parametrize("material", MATERIALS, ids=NAMES)
def test_a_rotated_body_has_the_same_energy_and_rotated_stresses(material: Material) -> None:
    F, Q = deformations(10, 3), rotation()
    energy, P, A = material.solid_response(F)
    rotated = np.einsum("im,kn,emJnL->eiJkL", Q, Q, A)
    for ours, expected in zip(material.solid_response(Q @ F), (energy, Q @ P, rotated), strict=True):
        np.testing.assert_allclose(ours, expected, rtol=0, atol=1e-13)  # round-off of sizes up to 10


@pytest.mark.parametrize("material", ISOTROPIC, ids=NAMES[:-1])
def test_a_rotated_material_has_the_same_energy(material: Material) -> None:
    F, Q = deformations(10, 3), rotation()
    energy, P, _ = material.solid_response(F)
    energy_rotated, P_rotated, _ = material.solid_response(F @ Q)
    np.testing.assert_allclose(energy_rotated, energy, rtol=0, atol=1e-13)  # round-off
    np.testing.assert_allclose(P_rotated, P @ Q, rtol=0, atol=1e-13)


@pytest.mark.parametrize("material", ISOTROPIC, ids=NAMES[:-1])
def test_small_strains_in_space_follow_hooke(material: Material) -> None:
    E, nu = material.youngs_modulus, material.poissons_ratio
    mu, lame = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
    one = np.eye(3)
    hooke = lame * np.einsum("iJ,kL->iJkL", one, one)
    hooke += mu * (np.einsum("ik,JL->iJkL", one, one) + np.einsum("iL,Jk->iJkL", one, one))
    energy, P, A = material.solid_response(one)
    # the state of rest, to round-off
    assert energy == pytest.approx(0, abs=1e-14)
    np.testing.assert_allclose(P, 0, rtol=0, atol=1e-14)
    np.testing.assert_allclose(A, hooke, rtol=0, atol=2e-14)
    # uniaxial stress: the next order of the strain 1e-6 is some of its squares
    strain = 1e-6
    _, P, _ = material.solid_response(np.diag([1 + strain, 1 - nu * strain, 1 - nu * strain]))
    np.testing.assert_allclose(P, E * strain * np.diag([1, 0, 0]), rtol=0, atol=50 * E * strain**2)


@pytest.mark.parametrize("stretch", [0.8, 1.0, 1.5])
def test_uniaxial_stretch_in_closed_form(stretch: float) -> None:
    """F = diag(a, b, b) with b^2 such that the sides are free of stress."""
    mu, lame = NEO_HOOKE.shear_modulus, NEO_HOOKE.lame_lambda
    # neo-Hooke, by J: mu (b^2 - 1) + lambda ln J = 0 gives a, and P_11 = (mu (a^2 - 1) + lambda ln J)/a
    across = stretch**-0.3
    log_J = mu / lame * (1 - across**2)
    along = np.exp(log_J) / across**2
    _, P, _ = NEO_HOOKE.solid_response(np.diag([along, across, across]))
    expected = np.diag([(mu * (along**2 - 1) + lame * log_J) / along, 0, 0])
    np.testing.assert_allclose(P, expected, rtol=0, atol=1e-14)  # round-off
    # Saint Venant-Kirchhoff: E_22 = -nu E_11, P_11 = a E E_11
    solid = SaintVenantKirchhoff(2.0, 0.3)
    green = (stretch**2 - 1) / 2
    across = np.sqrt(1 - 2 * 0.3 * green)
    _, P, _ = solid.solid_response(np.diag([stretch, across, across]))
    np.testing.assert_allclose(P, np.diag([stretch * 2.0 * green, 0, 0]), rtol=0, atol=1e-14)


def test_simple_shear_in_closed_form() -> None:
    """Neo-Hooke: sigma = mu (F F^T - 1); Saint Venant-Kirchhoff: P_12 = (lambda/2 + mu) g^3 + mu g."""
    g = np.array([0.01, 0.5, 2.0])
    F = np.eye(3) + g[:, None, None] * np.outer([1, 0, 0], [0, 1, 0])
    _, P, _ = NEO_HOOKE.solid_response(F)
    sigma = P @ F.transpose(0, 2, 1)
    left = F @ F.transpose(0, 2, 1) - np.eye(3)
    np.testing.assert_allclose(sigma, NEO_HOOKE.shear_modulus * left, rtol=0, atol=1e-14)  # round-off
    solid = SaintVenantKirchhoff(2.0, 0.3)
    _, P, _ = solid.solid_response(F)
    expected = (solid.lame_lambda / 2 + solid.shear_modulus) * g**3 + solid.shear_modulus * g
    np.testing.assert_allclose(P[:, 0, 1], expected, rtol=1e-14)


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_an_inverted_point_has_no_energy_where_the_energy_depends_on_the_volume(kind: type[Material]) -> None:
    solid = kind.like(2.0, 0.3)  # type: ignore[attr-defined]
    energy, P, A = solid.solid_response(np.diag([-1.0, 1.0, 1.0]))
    finite = kind is SaintVenantKirchhoff
    assert np.isfinite([energy, P[0, 0], A[0, 0, 0, 0]]).tolist() == [finite] * 3
    energy, P, A = evaluate_material(solid.kernel, solid.parameters, np.diag([-1.0, 1.0])[None])
    assert np.isfinite([energy[0], P[0, 0, 0], A[0, 0, 0, 0, 0]]).tolist() == [finite] * 3


@material
class Gent(Isotropic):
    """Gent, Rubber Chem. Technol. 69, 1996: psi = -mu L/2 ln(1 - (I1/J^(2/3) - 3)/L) + kappa/2 (J - 1)^2."""

    shear_modulus: Positive[Stress]
    limit: float
    bulk_modulus: Positive[Stress]

    @staticmethod
    def stored_energy(I1: Scalar, J: Scalar, mu: float, limit: float, kappa: float) -> Scalar:
        x = J ** (-2 / 3) * I1 - 3
        return -mu * limit / 2 * np.log(1 - x / limit) + kappa / 2 * (J - 1) ** 2


def test_a_material_of_ones_own_takes_few_lines_and_runs() -> None:
    source = getsource(Gent).replace(Gent.__doc__ or "", "")
    assert len([line for line in source.splitlines() if line.strip()]) <= 25
    gent = Gent(1.0, 50.0, 2.0)
    # E = 9 kappa mu/(3 kappa + mu), nu = (3 kappa - 2 mu)/(6 kappa + 2 mu); a few operations
    assert gent.youngs_modulus == pytest.approx(18 / 7, rel=1e-14)
    assert gent.poissons_ratio == pytest.approx(4 / 14, rel=1e-14)
    # simple shear of 1: x = g^2 and sigma_12 = mu g Im/(Im - g^2)
    _, P, _ = evaluate_material(gent.kernel, gent.parameters, np.array([[[1.0, 1.0], [0.0, 1.0]]]))
    assert P[0, 0, 1] == pytest.approx(50 / 49, rel=1e-14)
    at, space = np.radians([0.0, 0.5, 1.0]), row_space("N2", (40, 1))
    hooke = NeoHooke(gent.youngs_modulus, gent.poissons_ratio)
    moments = [
        np.array(
            [
                step.reaction
                for step in trace(
                    strip(length=40.0, height=2.0, adhering_length=20.0, material=solid), space, at
                )
            ]
        )
        for solid in (gent, hooke)
    ]
    # strains are below 2e-3, and bending adds up those of both signs
    np.testing.assert_allclose(moments[0][1:], moments[1][1:], rtol=2e-3)


def test_a_formula_is_the_same_material() -> None:
    formula = FormulaMaterial(
        "-mu*limit/2*log(1 - (I1/J**(2/3) - 3)/limit) + kappa/2*(J - 1)**2",
        {"mu": 1.0, "limit": 50.0, "kappa": 2.0},
    )
    F = deformations(10, 3)
    for ours, written in zip(formula.solid_response(F), Gent(1.0, 50.0, 2.0).solid_response(F), strict=True):
        np.testing.assert_allclose(ours, written, rtol=0, atol=1e-13)  # round-off


PLUG_IN = """
import numpy as np
from isopeel.common.quantities import Positive, Stress
from isopeel.physics.materials import Isotropic, material

@material
class Foam(Isotropic):
    mu: Positive[Stress]

    @staticmethod
    def stored_energy(I1, J, mu):
        return {0} * mu * (I1 - 3 - 2 * np.log(J))
"""
RUN = """
import numpy as np
from isopeel.physics.batch import evaluate_material
from foam import Foam
foam = Foam(1.0)
_, P, _ = evaluate_material(foam.kernel, foam.parameters, np.diag([2.0, 1.0])[None])
print(foam.kernel.cache_hits, P[0, 0, 0])
"""


def test_machine_code_is_kept_until_the_energy_changes(tmp_path: Path) -> None:
    def run(factor: float) -> str:
        file = tmp_path / "foam.py"
        if not file.exists() or f"return {factor} *" not in file.read_text():
            file.write_text(PLUG_IN.format(factor))
        script = f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n{RUN}"
        return subprocess.run(
            [sys.executable, "-c", script], check=True, capture_output=True, text=True
        ).stdout

    # P_11 = 2 factor mu (F_11 - 1/F_11)
    assert [run(2.0), run(2.0), run(30.0)] == ["0 6.0\n", "1 6.0\n", "0 90.0\n"]
