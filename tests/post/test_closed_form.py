"""The closed form of the strip against its published figures."""

from dataclasses import replace

import numpy as np
import pytest

from isopeel import Body, Interface, Problem, RotatedSide, strip
from isopeel.post.closed_form import BeamPeeling, beam_peeling
from isopeel.splines.nurbs import annulus_sector


def closed_form(problem: Problem) -> BeamPeeling:
    result = beam_peeling(problem)
    assert result is not None
    return result


def test_published_strip() -> None:
    result = closed_form(strip())
    # half a unit of the last published digit
    assert result.moment == pytest.approx(1.6315, abs=5e-5)
    assert result.radius == pytest.approx(53.2, abs=0.05)
    assert result.onset_deg == pytest.approx(53.8, abs=0.05)


def test_scales_of_the_strip() -> None:
    reference, thick = closed_form(strip()), closed_form(strip(height=40.0, adhering_length=175.0))
    # M grows with h^(3/2), the radius too; half the free length on an eightfold radius: a sixteenth
    assert thick.moment / reference.moment == pytest.approx(8, rel=1e-12)
    assert thick.radius / reference.radius == pytest.approx(8, rel=1e-12)
    assert thick.onset_deg / reference.onset_deg == pytest.approx(1 / 16, rel=1e-12)


def test_a_refined_strip_is_the_same_one() -> None:
    problem = strip()
    shape = problem.body.shape.elevate(2, 0).insert_knots([0.25, 0.75], 0).elevate(1, 1)
    refined = closed_form(problem.changed(body=replace(problem.body, shape=shape)))
    assert refined.moment == pytest.approx(closed_form(problem).moment, rel=1e-12)  # round-off
    assert refined.onset_deg == pytest.approx(closed_form(problem).onset_deg, rel=1e-12)


def test_the_free_part_is_the_one_at_the_drive() -> None:
    problem = strip()
    centred = replace(problem.adhesion, boundary=problem.body.side("bottom", 0.4, 0.9))
    results = {
        side: closed_form(problem.changed(adhesion=centred, drive=RotatedSide(side)))
        for side in ("left", "right")
    }
    # 80 nm are free at the left, 20 at the right
    assert results["left"].onset_deg / results["right"].onset_deg == pytest.approx(4, rel=1e-12)
    assert np.radians(results["right"].onset_deg) * results["right"].radius == pytest.approx(20, rel=1e-12)


def test_other_problems_have_none() -> None:
    problem = strip()
    curved = Body(annulus_sector(10.0, 20.0, 1.0), problem.body.material)
    at_end = Interface(curved.side("right"), problem.adhesion.law, problem.adhesion.substrate)
    assert beam_peeling(problem.changed(body=curved)) is None
    assert beam_peeling(problem.changed(adhesion=at_end)) is None
    assert beam_peeling(replace(problem, drive=RotatedSide("top"))) is None
