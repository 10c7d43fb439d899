"""Shapes and substrates in a case file, and what is held of a shape."""

import numpy as np
import pytest
from case_texts import BACKING, PARTS, case_with

from isopeel.case import Case
from isopeel.physics.substrates import Circle, Flat, Wavy
from isopeel.physics.substrates.formula import FormulaSubstrate
from isopeel.problem import Boundary, Support
from isopeel.problem.shapes import CurvedStrip


@pytest.mark.parametrize(
    ("keys", "substrate"),
    [
        ('kind = "flat"', Flat(-0.3)),
        ('kind = "flat"\nheight = "-1 nm"\ngap = "2 nm"', Flat(-3.0)),
        ('gap = "0 nm"', Flat(0.0)),
        (BACKING + 'gap = "1 nm"', Circle(99.0, "inside", (0.0, -100.0))),
        (BACKING + 'solid = "outside"\ngap = "1 nm"', Circle(101.0, "outside", (0.0, 100.0))),
        (BACKING + 'centre = ["0.1 um", "-2 nm"]\ngap = "0 nm"', Circle(100.0, "inside", (100.0, -2.0))),
        (
            'kind = "wavy"\namplitude = "5 angstrom"\nwavelength = "20 nm"\nphase = "90 deg"\ngap = "1 nm"',
            Wavy(0.5, 20.0, np.pi / 2, -1.5),
        ),
        (
            'kind = "formula"\nformula = "a*sin(x/l)"\ngap = "0.5 nm"\n'
            'constants = { a = "1 nm", l = "3 nm" }',
            FormulaSubstrate("(a*sin(x/l)) - (0.5)", {"a": 1.0, "l": 3.0}),
        ),
    ],
)
def test_every_substrate_can_be_written_and_starts_at_its_gap(keys: str, substrate: object) -> None:
    case = Case.parse(case_with(substrate=keys))
    assert case.problem().adhesion.substrate == substrate
    assert Case.parse(case.text) == case


def test_sides_are_held_as_written() -> None:
    fixed = Case.parse(case_with(head='held = { top = "xy", left = "x", bottom = "y" }')).problem().supports
    found = {(support.side, support.components) for support in fixed}
    assert found == {("top", (0, 1)), ("left", (0,)), ("bottom", (1,))}
    assert Case.parse(case_with(head="held = {}")).problem().supports == ()


def test_shapes_are_chosen_by_name() -> None:
    bent = 'shape = "curved-strip"\nlength = "50 nm"\nheight = "2 nm"\nradius = "100 nm"\nbends = "up"'
    case = Case.parse(case_with(body=bent, adhesion=PARTS["adhesion"] + '\nlength = "25 nm"'))
    shape = CurvedStrip(50.0, 2.0, 100.0, "up")
    expected = shape.surface()
    made = case.problem().body.shape
    assert np.array_equal(made.control_points, expected.control_points)
    assert np.array_equal(made.weights, expected.weights)
    # the middle of an arc, symmetric in its parameter, to the tolerance of the root
    assert case.problem().adhesion.end == pytest.approx(0.5, abs=1e-14)
    assert Case.parse(case.text) == case


def test_the_half_cylinder_is_held_on_top_and_adheres_about_its_lowest_point() -> None:
    body, length = 'shape = "half-cylinder"\nradius = "50 nm"', '\nlength = "20 nm"'
    problem = Case.parse(case_with(body=body, adhesion=PARTS["adhesion"] + length)).problem()
    assert problem.supports == (Support(Boundary("body", "top"), (0,)),)
    lower = problem.body.shape.boundary("bottom")
    start, end = lower.evaluate([problem.adhesion.start, problem.adhesion.end])
    # 10 nm of arc to either side, to the round-off of coordinates of size 50
    assert [start[0], end[0]] == pytest.approx([-50 * np.sin(0.2), 50 * np.sin(0.2)], abs=1e-13)
    written = Case.parse(case_with(body=body, head='held = { left = "y" }')).problem()
    assert written.supports == (Support(Boundary("body", "left"), (1,)),)
