"""Units as people write them: each text is read as pint reads its plain form, or refused in one line."""

from fractions import Fraction
from pathlib import Path

import pint
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isopeel.case import load_case
from isopeel.cli import main
from isopeel.common.units import Quantity, parse_quantity

#: Not the registry of isopeel, whose numbers are fractions.
PINT: pint.UnitRegistry[float] = pint.UnitRegistry()

STRIP = load_case("strip").text


@pytest.mark.parametrize(
    ("text", "pascals_metres", "stress", "length"),
    [
        ("30 mJ m-2", "0.03", 1, 1),  # as given
        ("1 N m-1", "1", 1, 1),
        ("1e-3m", "1e-3", 0, 1),
        ("1 J/m2", "1", 1, 1),
        ("1 J/m^2", "1", 1, 1),
        ("1 J m^-2", "1", 1, 1),
        ("1 N/mm", "1000", 1, 1),
        ("1 uN", "1e-6", 1, 2),
        ("1 µm", "1e-6", 0, 1),
        ("1 μm", "1e-6", 0, 1),
        ("1 um", "1e-6", 0, 1),
        ("1 kPa", "1e3", 1, 0),
        ("1 N·m⁻¹", "1", 1, 1),
        ("1 N⋅m⁻¹", "1", 1, 1),
        ("1 mJ/(m^2)", "1e-3", 1, 1),
        ("1 N.m-1", "1", 1, 1),
        ("1 N/(m mm)", "1e3", 1, 0),
        ("1 N/mm/mm", "1e6", 1, 0),
        ("5 x 10^-3 m", "5e-3", 0, 1),
        ("5×10⁻³ m", "5e-3", 0, 1),
        ("−5 nm", "-5e-9", 0, 1),
        ("1 nm²", "1e-18", 0, 2),
        ("3 Å", "3e-10", 0, 1),
        ("1 kgf/cm2", "98066.5", 1, 0),
    ],
)
def test_units_are_read_as_people_write_them(
    text: str, pascals_metres: str, stress: int, length: int
) -> None:
    quantity = parse_quantity(text)
    assert quantity.exact == Fraction(pascals_metres)  # rational, so that nothing is rounded
    assert [quantity.stress, quantity.length] == [Fraction(stress), Fraction(length)]


def test_a_fracture_toughness_has_half_a_power_of_a_length() -> None:
    for text in ("3 MPa m^0.5", "3 MPa·m^(1/2)"):
        quantity = parse_quantity(text)
        assert [quantity.stress, quantity.length] == [Fraction(1), Fraction(1, 2)]
        # of 2 GPa and 1 nm: 3e6 / (2e9 sqrt(1e-9)), to round-off
        assert quantity.value == pytest.approx(3e6 / (2e9 * 1e-9**0.5), rel=1e-14)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("1 e-3 m", "there is a space in its number; write 1e-3"),
        ("1 J/m nm", "can be read in two ways"),
        ("1 J/m*nm", "can be read in two ways"),
        ("1 N/25mm2", "it is not a number and a unit"),
        ("1 N/", "it is not a number and a unit"),
        ("1 N/(m", "it is not a number and a unit"),
        ("1 m^-", "it is not a number and a unit"),
        ("1 m0", "it is not a number and a unit"),
        ("1 m-", "it is not a number and a unit"),
        ("1,5 mm", "it is not a number and a unit"),
        ("1 per m", "'per' is not a known unit"),
        ("1 Newton", "'Newton' is not a known unit"),
        ("1 percent nm", "'percent' is neither an angle nor"),
        ("1e99 EPa^8.9 Em^8.9", "it is not finite"),
    ],
)
def test_a_missing_reading_has_a_reason(text: str, why: str) -> None:
    with pytest.raises(ValueError, match=why):
        parse_quantity(text)


@pytest.mark.parametrize("work", ["30 mJ m-2", "1 N m-1", "1 e-3 m", "3 J m", "0,03 J/m2"])
def test_a_case_is_read_or_refused_in_one_line(
    work: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    law = f'law = "exponential"\nstrength = "80 MPa"\nwork_of_adhesion = "{work}"'
    old = 'law = "van-der-waals"\nhamaker_constant = "1e-19 J"\nequilibrium_distance = "0.4 nm"'
    file = tmp_path / "unit.toml"
    file.write_text(STRIP.replace(old, law), encoding="utf-8")
    stated = read(work)
    if isinstance(stated, Quantity) and stated.stress == stated.length == 1:
        assert load_case(file).problem().adhesion.law.work_of_adhesion == pytest.approx(
            stated.value, rel=1e-12
        )
        return
    assert main(["run", str(file), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"isopeel: adhesion.work_of_adhesion: '{work}' cannot be used; ")
    assert error.count("\n") == 1


NAMES = [
    "m", "mm", "um", "µm", "nm", "cm", "km", "in", "ft", "mil", "micron", "Å", "N", "uN", "mN", "kN", "lbf",
    "kgf", "dyn", "Pa", "kPa", "MPa", "GPa", "psi", "bar", "J", "mJ", "kJ", "erg", "eV", "kg", "g", "s", "ms",
]  # fmt: skip
NUMBERS = ["1", "30", "0.5", ".5", "2.", "-3", "+4", "1e-3", "2.5E6", "7e+2"]

STYLES = ["{n}^{p}", "{n}**{p}", "{n}{p}", "{n}{raised}", "{n} ^ {p}", "({n}^{p})"]


def read(text: str) -> Quantity | str:
    """The quantity that is read from a text, or why there is none."""
    try:
        return parse_quantity(text)
    except ValueError as error:
        return str(error)


@st.composite
def spellings(draw: st.DrawFn) -> tuple[str, float, str]:
    """A quantity as it may be written, its number, and its unit for pint: powers by **, products by *."""
    number = draw(st.sampled_from(NUMBERS))
    written, plain = "", "dimensionless"
    for place in range(draw(st.integers(1, 4))):
        name, power = draw(st.sampled_from(NAMES)), draw(st.sampled_from([1, 1, 1, 2, 3, -1, -2]))
        style = draw(
            st.sampled_from(["{n}^{p}", "{n}**{p}", "{n}{p}", "{n}{raised}", "{n} ^ {p}", "({n}^{p})"])
        )
        raised = str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
        factor = name if power == 1 else style.format(n=name, p=power, raised=raised)
        between = draw(st.sampled_from([" ", "*", " * ", "·", ".", "/", " / "]))
        if place == 0:
            between = draw(st.sampled_from([" ", "  ", ""]))
        # what stands behind a solidus is pint's to divide by, each factor on its own
        plain += f"{'/' if '/' in between else '*'}({name}**({power}))"
        written += between + factor
    return number + written, float(number), plain


@settings(max_examples=400, deadline=None, derandomize=True, database=None)
@given(spellings())
def test_what_is_read_is_what_pint_reads(spelling: tuple[str, float, str]) -> None:
    written, number, plain = spelling
    quantity = read(written)
    if isinstance(quantity, str):
        assert len(quantity.splitlines()) == 1
        return
    expected = PINT.Quantity(number, PINT.parse_units(plain))
    unit = PINT.pascal ** float(quantity.stress) * PINT.meter ** float(quantity.length)
    # pint's floats are rounded at each factor
    assert float(quantity.exact) == pytest.approx(expected.to(unit).magnitude, rel=1e-12)


@settings(max_examples=300, deadline=None, derandomize=True, database=None)
@given(st.text(alphabet="0123456789.eE+-^*/()· ⁻²·µmNJPagkx×10°\u2212\u00a0", max_size=14))
def test_any_text_is_read_or_refused(text: str) -> None:
    found = read(text)
    assert isinstance(found, Quantity) or len(found.splitlines()) == 1
