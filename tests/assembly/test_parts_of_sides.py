"""Parts of sides: the functions that a support or a drive takes there, and the elements of an interface."""

import numpy as np
import pytest

from isopeel import (
    Body,
    Boundary,
    InputError,
    NeoHooke,
    Problem,
    PulledSide,
    RotatedSide,
    Support,
    row_space,
    trace,
)
from isopeel.assembly.spaces import Spaces
from isopeel.assembly.tables import side_of
from isopeel.splines.nurbs import rectangle

BODY = Body(rectangle(1.0, 0.1), NeoHooke(1.0, 0.2))
#: Elements end at multiples of a tenth.
SPACES = Spaces.on(Problem("parts", (BODY,), (), (), RotatedSide("right")), row_space("N2", (10, 1)))
#: A little more than the breakpoint, by round-off.
BEYOND = 0.1 + 0.2


@pytest.mark.parametrize(("start", "end"), [(0.0, 0.3), (0.3, 0.6), (0.7, 1.0)])
def test_a_part_takes_the_functions_of_its_elements(start: float, end: float) -> None:
    """Of degree 2: as many as elements, and two more."""
    functions = SPACES.boundary(BODY.side("bottom", start, end))
    elements = round(10 * (end - start))
    assert functions.tolist() == list(range(round(10 * start), round(10 * start) + elements + 2))


def test_an_end_at_a_breakpoint_takes_no_element_more_by_round_off() -> None:
    assert BEYOND > 0.3
    for beyond, exact in (((0.0, BEYOND), (0.0, 0.3)), ((np.nextafter(0.3, 0), 0.6), (0.3, 0.6))):
        one, other = (BODY.side("bottom", *part) for part in (beyond, exact))
        np.testing.assert_array_equal(SPACES.boundary(one), SPACES.boundary(other))
        assert side_of(SPACES, one).weights.shape == side_of(SPACES, other).weights.shape


def test_a_part_of_no_length_is_refused() -> None:
    for end in (0.3, BEYOND, 0.2):
        with pytest.raises(InputError, match="need 0 <= start < end <= 1 along the side"):
            Boundary("body", "bottom", 0.3, end)


@pytest.mark.parametrize("follows", [False, True])
def test_a_load_on_a_side_whose_rows_differ_stretches_the_body_evenly(*, follows: bool) -> None:
    """A bar on rollers: u = F L/(E' h), to the share of its strain, 2e-7; it becomes thinner by as much."""
    bar = Body(rectangle(10.0, 2.0), NeoHooke(3.0, 0.2))
    supports = (Support(bar.side("left"), (0,)), Support(bar.side("bottom"), (1,)))
    problem = Problem("bar", (bar,), (), supports, PulledSide("right", 0.0, follows, "force"))
    *_, step = trace(problem, row_space("L1+N4@2", (5, 4)), [0.0, 1e-6])
    assert step.reaction == pytest.approx(1e-6 * 10.0 / (3.0 / (1 - 0.2**2) * 2.0), rel=1e-6)
