"""The grammar of space names, good and bad."""

import pytest

from isopeel.common.errors import InputError
from isopeel.splines.names import SpaceName, SplineFamily, parse_space_name


@pytest.mark.parametrize(
    ("name", "degree", "continuity", "canonical"),
    [
        ("L1", 1, 0, "L1"),
        ("L2", 2, 0, "L2"),
        ("L4", 4, 0, "L4"),
        ("L20", 20, 0, "L20"),
        ("N1", 1, 0, "L1"),
        ("N2", 2, 1, "N2"),
        ("N4", 4, 3, "N4"),
        ("N6", 6, 5, "N6"),
        ("N8", 8, 7, "N8"),
        ("N20", 20, 19, "N20"),
        ("N2.1", 3, 1, "N2.1"),
        ("N4.1", 5, 3, "N4.1"),
        ("N2.3", 5, 1, "N2.3"),
        ("N1.3", 4, 0, "L4"),
        ("N19.1", 20, 18, "N19.1"),
        ("H1", 1, 0, "L1"),
        ("H3", 3, 1, "N2.1"),  # piecewise cubics with one continuous derivative are both
        ("H5", 5, 2, "N3.2"),
        ("H7", 7, 3, "N4.3"),
    ],
)
def test_plain_names(name: str, degree: int, continuity: int, canonical: str) -> None:
    family = SplineFamily(degree, continuity)
    assert parse_space_name(name) == SpaceName(family, family, 0)
    assert str(parse_space_name(name)) == canonical


@pytest.mark.parametrize(
    ("name", "bulk", "contact", "rows", "canonical"),
    [
        ("L1+N2.1", (1, 0), (3, 1), 1, "L1+N2.1"),
        ("L1+N2.1@1", (1, 0), (3, 1), 1, "L1+N2.1"),
        ("N2+N4@2", (2, 1), (4, 3), 2, "N2+N4@2"),
        ("L1+H5@12", (1, 0), (5, 2), 12, "L1+N3.2@12"),
        ("Q1N2", (1, 0), (2, 1), 1, "L1+N2"),
        ("Q1N2.1", (1, 0), (3, 1), 1, "L1+N2.1"),
        ("Q1N4.3", (1, 0), (7, 3), 1, "L1+N4.3"),
        ("Q1C4", (1, 0), (4, 0), 1, "L1+L4"),
        ("Q1CH", (1, 0), (3, 1), 1, "L1+N2.1"),
        ("L2+L2", (2, 0), (2, 0), 0, "L2"),
        ("H3+N2.1@4", (3, 1), (3, 1), 0, "N2.1"),
        ("Q1N1", (1, 0), (1, 0), 0, "L1"),
    ],
)
def test_names_with_contact_rows(
    name: str, bulk: tuple[int, int], contact: tuple[int, int], rows: int, canonical: str
) -> None:
    parsed = parse_space_name(name)
    assert parsed == SpaceName(SplineFamily(*bulk), SplineFamily(*contact), rows)
    assert str(parsed) == canonical
    assert parse_space_name(canonical) == parsed


# fmt: off
BAD = [
    "N", "L", "L0", "N0", "H4", "H0", "N2.", "N2.0", "N02", "L1+", "+L1", "L1+N2@", "L1+N2@0", "L1+N2@-1",
    "L1+N2@1.5", "L1+N2@02", "Q1", "Q2N2", "Q1C", "Q1H3", "Q1CH5", "Q1N2@2", "Q1N2+L1", "N2.1.1", "L1@2",
    "n2", "l1", "q1ch", "N2+N4+N6", "N25", "L21", "H21", "N20.1", "N2.99999", "L1+N25", "Q1C21", "Q1N20.1",
    "L-1", "L1.5", "L²", "L٣", "X3", "2", "N+2", "", " ", " N2", "N2 ", "N2\n", "L1 + N2", "L1+ N2",
    "L" + "9" * 5000,
]
# fmt: on


@pytest.mark.parametrize("name", BAD)
def test_other_names_are_refused_with_examples_of_every_form(name: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_space_name(name)
    assert (caught.value.field, caught.value.value) == ("space", name)
    message = str(caught.value)
    assert "\n" not in message
    for example in ("L2", "N4", "N2.1", "H3", "L1+N2.1", "N2+N4@2", "Q1N2.1", "Q1C4", "Q1CH"):
        assert example in message
        parse_space_name(example)


def test_families_and_rows_that_contradict_are_refused() -> None:
    linear, cubic = SplineFamily(1, 0), SplineFamily(3, 1)
    with pytest.raises(InputError, match="contact_rows: 2 cannot be used; with one family"):
        SpaceName(linear, linear, 2)
    with pytest.raises(InputError, match="it must be 1 or more"):
        SpaceName(linear, cubic, 0)
    with pytest.raises(InputError, match="continuity: 3"):
        SplineFamily(3, 3)
    with pytest.raises(InputError, match="degree: 21"):
        SplineFamily(21, 0)
