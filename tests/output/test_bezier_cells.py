"""Bezier cells as VTK evaluates them, against our own evaluation of shape, displacement and fields."""

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from bodies import BODIES, body, displacement, exact
from vtk_files import ReadGrid
from vtkmodules.vtkCommonDataModel import vtkBezierCurve, vtkHigherOrderQuadrilateral

from isopeel.assembly.interface import InterfacePoints
from isopeel.common.arrays import FloatArray
from isopeel.post.fields import fields_at
from isopeel.post.grids import body_grids, body_mesh, side_grids, side_mesh
from isopeel.results import vtk
from isopeel.results.fields import StoredState
from isopeel.splines.nurbs import Side

PLACES = tuple(product((0.0, 0.13, 0.5, 0.8, 1.0), repeat=2))


def between(ends: FloatArray, cell: int, place: float) -> float:
    return float(ends[cell] + place * (ends[cell + 1] - ends[cell]))


@pytest.mark.parametrize(("p", "q"), [(1, 1), (2, 1), (3, 1), (1, 3), (3, 2), (5, 4)])
def test_points_are_in_the_order_of_vtk(p: int, q: int) -> None:
    order = vtk.quadrilateral_order(p, q).tolist()
    for i, j in product(range(p + 1), range(q + 1)):
        assert order[vtkHigherOrderQuadrilateral.PointIndexFromIJK(i, j, (p, q))] == (q + 1) * i + j


@pytest.mark.parametrize("p", [1, 2, 5])
def test_points_of_curves_are_in_the_order_of_vtk(p: int) -> None:
    curve = vtkBezierCurve()
    curve.GetPointIds().SetNumberOfIds(p + 1)
    curve.GetPoints().SetNumberOfPoints(p + 1)
    curve.GetOrder()
    order = vtk.curve_order(p).tolist()
    assert [order[curve.PointIndexFromIJK(i, 0, 0)] for i in range(p + 1)] == list(range(p + 1))


@pytest.mark.parametrize("name", BODIES)
def test_shape_and_displacement_are_exact_in_cells(name: str, tmp_path: Path) -> None:
    problem, space = body(name)
    u = displacement(problem, space)
    mesh = body_mesh(problem, space, None)
    (grid,) = body_grids(problem, space, mesh, [StoredState(0, 0.0, u)])
    vtk.write_grid(tmp_path / "body.vtu", grid, 1.5, {"L0": "1 nm"})
    read = ReadGrid(tmp_path / "body.vtu")
    n_x, n_y = (ends.size - 1 for ends in mesh.ends)
    assert read.grid.GetNumberOfCells() == n_x * n_y
    assert (n_x, n_y) == (space.elements[0] + (name == "kinked"), space.elements[1])
    degrees = read.grid.GetCellData().GetHigherOrderDegrees()
    assert degrees.GetTuple(0) == (*BODIES[name][2], 1)
    weights = read.grid.GetPointData().GetRationalWeights()
    assert (weights is not None) == (name not in ("strip", "kinked"))
    extent = float(np.ptp(problem.body.shape.control_points))
    for cell, (s, t) in product(range(n_x * n_y), PLACES):
        i, j = divmod(cell, n_y)
        xi, eta = between(mesh.ends[0], i, s), between(mesh.ends[1], j, t)
        X, d = read.evaluate(cell, (s, t), "displacement [L0]")
        expected = exact(problem, space, u, xi, eta)
        # of the size of the body; ten round-offs were found
        assert np.abs(np.stack([X, d])[:, :2] - expected).max() < 1e-12 * extent
        assert X[2] == d[2] == 0


@pytest.mark.parametrize("name", BODIES)
def test_other_fields_are_exact_at_gauss_points_and_centres(name: str, tmp_path: Path) -> None:
    problem, space = body(name)
    u = displacement(problem, space)
    mesh = body_mesh(problem, space, None)
    (grid,) = body_grids(problem, space, mesh, [StoredState(0, 0.0, u)])
    vtk.write_grid(tmp_path / "body.vtu", grid, 0.0, {})
    read = ReadGrid(tmp_path / "body.vtu")
    n_y = mesh.ends[1].size - 1
    names = ("deformation gradient [1]", "first Piola-Kirchhoff stress [E0]", "Cauchy stress [E0]", "I1 [1]")
    gauss = [(np.polynomial.legendre.leggauss(degree + 1)[0] + 1) / 2 for degree in BODIES[name][2]]
    for cell in range(read.grid.GetNumberOfCells()):
        i, j = divmod(cell, n_y)
        for s, t in (*product(*gauss), (0.5, 0.5)):
            at = np.array([[between(mesh.ends[0], i, s)]]), np.array([[between(mesh.ends[1], j, t)]])
            own = fields_at(problem, space, u, *at)
            F, P, sigma = (
                field[0, 0, 0, 0]
                for field in (own.deformation_gradient, own.nominal_stress, own.cauchy_stress)
            )
            F = np.block([[F, np.zeros((2, 1))], [np.zeros((1, 2)), np.ones((1, 1))]])
            symmetric = sigma[[0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]
            expected = [F.ravel(), P.ravel(), symmetric, own.first_invariant.ravel()]
            # P = J sigma F^-T, also out of the plane: what is written fits together (round-off, E is 1)
            assert np.abs(P - np.linalg.det(F) * sigma @ np.linalg.inv(F).T).max() < 1e-13
            if (s, t) == (0.5, 0.5):
                found = [np.array(read.cell_data[field].GetTuple(cell)) for field in names]
            else:
                _, *found = read.evaluate(cell, (s, t), *names)
            for one, other in zip(found, expected, strict=True):
                # round-off, which interpolation at up to six points multiplies by less than 100
                assert np.abs(one - other).max() < 1e-12


@pytest.mark.parametrize("name", ["strip", "half cylinder", "linear rows on an arc", "kinked"])
@pytest.mark.parametrize("side", ["left", "right", "bottom", "top"])
def test_curves_along_a_side(name: str, side: Side, tmp_path: Path) -> None:
    problem, space = body(name, side)
    u = displacement(problem, space)
    (grid,) = side_grids(problem, space, side_mesh(problem, space, None), [StoredState(0, 0.0, u)])
    vtk.write_grid(tmp_path / "side.vtu", grid, 0.0, {})
    read = ReadGrid(tmp_path / "side.vtu")
    vertical = side in ("left", "right")
    knots = np.unique(
        np.concatenate(
            [
                (space.across if vertical else space.rows[0]).breakpoints,
                problem.body.shape.spaces[int(vertical)].breakpoints,
            ]
        )
    )
    ends = np.array([0.1, *knots[(knots > 0.1) & (knots < 0.75)], 0.75])
    assert read.grid.GetNumberOfCells() == ends.size - 1
    across = 0.0 if side in ("left", "bottom") else 1.0
    extent = float(np.ptp(problem.body.shape.control_points))
    points = read.grid.GetCell(0).GetNumberOfPoints()
    gauss = (np.polynomial.legendre.leggauss(points)[0] + 1) / 2
    for cell in range(ends.size - 1):
        for s in (0.0, 0.3, 1.0):
            along = between(ends, cell, s)
            X, d = read.evaluate(cell, (s, 0.0), "displacement [L0]")
            at = (across, along) if vertical else (along, across)
            assert np.abs(np.stack([X, d])[:, :2] - exact(problem, space, u, *at)).max() < 1e-12 * extent
        for s in (*gauss, 0.5):
            here = np.array([[between(ends, cell, s)]])
            own = InterfacePoints(problem, space, here).state(u)
            names = ("gap [L0]", "normal adhesive traction [E0]", "adhesive traction [E0]")
            traction = np.append(own.traction.ravel(), 0.0)
            expected = [own.gap.ravel(), own.normal_traction.ravel(), traction]
            if s == 0.5:
                found = [np.array(read.cell_data[field].GetTuple(cell)) for field in names]
            else:
                _, *found = read.evaluate(cell, (s, 0.0), *names)
            for one, other in zip(found, expected, strict=True):
                # round-off of gaps as large as the body; tractions are of size 1, and steep where it touches
                assert np.abs(one - other).max() < 1e-12 * max(extent, float(np.abs(other).max()) * 100)


def test_equal_weights_are_none() -> None:
    problem, space = body("strip")
    shape = problem.body.shape
    heavy = problem.changed(body=replace(problem.body, shape=replace(shape, weights=3 * shape.weights)))
    u = displacement(problem, space)
    light, grid = (
        next(body_grids(p, space, body_mesh(p, space, None), [StoredState(0, 0.0, u)]))
        for p in (problem, heavy)
    )
    assert grid.weights is None
    assert grid.degrees == light.degrees == (3, 1)
    np.testing.assert_array_equal(grid.points, light.points)


def test_what_has_no_stress_is_nan(tmp_path: Path) -> None:
    """An element inside out, and the two corners of a half cylinder where sides meet without a corner."""
    problem, space = body("strip")
    u = np.zeros((space.size, 2))
    bottom = space.side_functions("bottom")
    # a function of the third element goes beyond the fourth
    u[bottom[4]] = (60.0, 0.0)
    (grid,) = body_grids(problem, space, body_mesh(problem, space, None), [StoredState(0, 0.0, u)])
    vtk.write_grid(tmp_path / "body.vtu", grid, 0.0, {})
    read = ReadGrid(tmp_path / "body.vtu")
    stress = read.at_points("Cauchy stress [E0]").reshape(12 * 3, -1)
    lost = np.isnan(stress).all(axis=1)
    assert np.isfinite(stress[~lost]).all()
    assert 0 < lost.sum() < 6
    assert np.isfinite(read.at_points("displacement [L0]")).all()
    assert np.isfinite(read.at_points("deformation gradient [1]")).all()
    problem, space = body("half cylinder")
    rest = np.zeros((space.size, 2))
    (straight,) = body_grids(problem, space, body_mesh(problem, space, 2), [StoredState(0, 0.0, rest)])
    (whole,) = body_grids(problem, space, body_mesh(problem, space, None), [StoredState(0, 0.0, rest)])
    at_points, in_cells = (
        np.isnan(data["I1 [1]"]).sum() for data in (straight.point_data, straight.cell_data)
    )
    assert (at_points, in_cells) == (2, 0)
    # Gauss points are not at corners; round-off of a body at rest
    assert np.abs(whole.point_data["I1 [1]"]).max() < 1e-9
