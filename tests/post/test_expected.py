"""Closed forms are shown where they are valid, and nowhere else."""

from dataclasses import replace

import numpy as np
import pytest

from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.materials import NeoHooke
from isopeel.physics.materials.prestretched import Prestretched
from isopeel.physics.substrates import Flat
from isopeel.post.closed_form import expected, kendall_force, sliding_tape_force
from isopeel.problem import Body, Boundary, Problem, PulledSide, RotatedSide, Support, strip
from isopeel.splines.rows import row_space

SPACE = row_space("N2", (160, 3))
STIFFNESS = 4.0 / (1 - 0.2**2)


def tape(angle_deg: float, sliding_length: float | None = 0.3) -> Problem:
    made = strip(length=160.0, height=4.0, adhering_length=140.0)
    adhesion = replace(made.adhesion, sliding_length=sliding_length)
    return made.changed(adhesion=adhesion, drive=PulledSide("right", np.radians(angle_deg)))


def test_a_held_and_a_sliding_tape() -> None:
    work = tape(30).adhesion.law.work_of_adhesion
    held, sliding = expected(tape(30), SPACE), expected(tape(30, None), SPACE)
    assert held is not None
    assert sliding is not None
    assert held.reaction == pytest.approx(kendall_force(work, STIFFNESS, np.pi / 6), rel=1e-12)
    assert sliding.reaction == pytest.approx(sliding_tape_force(work, STIFFNESS, np.pi / 6), rel=1e-12)
    assert held.period == pytest.approx(1 - np.cos(np.pi / 6), rel=1e-12)  # elements of 1
    assert expected(tape(30), row_space("N2", (160, 3), 1, (2.0, 1.0))).period is None  # type: ignore[union-attr]


def test_a_tape_pulled_at_its_left_end_is_the_mirror_image() -> None:
    right = tape(60)
    adhesion = replace(right.adhesion, boundary=right.body.side("bottom", 20 / 160))
    left = right.changed(
        adhesion=adhesion,
        drive=PulledSide("left", np.radians(120)),
        supports=(Support(Boundary("body", "right"), (0,)),),
    )
    one, other = expected(left, SPACE), expected(right, SPACE)
    assert one is not None
    assert other is not None
    assert one.reaction == pytest.approx(other.reaction, rel=1e-12)


def prestretched(problem: Problem, stretch: float) -> Problem:
    return problem.changed(body=Body(problem.body.shape, Prestretched(NeoHooke(1.0, 0.2), stretch)))


@pytest.mark.parametrize(
    "problem",
    [
        pytest.param(tape(-60), id="into the substrate"),
        pytest.param(tape(240), id="into the substrate, by its supplement"),
        pytest.param(tape(0, None), id="along the substrate"),
        pytest.param(replace(tape(60), drive=PulledSide("right", 1.0, follows=True)), id="following"),
        pytest.param(replace(tape(60), drive=PulledSide("right", 1.0, control="force")), id="force raised"),
        pytest.param(
            replace(tape(60), drive=PulledSide(Boundary("", "right", 0.5), 1.0)), id="half of the end"
        ),
        pytest.param(
            tape(60).changed(supports=(Support(Boundary("body", "bottom"), (1,)),)), id="held below"
        ),
        pytest.param(
            tape(60).changed(adhesion=replace(tape(60).adhesion, against=Flat(-5.0))), id="far away"
        ),
        pytest.param(
            tape(60).changed(adhesion=replace(tape(60).adhesion, boundary=Boundary("body", "bottom", 0.2))),
            id="adhering in the middle",
        ),
        pytest.param(
            tape(90, None).changed(
                adhesion=replace(tape(90, None).adhesion, law=Mirrored(strip().adhesion.law))
            ),
            id="half of a cantilever",
        ),
        pytest.param(prestretched(tape(60), 1.1), id="so tense that it comes off"),
        pytest.param(prestretched(tape(60, None), 1.01), id="tense and sliding"),
        pytest.param(
            prestretched(replace(tape(60), drive=RotatedSide("right")), 1.01), id="tense and turned"
        ),
        pytest.param(strip(length=60.0, height=10.0, adhering_length=50.0), id="not slender"),
    ],
)
def test_no_closed_form_is_given_outside_of_theory(problem: Problem) -> None:
    assert expected(problem, SPACE) is None
