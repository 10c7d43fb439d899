"""Constants of formulas have the dimensions that the formula needs, or the result would depend on [units]."""

import re
from pathlib import Path
from time import perf_counter

import pytest

from isopeel.case import Case, load_case
from isopeel.cli import main
from isopeel.common.errors import InputError

STRIP = load_case("strip").text
LAW = 'law = "van-der-waals"\nhamaker_constant = "1e-19 J"\nequilibrium_distance = "0.4 nm"'
MATERIAL = 'law = "neo-hooke"\nyoungs_modulus = "2 GPa"\npoissons_ratio = 0.2'
LJ, EXP = "W*((s/r)**8/3 - 4/3*(s/r)**2)", "-W*(1 + (r - g)/l)*exp(-(r - g)/l)"
NEO_HOOKE = "mu/2*(I1 - 3 - 2*log(J)) + la/2*log(J)**2"


def formula_case(table: str, formula: str, constants: str) -> str:
    """The strip with a formula in a table."""
    rest = f"constants = {{ {constants} }}"
    match table:
        case "adhesion":
            return STRIP.replace(LAW, f'law = "formula"\npotential = "{formula}"\n{rest}')
        case "material":
            return STRIP.replace(MATERIAL, f'law = "formula"\nenergy = "{formula}"\n{rest}')
    return f'{STRIP}\n[substrate]\nkind = "formula"\nformula = "{formula}"\n{rest}\n'


@pytest.mark.parametrize(
    ("table", "formula", "constants", "name", "written", "needed"),
    [
        # as given
        ("adhesion", LJ, 'W = "50 N", s = "0.25 nm"', "W", "'50 N'", "an energy per area is needed, such as"),
        ("adhesion", LJ, 'W = 0.03, s = "0.25 nm"', "W", "0.03", "an energy per area is needed, such as"),
        ("adhesion", LJ, 'W = "0.03 J/m^2", s = "1 N"', "s", "'1 N'", "a length is needed, such as '200 nm'"),
        ("adhesion", LJ, 'W = "0.03 J/m^2", s = 0.25', "s", "0.25", "a length is needed, such as '200 nm'"),
        (
            "adhesion",
            EXP,
            'W = "30 mJ m-2", g = "1 GPa", l = "1 nm"',
            "g",
            "'1 GPa'",
            "a length is needed, such as '200 nm'",
        ),
        (
            "adhesion",
            "W*((s/r)**n - 2*(s/r)**m)",
            'W = "30 mJ m-2", s = "1 nm", n = "8 nm", m = 2',
            "n",
            "'8 nm'",
            "a number is needed, without quotes",
        ),
        (
            "adhesion",
            "K/2*(r - g)**2*exp(-r/g)",
            'K = "1 GPa", g = "1 nm"',
            "K",
            "'1 GPa'",
            "a quantity in Pa m^-1 is needed, such as '1 Pa m^-1'",
        ),
        (
            "adhesion",
            "K**2/E*tanh(r/l)**2",
            'K = "1 MPa", E = "1 GPa", l = "1 nm"',
            "K",
            "'1 MPa'",
            "a quantity in Pa m^(1/2) is needed, such as '1 Pa m^(1/2)'",
        ),
        (
            "material",
            NEO_HOOKE,
            'mu = "1 GPa", la = "1 N/m"',
            "la",
            "'1 N/m'",
            "a stress is needed, such as '2 GPa'",
        ),
        ("material", NEO_HOOKE, 'mu = 1, la = "1 GPa"', "mu", "1", "a stress is needed, such as '2 GPa'"),
        ("substrate", "a*cos(x/l)", 'a = "1 J", l = "30 nm"', "a", "'1 J'", "a length is needed"),
        (
            "substrate",
            "k*x**2",
            'k = "1 nm"',
            "k",
            "'1 nm'",
            "a quantity in m^-1 is needed, such as '1 m^-1'",
        ),
    ],
)
def test_a_constant_of_a_wrong_dimension_is_named_with_what_is_needed(
    table: str, formula: str, constants: str, name: str, written: str, needed: str
) -> None:
    with pytest.raises(InputError) as caught:
        Case.parse(formula_case(table, formula, constants))
    message = str(caught.value)
    assert message.startswith(f"{table}.constants.{name}: {written} cannot be used; in ")
    assert needed in message
    # the example is one that can be used there
    example = re.findall(r"such as '(.*)'$", message)
    right = f'"{example[0]}"' if example else "2"
    given = f'"{written[1:-1]}"' if written[0] == "'" else written
    try:
        Case.parse(formula_case(table, formula, constants.replace(f"{name} = {given}", f"{name} = {right}")))
    except InputError as error:
        assert "is needed" not in error.allowed  # noqa: PT017 (a law may still be refused for its values)


@pytest.mark.parametrize(
    ("table", "formula", "constants", "part"),
    [
        (
            "substrate",
            "a*cos(x/30)",
            'a = "0.1 nm"',
            "'x / 30' is the argument of a function, and not a number",
        ),
        ("substrate", "sqrt(100 - x**2)", "", "'100 - x ** 2' adds different dimensions"),
        ("substrate", "a + x**2*1e-3", 'a = "0.1 nm"', "'a + x ** 2 * 0.001' is not a length"),
        ("adhesion", "exp(-r)", "", "'-r' is the argument of a function, and not a number"),
        ("adhesion", "W*((0.25/r)**8 - (0.25/r)**2)", 'W = "1 J/m2"', "adds different dimensions"),
        ("adhesion", "W*(r/s)**r", 'W = "1 J/m2", s = "1 nm"', "'r' is an exponent, and not a number"),
        ("material", "I1 - 3 - 2*log(J)", "", "is not a stress"),
        ("material", "mu*(I1 - 3) + 5", 'mu = "1 GPa"', "is not a stress"),
    ],
)
def test_a_number_that_stands_for_a_length_must_be_a_constant(
    table: str, formula: str, constants: str, part: str
) -> None:
    with pytest.raises(InputError) as caught:
        Case.parse(formula_case(table, formula, constants))
    assert caught.value.field.startswith(f"{table}.")
    assert part in caught.value.allowed
    assert "must be constants with a unit" in caught.value.allowed


@pytest.mark.parametrize(
    ("table", "formula", "constants"),
    [
        ("adhesion", LJ, 'W = "0.03 J/m^2", s = "0.25 nm"'),
        ("adhesion", EXP, 'W = "30 N/m", g = "0 nm", l = "1 nm"'),
        ("adhesion", EXP + " + 0", 'W = "30 mJ m-2", g = "0.3 nm", l = "1 nm"'),
        ("material", NEO_HOOKE, 'mu = "1 GPa", la = "1 N/mm^2"'),
        ("substrate", "a*cos(2*pi*x/l)", 'a = "0.1 nm", l = "30 nm"'),
        ("substrate", "a*(1 + (x/l)**2)**(1/3) - 0.1*sqrt(a*l)", 'a = "0.1 nm", l = "9 mm"'),
        ("substrate", "0*x", ""),
    ],
)
def test_what_fits_together_is_read_in_any_units(table: str, formula: str, constants: str) -> None:
    for units in ("", 'units = { length = "1 um", stress = "1 GPa" }\n'):
        Case.parse(units + formula_case(table, formula, constants))


def test_the_refusal_is_one_line_of_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "case.toml"
    file.write_text(formula_case("adhesion", LJ, 'W = "50 N", s = "0.25 nm"'))
    assert main(["run", str(file), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert error.startswith(
        "isopeel: adhesion.constants.W: '50 N' cannot be used; in potential = 'W*((s/r)**8"
    )
    assert error.endswith("an energy per area is needed, such as '0.03 J/m^2'\n")
    assert error.count("\n") == 1


@pytest.mark.parametrize(
    "formula",
    ["9**9**9**9*r", "0+" * 900 + "r", "*".join(["r"] * 900), "r**" * 90 + "r", "r/0", "r.real", "(" * 80],
)
def test_hard_formulas_end_at_once(formula: str) -> None:
    began = perf_counter()
    with pytest.raises(InputError):
        Case.parse(formula_case("adhesion", formula, ""))
    assert perf_counter() - began < 5  # a tenth of that, on a machine that does other work
