"""The elements and the space of a case: as written, and where it names none."""

import re

import numpy as np
import pytest
from case_texts import case_with, changed

from isopeel.case import Case, load_case, parse_mesh
from isopeel.common.errors import InputError


def test_meshes_are_two_numbers() -> None:
    assert parse_mesh("mesh", "160x8") == (160, 8)
    for text in ("160", "160x", "-1x2", "2 x 3", "1.5x2"):
        with pytest.raises(InputError, match=r"length x height"):
            parse_mesh("mesh", text)


@pytest.mark.parametrize(
    ("length", "height", "mesh"),
    [
        ("200 nm", "10 nm", (200, 10)),  # elements as high as long
        ("200 nm", "4 nm", (200, 4)),
        ("100 mm", "0.05 mm", (200, 2)),  # of a tape: two are enough for bending
        ("1 mm", "4 mm", (200, 10)),  # of a block: no more than before
    ],
)
def test_usual_elements_are_as_high_as_long(length: str, height: str, mesh: tuple[int, int]) -> None:
    text = changed('height = "10 nm"', f'height = "{height}"')
    text = re.sub(r"(?m)^mesh = .*$", "", text).replace('length = "200 nm"', f'length = "{length}"')
    # the adhering part is no longer than the body
    case = Case.parse(re.sub(r"(?m)^length = \"150 nm\".*$", "", text))
    assert case.space().elements == mesh


def test_a_quarter_cylinder_is_graded_towards_its_contact() -> None:
    text = re.sub(r"grading = \[[^]]*\]", "", load_case("cylinder-pull-off").text)
    default = Case.parse(re.sub(r"(?m)^mesh = .*$", "", text)).space()
    assert default.elements == (120, 16)
    for ends in (default.rows[0].breakpoints, default.across.breakpoints):
        assert np.diff(ends)[-1] / np.diff(ends)[0] == pytest.approx(20.0)
    # elements that are named are even where the case names no grading
    named = Case.parse(text).space()
    assert np.ptp(np.diff(named.rows[0].breakpoints)) < 1e-12


def test_the_space_takes_degree_and_grading() -> None:
    keys = 'space = "N2"\nmesh = "20x4"\nacross_degree = 2\ngrading = [0.5, 2.0]'
    space = Case.parse(case_with(discretization=keys)).space()
    assert (space.across.degree, space.elements) == (2, (20, 4))
    for spline, ratio in ((space.rows[0], 0.5), (space.across, 2.0)):
        sizes = np.diff(spline.breakpoints)
        assert sizes[-1] / sizes[0] == pytest.approx(ratio, rel=1e-12)  # differences of sums, to round-off


@pytest.mark.parametrize("height", ["1 mm", "0.5 fm"])
def test_elements_that_are_needles_are_refused(height: str) -> None:
    with pytest.raises(InputError, match="one side may be 10000 times the other") as caught:
        Case.parse(changed('height = "10 nm"', f'height = "{height}"'))
    assert (caught.value.field, caught.value.value) == ("discretization.mesh", "200x10")


def test_graded_elements_that_are_needles_are_refused() -> None:
    with pytest.raises(InputError, match="one side may be 10000 times the other"):
        Case.parse(case_with(discretization="grading = [1e6, 1.0]"))
