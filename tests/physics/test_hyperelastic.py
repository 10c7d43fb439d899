"""Saint Venant-Kirchhoff, Mooney-Rivlin and Yeoh against their energies, closed forms and Hooke's law."""

import numpy as np
import pytest
import sympy
from scipy.optimize import brentq, minimize_scalar

from isopeel import FormulaMaterial, InputError, NeoHooke, row_space, strip
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.physics.batch import evaluate_material
from isopeel.physics.materials import Material
from isopeel.physics.materials.mooney_rivlin import MooneyRivlin
from isopeel.physics.materials.saint_venant_kirchhoff import SaintVenantKirchhoff
from isopeel.physics.materials.yeoh import Yeoh
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.newton import NewtonSettings, newton
from isopeel.solve.trace import trace

SVK = SaintVenantKirchhoff(youngs_modulus=2.0, poissons_ratio=0.3)
MOONEY_RIVLIN = MooneyRivlin(c10=0.3, c01=0.1, bulk_modulus=1.5)
YEOH = Yeoh(c10=0.3, c20=-0.05, c30=0.02, bulk_modulus=1.5)
MATERIALS = [SVK, MOONEY_RIVLIN, YEOH]
RUBBERS = [MOONEY_RIVLIN, YEOH]
ENERGIES = [
    (
        SVK,
        "lam/8*(I1 - 3)**2 + mu/4*(I1**2 - 2*I2 - 2*I1 + 3)",
        {"lam": SVK.lame_lambda, "mu": SVK.shear_modulus},
    ),
    (
        MOONEY_RIVLIN,
        "c10*(I1/J**(2/3) - 3) + c01*(I2/J**(4/3) - 3) + kappa/2*(J - 1)**2",
        {"c10": 0.3, "c01": 0.1, "kappa": 1.5},
    ),
    (
        YEOH,
        "c10*(I1/J**(2/3) - 3) + c20*(I1/J**(2/3) - 3)**2 + c30*(I1/J**(2/3) - 3)**3 + kappa/2*(J - 1)**2",
        {"c10": 0.3, "c20": -0.05, "c30": 0.02, "kappa": 1.5},
    ),
]


def material_at(material: Material, F: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    return evaluate_material(material.kernel, material.parameters, F)


def kirchhoff_stress(material: Material, F: FloatArray) -> FloatArray:
    """J sigma (n, 3, 3) at F (n, 2, 2)."""
    tau = np.zeros((len(F), 3, 3))
    tau[:, :2, :2] = material_at(material, F)[1] @ F.transpose(0, 2, 1)
    tau[:, 2, 2] = np.linalg.det(F) * material.out_of_plane_stress(F)
    return tau


def energy_slopes(material: Material, I1: FloatArray) -> tuple[FloatArray, FloatArray]:
    """d psi/dI1 and d psi/dI2 of an incompressible rubber."""
    if isinstance(material, MooneyRivlin):
        return np.full_like(I1, material.c10), np.full_like(I1, material.c01)
    assert isinstance(material, Yeoh)
    x = I1 - 3
    return material.c10 + 2 * material.c20 * x + 3 * material.c30 * x**2, np.zeros_like(I1)


def random_deformations(count: int) -> FloatArray:
    F = np.eye(2) + 0.4 * np.random.default_rng(3).uniform(-1, 1, (count, 2, 2))
    assert np.all(np.linalg.det(F) > 0.2)
    return F


def rotation(angle: float) -> FloatArray:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


@pytest.mark.parametrize(("material", "energy", "constants"), ENERGIES, ids=["svk", "mooney", "yeoh"])
def test_they_equal_their_energies_as_formulas(
    material: Material, energy: str, constants: dict[str, float]
) -> None:
    formula = FormulaMaterial(energy, constants)
    F = random_deformations(50)
    for ours, derived in zip(material_at(material, F), material_at(formula, F), strict=True):
        # other orders of some dozen operations on numbers of sizes up to 10
        np.testing.assert_allclose(ours, derived, rtol=1e-14, atol=1e-14)
    ours, derived = material.out_of_plane_stress(F), formula.out_of_plane_stress(F)
    np.testing.assert_allclose(ours, derived, rtol=1e-14, atol=1e-14)
    assert material.youngs_modulus == pytest.approx(formula.youngs_modulus, rel=1e-14)
    assert material.poissons_ratio == pytest.approx(formula.poissons_ratio, rel=1e-14)


@pytest.mark.parametrize(("material", "energy", "constants"), ENERGIES, ids=["svk", "mooney", "yeoh"])
def test_they_equal_their_energies_differentiated_by_sympy(
    material: Material, energy: str, constants: dict[str, float]
) -> None:
    F = sympy.Matrix(3, 3, sympy.symbols("F:9"))
    C = F.T * F
    invariants = {"I1": C.trace(), "I2": (C.trace() ** 2 - (C * C).trace()) / 2, "J": F.det()}
    psi = sympy.sympify(energy, locals={**invariants, **constants})
    # one derivative is enough: the other pairs of components are checked by differences
    P = [psi.diff(component) for component in F]
    A = [P[0].diff(component) for component in F]
    function = sympy.lambdify(list(F), [psi, *P, *A], "numpy")
    point = np.eye(3) + 0.3 * np.random.default_rng(5).uniform(-1, 1, (3, 3))
    energy_there, stress, tangent = material.solid_response(point)
    ours = [energy_there, *stress.ravel(), *tangent[0, 0].ravel()]
    # a few hundred operations on numbers of sizes up to 10, which cancel in the energy
    np.testing.assert_allclose(ours, function(*point.ravel()), rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("material", MATERIALS)
def test_stress_and_tangent_are_derivatives(material: Material) -> None:
    F = random_deformations(20)
    _, P, A = material_at(material, F)
    step = 1e-6
    for k in range(2):
        for L in range(2):
            change = np.zeros((2, 2))
            change[k, L] = step
            ahead, behind = material_at(material, F + change), material_at(material, F - change)
            # central differences: step^2 of truncation, up to 1e-15/step of round-off
            np.testing.assert_allclose((ahead[0] - behind[0]) / (2 * step), P[:, k, L], rtol=0, atol=2e-9)
            np.testing.assert_allclose((ahead[1] - behind[1]) / (2 * step), A[..., k, L], rtol=0, atol=2e-9)
    np.testing.assert_array_equal(A, A.transpose(0, 3, 4, 1, 2))  # the lower half is a copy of the upper


@pytest.mark.parametrize("material", MATERIALS)
def test_out_of_plane_stress_is_a_derivative_of_the_energy_in_three_dimensions(material: Material) -> None:
    def energy(F: np.ndarray) -> complex:
        C = F.T @ F
        J = np.linalg.det(F)
        density: complex
        if isinstance(material, SaintVenantKirchhoff):
            E = (C - np.eye(3)) / 2
            density = material.lame_lambda / 2 * E.trace() ** 2 + material.shear_modulus * (E @ E).trace()
            return density
        assert isinstance(material, MooneyRivlin | Yeoh)
        C_bar = C / J ** (2 / 3)
        x: complex = C_bar.trace() - 3
        density = material.c10 * x + material.bulk_modulus / 2 * (J - 1) ** 2
        if isinstance(material, Yeoh):
            return density + material.c20 * x**2 + material.c30 * x**3
        y: complex = np.linalg.inv(C_bar).trace() - 3  # I2 = tr C^-1 where det C = 1
        return density + material.c01 * y

    F = random_deformations(10)
    F3 = np.zeros((10, 3, 3), complex)
    F3[:, :2, :2] = F
    F3[:, 2, 2] = 1 + 1e-30j  # the complex step has no truncation, so that only round-off is left
    slopes = np.array([energy(one) for one in F3]).imag / 1e-30
    expected = slopes / np.linalg.det(F)
    np.testing.assert_allclose(material.out_of_plane_stress(F), expected, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("material", MATERIALS)
def test_small_strains_follow_hooke(material: Material) -> None:
    E, nu = material.youngs_modulus, material.poissons_ratio
    mu, lam = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
    one = np.eye(2)
    hooke = lam * np.einsum("iJ,kL->iJkL", one, one)
    hooke += mu * (np.einsum("ik,JL->iJkL", one, one) + np.einsum("iL,Jk->iJkL", one, one))
    energy, P, A = material_at(material, one[None])
    # the state of rest, to round-off: mu and kappa are of size 1
    assert energy[0] == pytest.approx(0, abs=2e-15)
    np.testing.assert_allclose(P[0], 0, rtol=0, atol=2e-15)
    np.testing.assert_allclose(A[0], hooke, rtol=0, atol=1e-14)
    strain = 1e-6 * np.array([[2.0, 0.5], [0.5, 1.0]])
    stress = material.out_of_plane_stress(one + strain)
    assert stress == pytest.approx(lam * np.trace(strain), rel=2e-5)  # the next order is some strains


@pytest.mark.parametrize("material", RUBBERS)
def test_bulk_modulus_is_the_one_given(material: MooneyRivlin | Yeoh) -> None:
    derived = material.youngs_modulus / (3 * (1 - 2 * material.poissons_ratio))
    assert derived == pytest.approx(material.bulk_modulus, rel=1e-14)  # a few operations


@pytest.mark.parametrize("material", MATERIALS)
def test_they_are_objective_and_isotropic(material: Material) -> None:
    F, Q = random_deformations(10), rotation(0.7)
    energy, P, A = material_at(material, F)
    turned = np.einsum("im,kn,emJnL->eiJkL", Q, Q, A)
    for ours, expected in zip(material_at(material, Q @ F), (energy, Q @ P, turned), strict=True):
        np.testing.assert_allclose(ours, expected, rtol=0, atol=2e-14)  # round-off of sizes up to 10
    energy_first, P_first, _ = material_at(material, F @ Q)
    np.testing.assert_allclose(energy_first, energy, rtol=0, atol=1e-14)
    np.testing.assert_allclose(P_first, P @ Q, rtol=0, atol=1e-14)
    stress = material.out_of_plane_stress(F)
    np.testing.assert_allclose(material.out_of_plane_stress(Q @ F), stress, rtol=0, atol=1e-14)


@pytest.mark.parametrize("material", RUBBERS)
def test_stress_differences_are_those_of_the_incompressible_rubber(material: Material) -> None:
    """Rivlin, Phil. Trans. R. Soc. A 241, 1948; Treloar, The Physics of Rubber Elasticity.

    The isochoric part sees F / J^(1/3) alone. So a stretch of 1.5 powers along one axis of the plane has the
    shear stresses of simple tension, (s, s^-1/2, s^-1/2), and one of 3 powers along both axes those of
    equibiaxial tension, (s, s, s^-2).
    """
    s = np.array([0.8, 0.95, 1.1, 1.4])
    one = np.broadcast_to(np.eye(2), (4, 2, 2))
    tension = one * np.stack([s**1.5, np.ones(4)], axis=1)[:, None]
    tau = kirchhoff_stress(material, tension)
    W1, W2 = energy_slopes(material, s**2 + 2 / s)
    # round-off: volumetric stresses, up to 75, cancel
    np.testing.assert_allclose(
        tau[:, 0, 0] - tau[:, 2, 2], 2 * (s**2 - 1 / s) * (W1 + W2 / s), rtol=0, atol=1e-13
    )
    np.testing.assert_allclose(tau[:, 1, 1], tau[:, 2, 2], rtol=0, atol=1e-13)
    tau = kirchhoff_stress(material, one * (s**3)[:, None, None])
    W1, W2 = energy_slopes(material, 2 * s**2 + s**-4)
    expected = 2 * (s**2 - s**-4) * (W1 + W2 * s**2)
    np.testing.assert_allclose(tau[:, 0, 0] - tau[:, 2, 2], expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("material", RUBBERS)
def test_simple_shear_is_that_of_the_incompressible_rubber(material: Material) -> None:
    """Rivlin: sigma_12 = 2 (W1 + W2) g, sigma_11 - sigma_33 = 2 W1 g^2, sigma_22 - sigma_33 = -2 W2 g^2."""
    g = np.array([0.01, 0.5, 2.0])
    F = np.array([[[1, shear], [0, 1]] for shear in g])
    sigma = kirchhoff_stress(material, F)
    W1, W2 = energy_slopes(material, 3 + g**2)
    np.testing.assert_allclose(
        sigma[:, 0, 1], 2 * (W1 + W2) * g, rtol=0, atol=1e-14
    )  # a few operations, as below
    np.testing.assert_allclose(sigma[:, 0, 0] - sigma[:, 2, 2], 2 * W1 * g**2, rtol=0, atol=1e-14)
    np.testing.assert_allclose(sigma[:, 1, 1] - sigma[:, 2, 2], -2 * W2 * g**2, rtol=0, atol=1e-14)


@pytest.mark.parametrize("stretch", [0.7, 1.2, 2.0])
@pytest.mark.parametrize("rubber", RUBBERS)
def test_a_strip_in_tension_tends_to_the_incompressible_one(
    rubber: MooneyRivlin | Yeoh, stretch: float
) -> None:
    """With F_22 free, P_11 -> 2 (s - s^-3) (W1 + W2) as the bulk modulus grows."""
    errors = []
    for bulk in (1e3, 1e4, 1e5):
        if isinstance(rubber, MooneyRivlin):
            material: Material = MooneyRivlin(rubber.c10, rubber.c01, bulk)
        else:
            material = Yeoh(rubber.c10, rubber.c20, rubber.c30, bulk)

        def stress(lateral: float, material: Material = material) -> FloatArray:
            return material_at(material, np.array([[[stretch, 0], [0, lateral]]]))[1]

        lateral = brentq(lambda x: stress(x)[0, 1, 1], 0.9 / stretch, 1.1 / stretch, xtol=1e-15)
        W1, W2 = energy_slopes(rubber, np.array(stretch**2 + 1 + stretch**-2))
        exact = 2 * (stretch - stretch**-3) * float(W1 + W2)
        errors.append(abs(stress(lateral)[0, 0, 0] - exact))
    assert errors[0] < 1e-2 * abs(exact)  # mu / kappa is 8e-4
    # the first order in mu / kappa remains, and the root's 1e-15 times kappa of round-off
    assert errors[1] == pytest.approx(errors[0] / 10, rel=0.02)
    assert errors[2] == pytest.approx(errors[1] / 10, rel=0.02)


@pytest.mark.parametrize("stretch", [0.5, 1.2, 3.0])
@pytest.mark.parametrize("ratio", [0.1, 0.3, 0.49, 0.4999])
def test_neo_hooke_in_tension_in_closed_form(ratio: float, stretch: float) -> None:
    """With F_22 free, ln J = mu/lambda (1 - J^2/s^2) and P_11 = mu (s - J^2/s^3), incompressible: J = 1."""
    material = NeoHooke(1.0, ratio)
    mu, lame = material.shear_modulus, material.lame_lambda
    J = brentq(lambda J: lame * np.log(J) - mu * (1 - J**2 / stretch**2), 0.1, 30.0, xtol=1e-15)
    _, P, _ = material_at(material, np.array([[[stretch, 0], [0, J / stretch]]]))
    # lambda, up to 1667, times the round-off of J
    np.testing.assert_allclose(P[0], np.diag([mu * (stretch - J**2 / stretch**3), 0]), rtol=0, atol=4e-12)
    if ratio == 0.4999:
        incompressible = mu * (stretch - stretch**-3)
        # the first order in mu/lambda, 2e-4, times up to 2/s^4/(1 + 1/s^2) = 6.4
        assert P[0, 0, 0] == pytest.approx(incompressible, rel=1.5e-3)


def test_saint_venant_kirchhoff_in_uniaxial_strain_and_simple_shear() -> None:
    mu, lam = SVK.shear_modulus, SVK.lame_lambda
    s = np.linspace(0.1, 2, 20)
    F = np.eye(2) * np.stack([s, np.ones(20)], axis=1)[:, None]
    # S_11 = (lambda + 2 mu) (s^2 - 1)/2; round-off as below
    np.testing.assert_allclose(
        material_at(SVK, F)[1][:, 0, 0], (lam + 2 * mu) * s * (s**2 - 1) / 2, rtol=1e-13, atol=1e-14
    )
    g = np.array([0.1, 1.0, 3.0])
    sheared = np.array([[[1, shear], [0, 1]] for shear in g])
    # E_12 = g/2 and E_22 = g^2/2, so P_12 = S_12 + g S_22
    expected = mu * g + (lam + 2 * mu) * g**3 / 2
    np.testing.assert_allclose(material_at(SVK, sheared)[1][:, 0, 1], expected, rtol=1e-14)


def test_saint_venant_kirchhoff_loses_stiffness_in_compression() -> None:
    """P = (lambda + 2 mu) s (s^2 - 1)/2 of uniaxial strain is least at s = 1/sqrt(3)."""

    def at(s: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        return material_at(SVK, np.array([[[s, 0.0], [0.0, 1.0]]]))

    least = minimize_scalar(
        lambda s: at(s)[1][0, 0, 0], bounds=(0.1, 1), method="bounded", options={"xatol": 1e-9}
    )
    modulus = SVK.lame_lambda + 2 * SVK.shear_modulus
    assert least.fun == pytest.approx(-modulus / (3 * np.sqrt(3)), rel=1e-14)
    assert least.x == pytest.approx(1 / np.sqrt(3), rel=1e-7)  # flat to the root of round-off there
    turning = brentq(lambda s: at(s)[2][0, 0, 0, 0, 0], 0.1, 1, xtol=1e-15)
    assert turning == pytest.approx(1 / np.sqrt(3), rel=1e-14)


@pytest.mark.parametrize("material", RUBBERS)
@pytest.mark.parametrize("stretch", [-1.0, 0.0])
def test_an_inverted_point_of_rubber_has_no_energy(material: Material, stretch: float) -> None:
    energy, P, A = material_at(material, np.array([[[stretch, 0.0], [0.0, 1.0]]]))
    assert np.isnan(energy).all()
    assert np.isnan(P[0].diagonal()).all()
    assert np.isnan(A[0, 0, 0, 0, 0])


def test_saint_venant_kirchhoff_turned_inside_out_is_refused_by_the_solver() -> None:
    """The strip's mirror image balances, with no stress anywhere, and is no answer."""
    system = System(strip(material=SVK), row_space("L1", (20, 2)))
    mirrored = np.zeros((system.space.size, 2))
    for row, height in enumerate((0.0, 5.0, 10.0)):
        mirrored[system.space.offsets[row] : system.space.offsets[row + 1], 1] = -2 * height
    state = system.equilibrium(mirrored)
    # the adhesive force of a face at the equilibrium gap, and stresses: round-off
    np.testing.assert_allclose(state.forces, 0, rtol=0, atol=1e-13)
    assert state.stored_energy == pytest.approx(0, abs=1e-13)
    start = system.constraints.unknown_values(mirrored, np.pi)
    with pytest.raises(ConvergenceError) as caught:
        newton(system, start, np.pi, NewtonSettings())
    assert "inverted: det F = -1 " in caught.value.located(system).reason


@pytest.mark.parametrize("material", MATERIALS)
def test_a_strip_bent_little_has_the_moment_of_a_neo_hookean_one(material: Material) -> None:
    neo_hooke = NeoHooke(material.youngs_modulus, material.poissons_ratio)
    space, angles = row_space("N2", (60, 2)), np.radians([0.0, 0.05])
    *_, ours = trace(strip(material=material), space, angles)
    *_, theirs = trace(strip(material=neo_hooke), space, angles)
    assert ours.reaction == pytest.approx(theirs.reaction, rel=1e-4)  # strains are below 1e-4


@pytest.mark.parametrize(
    ("kind", "values", "field"),
    [
        (SaintVenantKirchhoff, (0.0, 0.2), "material.youngs_modulus"),
        (SaintVenantKirchhoff, (np.inf, 0.2), "material.youngs_modulus"),
        (SaintVenantKirchhoff, (1.0, 0.5), "material.poissons_ratio"),
        (SaintVenantKirchhoff, (1.0, -1.0), "material.poissons_ratio"),
        (MooneyRivlin, (0.1, -0.1, 1.0), "material.c10 + c01"),
        (MooneyRivlin, (np.nan, 0.1, 1.0), "material.c10"),
        (MooneyRivlin, (0.1, np.inf, 1.0), "material.c01"),
        (MooneyRivlin, (0.3, 0.1, 0.0), "material.bulk_modulus"),
        (Yeoh, (0.0, 0.1, 0.1, 1.0), "material.c10"),
        (Yeoh, (0.3, np.nan, 0.1, 1.0), "material.c20"),
        (Yeoh, (0.3, 0.1, np.inf, 1.0), "material.c30"),
        (Yeoh, (0.3, 0.1, 0.1, -1.0), "material.bulk_modulus"),
    ],
)
def test_constants_without_a_stable_rest_are_refused(
    kind: type, values: tuple[float, ...], field: str
) -> None:
    with pytest.raises(InputError) as caught:
        kind(*values)
    assert caught.value.field == field


def test_a_negative_c01_may_be_made_up_for_by_c10() -> None:
    # c10 + c01 = 0.25, kappa = 1: E = 9 kappa mu/(3 kappa + mu) = 9/7 with mu = 1/2; exact to round-off
    assert MooneyRivlin(0.375, -0.125, 1.0).youngs_modulus == pytest.approx(9 / 7, rel=1e-15)
