"""Case files of several bodies, interfaces and supports: what they mean, and what is refused."""

import pickle
import re
from math import pi

import numpy as np
import pytest

from isopeel import Circle, Flat, InputError, Mirrored, NeoHooke
from isopeel.case import Case, SeveralBodies, load_case, with_options
from isopeel.problem import Boundary, Support

TWO = """
name = "two-tapes"

[[body]]
name = "upper"
length = "20 nm"
height = "2 nm"
at = ["0 nm", "10 nm"]
material = { law = "neo-hooke", youngs_modulus = "2 GPa", poissons_ratio = 0.2 }
space = "L1+N2"
mesh = "20x2"
across_degree = 1

[[body]]
name = "lower"
length = "30 nm"
height = "2 nm"
material = { law = "neo-hooke", youngs_modulus = "1 GPa", poissons_ratio = 0.3, prestretch = 1.1 }

[[interface]]
boundary = "upper.bottom"
law = "van-der-waals"
hamaker_constant = "1e-19 J"
equilibrium_distance = "0.4 nm"
length = "15 nm"

[[interface]]
boundary = "lower.bottom"
law = "exponential"
strength = "80 MPa"
work_of_adhesion = "0.03 J/m^2"
start = "6 nm"
end = 0.8
irreversible = true

[[support]]
boundary = "upper.left"
holds = "x"

[[support]]
boundary = "lower.top"
length = "3 nm"
holds = "xy"

[discretization]
space = "N2"
mesh = "16x2"

[drive]
boundary = "upper.right"
to = "10 deg"
step = "1 deg"
"""


def changed(old: str, new: str) -> str:
    assert old in TWO
    return TWO.replace(old, new, 1)


def test_bodies_interfaces_and_supports_are_those_of_the_tables() -> None:
    case = Case.parse(TWO)
    problem = case.problem()
    upper, lower = problem.bodies
    assert [body.name for body in problem.bodies] == ["upper", "lower"]
    assert upper.material == NeoHooke(1.0, 0.2)
    corners = [upper.shape.evaluate(*place).tolist() for place in ((0, 0), (1, 1))]
    assert corners == [[0.0, 10.0], [20.0, 12.0]]
    assert lower.shape.evaluate(1.0, 0.0).tolist() == [30.0, 0.0]
    first, second = problem.interfaces
    assert first.boundary == Boundary("upper", "bottom", 0.0, 0.75)
    # at the equilibrium gap below the face, which lies at 10 nm; exactly
    assert first.substrate == Flat(10.0 - first.law.equilibrium_gap)
    assert second.boundary == Boundary("lower", "bottom", 0.2, 0.8)
    assert (second.irreversible, second.substrate) == (True, Flat(0.0))
    assert problem.supports == (
        Support(Boundary("upper", "left"), (0,)),
        Support(Boundary("lower", "top", 0.0, 0.1), (0, 1)),
    )
    assert {name: (space.name, space.elements) for name, space in case.spaces().items()} == {
        "upper": ("L1+N2", (20, 2)),
        "lower": ("N2", (16, 2)),
    }
    # 2 of bodies that bend, but for one that has a degree of its own
    assert [space.across.degree for space in case.spaces().values()] == [1, 2]
    with pytest.raises(InputError, match="this is known for one body only"):
        case.space()


def test_a_case_can_be_read_back() -> None:
    case = Case.parse(TWO)
    assert isinstance(case, SeveralBodies)
    assert Case.parse(case.text) == case


@pytest.mark.parametrize("case", [Case.parse(TWO), load_case("strip")])
def test_a_case_goes_to_another_process(case: Case) -> None:
    assert pickle.loads(pickle.dumps(case)) == case


def test_one_body_is_the_problem_of_the_short_form() -> None:
    """To the last bit: the short form of the strip, written as lists of one."""
    strip = load_case("strip")
    tables = {
        "[body]": '[[body]]\nname = "body"\nmaterial = { law = "neo-hooke", youngs_modulus = "2 GPa",'
        " poissons_ratio = 0.2 }",
        "[adhesion]": '[[interface]]\nboundary = "body.bottom"',
        "[drive]": '[[support]]\nboundary = "body.left"\nholds = "x"\n[drive]\nboundary = "body.right"',
    }
    text = re.sub(r"\[material\]\n(.+\n)+", "", strip.text)
    for old, new in tables.items():
        assert old in text
        text = text.replace(old, new)
    text = re.sub(r"(?m)^side = .*\n", "", text)
    case = Case.parse(text)
    (one,), (other,) = case.stages(), strip.stages()
    assert one.problem.interfaces == other.problem.interfaces
    assert one.problem.supports == other.problem.supports
    assert one.problem.body.material == other.problem.body.material
    np.testing.assert_array_equal(
        one.problem.body.shape.control_points, other.problem.body.shape.control_points
    )
    for found, expected in zip(case.space().rows, strip.space().rows, strict=True):
        np.testing.assert_array_equal(found.knot_vector, expected.knot_vector)
    np.testing.assert_array_equal(case.space().across.knot_vector, strip.space().across.knot_vector)


@pytest.mark.parametrize(
    ("side", "height", "angle"),
    [
        ("bottom", -0.25, pi / 2),
        ("top", -2.25, -pi / 2),
        ("left", -0.25, 0.0),
        ("right", -20.25, pi),
    ],
)
def test_a_plane_lies_along_any_side(side: str, height: float, angle: float) -> None:
    """It faces the body: of one 20 nm long and 2 nm high whose corner is the origin, a quarter off."""
    text = changed('at = ["0 nm", "10 nm"]', "").replace("upper.bottom", f"upper.{side}")
    text = text.replace('length = "15 nm"', 'substrate = { gap = "0.25 nm" }')
    (first, _) = Case.parse(text).problem().interfaces
    assert isinstance(first.substrate, Flat)
    assert first.substrate.height == height  # sums of numbers that are exact
    assert first.substrate.angle == pytest.approx(angle, abs=1e-15)  # an arc tangent of zero and one


def test_a_body_is_turned_and_then_moved() -> None:
    text = changed('at = ["0 nm", "10 nm"]', 'at = ["1 nm", "10 nm"]\nrotated = "90 deg"')
    problem = Case.parse(text).problem()
    ends = [problem.bodies[0].shape.evaluate(*place).tolist() for place in ((0, 0), (1, 0), (1, 1))]
    assert ends == [[1.0, 10.0], [1.0, 30.0], [-1.0, 30.0]]  # a quarter turn is exact
    # the lower face now looks along x, and so the plane looks along -x
    assert problem.interfaces[0].substrate.parameters.tolist() == pytest.approx(
        [-1.0 - problem.interfaces[0].law.equilibrium_gap, -1.0, 0.0], abs=1e-15
    )


def test_a_substrate_of_a_kind_lies_where_its_table_says() -> None:
    round_one = (
        'substrate = { kind = "circle", radius = "50 nm", centre = ["0 nm", "-40.5 nm"], gap = "0.5 nm" }'
    )
    text = changed('length = "15 nm"', f'length = "15 nm"\n{round_one}')
    (first, _) = Case.parse(text).problem().interfaces
    assert first.substrate == Circle(49.5, "inside", (0.0, -40.5))
    mirrored = changed('length = "15 nm"', 'length = "15 nm"\nsymmetric = true')
    assert isinstance(Case.parse(mirrored).problem().interfaces[0].law, Mirrored)


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


def test_values_are_set_by_the_numbers_of_tables() -> None:
    case = Case.parse(TWO)
    other = case.with_values(
        {"body.2.mesh": "8x1", "interface.1.length": "10 nm", "support.2.holds": "y", "body.1.at": None}
    )
    problem = other.problem()
    assert other.spaces()["lower"].elements == (8, 1)
    assert problem.interfaces[0].boundary.end == 0.5
    assert problem.supports[1].components == (1,)
    assert problem.bodies[0].shape.evaluate(0, 0).tolist() == [0.0, 0.0]
    assert case == Case.parse(TWO)


def test_options_set_the_keys_of_all_tables() -> None:
    case = with_options(Case.parse(TWO), space="N3", mesh="9x1", traction="projected", to="5")
    assert case.spaces()["lower"].elements == (9, 1)
    # a key of a body counts before that of all
    assert (case.spaces()["upper"].name, case.spaces()["lower"].name) == ("L1+N2", "N3")
    first, second = case.problem().interfaces
    assert {first.traction, second.traction} == {"projected"}
    assert case.drive[0].to == "5.0 deg"


def test_stages_may_drive_different_bodies() -> None:
    stage = 'boundary = "lower.right"\nto = "1 deg"\nstep = "1 deg"\n'
    case = Case.parse(TWO.replace("[drive]", "[[drive]]") + "[[drive]]\n" + stage)
    driven = [one.boundary.body for stage in case.stages() for one in stage.problem.driven]
    assert driven == ["upper", "lower"]


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
    ('boundary = "upper.right"', "", "drive.boundary", "the key is missing; a boundary is needed"),
    ("prestretch = 1.1", "prestretch = '1'", "body.2.material.prestretch", "a number is needed"),
    ('law = "neo-hooke"', 'law = "steel"', "body.1.material.law", "one of these laws is needed"),
    ('youngs_modulus = "1 GPa"', 'youngs_modulus = "1 N"', "body.2.material.youngs_modulus", "a stress"),
    ("poissons_ratio = 0.3", "poissons_ratio = 0.7", "body.2.material.poissons_ratio", ""),
    (LAW, 'law = "glue"', "interface.1.law", "one of these laws is needed"),
    (LAW, "", "interface.1.law", "one of these laws is needed"),
    (LAW, f'{LAW}\ntraction = "shear"', "interface.1.traction", "'reference' or 'projected'"),
    (LAW, f"{LAW}\nbetween = ['upper.bottom', 'lower.top']", "interface.1.between", "not there yet"),
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
