"""Materials and adhesion laws in a case file: all that there are, formulas, and bad constants."""

import numpy as np
import pytest
from case_texts import BACKING, PARTS, STRIP, case_with

from isopeel.case import Case, load_case
from isopeel.common.errors import InputError
from isopeel.physics.adhesion import (
    AdhesionLaw,
    Bilinear,
    Contact,
    Dugdale,
    Exponential,
    LennardJones,
    Trapezoidal,
)
from isopeel.physics.adhesion.formula import FormulaAdhesion
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.materials import Material, MooneyRivlin, NeoHooke, SaintVenantKirchhoff, Yeoh
from isopeel.physics.materials.formula import FormulaMaterial
from isopeel.physics.materials.prestretched import Prestretched
from isopeel.physics.substrates import Flat

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


def test_the_material_may_be_laid_stretched() -> None:
    case = Case.parse(case_with(material=PARTS["material"] + "\nprestretch = 1.05"))
    assert case.problem().body.material == Prestretched(NeoHooke(1.0, 0.2), 1.05)


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


def test_contact_needs_no_stiffness_and_has_no_damage() -> None:
    made = Case.parse(with_section("adhesion", "contact", 'stiffness = "20 GPa/nm"\n')).problem().adhesion.law
    # units of 2 GPa and nm, to round-off
    np.testing.assert_allclose(made.parameters, [0.0, 10.0], rtol=1e-12)
    assert Case.parse(with_section("adhesion", "contact", "")).problem().adhesion.law == Contact()
    for keys, field in (
        ('stiffness = "0 N/mm^3"\n', "stiffness"),
        ('stiffness = "20 GPa"\n', "stiffness"),
        ("irreversible = true\n", "irreversible"),
        ('sliding_length = "1 nm"\n', "sliding_length"),
    ):
        with pytest.raises(InputError) as caught:
            Case.parse(with_section("adhesion", "contact", keys))
        assert caught.value.field == f"adhesion.{field}"


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


def test_the_lower_face_may_adhere_to_its_mirror_image_or_hold_along_it() -> None:
    keys = PARTS["adhesion"] + '\nlength = "50 nm"\n'
    adhesion = Case.parse(case_with(adhesion=keys + "symmetric = true")).problem().adhesion
    assert adhesion.law == Mirrored(Bilinear(0.05, 0.015, 0.2, equilibrium_gap=0.3))
    # the plane of the mirror is half the equilibrium gap away
    assert (adhesion.substrate, adhesion.end) == (Flat(-0.15), 0.25)
    holding = Case.parse(case_with(adhesion=keys + 'sliding_length = "0.3 nm"')).problem().adhesion
    assert holding.sliding_length == 0.3


def test_a_mirror_is_flat() -> None:
    text = case_with(adhesion=PARTS["adhesion"] + "\nsymmetric = true", substrate=BACKING)
    with pytest.raises(InputError, match=r"adhesion\.symmetric: True.*must be flat"):
        Case.parse(text)
