"""Cases of one body with several interfaces and supports: on two faces, in patches, on parts of a side."""

import numpy as np
import pytest

from isopeel import Step, VanDerWaals
from isopeel.case import Case
from isopeel.solve.trace import trace

STRIP = """
name = "strip"
[[body]]
name = "strip"
length = "20 nm"
height = "2 nm"
material = { law = "neo-hooke", youngs_modulus = "2 GPa", poissons_ratio = 0.2 }
space = "N2"
mesh = "20x2"
[[support]]
boundary = "strip.left"
holds = "x"
[drive]
boundary = "strip.right"
to = "4 deg"
step = "1 deg"
"""
LAW = 'law = "van-der-waals"\nhamaker_constant = "1e-19 J"\nequilibrium_distance = "0.4 nm"\n'
WORK = VanDerWaals(0.05, 0.4).work_of_adhesion


def interface(boundary: str, *keys: str) -> str:
    """A table of the same law, on some part of a side."""
    return f'[[interface]]\nboundary = "strip.{boundary}"\n{LAW}' + "".join(f"{key}\n" for key in keys)


def steps(text: str) -> list[Step]:
    case = Case.parse(text)
    (stage,) = case.stages()
    return list(trace(stage.problem, case.spaces(), stage.parameters))


def test_a_face_in_two_patches_is_that_of_one() -> None:
    """They meet at the end of an element, so that the Gauss points are the same."""
    whole = steps(STRIP + interface("bottom", 'length = "15 nm"'))
    split = steps(
        STRIP
        + interface("bottom", 'length = "8 nm"')
        + interface("bottom", 'start = "8 nm"', 'end = "15 nm"')
    )
    found, expected = ([step.reaction for step in one] for one in (split, whole))
    # both are converged
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8 * np.abs(expected).max())


def test_a_gap_between_patches_has_no_energy() -> None:
    """At rest each patch has -W per area: of 4 nm, 3.5 nm and 2.5 nm, which end within elements."""
    patches = [("0 nm", "4 nm"), ("6 nm", "9.5 nm"), ("12.5 nm", "15 nm")]
    tables = [interface("bottom", f'start = "{start}"', f'end = "{end}"') for start, end in patches]
    first, *_, last = steps(STRIP + "".join(tables))
    assert first.adhesive_energy == pytest.approx(-10.0 * WORK, rel=1e-12)  # round-off of a sum
    # the last patch, nearest to the drive, opens
    assert last.adhesive_energy > first.adhesive_energy + 1e-4 * WORK


def test_a_strip_between_two_walls_answers_alike_up_and_down() -> None:
    """The planes lie along the faces: by symmetry the force on its end is that of a pull down."""
    text = STRIP.replace('to = "4 deg"\nstep = "1 deg"', "") + interface("bottom") + interface("top")
    pull = 'kind = "displacement"\nto = "0.04 nm"\nstep = "0.01 nm"\nangle = '
    up, down = (
        steps(text.replace("[drive]", f'[drive]\n{pull}"{angle}"')) for angle in ("90 deg", "270 deg")
    )
    assert up[0].adhesive_energy == pytest.approx(-2 * 20.0 * WORK, rel=1e-12)  # round-off of a sum
    one, other = ([step.reaction for step in path] for path in (up, down))
    # both are converged
    np.testing.assert_allclose(one, other, rtol=0, atol=1e-8 * np.abs(one).max())
    assert one[-1] > 0


def test_a_support_holds_a_part_of_a_side_and_no_more() -> None:
    """The upper face is held between 2 nm and 5 nm; the control points there stay, and the others move."""
    held = '[[support]]\nboundary = "strip.top"\nstart = "2 nm"\nlength = "3 nm"\nholds = "xy"\n'
    text = STRIP + held + interface("bottom", 'length = "15 nm"')
    last = steps(text)[-1]
    top = Case.parse(text).spaces()["strip"].side_functions("top")
    size = np.abs(last.displacement[top]).max(axis=1)
    # of 20 quadratic elements, functions 2 to 6 do not vanish on the three
    assert np.flatnonzero(size == 0).tolist() == [2, 3, 4, 5, 6]
    assert size[-1] > 0.01
