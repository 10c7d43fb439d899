"""Parts of sides in a case file: where they lie, and where two must not overlap."""

import pytest
from tape_texts import TWO, changed

from isopeel import InputError
from isopeel.case import Case
from isopeel.problem import Boundary


@pytest.mark.parametrize(
    ("keys", "part"),
    [
        ("", (0.0, 1.0)),
        ('length = "5 nm"', (0.0, 0.25)),
        ('length = "5 nm"\nend = 1.0', (0.75, 1.0)),
        ('length = "5 nm"\nstart = "10 nm"', (0.5, 0.75)),
        ('length = "5 nm"\nend = "15 nm"', (0.5, 0.75)),
        ('start = "5 nm"\nend = 0.5', (0.25, 0.5)),
    ],
)
@pytest.mark.parametrize("side", ["bottom", "top"])
def test_a_part_of_a_side_by_lengths_or_parameters(keys: str, part: tuple[float, float], side: str) -> None:
    text = changed('length = "15 nm"', keys).replace("upper.bottom", f"upper.{side}")
    assert Case.parse(text).problem().interfaces[0].boundary == Boundary("upper", side, *part)  # type: ignore[arg-type]


def test_a_part_of_an_arc_is_found_by_its_length() -> None:
    text = changed('length = "20 nm"', 'shape = "curved-strip"\nlength = "20 nm"\nradius = "15 nm"')
    text = text.replace('length = "15 nm"', 'length = "5 nm"\nend = 1.0\nsubstrate = { kind = "flat" }')
    problem = Case.parse(text).problem()
    curve = problem.bodies[0].shape.boundary("bottom")
    (first, _) = problem.interfaces
    assert first.boundary.end == 1.0
    # the root finder's tolerance
    assert curve.length() - curve.length(first.boundary.start) == pytest.approx(5.0, rel=1e-12)


def test_a_plane_does_not_lie_along_an_arc() -> None:
    text = changed('length = "20 nm"', 'shape = "curved-strip"\nlength = "20 nm"\nradius = "15 nm"')
    with pytest.raises(InputError, match=r"interface\.1\.substrate: .* along a straight boundary only"):
        Case.parse(text)


SECOND = """
[[interface]]
boundary = "upper.bottom"
law = "exponential"
strength = "80 MPa"
work_of_adhesion = "0.03 J/m^2"
{part}
"""


def test_parts_of_a_side_that_overlap_on_one_substrate_are_refused() -> None:
    """Their adhesion would add up unnoticed. The first one ends at 15 nm."""
    with pytest.raises(InputError) as caught:
        Case.parse(TWO + SECOND.format(part='start = "14.9 nm"'))
    assert caught.value.field == "interface.3.boundary"
    assert caught.value.value == "upper.bottom"
    assert "it overlaps interface.1 on the same substrate" in caught.value.allowed
    # the same plane, as a table of its own describes it
    same = 'substrate = { kind = "flat", height = "10 nm", gap = "1 nm" }'
    with pytest.raises(InputError, match=r"overlaps interface\.1 on the same substrate"):
        Case.parse(TWO + SECOND.format(part=same))
    # another substrate attracts it too
    wall = 'substrate = { kind = "flat", height = "-5 nm" }'
    assert len(Case.parse(TWO + SECOND.format(part=wall)).problem().interfaces) == 3


def test_parts_of_a_side_may_meet() -> None:
    """At a place that is a sum of lengths: 0.1 + 0.2 is not 0.3."""
    text = changed('length = "15 nm"', 'start = "0.1 nm"\nlength = "0.2 nm"')
    problem = Case.parse(text + SECOND.format(part='start = "0.3 nm"')).problem()
    first, _, last = (one.boundary for one in problem.interfaces)
    assert first.end > last.start
    assert not first.overlaps(last)


HOLDS = '\n[[support]]\nboundary = "{boundary}"\nholds = "{holds}"\n'


@pytest.mark.parametrize(
    ("boundary", "holds", "before"), [("upper.left", "xy", 1), ("lower.top", "y", 2), ("upper.left", "x", 1)]
)
def test_supports_that_hold_a_component_twice_are_refused(boundary: str, holds: str, before: int) -> None:
    with pytest.raises(InputError) as caught:
        Case.parse(TWO + HOLDS.format(boundary=boundary, holds=holds))
    assert (caught.value.field, caught.value.value) == ("support.3.boundary", boundary)
    assert caught.value.allowed == f"support.{before} already holds a part of it; hold each part once"


def test_supports_may_hold_other_components_or_meet() -> None:
    """The lower tape's upper side is held up to 3 nm, and its left side shares the corner."""
    others = HOLDS.format(boundary="upper.left", holds="y") + HOLDS.format(boundary="lower.left", holds="xy")
    others += HOLDS.format(boundary="lower.top", holds="xy") + 'start = "3 nm"\nend = "4 nm"\n'
    assert len(Case.parse(TWO + others).problem().supports) == 5


def test_a_drive_acts_on_a_part_by_the_keys_of_all_boundaries() -> None:
    text = changed('boundary = "upper.right"', 'boundary = "upper.top"\nlength = "5 nm"\nend = 1.0')
    ((boundary, _),) = Case.parse(text).problem().driven
    assert boundary == Boundary("upper", "top", 0.75, 1.0)
