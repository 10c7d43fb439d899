"""Case files of bodies that adhere to each other: what they mean, and which are refused, in one line."""

import re
from math import sqrt

import numpy as np
import pytest
from facing_texts import FACING, changed

from isopeel import InputError, MixedModeBilinear, VanDerWaals
from isopeel.assembly.system import System
from isopeel.case import Case, with_options
from isopeel.problem import Boundary

SIDES = 'between = ["upper.bottom", "lower.top"]'
LAW = 'law = "van-der-waals"'
PART = 'length = "15 nm"'


def corner(text: str, body: str, xi: float = 0.0, eta: float = 0.0) -> list[float]:
    place: list[float] = Case.parse(text).problem().body_of(body).shape.evaluate(xi, eta).tolist()
    return place


def test_an_interface_is_between_the_parts_of_two_sides() -> None:
    problem = Case.parse(FACING).problem()
    (interface,) = problem.interfaces
    assert isinstance(interface.law, VanDerWaals)
    # the first 15 nm of each side, of 20 nm and of 24 nm
    assert interface.boundary == Boundary("upper", "bottom", 0.0, 0.75)
    assert interface.against == Boundary("lower", "top", 0.0, 0.625)
    assert (interface.scheme, interface.irreversible) == ("unbiased", False)
    assert problem.interface_names == ("upper.bottom", "lower.top")


@pytest.mark.parametrize("scheme", ["unbiased", "biased", "two-half-pass"])
def test_scheme_and_damage_are_keys(scheme: str) -> None:
    text = changed(LAW, f"{LAW}\nscheme = '{scheme}'\nirreversible = true")
    (interface,) = Case.parse(text).problem().interfaces
    assert (interface.scheme, interface.irreversible) == (scheme, True)


def test_a_side_may_have_a_part_of_its_own() -> None:
    """The other one has that of the interface."""
    own = '{ boundary = "lower.top", start = "2 nm", length = "15 nm" }'
    (interface,) = Case.parse(changed('"lower.top"]', f"{own}]")).problem().interfaces
    assert interface.boundary == Boundary("upper", "bottom", 0.0, 0.75)
    assert interface.against == Boundary("lower", "top", 2 / 24, 17 / 24)


def test_a_case_can_be_read_back() -> None:
    case = Case.parse(FACING)
    assert Case.parse(case.text) == case


def test_a_body_lies_at_the_equilibrium_gap_of_its_interface() -> None:
    gap = Case.parse(FACING).problem().interfaces[0].law.equilibrium_gap
    assert gap == pytest.approx(0.4 / 15 ** (1 / 6), rel=1e-14)  # of the law, in closed form
    assert corner(FACING, "upper") == [0.0, 2.0 + gap]


def test_the_gap_may_be_given_and_is_zero_without_an_interface() -> None:
    assert corner(changed('on = "lower.top"', 'on = "lower.top"\ngap = "0.5 nm"'), "upper") == [0.0, 2.5]
    assert corner(changed('on = "lower.top"', 'on = "lower.left"'), "upper", 1.0) == [-2.0, 0.0]


def test_a_body_is_moved_along_the_normal_only() -> None:
    text = changed('on = "lower.top"', 'on = "lower.top"\nat = ["3 nm", "99 nm"]\ngap = "0 nm"')
    assert corner(text, "upper") == [3.0, 2.0]


def test_a_body_lies_on_an_inclined_side() -> None:
    """The lower strip is turned by 30 degrees, and the upper one too."""
    turned = 'rotated = "30 deg"'
    text = changed('at = ["-2 nm", "0 nm"]', turned).replace(
        'on = "lower.top"', f'on = "lower.top"\n{turned}'
    )
    gap = Case.parse(text).problem().interfaces[0].law.equilibrium_gap
    normal = np.array([-0.5, sqrt(0.75)])
    # sums of a few numbers of this size
    np.testing.assert_allclose(corner(text, "upper"), (2.0 + gap) * normal, atol=1e-14)


def test_the_lowest_point_of_a_round_body_is_at_the_gap() -> None:
    """A half disc of 5 nm, turned by 30 degrees: its lowest point is between two control points of an arc."""
    text = changed('length = "20 nm"\nheight = "2 nm"', 'shape = "half-cylinder"\nradius = "5 nm"')
    text = text.replace('on = "lower.top"', 'on = "lower.top"\nrotated = "30 deg"\ngap = "0.5 nm"')
    text = text.replace(PART, 'length = "5 nm"')
    shape = Case.parse(text).problem().body_of("upper").shape
    along = np.linspace(0.0, 1.0, 20001)
    lowest = shape.evaluate(along, np.zeros(along.size))[:, 1].min()
    # the arc is 8 nm long: a sample is at most 2e-4 nm away, and lies higher by its square over the diameter
    assert lowest == pytest.approx(2.5, abs=1e-8)


def test_bodies_lie_on_each_other_in_any_order() -> None:
    third = FACING[FACING.index('[[body]]\nname = "upper"') : FACING.index("[[interface]]")]
    third = third.replace('"upper"', '"third"').replace('"lower.top"', '"upper.top"')
    text = (
        FACING.replace("[[body]]", third + "[[body]]", 1)
        + '[[support]]\nboundary = "third.top"\nholds = "xy"\n'
    )
    gap = Case.parse(text).problem().interfaces[0].law.equilibrium_gap
    assert corner(text, "third") == [0.0, 4.0 + gap]


BAD: list[tuple[str, str, str, str]] = [
    (SIDES, 'between = ["upper.bottom"]', "interface.1.between", "a list of 2 boundaries is needed"),
    (SIDES, 'between = "upper.bottom"', "interface.1.between", "a list of 2 boundaries is needed"),
    (SIDES, 'between = ["upper.bottom", 3]', "interface.1.between", "a list of 2 boundaries is needed"),
    ('"lower.top"]', '"pad.top"]', "interface.1.between.2", "the bodies are lower, upper"),
    ('"lower.top"]', '"lower.front"]', "interface.1.between.2", "the sides are left, right, bottom, top"),
    ('"lower.top"]', '{ side = "lower.top" }]', "interface.1.between.2.side", "there is no such key"),
    ('"lower.top"]', '{ boundary = "lower.top", end = 2 }]', "interface.1.between.2.end", "24 nm long"),
    ('"lower.top"]', '"upper.top"]', "interface.1.between", "a body does not adhere to itself"),
    (PART, 'length = "22 nm"', "interface.1.length", "at most 20"),
    (LAW, f"{LAW}\nscheme = 'mortar'", "interface.1.scheme", "'unbiased', 'biased' or 'two-half-pass'"),
    (LAW, f"{LAW}\nboundary = 'upper.bottom'", "interface.1.boundary", "or of a boundary and a substrate"),
    (LAW, f"{LAW}\nsubstrate = {{ gap = '1 nm' }}", "interface.1.substrate", "or of a boundary and a"),
    (LAW, f"{LAW}\nsymmetric = true", "interface.1.symmetric", "there is no mirror plane"),
    (LAW, f"{LAW}\nsliding_length = '1 nm'", "interface.1.sliding_length", "mixed-mode-bilinear"),
    (LAW, f"{LAW}\ntraction = 'projected'", "interface.1.traction", "between bodies it must be 'reference'"),
    ("hamaker_constant", "hamaker", "interface.1.hamaker", "hamaker_constant, equilibrium_distance"),
    (LAW, 'law = "xu-needleman"', "interface.1.hamaker_constant", "shear_strength"),
    ('hamaker_constant = "1e-19 J"', "", "interface.1.hamaker_constant", "missing; an energy is needed"),
    ('on = "lower.top"', 'on = "pad.top"', "body.2.on", "the bodies are lower, upper"),
    ('on = "lower.top"', 'on = "lower.front"', "body.2.on", "the sides are left, right, bottom, top"),
    ('on = "lower.top"', 'on = "upper.top"', "body.2.on", "a body lies on another one"),
    ('on = "lower.top"', 'on = ["lower.top"]', "body.2.on", "a boundary is needed"),
    ('on = "lower.top"', 'gap = "1 nm"', "body.2.gap", "from the side that the body lies `on`"),
    ('on = "lower.top"', 'on = "lower.top"\ngap = "-1 nm"', "body.2.gap", "not negative"),
    ('at = ["-2 nm", "0 nm"]', 'on = "upper.top"', "body.1.on", "and not in a circle"),
    (
        'length = "24 nm"',
        'shape = "curved-strip"\nlength = "24 nm"\nradius = "50 nm"',
        "body.2.on",
        "a straight side",
    ),
]


@pytest.mark.parametrize(("old", "new", "field", "allowed"), BAD)
def test_bad_values_name_their_key_and_what_is_allowed(old: str, new: str, field: str, allowed: str) -> None:
    with pytest.raises(InputError) as caught:
        Case.parse(changed(old, new))
    assert caught.value.field == field
    assert allowed in caught.value.allowed
    assert str(caught.value).count("\n") == 0
    # what is refused is shown as it is written
    assert "Section(" not in str(caught.value)


SECOND = f"""
[[interface]]
{SIDES}
law = "exponential"
strength = "80 MPa"
work_of_adhesion = "0.03 J/m^2"
start = "14 nm"
"""


def test_two_interfaces_between_the_same_parts_are_refused() -> None:
    """Their adhesion would add up; side by side they may lie. The first one ends at 15 nm."""
    text = changed('on = "lower.top"', 'on = "lower.top"\ngap = "0.3 nm"')
    with pytest.raises(InputError) as caught:
        Case.parse(text + SECOND)
    assert (caught.value.field, caught.value.value) == ("interface.2.between", ["upper.bottom", "lower.top"])
    assert "it overlaps interface.1 between the same sides" in caught.value.allowed
    assert len(Case.parse(text + SECOND.replace("14 nm", "15 nm")).problem().interfaces) == 2


def test_a_gap_is_needed_where_interfaces_have_several() -> None:
    with pytest.raises(InputError, match=r"^body\.2\.gap: the key is missing: .*different equilibrium gaps"):
        Case.parse(FACING + SECOND.replace("14 nm", "15 nm"))


def test_the_option_for_the_traction_is_refused() -> None:
    with pytest.raises(InputError, match=r"^--traction: 'projected' .* it must be 'reference'"):
        with_options(Case.parse(FACING), traction="projected")


#: Contact without adhesion in place of the law.
TOUCH = {
    "interface.1.law": "contact",
    "interface.1.hamaker_constant": None,
    "interface.1.equilibrium_distance": None,
}


@pytest.mark.parametrize(
    ("values", "field", "message"),
    [
        ({"body.2.on": None, "body.2.at": ["0 nm", "1.5 nm"]}, "interface.1.between", "must not overlap at"),
        ({"body.2.gap": "1 m"}, "interface.1.between", "the smallest gap between them is 1e+09 L0"),
        ({"body.2.at": ["50 nm", "0 nm"]}, "interface.1.between", "no point faces the other side"),
        ({"interface.1.between": ["upper.top", "lower.top"]}, "interface.1.between", "no point faces"),
        ({"interface.1.between": ["upper.top", "lower.bottom"]}, "interface.1.between", "nor one lie behind"),
        ({**TOUCH, "body.2.gap": "1 nm"}, "support", "no law acts between upper.bottom and lower.top at the"),
        ({"support.2.boundary": "lower.right"}, "support", "a motion along x of the body upper"),
        ({"support.1.holds": "y"}, "support", "a motion along x of the body lower"),
    ],
)
def test_what_only_the_system_finds_is_named_by_the_keys_of_the_case(
    values: dict[str, object], field: str, message: str
) -> None:
    case = Case.parse(FACING).with_values(values)
    with pytest.raises(InputError) as caught:
        System(case.problem(), case.spaces())
    error = case.named(caught.value)
    assert error.field == field
    assert message in re.sub(r"\s+", " ", str(error))


def test_the_number_is_that_of_the_interface() -> None:
    """Each interface between two bodies has two faces."""
    text = FACING + SECOND.replace("14 nm", "15 nm").replace("upper.bottom", "upper.top")
    case = Case.parse(text.replace('on = "lower.top"', 'on = "lower.top"\ngap = "0.3 nm"'))
    with pytest.raises(InputError) as caught:
        System(case.problem(), case.spaces())
    assert caught.value.field == "interface.2.between"


JOINT = """law = "mixed-mode-bilinear"
strength = "20 MPa"
work_of_adhesion = "500 mJ/m^2"
shear_strength = "30 MPa"
shear_work = "1 J/m^2"
rise = 0.1
"""
#: The law of `FACING`, with its constants.
ADHESION = """law = "van-der-waals"
hamaker_constant = "1e-19 J"
equilibrium_distance = "0.4 nm"
"""


def test_a_joint_law_holds_two_bodies() -> None:
    (interface,) = Case.parse(changed(ADHESION, JOINT)).problem().interfaces
    law = interface.law
    assert isinstance(law, MixedModeBilinear)
    # in E0 = 2 GPa and L0 = 1 nm
    assert (law.strength, law.shear_strength) == (0.01, 0.015)
    assert (law.work_of_adhesion, law.shear_work) == pytest.approx((0.25, 0.5), rel=1e-15)
    assert (law.rise, law.exponent, law.initial_damage) == (0.1, 2.0, 0.0)


@pytest.mark.parametrize(
    ("extra", "field"), [("irreversible = true", "irreversible"), ('scheme = "biased"', "scheme")]
)
def test_a_joint_law_has_no_scheme_and_states_its_damage(extra: str, field: str) -> None:
    with pytest.raises(InputError, match=rf"interface\.1\.{field}: .*a joint law"):
        Case.parse(changed(ADHESION, JOINT + extra + "\n")).problem()


def test_a_substrate_takes_no_joint_law() -> None:
    text = changed('between = ["upper.bottom", "lower.top"]', 'boundary = "upper.bottom"')
    with pytest.raises(InputError, match=r"interface\.1\.law: 'mixed-mode-bilinear' .*between two bodies"):
        Case.parse(text.replace(ADHESION, JOINT)).problem()


def test_a_smoothed_side_and_a_penetration_are_keys() -> None:
    contact = 'law = "contact"\npenetration = "1 pm"\nsmoothed = true\n'
    (interface,) = Case.parse(changed(ADHESION, contact)).problem().interfaces
    assert (interface.smoothed, interface.penetration) == (True, 1e-3)
