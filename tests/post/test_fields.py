"""Sampled fields against rigid motions, homogeneous deformations and Hooke's law."""

from dataclasses import replace

import numpy as np
import pytest

from isopeel import (
    Body,
    FormulaMaterial,
    InputError,
    NeoHooke,
    Problem,
    RowSpace,
    SaintVenantKirchhoff,
    row_space,
    strip,
)
from isopeel.common.arrays import FloatArray
from isopeel.physics.materials import Material
from isopeel.post.fields import sample_fields, side_positions
from isopeel.splines.nurbs import NurbsSurface, Side, annulus_sector, rectangle
from isopeel.splines.space import SplineSpace

STRETCH = np.array([[1.2, 0.3], [-0.1, 0.9]])


def kinked() -> NurbsSurface:
    """A bar of two straight halves that meet at an angle."""
    points = np.array([[[0.0, 0.0], [0.0, 1.0]], [[2.0, 0.0], [2.0, 1.0]], [[3.5, 1.5], [3.0, 2.5]]])
    return NurbsSurface((SplineSpace.uniform(1, 0, 2), SplineSpace.uniform(1, 0, 1)), points, np.ones((3, 2)))


def body(shape: NurbsSurface, name: str, elements: tuple[int, int]) -> tuple[Problem, RowSpace]:
    problem = strip()
    return problem.changed(body=Body(shape, NeoHooke(1.0, 0.2))), row_space(name, elements)


def linear_field(problem: Problem, space: RowSpace, gradient: FloatArray) -> FloatArray:
    """Coefficients of u = gradient X."""
    shape = problem.body.shape
    return space.weighted(shape).interpolate(lambda xi, eta: shape.evaluate(xi, eta) @ gradient.T)


SHAPES = pytest.mark.parametrize(
    ("shape", "name", "elements"),
    [
        (rectangle(200.0, 10.0), "L1+N2.1", (12, 3)),
        (annulus_sector(10.0, 20.0, 2.0), "N3", (5, 2)),  # rational
        (kinked(), "L2", (6, 2)),  # the reference position has a kink at an element's edge
    ],
    ids=["strip", "sector", "kinked"],
)


@SHAPES
def test_a_rigid_rotation_is_exact_and_free_of_stress(
    shape: NurbsSurface, name: str, elements: tuple[int, int]
) -> None:
    problem, space = body(shape, name, elements)
    Q = np.array([[np.cos(2.0), -np.sin(2.0)], [np.sin(2.0), np.cos(2.0)]])
    fields = sample_fields(problem, space, linear_field(problem, space, Q - np.eye(2)), (3, 2))
    size = np.abs(fields.reference_position).max()
    # round-off of a few hundred operations; derivatives of the strip lose another factor of the mesh, 12
    assert np.abs(fields.position - fields.reference_position @ Q.T).max() < 1e-14 * size * 10
    assert np.abs(fields.deformation_gradient - Q).max() < 1e-13
    assert np.abs(fields.cauchy_stress).max() < 1e-13  # E is 1


@SHAPES
def test_a_homogeneous_deformation_has_the_stress_of_the_closed_form(
    shape: NurbsSurface, name: str, elements: tuple[int, int]
) -> None:
    problem, space = body(shape, name, elements)
    fields = sample_fields(problem, space, linear_field(problem, space, STRETCH - np.eye(2)), (3, 2))
    # nu = 0.2: mu = E/2.4, lambda = 0.2 E/(1.2 0.6); sigma = (lambda ln J 1 + mu (F F^T - 1)) / J
    mu, lame_lambda, J = 1 / 2.4, 0.2 / 0.72, float(np.linalg.det(STRETCH))
    sigma = lame_lambda * np.log(J) * np.eye(3)
    sigma[:2, :2] += mu * (STRETCH @ STRETCH.T - np.eye(2))
    # round-off of F, as above
    assert np.abs(fields.deformation_gradient - STRETCH).max() < 1e-13
    assert np.abs(fields.cauchy_stress - sigma / J).max() < 1e-13
    assert np.abs(fields.first_invariant - np.trace(sigma) / J).max() < 3e-13


def test_small_strains_give_hookes_law() -> None:
    strain = 1e-7 * np.array([[3.0, 1.0], [1.0, -2.0]])
    problem, space = body(rectangle(2.0, 1.0), "N2", (3, 2))
    problem = problem.changed(body=replace(problem.body, material=NeoHooke(5.0, 0.3)))
    stress = sample_fields(problem, space, linear_field(problem, space, strain)).cauchy_stress
    # E eps = (1 + nu) sigma - nu tr(sigma) 1 in three dimensions, inverted by hand: E = 5, nu = 0.3
    mu, lame_lambda = 5 / 2.6, 1.5 / (1.3 * 0.4)
    hooke = lame_lambda * np.trace(strain) * np.eye(3)
    hooke[:2, :2] += 2 * mu * strain
    # the terms of second order are below (3e-7)^2 times a few moduli, round-off of F below 1e-15 times E
    assert np.abs(stress - hooke).max() < 1e-12


def test_a_formula_material_has_the_same_stresses() -> None:
    problem, space = body(annulus_sector(1.0, 2.0, 1.0), "N2.1", (4, 2))
    formula = FormulaMaterial(
        "mu/2*(I1 - 3 - 2*log(J)) + lam/2*log(J)**2", {"mu": 1 / 2.4, "lam": 0.2 / 0.72}
    )
    other = problem.changed(body=replace(problem.body, material=formula))
    random = np.random.default_rng(1)
    displacement = 0.02 * random.standard_normal((space.size, 2))
    ours, theirs = (sample_fields(p, space, displacement, (2, 2)) for p in (problem, other))
    # SymPy's derivatives against ours by hand: round-off times the number of operations
    assert np.abs(ours.cauchy_stress - theirs.cauchy_stress).max() < 1e-12
    assert np.abs(ours.cauchy_stress).max() > 0.01


def test_elements_keep_their_own_values_on_shared_edges() -> None:
    problem, space = body(rectangle(4.0, 1.0), "L1", (4, 1))
    displacement = np.zeros((space.size, 2))
    displacement[[1, 6], 0] = 0.25  # the column of nodes at x = 1
    fields = sample_fields(problem, space, displacement, (2, 1))
    stretch = fields.deformation_gradient[..., 0, 0]
    # linear elements of length 1: 1 + 0.25, 1 - 0.25, then nothing, up to and on their edges
    assert stretch.shape == (4, 1, 3, 2)
    np.testing.assert_allclose(stretch[:, 0], np.array([1.25, 0.75, 1, 1])[:, None, None] * np.ones((3, 2)))


@pytest.mark.parametrize("material", [NeoHooke(1.0, 0.2), SaintVenantKirchhoff(1.0, 0.2)])
def test_an_element_inside_out_has_no_stress(material: Material) -> None:
    """Also of a material whose stress stays finite there."""
    problem, space = body(rectangle(4.0, 1.0), "L1", (4, 1))
    problem = problem.changed(body=replace(problem.body, material=material))
    displacement = np.zeros((space.size, 2))
    displacement[[1, 6], 0] = 1.5  # beyond the next column, at x = 2
    invariant = sample_fields(problem, space, displacement).first_invariant
    assert np.isnan(invariant[1]).all()
    assert np.isfinite(invariant[[0, 2, 3]]).all()


@pytest.mark.parametrize("side", ["left", "right", "bottom", "top"])
def test_positions_along_a_side(side: Side) -> None:
    problem, space = body(annulus_sector(10.0, 20.0, 2.0), "N3", (5, 2))
    along = np.linspace(0, 1, 7)
    positions = side_positions(problem, space, linear_field(problem, space, STRETCH - np.eye(2)), side, along)
    expected = problem.body.shape.boundary(side).evaluate(along) @ STRETCH.T
    np.testing.assert_allclose(positions, expected, atol=1e-13)  # round-off of lengths up to 20


def test_bad_input_is_named() -> None:
    problem, space = body(rectangle(4.0, 1.0), "L1", (4, 1))
    with pytest.raises(InputError, match="displacement"):
        sample_fields(problem, space, np.zeros((3, 2)))
    with pytest.raises(InputError, match="per_element"):
        sample_fields(problem, space, np.zeros((space.size, 2)), (0, 1))
