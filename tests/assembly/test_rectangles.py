"""Elements that are equal rectangles take a shorter way to the same forces and tangent."""

from dataclasses import replace

import numpy as np
import pytest

from isopeel.assembly.system import System
from isopeel.assembly.tables import body_table
from isopeel.problem import strip
from isopeel.splines.nurbs import annulus_sector, rectangle
from isopeel.splines.rows import row_space


@pytest.mark.parametrize("name", ["L1", "L3", "N2", "N3.1", "L1+N2.1"])
@pytest.mark.parametrize("storage", ["symmetric", "general"])
def test_forces_and_tangent_are_those_of_any_elements(name: str, storage: str) -> None:
    system = System(strip(), row_space(name, (12, 3)))
    assert system.body.rectangles.all()
    u, _ = system.state(0.01 * np.random.default_rng(0).standard_normal(system.count), 0.1)
    found = system.equilibrium(u)
    _, matrix = system.linearize(u, storage)  # type: ignore[arg-type]
    tangent = matrix.workspace[:-1].copy()
    body = system.equations.body
    none = np.zeros_like(body.rectangles)
    system.equations = system.equations._replace(body=body._replace(rectangles=none))
    expected = system.equilibrium(u)
    _, matrix = system.linearize(u, storage)  # type: ignore[arg-type]
    # sums in another order
    largest = np.abs(expected.forces).max()
    np.testing.assert_allclose(found.forces, expected.forces, rtol=0, atol=1e-13 * largest)
    assert found.stored_energy == pytest.approx(expected.stored_energy, rel=1e-13)
    largest = np.abs(matrix.workspace[:-1]).max()
    np.testing.assert_allclose(tangent, matrix.workspace[:-1], rtol=0, atol=1e-13 * largest)


@pytest.mark.parametrize(
    ("map_of_points", "expected"),
    [
        ([[2.0, 0.0], [0.0, 0.5]], True),
        ([[0.0, -1.0], [1.0, 0.0]], False),  # turned
        ([[1.0, 0.2], [0.0, 1.0]], False),  # sheared
    ],
)
def test_rectangles_are_told(map_of_points: list[list[float]], expected: bool) -> None:
    shape = rectangle(6.0, 2.0)
    mapped = replace(shape, control_points=shape.control_points @ np.array(map_of_points).T)
    assert (body_table(mapped, row_space("N2", (4, 2))).rectangles == expected).all()


def test_elements_of_several_sizes_and_curved_ones_are_none() -> None:
    space = row_space("L1", (4, 2))
    shape = rectangle(6.0, 2.0).elevate(1, 0)
    points = shape.control_points.copy()
    points[1, :, 0] += 0.5  # the middle ones: elements grow along it
    assert not body_table(replace(shape, control_points=points), space).rectangles.any()
    sector = annulus_sector(1.0, 2.0, 1.0)
    assert not body_table(sector, space.weighted(sector)).rectangles.any()
