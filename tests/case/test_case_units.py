"""The units of a case."""

import re

import numpy as np
import pytest
from case_texts import STAGES, STRIP, case_with

from isopeel.case import Case
from isopeel.common.errors import InputError

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
