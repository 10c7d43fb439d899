import re
import tomllib
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from isopeel.case import Case, OneBody, load_case, parse_mesh, shipped_cases, with_options
from isopeel.case.load import LARGEST_FILE
from isopeel.common.errors import InputError
from isopeel.physics.adhesion import (
    AdhesionLaw,
    Bilinear,
    Dugdale,
    Exponential,
    LennardJones,
    Trapezoidal,
)
from isopeel.physics.adhesion.formula import FormulaAdhesion
from isopeel.physics.materials import Material, MooneyRivlin, NeoHooke, SaintVenantKirchhoff, Yeoh
from isopeel.physics.materials.formula import FormulaMaterial
from isopeel.problem import strip

STRIP = resources.files("isopeel").joinpath("cases", "strip", "case.toml").read_text("utf-8")


def changed(old: str, new: str) -> str:
    assert STRIP.count(old) == 1
    return STRIP.replace(old, new)


def test_the_shipped_strip_is_the_one_of_the_literature() -> None:
    case = load_case("strip")
    problem, published = case.problem(), strip()
    # exactly: quantities are converted without rounding
    assert problem.body.material == published.body.material
    assert problem.adhesion == published.adhesion
    assert (problem.supports, problem.drive, problem.name) == (
        published.supports,
        published.drive,
        published.name,
    )
    assert np.array_equal(problem.body.shape.control_points, published.body.shape.control_points)
    assert (case.space().name, case.space().elements) == ("N2.1", (200, 10))
    assert case.reading is not None
    assert case.reading.window == (98.0, 101.4)


def test_sections_with_defaults_may_be_left_out() -> None:
    start = STRIP.index("[discretization]")
    case = Case.parse(STRIP[:start].replace('traction = "reference"', ""))
    full = load_case("strip")
    assert isinstance(case, OneBody)
    assert isinstance(full, OneBody)
    # the published strip is linear across, which is no default
    usual = full.discretization.model_copy(update={"across_degree": None, "mesh": None})
    assert (case.discretization, case.drive, case.adhesion) == (
        usual,
        full.drive,
        full.adhesion,
    )
    assert case.reading is None


def test_angles_are_multiples_of_the_step_and_end_at_the_requested_one() -> None:
    case = load_case("strip")
    requested = [float(f"{k}e-1") for k in range(1201)]
    (stage,) = case.stages()
    assert stage.name == "rotation"
    assert np.array_equal(stage.parameters, np.radians(requested))
    for to, step in ((3.0, 0.7), ("3 deg", "0.7 deg"), ("180 arcmin", "0.7"), ("3", "42 arcmin")):
        (stage,) = with_options(case, to=to, step=step).stages()
        assert np.array_equal(stage.parameters, np.radians([0, 0.7, 1.4, 2.1, 2.8, 3.0]))
    (stage,) = with_options(case, to=0.05).stages()
    assert np.array_equal(stage.parameters, np.radians([0, 0.05]))


def test_overrides_give_a_new_case_that_can_be_read_back() -> None:
    case = load_case("strip")
    other = with_options(case, space="L1+N2", mesh="20x2", to=3.0, step=0.5, traction="projected")
    assert case == load_case("strip")
    assert (other.discretization.space, other.space().elements) == ("L1+N2", (20, 2))
    (drive,) = other.drive
    assert (drive.to, drive.step, other.problem().adhesion.traction) == ("3.0 deg", "0.5 deg", "projected")
    assert Case.parse(other.text) == other
    assert Case.parse(case.text) == case


FORMULAS = """
name = "formulas"
[body]
length = "0.2 um"
height = "10 nm"
[material]
law = "formula"
energy = "mu/2*(I1 - 3 - 2*log(J)) + bulk/2*log(J)**2"
[material.constants]
mu = "0.8 GPa"
bulk = "0.6 GPa"
[adhesion]
law = "formula"
potential = "W*((s/r)**8 - k*(s/r)**2)"
length = "150 nm"
[adhesion.constants]
W = "30 mJ/m^2"
s = "4 angstrom"
k = 2
"""


def test_laws_may_be_formulas_with_constants_that_have_units() -> None:
    case = Case.parse(FORMULAS)
    problem = case.problem()
    material, law = problem.body.material, problem.adhesion.law
    assert isinstance(material, FormulaMaterial)
    assert isinstance(law, FormulaAdhesion)
    assert material.constants == {"mu": 0.4, "bulk": 0.3}  # in 2 GPa
    assert law.constants == {"W": 0.015, "s": 0.4, "k": 2.0}  # in 2 J/m^2 and nm
    # neo-Hooke with mu and lambda: E = mu (3 lambda + 2 mu)/(lambda + mu), nu = lambda/(2 (lambda + mu))
    same = NeoHooke(0.4 * (3 * 0.3 + 2 * 0.4) / (0.3 + 0.4), 0.3 / (2 * (0.3 + 0.4)))
    assert material.youngs_modulus == pytest.approx(same.youngs_modulus, rel=1e-14)  # round-off
    # Phi' = 0: 8 (s/r)^6 = 2 k
    assert law.equilibrium_gap == pytest.approx(
        0.4 * (8 / 4) ** (1 / 6), rel=1e-12
    )  # a root finder's tolerance
    assert problem.name == "formulas"
    assert Case.parse(case.text) == case


SAME_MODULI = 'youngs_modulus = "2 GPa"\npoissons_ratio = 0.2\n'
MATERIALS = [
    ("neo-hooke", SAME_MODULI, NeoHooke(1.0, 0.2)),
    ("saint-venant-kirchhoff", SAME_MODULI, SaintVenantKirchhoff(1.0, 0.2)),
    (
        "mooney-rivlin",
        'c10 = "0.6 GPa"\nc01 = "0.2 GPa"\nbulk_modulus = "1 GPa"\n',
        MooneyRivlin(0.3, 0.1, 0.5),
    ),
    (
        "yeoh",
        'c10 = "0.6 GPa"\nc20 = "-20 MPa"\nc30 = "2 MPa"\nbulk_modulus = "1 GPa"\n',
        Yeoh(0.3, -0.01, 0.001, 0.5),
    ),
]
STRENGTH = 'strength = "124 MPa"\nwork_of_adhesion = "0.03 J/m^2"\n'
LAWS = [
    (
        "lennard-jones",
        'work_of_adhesion = "0.03 J/m^2"\nequilibrium_gap = "0.25 nm"\nrepulsive_exponent = 12.0\n',
        LennardJones(0.015, 0.25, 12.0),
    ),
    ("exponential", STRENGTH + 'equilibrium_gap = "0.1 nm"\n', Exponential(0.062, 0.015, 0.1)),
    ("bilinear", STRENGTH + "rise = 0.2\n", Bilinear(0.062, 0.015, 0.2)),
    ("trapezoidal", STRENGTH + "rise = 0.2\nplateau = 0.3\n", Trapezoidal(0.062, 0.015, 0.2, 0.3)),
    ("dugdale", STRENGTH + "transition = 0.5\n", Dugdale(0.062, 0.015, 0.5)),
]


def with_section(section: str, law: str, keys: str) -> str:
    """The shipped strip with another law in a section."""
    length = 'length = "150 nm"\n' if section == "adhesion" else ""
    before, _, after = load_case("strip").text.partition(f"[{section}]\n")
    rest = after[after.index("\n[") :]
    return f'{before}[{section}]\nlaw = "{law}"\n{keys}{length}{rest}'


@pytest.mark.parametrize(("law", "keys", "material"), MATERIALS)
def test_every_material_can_be_written_in_a_case(law: str, keys: str, material: Material) -> None:
    case = Case.parse(with_section("material", law, keys))
    made = case.problem().body.material
    assert type(made) is type(material)
    # units of 2 GPa, to round-off
    np.testing.assert_allclose(made.parameters, material.parameters, rtol=1e-14)
    assert Case.parse(case.text) == case


@pytest.mark.parametrize(("law", "keys", "adhesion"), LAWS)
def test_every_law_of_adhesion_can_be_written_in_a_case(law: str, keys: str, adhesion: AdhesionLaw) -> None:
    case = Case.parse(with_section("adhesion", law, keys))
    made = case.problem().adhesion.law
    assert type(made) is type(adhesion)
    # units of 2 GPa, 2 J/m^2 and nm, to round-off
    np.testing.assert_allclose(made.parameters, adhesion.parameters, rtol=1e-12)
    assert made.work_of_adhesion == pytest.approx(0.015, rel=1e-12)
    assert Case.parse(case.text) == case


def test_adhesion_may_be_irreversible() -> None:
    text = STRIP.replace('length = "150 nm"', 'length = "150 nm"\nirreversible = true')
    assert Case.parse(text).problem().adhesion.irreversible
    assert not Case.parse(STRIP).problem().adhesion.irreversible
    with pytest.raises(InputError, match=r"adhesion\.irreversible: 'yes'.*true or false"):
        Case.parse(text.replace("= true", '= "yes"'))


@pytest.mark.parametrize(
    ("section", "law", "old", "new", "field"),
    [
        ("material", "mooney-rivlin", '"0.6 GPa"', '"-0.6 GPa"', "material.c10 + c01"),
        ("material", "yeoh", '"1 GPa"', '"-1 GPa"', "material.bulk_modulus"),
        ("adhesion", "lennard-jones", "12.0", "2.0", "adhesion.repulsive_exponent"),
        ("adhesion", "exponential", '"124 MPa"', '"0 MPa"', "adhesion.strength"),
        ("adhesion", "bilinear", '"0.03 J/m^2"', '"0.03 J"', "adhesion.work_of_adhesion"),
        ("adhesion", "trapezoidal", "plateau = 0.3", "plateau = 1.3", "adhesion.plateau"),
        ("adhesion", "dugdale", "transition = 0.5", "", "adhesion.transition"),
    ],
)
def test_bad_constants_of_laws_name_their_key(section: str, law: str, old: str, new: str, field: str) -> None:
    known: list[tuple[str, str, object]] = [*MATERIALS, *LAWS]
    (keys,) = (keys for name, keys, _ in known if name == law)
    assert old in keys
    with pytest.raises(InputError) as caught:
        Case.parse(with_section(section, law, keys.replace(old, new)))
    assert caught.value.field == field


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
    ('length = "150 nm"', 'length = "201 nm"', "adhesion.length", "at most 200"),
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


@pytest.mark.parametrize("height", ["1 mm", "0.5 fm"])
def test_elements_that_are_needles_are_refused(height: str) -> None:
    with pytest.raises(InputError, match="one side may be 10000 times the other") as caught:
        Case.parse(changed('height = "10 nm"', f'height = "{height}"'))
    assert (caught.value.field, caught.value.value) == ("discretization.mesh", "200x10")


@pytest.mark.parametrize(
    ("old", "new", "field"),
    [
        ('mu = "0.8 GPa"', 'mu = "0.8 s"', "material.constants.mu"),
        ('mu = "0.8 GPa"', "mu = true", "material.constants.mu"),
        ('mu = "0.8 GPa"', "mu = inf", "material.constants.mu"),
        ('mu = "0.8 GPa"', f"mu = 1{'0' * 400}", "material.constants.mu"),
        ('mu = "0.8 GPa"', 'mu = "-0.8 GPa"', "material.energy"),
        ('mu = "0.8 GPa"', 'J = "0.8 GPa"', "material.constants"),
        ("k = 2", 'k = "2 deg"', "adhesion.constants.k"),
        ("k = 2", "", "adhesion.potential"),
        ("k = 2", "k = -2", "adhesion.potential"),
        ('energy = "mu/2', 'energy = "__import__(1)', "material.energy"),
    ],
)
def test_bad_formulas_name_their_key(old: str, new: str, field: str) -> None:
    assert FORMULAS.count(old) == 1
    with pytest.raises(InputError) as caught:
        Case.parse(FORMULAS.replace(old, new))
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


def test_files_that_are_no_case_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    broken, binary, nested, digits, large = (tmp_path / f"{name}.toml" for name in "abcde")
    broken.write_text('name = "x"\nlength 3\n')
    binary.write_bytes(b"name\xff")
    nested.write_text("a = " + "[" * 10_000)
    digits.write_text("a = " + "1" * 5000)
    large.write_text("#" * (LARGEST_FILE + 1))
    for path, allowed in (
        (tmp_path / "none.toml", "does not exist"),
        (tmp_path, "is no file"),
        (broken, "line 2"),
        (binary, "byte 4"),
        (nested, "not TOML"),
        (digits, "not TOML"),
        (large, f"at most {LARGEST_FILE} bytes"),
    ):
        with pytest.raises(InputError) as caught:
            load_case(path)
        assert (caught.value.field, caught.value.value) == ("CASE", str(path))
        assert allowed in caught.value.allowed

    def refuse(*_: object) -> str:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(InputError, match="Permission denied"):
        load_case(broken)


def test_a_file_is_read_like_a_shipped_case(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(STRIP)
    assert load_case(path) == load_case("strip")
    assert "strip" in shipped_cases()


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
