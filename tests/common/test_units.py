from fractions import Fraction

import pytest

from isopeel.common.units import UnitSystem, measured_in, parse_quantity, shown


@pytest.mark.parametrize(
    ("text", "value", "stress", "length"),
    [
        # L0 = 1 nm and E0 = 2 GPa; equal to the last bit, because the conversion is rational
        ("200 nm", 200.0, 0, 1),
        ("0.2 um", 200.0, 0, 1),
        ("4 Å", 0.4, 0, 1),
        ("2 GPa", 1.0, 1, 0),
        ("2000 N/mm^2", 1.0, 1, 0),
        ("1e-19 J", 0.05, 1, 3),
        ("30.7 mJ/m**2", 0.01535, 1, 1),
        ("30.7e-3 kg s^-2", 0.01535, 1, 1),
        ("1 GPa/nm", 0.5, 1, -1),
    ],
)
def test_quantities_become_powers_of_stress_and_length(
    text: str, value: float, stress: int, length: int
) -> None:
    quantity = parse_quantity(text)
    assert quantity.value == value
    assert quantity.stress == stress
    assert quantity.length == length


@pytest.mark.parametrize(("text", "degrees"), [("0.1 deg", 0.1), ("120 degree", 120.0), ("0.5 turn", 180.0)])
def test_angles_are_in_degrees(text: str, degrees: float) -> None:
    quantity = parse_quantity(text)
    assert quantity.angle
    assert quantity.value == degrees  # rational as well


def test_radians_agree_with_pi() -> None:
    # one rounding of pi in the registry, one of the result
    assert parse_quantity("3.141592653589793 rad").value == pytest.approx(180, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("2", "it has no unit"),
        ("2.0", "it has no unit"),
        ("-2.5e-3 ", "it has no unit"),
        ("2 GPaa", "'GPaa' is not a known unit"),
        ("3 s", "'s' is neither an angle nor"),
        ("10 deg nm", "mixes an angle"),
        ("10 nm deg/rad", "mixes an angle"),
        ("1 m deg/nm", "mixes an angle"),
        ("1 N/m/rad", "mixes an angle"),
        ("1 nm sr", "mixes an angle"),
        ("5 dB nm", "'dB' is not a known unit"),
        ("3 K", "'K' is neither an angle nor"),
        ("5 %", "it is not a number and a unit"),
        ("5 dB", "'dB' is not a known unit"),
        ("GPa", "it is not a number and a unit"),
        ("2 GPa; 3", "it is not a number and a unit"),
        ("1 m^9**9", "it is not a number and a unit"),
        ("nan nm", "it is not finite"),
        ("-inf nm", "it is not finite"),
        ("1e999 nm", "it is not finite"),
        ("1" * 200 + " nm", "it is not a number and a unit"),
    ],
)
def test_other_texts_are_refused(text: str, why: str) -> None:
    with pytest.raises(ValueError, match=why):
        parse_quantity(text)


@pytest.mark.parametrize(
    ("value", "stress", "length", "expected"),
    [
        (0.0153324, 1, 1, "0.030665 J/m^2"),
        (0.0617849, 1, 0, "123.57 MPa"),
        (0.30589, 0, 1, "305.89 pm"),
        (3.7813, 1, -1, "7.5626 GPa/nm"),
        (0.0, 0, 1, "0 m"),
    ],
)
def test_values_are_shown_in_si_units(value: float, stress: int, length: int, expected: str) -> None:
    """Of E0 = 2 GPa and L0 = 1 nm, worked by hand."""
    assert shown(value, UnitSystem(), stress, length) == expected


def test_quantities_are_read_in_the_units_of_a_case() -> None:
    with measured_in(UnitSystem(Fraction(1, 1000), Fraction(10**6))):
        assert parse_quantity("250 J/m^2").value == 0.25  # 1 MPa x 1 mm is 1000 J/m^2
        assert parse_quantity("90 deg").value == 90.0
    assert parse_quantity("1 nm").value == 1.0
