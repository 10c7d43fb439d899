"""The assembled system: patch test, rigid motions, consistent tangents, Lagrange elements."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import BarycentricInterpolator

from isopeel import (
    Body,
    Boundary,
    Circle,
    Flat,
    InputError,
    Interface,
    NeoHooke,
    Problem,
    RotatedSide,
    Support,
    VanDerWaals,
    row_space,
    strip,
)
from isopeel.assembly.system import System, bytes_needed
from isopeel.assembly.tables import body_table
from isopeel.common.arrays import FloatArray
from isopeel.matrix.band import BandMatrix, Storage
from isopeel.physics.batch import evaluate_law
from isopeel.problem import Traction
from isopeel.splines.nurbs import NurbsSurface, Side, annulus_sector, rectangle
from isopeel.splines.space import SplineSpace

MATERIAL = NeoHooke(youngs_modulus=1.0, poissons_ratio=0.2)
LAW = VanDerWaals(hamaker_constant=0.05, equilibrium_distance=0.4)
# forces of the body alone: an adhesion too weak to count
NO_ADHESION = VanDerWaals(hamaker_constant=1e-300, equilibrium_distance=0.4)
SPACES = ["L1", "L2", "L4", "N2", "N4", "N2.1", "L1+N2.1", "L1+L4", "N2+N4@2", "L1+H5"]


def problem_of(
    shape: NurbsSurface, traction: Traction = "reference", side: Side = "bottom", law: VanDerWaals = LAW
) -> Problem:
    lowest = float(shape.control_points[..., 1].min())
    adhesion = Interface(
        Boundary("body", side, end=0.7),
        law=law,
        against=Flat(lowest - 0.27),
        traction=traction,
    )
    return Problem(
        "test",
        (Body(shape, MATERIAL),),
        (adhesion,),
        (Support(Boundary("body", "left"), (0,)),),
        RotatedSide("right"),
    )


def dense(matrix: BandMatrix) -> FloatArray:
    """The full matrix of either storage."""
    n, b = len(matrix.entries), matrix.half_bandwidth
    diagonal = 0 if matrix.storage == "symmetric" else 2 * b
    full = np.zeros((n, n))
    for j in range(n):
        for i in range(j if matrix.storage == "symmetric" else max(0, j - b), min(n, j + b + 1)):
            full[i, j] = matrix.entries[j, diagonal + i - j]
    return full if matrix.storage == "general" else full + np.tril(full, -1).T


@pytest.mark.parametrize("name", SPACES)
def test_patch_test(name: str) -> None:
    """A homogeneous deformation leaves every inner coefficient free of force, whatever the rows."""
    system = System(problem_of(rectangle(20.0, 3.0), law=NO_ADHESION), row_space(name, (9, 3)))
    stretch = np.array([[0.2, 0.1], [-0.05, 0.1]])
    u = system.space.interpolate(lambda xi, eta: np.stack([20 * xi, 3 * eta], axis=1) @ stretch.T)
    forces = system.equilibrium(u).forces
    inner = np.ones(system.space.size, dtype=bool)
    for side in ("left", "right", "bottom", "top"):
        inner[system.space.side_functions(side)] = False
    assert inner.any()
    # forces of a single function reach about 1: sums of some hundred terms of round-off remain
    assert np.abs(forces[inner]).max() < 1e-13
    assert np.abs(forces[~inner]).max() > 0.05


@pytest.mark.parametrize(
    "shape", [rectangle(20.0, 3.0), annulus_sector(4.0, 6.0, 1.9)], ids=["strip", "sector"]
)
@pytest.mark.parametrize("name", ["N2", "N4", "L2", "N2.1", "L4+N4@2"])
def test_rigid_motion_of_a_rational_body_is_free_of_force(shape: NurbsSurface, name: str) -> None:
    """Weights are not uniform on the sector; spaces of degree 2 and more hold its shape exactly."""
    system = System(problem_of(shape, law=NO_ADHESION), row_space(name, (6, 3)))
    angle = 2.1
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

    def motion(xi: FloatArray, eta: FloatArray) -> FloatArray:
        X = shape.evaluate(xi, eta)
        moved: FloatArray = X @ turn.T + [3.0, -1.0] - X
        return moved

    u = system.space.interpolate(motion)
    # E = 1, forces per unit strain are of size 1; round-off of coefficients of size 20
    assert np.abs(system.equilibrium(u).forces).max() < 1e-13
    assert abs(system.equilibrium(u).stored_energy) < 1e-13


def test_a_space_that_does_not_hold_the_shape_is_refused() -> None:
    """Turning the body would strain it: an error of the second order in the size of an element."""
    shape = annulus_sector(4.0, 6.0, 1.9)
    coarse, fine = (row_space("L1", (elements, 2)).misfit(shape)[0] for elements in (20, 40))
    assert np.log2(coarse / fine) == pytest.approx(2, abs=0.2)
    with pytest.raises(InputError, match="degree 2 in all rows, such as 'N2'") as refused:
        System(problem_of(shape), row_space("L1", (20, 2)))
    assert refused.value.field == "space"


@pytest.mark.parametrize(
    ("traction", "storage"),
    [("reference", "symmetric"), ("reference", "general"), ("projected", "general")],
)
@pytest.mark.parametrize(
    ("shape", "name", "side"),
    [
        (rectangle(8.0, 2.0), "L1", "bottom"),
        (rectangle(8.0, 2.0), "N2.1", "bottom"),
        (rectangle(8.0, 2.0), "L1+N4", "bottom"),
        (rectangle(8.0, 2.0), "N2", "left"),
        # elements of the side with different numbers of functions
        (rectangle(8.0, 2.0), "L1+N4", "left"),
        (annulus_sector(4.0, 6.0, 1.9), "N2", "bottom"),
        (annulus_sector(4.0, 6.0, 1.9), "L4+N4@2", "top"),
    ],
)
def test_tangent_is_the_derivative_of_the_residual(
    traction: Traction, shape: NurbsSurface, name: str, side: Side, storage: Storage
) -> None:
    system = System(problem_of(shape, traction, side), row_space(name, (5, 2)))
    rng = np.random.default_rng(3)
    z = 0.02 * rng.standard_normal(system.constraints.count)
    angle = 0.02

    def residual(values: FloatArray) -> FloatArray:
        return system.equilibrium(system.constraints.displacement(values, angle)).residual

    _, matrix = system.linearize(system.constraints.displacement(z, angle), storage)
    tangent = dense(matrix)
    step = 1e-6
    for _ in range(5):
        direction = rng.standard_normal(len(z))
        difference = (residual(z + step * direction) - residual(z - step * direction)) / (2 * step)
        # central differences; the law's stiffness reaches 60, its third derivative 1e4
        scale = np.abs(difference).max()
        np.testing.assert_allclose(tangent @ direction, difference, rtol=0, atol=1e-7 * scale)


@pytest.mark.parametrize("traction", ["reference", "projected"])
def test_tangent_turns_with_the_normal_of_a_curved_substrate(traction: Traction) -> None:
    problem = problem_of(rectangle(8.0, 2.0), traction)
    curved = replace(
        problem.adhesion,
        boundary=Boundary("body", "bottom", end=0.9),
        against=Circle(4.0, centre=(3.0, -4.3)),
    )
    system = System(problem.changed(adhesion=curved), row_space("N2", (6, 2)))
    rng = np.random.default_rng(8)
    z, direction = 0.02 * rng.standard_normal((2, system.constraints.count))
    _, matrix = system.linearize(system.constraints.displacement(z, 0.02))

    def residual(values: FloatArray) -> FloatArray:
        return system.equilibrium(system.constraints.displacement(values, 0.02)).residual

    difference = (residual(z + 1e-5 * direction) - residual(z - 1e-5 * direction)) / 2e-5
    change = dense(matrix) @ direction
    np.testing.assert_allclose(change, difference, rtol=0, atol=1e-7 * np.abs(change).max())  # as above


@pytest.mark.parametrize("name", ["L2", "N4"])
def test_residual_is_the_derivative_of_the_energy(name: str) -> None:
    system = System(problem_of(rectangle(8.0, 2.0)), row_space(name, (5, 2)))
    rng = np.random.default_rng(4)
    z = 0.02 * rng.standard_normal(system.constraints.count)

    def energy(values: FloatArray) -> float:
        state = system.equilibrium(system.constraints.displacement(values, 0.01))
        return state.stored_energy + state.adhesive_energy

    residual = system.equilibrium(system.constraints.displacement(z, 0.01)).residual
    direction = rng.standard_normal(len(z))
    step = 1e-5
    difference = (energy(z + step * direction) - energy(z - step * direction)) / (2 * step)
    assert residual @ direction == pytest.approx(difference, rel=1e-7)  # central differences


def test_reaction_is_the_derivative_of_the_energy() -> None:
    system = System(problem_of(rectangle(8.0, 2.0)), row_space("N2", (5, 2)))
    z = 0.02 * np.random.default_rng(5).standard_normal(system.constraints.count)

    def energy(angle: float) -> float:
        state = system.equilibrium(system.constraints.displacement(z, angle))
        return state.stored_energy + state.adhesive_energy

    forces = system.equilibrium(system.constraints.displacement(z, 0.3)).forces
    difference = (energy(0.3 + 1e-6) - energy(0.3 - 1e-6)) / 2e-6
    assert system.constraints.reaction(forces, 0.3) == pytest.approx(
        difference, rel=1e-7
    )  # central differences


@pytest.mark.parametrize("degree", [1, 2, 4])
def test_c0_splines_are_lagrange_elements(degree: int) -> None:
    """The stored energy of nodal values, by Lagrange polynomials from scipy, is that of the C0 spline."""
    nx, ny = 4, 2
    length, height = 8.0, 2.0
    space = row_space(f"L{degree}", (nx, ny))
    system = System(problem_of(rectangle(length, height)), space)
    nodes = np.linspace(0, 1, nx * degree + 1)
    nodal = 0.1 / degree**2 * np.random.default_rng(6).standard_normal((ny + 1, len(nodes), 2))
    to_nodes = space.rows[0].collocation(nodes).toarray()
    u = np.concatenate([np.linalg.solve(to_nodes, values) for values in nodal])

    points, weights = np.polynomial.legendre.leggauss(degree + 1)
    along = 0.5 * (points + 1)
    lagrange = BarycentricInterpolator(np.linspace(0, 1, degree + 1), np.eye(degree + 1))
    value, slope = lagrange(along), lagrange.derivative(along)
    heights, height_weights = np.polynomial.legendre.leggauss(2)
    mu, lam = MATERIAL.shear_modulus, MATERIAL.lame_lambda
    energy = 0.0
    for e in range(nx):
        for f in range(ny):
            rows = nodal[f : f + 2, e * degree : (e + 1) * degree + 1]
            for eta, h in zip(0.5 * (heights + 1), height_weights, strict=True):
                across, climb = np.array([1 - eta, eta]), np.array([-1.0, 1.0])
                for q, w in enumerate(weights):
                    gradient = np.stack(
                        [
                            np.einsum("j,a,jai->i", across, slope[q], rows) * nx / length,
                            np.einsum("j,a,jai->i", climb, value[q], rows) * ny / height,
                        ],
                        axis=1,
                    )
                    F = np.eye(2) + gradient
                    log_J = np.log(np.linalg.det(F))
                    density = mu / 2 * (np.sum(F * F) - 2 - 2 * log_J) + lam / 2 * log_J**2
                    energy += density * w * h / 4 * length / nx * height / ny
    # the same sum in another order and another basis: round-off only
    assert system.equilibrium(u).stored_energy == pytest.approx(energy, rel=1e-13)


def test_degrees_of_freedom_are_the_published_ones() -> None:
    published = {"L1": 4422, "L2": 8822, "L4": 17622, "N2": 4444, "N4": 4488, "N6": 4532, "N8": 4576}
    published |= {"N2.1": 8844, "N4.1": 8888}
    assert {name: 2 * row_space(name, (200, 10)).size for name in published} == published


@pytest.mark.parametrize(("name", "expected"), [("L1", 25), ("L2", 47), ("L4", 91), ("N8", 179)])
def test_the_band_is_narrow(name: str, expected: int) -> None:
    # p columns of 2 x 11 unknowns, one row up, one component on
    assert System(strip(), row_space(name, (24, 10))).half_bandwidth == expected
    # turned by a right angle the strip has as narrow a band: unknowns are numbered along its length
    upright = strip().changed(
        body=Body(rectangle(10.0, 200.0), MATERIAL), supports=(Support(Boundary("body", "bottom"), (0,)),)
    )
    turned = replace(upright, drive=RotatedSide("top"))
    assert System(turned, row_space("L1", (10, 24))).half_bandwidth == 25


def test_part_of_an_element_adheres() -> None:
    """The adhesive energy at rest is exact also where the adhering part ends inside an element."""
    for length in (150.0, 149.3, 0.4):
        system = System(strip(adhering_length=length), row_space("N2", (20, 2)))
        rest = system.equilibrium(np.zeros((system.space.size, 2)))
        # a constant potential is integrated exactly
        assert rest.adhesive_energy == pytest.approx(-LAW.work_of_adhesion * length, rel=1e-13)
        assert np.abs(rest.residual).max() < 1e-14


@pytest.mark.parametrize("points", [1, 2, 3, 7])
def test_the_adhesive_force_has_the_requested_gauss_points(points: int) -> None:
    """On a strip lifted along a straight line, against the same rule on the law's own potential."""
    system = System(strip(), row_space("N2", (20, 2)), points)
    lift = system.space.interpolate(lambda xi, _eta: np.stack([0 * xi, 2e-3 * 200 * xi], axis=-1))
    places, weights = np.polynomial.legendre.leggauss(points)
    x = 10.0 * np.arange(15)[:, None] + 5 * (places + 1)
    gap = LAW.equilibrium_gap + 2e-3 * x
    potential, _, _ = evaluate_law(LAW.kernel, LAW.parameters, gap, np.zeros_like(gap))
    expected = float(np.sum(5 * weights * potential))
    # a sum of at most 105 terms
    assert system.equilibrium(lift).adhesive_energy == pytest.approx(expected, rel=1e-13)


def test_no_gauss_point_is_too_few() -> None:
    with pytest.raises(InputError, match="contact_points"):
        System(strip(), row_space("N2", (20, 2)), 0)


def test_an_inverted_element_is_found() -> None:
    system = System(strip(), row_space("L1", (20, 2)))
    u = np.zeros((system.space.size, 2))
    u[5] = [25.0, 0.0]  # beyond its neighbour, 10 away
    found = system.inverted_point(u)
    assert found is not None
    place, determinant = found
    assert determinant < 0
    assert 50 < place[0] < 60
    assert place[1] < 5
    assert system.inverted_point(np.zeros_like(u)) is None


def test_a_held_side_that_the_drive_moves_is_refused() -> None:
    problem = strip().changed(supports=(Support(Boundary("body", "right"), (0,)),))
    with pytest.raises(InputError, match="the drive moves the side right, which shares points with it"):
        System(problem, row_space("L1", (20, 2)))


def test_a_patch_that_folds_is_refused() -> None:
    line = SplineSpace.uniform(1, 0, 1)
    points = np.array([[[0.0, 0.0], [0.0, 1.0]], [[1.0, 1.0], [1.0, 0.0]]])  # the top crosses the bottom
    folded = NurbsSurface((line, line), points, np.ones((2, 2)))
    with pytest.raises(InputError, match="must not fold"):
        System(problem_of(folded), row_space("L1", (4, 4)))


@pytest.mark.parametrize("name", ["L1", "N4", "L1+N2.1"])
def test_memory_is_estimated_from_above(name: str) -> None:
    # on a body whose elements are not alike
    line = SplineSpace.uniform(1, 0, 1)
    points = np.array([[[0.0, 0.0], [0.0, 10.0]], [[200.0, 0.0], [200.0, 5.0]]])
    tapered = NurbsSurface((line, line), points, np.ones((2, 2)))
    system = System(problem_of(tapered), row_space(name, (40, 6)))
    u = np.zeros((system.space.size, 2))
    system.linearize(u)
    general = system.linearize(u, "general")[1].workspace
    tables = [value for value in vars(system.body).values() if isinstance(value, np.ndarray)]
    # compiled code has its own
    terms = system.equations.terms
    held = sum(array.nbytes for array in (general, *tables, terms.integers, terms.floats))
    estimate = bytes_needed(system.space)
    # a driven side has one unknown, and the first and last elements few functions of their own
    assert held < estimate < 2 * held


@pytest.mark.parametrize(
    ("shape", "area", "maps", "areas"),
    [
        (rectangle(7.0, 3.0), 21.0, 1, 1),
        (annulus_sector(1.0, 2.0, np.pi / 2), 0.75 * np.pi, 4 * 2, 4 * 2),
    ],
    ids=["rectangle", "sector"],
)
def test_lines_of_points_share_what_is_alike(shape: NurbsSurface, area: float, maps: int, areas: int) -> None:
    table = body_table(shape, row_space("N2", (7, 4)))
    assert len(table.maps) == maps
    assert len(table.weights) == areas
    for y, heights in enumerate(table.eta):
        for r, eta in enumerate(heights):
            for x, places in enumerate(table.xi):
                jacobian = shape.jacobian(places, np.full(3, eta))
                to_X = table.maps[table.map_kinds[y, r], :, :, :, x]
                np.testing.assert_allclose(jacobian @ to_X, np.tile(np.eye(2), (3, 1, 1)), atol=1e-12)
    assert table.area == pytest.approx(area, rel=1e-6)  # of the sector, by Gauss points
