"""Case files of several bodies that are refused, in one line."""

import re

import pytest
from tape_texts import TWO, changed

from isopeel import InputError
from isopeel.case import Case, load_case, with_options

UPPER_NAME, LOWER_NAME = 'name = "upper"', 'name = "lower"'
LAW = 'law = "van-der-waals"'
BAD: list[tuple[str, str, str, str]] = [
    (LOWER_NAME, UPPER_NAME, "body.2.name", "each body needs a name of its own"),
    (LOWER_NAME, 'name = "a.b"', "body.2.name", "a name of letters, digits"),
    (LOWER_NAME, "", "body.2.name", "the key is missing; a name of letters"),
    ('"lower.bottom"', '"pad.bottom"', "interface.2.boundary", "the bodies are upper, lower"),
    ('"lower.bottom"', '"lower.front"', "interface.2.boundary", "the sides are left, right, bottom, top"),
    ('"lower.bottom"', '"lower"', "interface.2.boundary", "BODY.SIDE"),
    ('"lower.bottom"', "3", "interface.2.boundary", "BODY.SIDE"),
    ('"lower.top"', '"pad.top"', "support.2.boundary", "the bodies are upper, lower"),
    ('"upper.right"', '"pad.right"', "drive.boundary", "the bodies are upper, lower"),
    ('"upper.right"', '"upper.front"', "drive.boundary", "the sides are left, right, bottom, top"),
    ('boundary = "upper.right"', 'side = "right"', "drive.side", "in place of a side"),
    ('boundary = "upper.bottom"', "", "interface.1.boundary", "the key is missing; a boundary is needed"),
    (LAW, f"{LAW}\nscheme = 'biased'", "interface.1.scheme", "an interface with a substrate has none"),
    ('boundary = "upper.right"', "", "drive.boundary", "the key is missing; a boundary is needed"),
    ("prestretch = 1.1", "prestretch = '1'", "body.2.material.prestretch", "a number is needed"),
    ('law = "neo-hooke"', 'law = "steel"', "body.1.material.law", "one of these laws is needed"),
    ('youngs_modulus = "1 GPa"', 'youngs_modulus = "1 N"', "body.2.material.youngs_modulus", "a stress"),
    ("poissons_ratio = 0.3", "poissons_ratio = 0.7", "body.2.material.poissons_ratio", ""),
    (LAW, 'law = "glue"', "interface.1.law", "one of these laws is needed"),
    (LAW, "", "interface.1.law", "one of these laws is needed"),
    (LAW, f'{LAW}\ntraction = "shear"', "interface.1.traction", "'reference' or 'projected'"),
    (LAW, f"{LAW}\nbetween = ['upper.bottom', 'lower.top']", "interface.1.boundary", "or of a boundary"),
    (LAW, f"{LAW}\nsubstrate = {{ kind = 'hill' }}", "interface.1.substrate.kind", "one of these kinds"),
    (LAW, f"{LAW}\nsubstrate = {{ hight = '1 nm' }}", "interface.1.substrate.hight", "the keys are gap"),
    (LAW, f"{LAW}\nsubstrate = 'flat'", "interface.1.substrate", "a table is needed"),
    (LAW, f"{LAW}\nsliding_length = '-1 nm'", "interface.1.sliding_length", "it must be positive"),
    ('length = "15 nm"', 'length = "25 nm"', "interface.1.length", "at most 20"),
    ('length = "15 nm"', 'length = "15 nm"\nstart = "6 nm"', "interface.1.length", "which is 20 nm long"),
    ('length = "15 nm"', 'start = "21 nm"', "interface.1.start", "which is 20 nm long"),
    ('length = "15 nm"', "end = 1.5", "interface.1.end", "a number is the parameter along the side"),
    ('length = "15 nm"', "start = 0.5\nend = 0.5", "interface.1.end", "beyond the start"),
    ('length = "15 nm"', "length = '5 nm'\nstart = 0.1\nend = 0.5", "interface.1.length", "not with both"),
    ('length = "15 nm"', "start = true", "interface.1.start", "a number from 0 to 1"),
    ('start = "6 nm"', 'start = "6 N"', "interface.2.start", "a length is needed"),
    ('holds = "x"', 'holds = "z"', "support.1.holds", "'x', 'y' or 'xy' is needed"),
    ('holds = "x"', "", "support.1.holds", "the key is missing; 'x', 'y' or 'xy'"),
    ('at = ["0 nm", "10 nm"]', 'at = ["0 nm"]', "body.1.at", "a list of 2 is needed"),
    ('at = ["0 nm", "10 nm"]', 'at = ["0 nm", "1 Pa"]', "body.1.at", "a length is needed"),
    ('at = ["0 nm", "10 nm"]', 'rotated = "10 nm"', "body.1.rotated", "an angle is needed"),
    ('height = "2 nm"', 'height = "-2 nm"', "body.1.height", "it must be positive"),
    ('height = "2 nm"', 'hight = "2 nm"', "body.1.hight", "there is no such key"),
    ('mesh = "20x2"', 'mesh = "20"', "body.1.mesh", "elements along length x height"),
    ('mesh = "20x2"', 'mesh = "20x20000"', "body.1.mesh", ""),
    ('space = "L1+N2"', 'space = "Q"', "body.1.space", ""),
    ('mesh = "16x2"', 'mesh = "16"', "discretization.mesh", "elements along length x height"),
    ("[discretization]", "[adhesion]\n[discretization]", "adhesion", "each adhesion is an [[interface]]"),
    ("[discretization]", "[held]\n[discretization]", "held", "is a [[support]]"),
    ("[discretization]", "[material]\n[discretization]", "material", "a table in its [[body]]"),
]


@pytest.mark.parametrize(("old", "new", "field", "allowed"), BAD)
def test_bad_values_name_their_key_and_what_is_allowed(old: str, new: str, field: str, allowed: str) -> None:
    with pytest.raises(InputError) as caught:
        Case.parse(changed(old, new))
    assert caught.value.field == field
    assert allowed in caught.value.allowed
    assert str(caught.value).count("\n") == 0


SHORT = load_case("strip").text


@pytest.mark.parametrize(
    ("text", "field", "allowed"),
    [
        ("body = []\n" + TWO[: TWO.index("[[body]]")], "body", "a table [[body]] is needed for each body"),
        (TWO[: TWO.index("[[body]]")] + "[[support]]\n", "body", "a table [[body]] is needed"),
        (SHORT + "[[support]]\n", "body", "with [[support]] each body is a [[body]] with a name"),
        (SHORT.replace("[drive]", "[drive]\nboundary = 'body.right'"), "drive.boundary", "a side in place"),
        (
            re.sub(r"\[\[support\]\]\nboundary = \"lower(.*\n)+?\n", "", TWO).replace(
                "lower.bottom", "upper.top"
            ),
            "body.2.name",
            "nothing holds or drives this body",
        ),
    ],
)
def test_forms_that_are_mixed_or_empty_are_refused(text: str, field: str, allowed: str) -> None:
    with pytest.raises(InputError) as caught:
        Case.parse(text)
    assert caught.value.field == field
    assert allowed in caught.value.allowed


@pytest.mark.parametrize("table", ["interface", "support"])
def test_an_empty_list_is_refused(table: str) -> None:
    text = re.sub(rf"\[\[{table}\]\]\n(.+\n)+", "", TWO)
    with pytest.raises(InputError) as caught:
        Case.parse(f"{table} = []\n{text}")
    assert caught.value.field == table
    assert f"a table [[{table}]] is needed" in caught.value.allowed


def test_widths_of_bodies_must_agree() -> None:
    wide = changed('length = "30 nm"', 'length = "30 nm"\nwidth = "1 mm"')
    assert Case.parse(wide).width == 1e6
    with pytest.raises(InputError, match=r"body\.2\.width: '1 mm' cannot be used; all bodies have one width"):
        Case.parse(wide.replace('length = "20 nm"', 'length = "20 nm"\nwidth = "2 mm"'))


@pytest.mark.parametrize(
    ("table", "field"),
    [("interface", "interface"), ("support", "support"), ("load", "load"), ("drive.on", "drive.on")],
)
def test_a_table_in_place_of_a_list_is_refused_without_its_content(table: str, field: str) -> None:
    text = re.sub(rf"\[\[{table}\]\]\n(.+\n)+", "", TWO)
    with pytest.raises(InputError) as caught:
        Case.parse(f'{text}[{table}]\nboundary = "upper.left"\n')
    allowed = f"write [[{table}]], as a case may have several of them"
    assert str(caught.value) == f"{field}: '[{table}]' cannot be used; {allowed}"


def test_the_stage_of_such_a_table_is_numbered() -> None:
    text = TWO.replace("[drive]", "[[drive]]") + '[drive.on]\nboundary = "upper.left"\n'
    with pytest.raises(InputError, match=r"^drive\.1\.on: '\[drive\.on\]' cannot be used; write \[\[drive"):
        Case.parse(text)


@pytest.mark.parametrize(("option", "value"), [("space", "N3"), ("mesh", "8x1")])
def test_an_option_that_each_body_has_as_its_own_key_is_refused(option: str, value: str) -> None:
    """It would have no effect."""
    case = Case.parse(TWO).with_values({f"body.2.{option}": value})
    with pytest.raises(InputError) as caught:
        with_options(case, **{option: value})  # type: ignore[arg-type]
    assert (caught.value.field, caught.value.value) == (f"--{option}", value)
    assert f"each body has its own {option}; set body.1.{option}" in caught.value.allowed


def test_traction_without_an_interface_is_refused() -> None:
    case = Case.parse(re.sub(r"\[\[interface\]\]\n(.+\n)+", "", TWO))
    with pytest.raises(
        InputError, match=r"^--traction: 'projected' cannot be used; the case has no \[\[interface\]\]"
    ):
        with_options(case, traction="projected")


@pytest.mark.parametrize(("old", "new"), [("upper.right", "upper.front"), ('boundary = "upper.right"', "")])
def test_the_only_table_of_a_list_has_the_number_by_which_it_is_set(old: str, new: str) -> None:
    with pytest.raises(InputError) as caught:
        Case.parse(TWO.replace("[drive]", "[[drive]]").replace(old, new))
    assert caught.value.field == "drive.1.boundary"
