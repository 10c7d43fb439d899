"""Bad values, keys and tables of a case file: one line with the key and what is allowed."""

import tomllib

import pytest
from case_texts import BACKING, PARTS, STAGES, case_with, changed, two_stages

from isopeel.case import Case, load_case, with_options
from isopeel.common.errors import InputError

BAD_VALUES = [
    ('youngs_modulus = "2 GPa"', 'youngs_modulus = "2 nm"', "material.youngs_modulus", "a stress is needed"),
    ('youngs_modulus = "2 GPa"', 'youngs_modulus = "-2 GPa"', "material.youngs_modulus", "positive"),
    ('youngs_modulus = "2 GPa"', 'youngs_modulus = "0 GPa"', "material.youngs_modulus", "positive"),
    ('youngs_modulus = "2 GPa"', "youngs_modulus = 2.0", "material.youngs_modulus", "no unit"),
    ('youngs_modulus = "2 GPa"', 'youngs_modulus = "2"', "material.youngs_modulus", "no unit"),
    ('youngs_modulus = "2 GPa"', 'youngs_modulus = "2 GPaa"', "material.youngs_modulus", "known unit"),
    ('youngs_modulus = "2 GPa"', 'youngs_modulus = "nan GPa"', "material.youngs_modulus", "finite"),
    ('youngs_modulus = "2 GPa"', "youngs_modulus = inf", "material.youngs_modulus", "unit"),
    ('youngs_modulus = "2 GPa"', "youngs_modulus = true", "material.youngs_modulus", "a stress is needed"),
    ('youngs_modulus = "2 GPa"', "youngs_modulus = []", "material.youngs_modulus", "a stress is needed"),
    ('youngs_modulus = "2 GPa"', "", "material.youngs_modulus", "missing"),
    ("poissons_ratio = 0.2", "poissons_ratio = 0.5", "material.poissons_ratio", "(-1, 0.5)"),
    ("poissons_ratio = 0.2", "poissons_ratio = -1", "material.poissons_ratio", "(-1, 0.5)"),
    ("poissons_ratio = 0.2", "poissons_ratio = nan", "material.poissons_ratio", "(-1, 0.5)"),
    ("poissons_ratio = 0.2", 'poissons_ratio = "0.2"', "material.poissons_ratio", "without quotes"),
    ('law = "neo-hooke"', 'law = "ogden"', "material.law", "neo-hooke, saint-venant-kirchhoff"),
    ('law = "neo-hooke"', "", "material.law", "neo-hooke, saint-venant-kirchhoff"),
    ('length = "200 nm"', 'length = "-200 nm"', "body.length", "positive"),
    ('height = "10 nm"', 'height = "0 nm"', "body.height", "positive"),
    ('height = "10 nm"', 'heigth = "10 nm"', "body.heigth", "length, height"),
    ("[body]", "[bodies]", "bodies", "body, material, adhesion, substrate, held"),
    ('name = "strip"', 'name = "../strip"', "name", "letters"),
    ('name = "strip"', "name = 3", "name", "letters"),
    ('length = "150 nm"', 'length = "201 nm"', "adhesion.length", "at most 200 nm"),
    ('length = "150 nm"', 'length = "-1 nm"', "adhesion.length", "positive"),
    (
        'hamaker_constant = "1e-19 J"',
        'hamaker_constant = "1e-19 J/m"',
        "adhesion.hamaker_constant",
        "an energy",
    ),
    ('traction = "reference"', 'traction = "both"', "adhesion.traction", "'projected'"),
    ('space = "N2.1"', 'space = "Z3"', "discretization.space", "L2, N4, N2.1"),
    ('space = "N2.1"', "space = 3", "discretization.space", "'N2.1'"),
    ('mesh = "200x10"', 'mesh = "0x10"', "discretization.mesh", "1 to"),
    ('mesh = "200x10"', 'mesh = "200"', "discretization.mesh", "200x10"),
    ('mesh = "200x10"', 'mesh = "1e9x10"', "discretization.mesh", "200x10"),
    ('mesh = "200x10"', 'mesh = "999999999x10"', "discretization.mesh", "1 to"),
    ('mesh = "200x10"', 'mesh = "1x1000"', "discretization.mesh", "200 nm x 10 pm"),
    ('height = "10 nm"', 'height = "1e-200 nm"', "body.height", "between 1e-12 and 1e+12 in units"),
    ('length = "200 nm"', 'length = "1e200 nm"', "body.length", "between 1e-12 and 1e+12 in units"),
    ('youngs_modulus = "2 GPa"', 'youngs_modulus = "1e-320 GPa"', "material.youngs_modulus", "between"),
    ('hamaker_constant = "1e-19 J"', 'hamaker_constant = "1e100 J"', "adhesion.hamaker_constant", "between"),
    ("poissons_ratio = 0.2", f"poissons_ratio = 1{'0' * 400}", "material.poissons_ratio", "number"),
    ('height = "10 nm"', 'height = "10 deg nm"', "body.height", "mixes an angle"),
    ('step = "0.1 deg"', 'step = "1e-13 deg"', "drive.step", "in degrees"),
    ('step = "0.1 deg"', 'step = "0 deg"', "drive.step", "positive"),
    ('step = "0.1 deg"', 'step = "-1 deg"', "drive.step", "positive"),
    ('step = "0.1 deg"', 'step = "1e-4 deg"', "drive.step", "100000 steps"),
    ('step = "0.1 deg"', 'step = "0.1 nm"', "drive.step", "an angle"),
    ('to = "120 deg"', 'to = "181 deg"', "drive.to", "at most 180"),
    ('to = "120 deg"', 'to = "0 deg"', "drive.to", "above 0"),
    ('window = ["98 deg", "101.4 deg"]', 'window = ["98 deg"]', "reading.window", "two values"),
    ('window = ["98 deg", "101.4 deg"]', 'window = "98 deg"', "reading.window", "two values"),
    ('window = ["98 deg", "101.4 deg"]', "", "reading.window", "missing"),
    ('fields_every = "10 deg"', 'fields_every = "0 deg"', "output.fields_every", "positive"),
    ('fields_every = "10 deg"', "fields_every = 10", "output.fields_every", "an angle is needed"),
    ('fields_every = "10 deg"', 'every = "10 deg"', "output.every", "fields_every"),
    (
        'window = ["98 deg", "101.4 deg"]',
        'window = ["98 deg", "98 deg"]',
        "reading.window",
        "smaller one first",
    ),
    (
        'window = ["98 deg", "101.4 deg"]',
        'window = ["98 deg", "1 nm"]',
        "reading.window",
        "an angle is needed",
    ),
]


@pytest.mark.parametrize(("old", "new", "field", "allowed"), BAD_VALUES)
def test_bad_values_name_their_key_and_what_is_allowed(old: str, new: str, field: str, allowed: str) -> None:
    with pytest.raises(InputError) as caught:
        Case.parse(changed(old, new))
    assert caught.value.field == field
    assert allowed in caught.value.allowed
    written = next(iter(tomllib.loads(new).values()), None)
    if not isinstance(written, dict):
        assert repr(caught.value.value) == repr(written)
    assert "\n" not in str(caught.value)


def test_an_unknown_table_is_shown_by_its_name_alone() -> None:
    with pytest.raises(InputError, match=r"^bodies: '\[bodies\]' cannot be used; there is no such key"):
        Case.parse(changed("[body]", "[bodies]"))


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
    ("drive", 'angle = "1 deg"', "drive.angle", "name, side, boundary, start, end, length, on, to, step"),
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


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("mesh", "0x1"),
        ("space", "Z3"),
        ("traction", "x"),
        ("to", 200.0),
        ("to", "3 nm"),
        ("step", "x"),
        ("contact_points", 0),
    ],
)
def test_bad_overrides_name_the_option(option: str, value: object) -> None:
    with pytest.raises(InputError) as caught:
        with_options(load_case("strip"), **{option: value})  # type: ignore[arg-type]
    assert (caught.value.field, caught.value.value) == (f"--{option.replace('_', '-')}", value)
