"""Case files of several bodies, interfaces and supports: what they mean."""

import pickle
import re
from math import pi

import numpy as np
import pytest
from tape_texts import TWO, changed

from isopeel import Circle, Flat, InputError, Mirrored, NeoHooke
from isopeel.case import Case, SeveralBodies, load_case, with_options
from isopeel.problem import Boundary, Support


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
