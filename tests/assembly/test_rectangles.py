"""Elements that are equal rectangles take a shorter way to the same forces and tangent."""

from dataclasses import replace

import numpy as np
import pytest

from isopeel.assembly import tables
from isopeel.assembly.system import System
from isopeel.assembly.tables import body_table
from isopeel.matrix.band import Storage
from isopeel.problem import strip
from isopeel.splines.nurbs import annulus_sector, rectangle
from isopeel.splines.rows import RowSpace, row_space


@pytest.mark.parametrize(
    "space",
    [
        *(row_space(name, (12, 3)) for name in ("L1", "L3", "N2", "N3.1", "L1+N2.1")),
        row_space("N2", (12, 3), across_degree=2),
        row_space("L1", (300, 1)),  # more than are treated together
    ],
)
@pytest.mark.parametrize("storage", ["symmetric", "general"])
def test_forces_and_tangent_are_those_of_any_elements(
    space: RowSpace, storage: Storage, monkeypatch: pytest.MonkeyPatch
) -> None:
    system = System(strip(), space)
    assert system.body.rectangles.all()
    u, _ = system.state(0.01 * np.random.default_rng(0).standard_normal(system.count), 0.1)
    found = system.equilibrium(u)
    _, matrix = system.linearize(u, storage)
    tangent = matrix.workspace[:-1].copy()
    monkeypatch.setattr(tables, "_of_rectangles", lambda *_: False)
    system = System(strip(), space)
    assert not system.body.rectangles.any()
    expected = system.equilibrium(u)
    _, matrix = system.linearize(u, storage)
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
def test_rectangles_are_reported(map_of_points: list[list[float]], expected: bool) -> None:
    shape = rectangle(6.0, 2.0)
    mapped = replace(shape, control_points=shape.control_points @ np.array(map_of_points).T)
    assert (body_table(mapped, row_space("N2", (4, 2))).rectangles == expected).all()


@pytest.mark.parametrize("elements", [7, 1000, 2000])
def test_rectangles_are_reported_whatever_the_round_off_of_their_sizes(elements: int) -> None:
    assert body_table(rectangle(elements, 2.0), row_space("N2", (elements, 1))).rectangles.all()


@pytest.mark.parametrize(("grading", "expected"), [((3.0, 1.0), False), ((1.0, 3.0), True)])
def test_elements_may_grow_across_but_not_along(grading: tuple[float, float], expected: bool) -> None:
    space = row_space("N2", (6, 3), grading=grading)
    assert (body_table(rectangle(6.0, 2.0), space).rectangles == expected).all()


def test_elements_of_several_sizes_and_curved_ones_are_none() -> None:
    space = row_space("L1", (4, 2))
    shape = rectangle(6.0, 2.0).elevate(1, 0)
    points = shape.control_points.copy()
    points[1, :, 0] += 0.5  # the middle ones: elements grow along it
    assert not body_table(replace(shape, control_points=points), space).rectangles.any()
    sector = annulus_sector(1.0, 2.0, 1.0)
    assert not body_table(sector, space.weighted(sector)).rectangles.any()
