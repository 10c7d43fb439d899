"""Numbers are in units that a laboratory reads, with their digits: never 0.000000, and never 3e+06 L0."""

import re

import pytest
from summaries import CaseResult, result_of

TAPE = """
name = "tape"
{units}
[body]
length = "12 mm"
height = "0.05 mm"
{width}
[material]
law = "neo-hooke"
youngs_modulus = "{modulus}"
poissons_ratio = 0.3
[adhesion]
law = "exponential"
strength = "{strength}"
work_of_adhesion = "{work}"
length = "10 mm"
sliding_length = "0.05 mm"
[discretization]
space = "N2"
mesh = "60x1"
[drive]
kind = "force"
side = "right"
angle = "90 deg"
to = "6 mm"
step = "0.2 mm"
[reading]
window = ["5 mm", "6 mm"]
[output]
fields_every = "0.5 mm"
"""

MM_MPA = '[units]\nlength = "1 mm"\nstress = "1 MPa"'
USUAL = {
    "units": MM_MPA,
    "width": "",
    "modulus": "300 MPa",
    "strength": "0.03 MPa",
    "work": "0.01 N/mm",
}


def tape(**changes: str) -> CaseResult:
    return result_of(TAPE.format(**(USUAL | changes)))


def numbers(message: CaseResult) -> list[str]:
    """All numbers with a dot or an exponent in the table."""
    cells = [cell for row in message.rows for cell in row[1:]]
    return re.findall(r"\d+\.\d+(?:e[-+]\d+)?", " ".join(cells))


@pytest.mark.parametrize(
    "changes",
    [
        # the smallest in the internal units, 5e-8, then 1e-4 of the usual, large ones, and none of their own
        {"units": '[units]\nlength = "1 m"\nstress = "1 GPa"', "work": "0.01 N/mm"},
        {"modulus": "30 kPa", "strength": "1 Pa", "work": "0.001 J/m^2"},
        {"modulus": "300 GPa", "strength": "10 MPa", "work": "10000 J/m^2"},
        {"units": ""},
    ],
)
def test_the_table_has_significant_digits_and_laboratory_units(changes: dict[str, str]) -> None:
    message = tape(**changes)
    steady = message.row("steady force").value
    assert re.match(
        r"(\S+ E0 L0 = )?[1-9]\S* N/m" if "units" in changes and not changes["units"] else r"[\d.e+-]+ N/m",
        steady,
    )
    assert not any(float(number) == 0 for number in numbers(message))
    cells = " ".join(cell for row in message.rows for cell in row)
    if changes.get("units") != "":
        assert "L0" not in cells
        assert "E0" not in cells
    assert message.row("reached").value == "6 mm"
    found = message.reading("steady force")
    assert float(steady.split(" N/m")[0].split()[-1]) == pytest.approx(found["value"], rel=1e-5)
    assert not any("L0" in note for note in message.notes("reading"))


def test_a_width_gives_newtons() -> None:
    per_width, whole = tape(), tape(width='width = "20 mm"')
    one, other = (message.reading("steady force") for message in (per_width, whole))
    assert (one["unit"], other["unit"]) == ("N/m", "N")
    assert other["value"] == pytest.approx(one["value"] * 0.02, rel=1e-12)
    assert whole.found.laboratory.note() == "for a width of 20 mm"
    # nothing else depends on it
    assert per_width.curve.reaction.tolist() == whole.curve.reaction.tolist()
    assert whole.reading("energy release rate") == per_width.reading("energy release rate")


@pytest.mark.parametrize("units", [MM_MPA, '[units]\nlength = "1 um"\nstress = "2 GPa"', ""])
def test_readings_do_not_depend_on_the_units_of_the_case(units: str) -> None:
    one, other = tape(), tape(units=units)
    for quantity in ("steady force", "process zone", "energy release rate"):
        first, second = one.reading(quantity), other.reading(quantity)
        assert first["unit"] == second["unit"]
        assert first["value"] == pytest.approx(second["value"], rel=1e-4)  # the tolerance of the solver
