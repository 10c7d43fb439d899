"""A case file of one body: what it means, with and without its defaults, and with other values."""

import numpy as np
from case_texts import STRIP, case_with

from isopeel.case import Case, OneBody, load_case, with_options
from isopeel.physics.adhesion import (
    Bilinear,
)
from isopeel.physics.substrates import Flat
from isopeel.problem import Boundary, RotatedSide, Support, strip


def test_the_shipped_strip_is_the_one_of_the_literature() -> None:
    case = load_case("strip")
    problem, published = case.problem(), strip()
    # exactly: quantities are converted without rounding
    assert problem.body.material == published.body.material
    assert problem.adhesion == published.adhesion
    assert (problem.supports, problem.drive, problem.name) == (
        published.supports,
        published.drive,
        published.name,
    )
    assert np.array_equal(problem.body.shape.control_points, published.body.shape.control_points)
    assert (case.space().name, case.space().elements) == ("N2.1", (200, 10))
    assert case.reading is not None
    assert case.reading.window == (98.0, 101.4)


def test_sections_with_defaults_may_be_left_out() -> None:
    start = STRIP.index("[discretization]")
    case = Case.parse(STRIP[:start].replace('traction = "reference"', ""))
    full = load_case("strip")
    assert isinstance(case, OneBody)
    assert isinstance(full, OneBody)
    # the published strip is linear across, which is no default
    usual = full.discretization.model_copy(update={"across_degree": None, "mesh": None})
    assert (case.discretization, case.drive, case.adhesion) == (
        usual,
        full.drive,
        full.adhesion,
    )
    assert case.reading is None


def test_what_is_left_out_is_the_strip_s() -> None:
    case = Case.parse(case_with())
    (stage,) = case.stages()
    problem = stage.problem
    assert problem.drive == RotatedSide("right")
    assert problem.supports == (Support(Boundary("body", "left"), (0,)),)
    assert problem.adhesion.law == Bilinear(0.05, 0.015, 0.2, equilibrium_gap=0.3)
    assert problem.adhesion.substrate == Flat(-0.3)
    assert (problem.adhesion.start, problem.adhesion.end) == (0.0, 1.0)
    assert problem.adhesion.sliding_length is None
    assert np.array_equal(stage.parameters, load_case("strip").stages()[0].parameters)
    assert stage.fields_every == 10.0
    assert Case.parse(case.text) == case


def test_overrides_give_a_new_case_that_can_be_read_back() -> None:
    case = load_case("strip")
    other = with_options(case, space="L1+N2", mesh="20x2", to=3.0, step=0.5, traction="projected")
    assert case == load_case("strip")
    assert (other.discretization.space, other.space().elements) == ("L1+N2", (20, 2))
    (drive,) = other.drive
    assert (drive.to, drive.step, other.problem().adhesion.traction) == ("3.0 deg", "0.5 deg", "projected")
    assert Case.parse(other.text) == other
    assert Case.parse(case.text) == case
