"""Sections of a case file beyond the strip: shapes, substrates, held sides, drives and their stages."""

import json
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

from isopeel.case import Case, load_case, with_options
from isopeel.common.errors import InputError
from isopeel.physics.adhesion import Bilinear
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.materials import NeoHooke
from isopeel.physics.materials.prestretched import Prestretched
from isopeel.physics.substrates import Circle, Flat, Wavy
from isopeel.physics.substrates.formula import FormulaSubstrate
from isopeel.problem import Boundary, MovedSide, PulledSide, RotatedSide, Support
from isopeel.problem.shapes import CurvedStrip, Patch

PARTS = {
    "body": 'length = "200 nm"\nheight = "10 nm"',
    "material": 'law = "neo-hooke"\nyoungs_modulus = "2 GPa"\npoissons_ratio = 0.2',
    "adhesion": 'law = "bilinear"\nstrength = "100 MPa"\nwork_of_adhesion = "0.03 J/m^2"\nrise = 0.2\n'
    'equilibrium_gap = "0.3 nm"',
}


def case_with(**parts: str) -> str:
    """A case with other or further tables, or with lines before the first one, as `head`."""
    head = parts.pop("head", "")
    tables = (f"[{name}]\n{keys}\n" for name, keys in (PARTS | parts).items() if not name.startswith("_"))
    return f'name = "test"\n{head}\n' + "".join(tables)


def two_stages(second: str) -> str:
    return case_with() + f'[[drive]]\nside = "right"\nto = "3 deg"\nstep = "1 deg"\n[[drive]]\n{second}'


def test_what_is_left_out_is_the_strip_s() -> None:
    case = Case.parse(case_with())
    (stage,) = case.stages()
    problem = stage.problem
    assert problem.drive == RotatedSide("right")
    assert problem.supports == (Support(Boundary("body", "left"), (0,)),)
    assert problem.adhesion.law == Bilinear(0.05, 0.015, 0.2, equilibrium_gap=0.3)
    assert problem.adhesion.substrate == Flat(-0.3)
    assert (problem.adhesion.start, problem.adhesion.end) == (0.0, 1.0)
    assert problem.adhesion.sliding_length is None
    assert np.array_equal(stage.parameters, load_case("strip").stages()[0].parameters)
    assert stage.fields_every == 10.0
    assert Case.parse(case.text) == case


BACKING = 'kind = "circle"\nradius = "100 nm"\n'


@pytest.mark.parametrize(
    ("keys", "substrate"),
    [
        ('kind = "flat"', Flat(-0.3)),
        ('kind = "flat"\nheight = "-1 nm"\ngap = "2 nm"', Flat(-3.0)),
        ('gap = "0 nm"', Flat(0.0)),
        (BACKING + 'gap = "1 nm"', Circle(99.0, "inside", (0.0, -100.0))),
        (BACKING + 'solid = "outside"\ngap = "1 nm"', Circle(101.0, "outside", (0.0, 100.0))),
        (BACKING + 'centre = ["0.1 um", "-2 nm"]\ngap = "0 nm"', Circle(100.0, "inside", (100.0, -2.0))),
        (
            'kind = "wavy"\namplitude = "5 angstrom"\nwavelength = "20 nm"\nphase = "90 deg"\ngap = "1 nm"',
            Wavy(0.5, 20.0, np.pi / 2, -1.5),
        ),
        (
            'kind = "formula"\nformula = "a*sin(x/l)"\ngap = "0.5 nm"\n'
            'constants = { a = "1 nm", l = "3 nm" }',
            FormulaSubstrate("(a*sin(x/l)) - (0.5)", {"a": 1.0, "l": 3.0}),
        ),
    ],
)
def test_every_substrate_can_be_written_and_starts_at_its_gap(keys: str, substrate: object) -> None:
    case = Case.parse(case_with(substrate=keys))
    assert case.problem().adhesion.substrate == substrate
    assert Case.parse(case.text) == case


def test_the_material_may_be_laid_stretched() -> None:
    case = Case.parse(case_with(material=PARTS["material"] + "\nprestretch = 1.05"))
    assert case.problem().body.material == Prestretched(NeoHooke(1.0, 0.2), 1.05)


def test_the_lower_face_may_adhere_to_its_mirror_image_or_hold_along_it() -> None:
    keys = PARTS["adhesion"] + '\nlength = "50 nm"\n'
    adhesion = Case.parse(case_with(adhesion=keys + "symmetric = true")).problem().adhesion
    assert adhesion.law == Mirrored(Bilinear(0.05, 0.015, 0.2, equilibrium_gap=0.3))
    # the plane of the mirror is half the equilibrium gap away
    assert (adhesion.substrate, adhesion.end) == (Flat(-0.15), 0.25)
    holding = Case.parse(case_with(adhesion=keys + 'sliding_length = "0.3 nm"')).problem().adhesion
    assert holding.sliding_length == 0.3


def test_a_stage_may_jump_and_a_case_has_a_path_control() -> None:
    case = Case.parse(case_with(head='about = "A test."', drive='path_control = "jump"'))
    assert [stage.path_control for stage in case.stages()] == ["jump"]
    assert case.about == "A test."
    plain = Case.parse(case_with())
    assert [stage.path_control for stage in plain.stages()] == ["auto"]
    assert plain.about == ""
    with pytest.raises(
        InputError, match=r"drive\.path_control: 1 cannot be used; 'newton', 'auto', 'jump' or"
    ):
        Case.parse(case_with(drive="path_control = 1"))


def test_sides_are_held_as_written() -> None:
    fixed = Case.parse(case_with(head='held = { top = "xy", left = "x", bottom = "y" }')).problem().supports
    found = {(support.side, support.components) for support in fixed}
    assert found == {("top", (0, 1)), ("left", (0,)), ("bottom", (1,))}
    assert Case.parse(case_with(head="held = {}")).problem().supports == ()


def test_shapes_are_chosen_by_name() -> None:
    bent = 'shape = "curved-strip"\nlength = "50 nm"\nheight = "2 nm"\nradius = "100 nm"\nbends = "up"'
    case = Case.parse(case_with(body=bent, adhesion=PARTS["adhesion"] + '\nlength = "25 nm"'))
    shape = CurvedStrip(50.0, 2.0, 100.0, "up")
    expected = shape.surface()
    made = case.problem().body.shape
    assert np.array_equal(made.control_points, expected.control_points)
    assert np.array_equal(made.weights, expected.weights)
    # the middle of an arc, symmetric in its parameter, to the tolerance of the root
    assert case.problem().adhesion.end == pytest.approx(0.5, abs=1e-14)
    assert Case.parse(case.text) == case


def test_a_shape_s_file_is_seen_from_the_folder_of_the_case(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    patch = {
        "SplineType": "Bezier",
        "para_dim": 2,
        "dim": 2,
        "degrees": [1, 1],
        "control_points": [[0, 0], [4, 0], [0, 1], [4, 1]],
    }
    (tmp_path / "patch.json").write_text(json.dumps({"SplineList": [patch]}))
    (tmp_path / "case.toml").write_text(
        case_with(body='shape = "patch"\nfile = "patch.json"\nunit_length = "10 nm"')
    )
    case = load_case(tmp_path / "case.toml")
    shape = case.problem().body.shape
    expected = Patch(tmp_path / "patch.json", 10.0).surface()
    assert np.array_equal(shape.control_points, expected.control_points)
    assert shape.control_points.max() == 40.0
    # the text of the case, which a run keeps, can be read from any other place
    monkeypatch.chdir(Path("/"))
    again = Case.parse(with_options(case, mesh="20x2").text)
    assert np.array_equal(again.problem().body.shape.control_points, expected.control_points)
    with pytest.raises(InputError, match=r"body\.file"):
        Case.parse((tmp_path / "case.toml").read_text())


def test_the_space_takes_degree_and_grading() -> None:
    keys = 'space = "N2"\nmesh = "20x4"\nacross_degree = 2\ngrading = [0.5, 2.0]'
    space = Case.parse(case_with(discretization=keys)).space()
    assert (space.across.degree, space.elements) == (2, (20, 4))
    for spline, ratio in ((space.rows[0], 0.5), (space.across, 2.0)):
        sizes = np.diff(spline.breakpoints)
        assert sizes[-1] / sizes[0] == pytest.approx(ratio, rel=1e-12)  # differences of sums, to round-off


STAGES = [
    ('kind = "displacement"\nside = "right"\nangle = "90 deg"\nto = "-2 nm"\nstep = "8 angstrom"',
     MovedSide("right", np.pi / 2), [0.0, -0.8, -1.6, -2.0]),
    ('kind = "force"\nside = "right"\nangle = "45 deg"\nto = "3 nm"\nstep = "1 nm"\nstart = 0.25',
     PulledSide(Boundary("body", "right", 0.25), np.pi / 4), [0.0, 1.0, 2.0, 3.0]),
    ('kind = "force"\nside = "top"\nangle = "90 deg"\ncontrol = "force"\nfollows = true\n'
     'to = "0.06 N/m"\nstep = "0.02 N/m"',
     PulledSide("top", np.pi / 2, follows=True, control="force"), [0.0, 0.01, 0.02, 0.03]),
]  # fmt: skip


@pytest.mark.parametrize(("keys", "drive", "parameters"), STAGES)
def test_a_stage_continues_in_the_dimension_of_its_drive(
    keys: str, drive: object, parameters: list[float]
) -> None:
    case = Case.parse(two_stages(keys + '\nname = "peel"'))
    first, last = case.stages()
    assert (first.name, last.name) == ("rotation", "peel")
    assert np.array_equal(first.parameters, np.radians([0.0, 1.0, 2.0, 3.0]))
    assert last.problem.drive == drive
    assert last.parameters.tolist() == parameters
    assert last.problem.body.material == first.problem.body.material
    assert case.problem().drive == RotatedSide("right")
    # a tenth, where nothing is said
    assert last.fields_every == pytest.approx(abs(parameters[-1]) / 10, rel=1e-15)
    assert first.fields_every == 10.0
    assert Case.parse(case.text) == case
    alone = Case.parse(case_with(drive=keys)).stages()
    assert [stage.name for stage in alone] == [tomllib.loads(keys)["kind"]]


def test_windows_and_fields_are_in_the_dimension_of_the_last_drive() -> None:
    tables = '\n[reading]\nwindow = ["5 angstrom", "2 nm"]\n[output]\nfields_every = "0.5 nm"\n'
    case = Case.parse(two_stages(STAGES[1][0]) + tables)
    assert case.reading is not None
    assert case.reading.window == (0.5, 2.0)
    assert case.output.fields_every == 0.5
    first, last = case.stages()
    assert (first.window, first.fields_every) == (None, 10.0)
    assert (last.window, last.fields_every) == ((0.5, 2.0), 0.5)
    # all stages of that dimension, the first one too
    tables = '\n[output]\nfields_every = "1 deg"\n'
    turned_on = Case.parse(
        two_stages('kind = "rotation"\nside = "right"\nto = "4 deg"\nstep = "1 deg"') + tables
    )
    assert [stage.fields_every for stage in turned_on.stages()] == [1.0, 1.0]
    with pytest.raises(InputError, match=r"output\.fields_every: '0\.5 nm'.*a force per width"):
        Case.parse(two_stages(STAGES[2][0]) + '\n[output]\nfields_every = "0.5 nm"')


def test_overrides_are_for_the_last_stage() -> None:
    case = with_options(Case.parse(two_stages(STAGES[1][0])), to="2 nm", step="5 angstrom")
    first, last = case.stages()
    assert first.parameters[-1] == np.radians(3.0)
    assert last.parameters.tolist() == [0.0, 0.5, 1.0, 1.5, 2.0]
    for to, reason in ((2.0, "no unit; a length is needed"), ("2 deg", "a length"), ("0 nm", "not be zero")):
        with pytest.raises(InputError, match=reason) as caught:
            with_options(case, to=to)
        assert (caught.value.field, caught.value.value) == ("--to", to)


BAD_TABLES = [
    ("body", 'shape = "cube"', "body.shape", "shapes is needed: curved-strip"),
    ("body", 'shape = "tapered-strip"\nlength = "9 nm"', "body.height", "missing; a length is needed"),
    ("body", 'shape = "half-cylinder"\nradius = "1 MPa"', "body.radius", "a length is needed"),
    ("body", 'shape = "half-cylinder"\nlength = "1 nm"', "body.length", "here the keys are width, shape"),
    ("body", 'shape = "patch"\nfile = 3', "body.file", "the path of a file"),
    ("body", 'shape = "patch"\nfile = "none.json"', "body.file", ""),
    ("substrate", 'kind = "sphere"', "substrate.kind", "kinds is needed: circle, flat"),
    ("substrate", 'kind = 3', "substrate.kind", "circle, flat"),
    ("substrate", 'kind = "circle"', "substrate.radius", "missing; a length is needed"),
    ("substrate", BACKING + 'solid = "above"', "substrate.solid", "'inside' or 'outside' is needed"),
    ("substrate", BACKING + 'centre = ["1 nm"]', "substrate.centre", "a list of 2 is needed; for each"),
    ("substrate", BACKING + 'centre = ["1 nm", "1 GPa"]', "substrate.centre", "a length is needed"),
    ("substrate", BACKING + 'gap = "100 nm"', "substrate.gap", "must be positive"),
    ("substrate", 'gap = "1 deg"', "substrate.gap", "a length is needed"),
    ("substrate", 'depth = "1 nm"', "substrate.depth", "here the keys are gap, kind, height"),
    ("substrate", 'kind = "formula"', "substrate.formula", "a formula of the place x"),
    ("substrate", 'kind = "formula"\nformula = "x"\nconstants = 3', "substrate.constants", "a table"),
    ("held", 'left = "z"', "held.left", "'x', 'y' or 'xy'"),
    ("held", 'front = "x"', "held.front", "left, right, bottom, top"),
    ("material", PARTS["material"] + '\nprestretch = "2"', "material.prestretch", "without quotes"),
    ("material", PARTS["material"] + "\nprestretch = -1.0", "material.prestretch", "positive"),
    ("adhesion", PARTS["adhesion"] + '\nsliding_length = "0 nm"', "adhesion.sliding_length", "positive"),
    (
        "adhesion",
        PARTS["adhesion"] + '\nsymmetric = true\nsliding_length = "1 nm"',
        "adhesion.symmetric",
        "do not slip past each other",
    ),
    ("adhesion", PARTS["adhesion"] + '\nsymmetric = "yes"', "adhesion.symmetric", "true or false"),
    ("adhesion", PARTS["adhesion"] + '\nlength = "1 m/m"', "adhesion.length", "a length is needed"),
    ("discretization", "across_degree = 9", "discretization.across_degree", "from 1 to 8"),
    ("discretization", "across_degree = 1.5", "discretization.across_degree", "from 1 to 8"),
    ("discretization", "grading = [1.0]", "discretization.grading", "a list of 2"),
    ("discretization", 'grading = [1.0, "2"]', "discretization.grading", "a list of 2"),
    ("discretization", "grading = [1.0, -2.0]", "discretization.grading", "two ratios"),
    ("drive", 'kind = "turn"', "drive.kind", "displacement, force"),
    ("drive", 'side = "front"', "drive.side", "'left'"),
    ("drive", 'angle = "1 deg"', "drive.angle", "name, side, boundary, start, end, on, to, step"),
    ("drive", 'name = "a b"', "drive.name", "letters, digits and '-'"),
    ("drive", 'kind = "displacement"\nside = "right"\nangle = 3', "drive.angle", "an angle is needed"),
    ("drive", STAGES[1][0].replace('to = "3 nm"', ""), "drive.to", "missing; a length is needed"),
    ("drive", STAGES[1][0].replace('step = "1 nm"', ""), "drive.step", "missing; a length is needed"),
    ("drive", STAGES[2][0].replace("0.06 N/m", "3 nm"), "drive.to", "a force per width"),
    ("drive", STAGES[1][0].replace("0.25", "'0.25'"), "drive.start", "it has no unit; a length is needed"),
    ("drive", STAGES[1][0].replace("3 nm", "0 nm"), "drive.to", "not be zero"),
    ("drive", STAGES[1][0].replace("1 nm", "1 fm"), "drive.step", "a step of at least 30 fm is needed"),
]  # fmt: skip


@pytest.mark.parametrize(("table", "keys", "field", "allowed"), BAD_TABLES)
def test_bad_tables_name_their_key_and_what_is_allowed(
    table: str, keys: str, field: str, allowed: str
) -> None:
    with pytest.raises(InputError) as caught:
        Case.parse(case_with(**{table: keys}))
    assert caught.value.field == field
    assert allowed in caught.value.allowed
    assert "\n" not in str(caught.value)
    written = tomllib.loads(keys).get(field.split(".")[1])
    if not isinstance(written, list):
        assert caught.value.value == written


@pytest.mark.parametrize(
    ("second", "field"),
    [
        ('kind = "turn"', "drive.2.kind"),
        ('side = "front"', "drive.2.side"),
        ('to = "181 deg"', "drive.2.to"),
        ('far = "1 deg"', "drive.2.far"),
        (STAGES[0][0].replace("90", "80"), "drive.2.angle"),
    ],
)
def test_stages_are_numbered_where_something_is_wrong(second: str, field: str) -> None:
    with pytest.raises(InputError) as caught:
        Case.parse(two_stages(second))
    assert caught.value.field == field
    assert caught.value.value == tomllib.loads(second)[field.split(".")[-1]]


@pytest.mark.parametrize("head", ["substrate = 3", "held = 3", "reading = 3", "units = 3"])
def test_tables_that_are_none_are_refused(head: str) -> None:
    field = head.split(" ")[0]
    with pytest.raises(InputError, match=rf"a table \[{field}\] is needed") as caught:
        Case.parse(case_with(head=head))
    assert caught.value.field == field


@pytest.mark.parametrize(("head", "field"), [("[]", "drive"), ("3", "drive"), ("[1, 2]", "drive.1")])
def test_drives_that_are_none_are_refused(head: str, field: str) -> None:
    with pytest.raises(InputError, match=r"a table \[drive\], or several \[\[drive\]\], is needed") as caught:
        Case.parse(case_with(head=f"drive = {head}"))
    assert caught.value.field == field


def test_the_half_cylinder_is_held_on_top_and_adheres_about_its_lowest_point() -> None:
    body, length = 'shape = "half-cylinder"\nradius = "50 nm"', '\nlength = "20 nm"'
    problem = Case.parse(case_with(body=body, adhesion=PARTS["adhesion"] + length)).problem()
    assert problem.supports == (Support(Boundary("body", "top"), (0,)),)
    lower = problem.body.shape.boundary("bottom")
    start, end = lower.evaluate([problem.adhesion.start, problem.adhesion.end])
    # 10 nm of arc to either side, to the round-off of coordinates of size 50
    assert [start[0], end[0]] == pytest.approx([-50 * np.sin(0.2), 50 * np.sin(0.2)], abs=1e-13)
    written = Case.parse(case_with(body=body, head='held = { left = "y" }')).problem()
    assert written.supports == (Support(Boundary("body", "left"), (1,)),)


def test_too_many_steps_are_an_error_of_the_given_option() -> None:
    stages = Case.parse(two_stages(STAGES[1][0]))
    single = Case.parse(case_with(drive=STAGES[1][0]))
    for case in (stages, single):
        with pytest.raises(InputError, match=r"^--to: '1 m' cannot be used; .* at least 10 µm is") as caught:
            with_options(case, to="1 m")
        assert (caught.value.field, caught.value.value) == ("--to", "1 m")
        with pytest.raises(InputError, match=r"^--step: '1 fm' cannot be used; .* at least 30 fm is"):
            with_options(case, step="1 fm")
        with pytest.raises(InputError, match=r"^--step: '1 fm' cannot be used; .* at least 20 fm is"):
            with_options(case, to="2 nm", step="1 fm")


def test_a_mirror_is_flat() -> None:
    text = case_with(adhesion=PARTS["adhesion"] + "\nsymmetric = true", substrate=BACKING)
    with pytest.raises(InputError, match=r"adhesion\.symmetric: True.*must be flat"):
        Case.parse(text)


def test_graded_elements_that_are_needles_are_refused() -> None:
    with pytest.raises(InputError, match="one side may be 10000 times the other"):
        Case.parse(case_with(discretization="grading = [1e6, 1.0]"))


STRIP = load_case("strip").text
UNITS = STRIP.replace("[body]", '[units]\nlength = "1 um"\nstress = "1 MPa"\n\n[body]', 1)


def test_a_case_has_units_of_its_own() -> None:
    """The same strip: lengths a thousandth, stresses 2000 times as large, energies by their products."""
    one, other = Case.parse(STRIP).stages()[0], Case.parse(UNITS).stages()[0]
    a, b = one.problem, other.problem
    assert b.body.shape.control_points.max() == 0.2
    assert b.body.material.youngs_modulus == 2000 * a.body.material.youngs_modulus
    ratio = b.adhesion.law.work_of_adhesion / a.adhesion.law.work_of_adhesion
    assert ratio == pytest.approx(2000 / 1000, rel=1e-14)  # a few roundings
    np.testing.assert_array_equal(one.parameters, other.parameters)
    assert Case.parse(Case.parse(UNITS).text).stages()[0].problem.adhesion.law == b.adhesion.law


def test_messages_have_units_whatever_the_case_measures_in() -> None:
    with pytest.raises(InputError, match=r"it has elements of 200 nm x 10 pm; one side"):
        Case.parse(UNITS.replace('mesh = "200x10"', 'mesh = "1x1000"'))
    drive = STAGES[1][0].replace("1 nm", "1 fm")
    for units in ("", 'units = { length = "1 mm", stress = "1 kPa" }'):
        with pytest.raises(InputError, match="a step of at least 30 fm is needed"):
            Case.parse(case_with(head=units, drive=drive))


@pytest.mark.parametrize(
    ("units", "message"),
    [
        ("length = '1 Pa'", "units.length: '1 Pa' cannot be used; a length is needed"),
        ("stress = '0 Pa'", "units.stress: '0 Pa' cannot be used; it must be positive"),
        ("length = 3", "units.length: 3 cannot be used; a length is needed, such as '1 nm'"),
        ("stress = []", "units.stress: [] cannot be used; a stress is needed, such as '2 GPa'"),
        ("length = '1e9 m'", "units.length: '1e9 m' cannot be used; it must lie between 1e-21 m and 1000 m"),
        ("stress = '1e-9 Pa'", "'1e-9 Pa' cannot be used; it must lie between 0.002 Pa and 2e+21 Pa"),
        (
            "mass = '1 kg'",
            "units.mass: '1 kg' cannot be used; there is no such key; here the keys are length, stress",
        ),
    ],
)
def test_units_that_are_none(units: str, message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        Case.parse(STRIP.replace("[body]", f"[units]\n{units}\n\n[body]", 1))
