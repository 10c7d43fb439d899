"""Outputs are in the units of a laboratory."""

import csv
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from isopeel.common.units import UnitSystem
from isopeel.post.laboratory import Laboratory
from isopeel.post.table import write_curve
from isopeel.problem import Column, MovedSide, strip
from isopeel.problem.drives.base import DISPLACEMENT, FORCE
from isopeel.results.curve import Curve

NANO = Laboratory(UnitSystem(), 200.0)
MM_MPA = Laboratory(UnitSystem(Fraction(1, 1000), Fraction(10**6)), 150.0)


def test_the_plateau_of_the_paper_in_both_units() -> None:
    # 1.6294 E0 L0^3 = 1.6294 x 2 nN nm for a width of 1 nm
    assert NANO.both(1.6294, "moment", 5) == "1.6294 E0 L0^3 = 3.2588e-09 N m/m"
    assert MM_MPA.both(1.6294, "moment", 5) == "1.6294 N m/m"  # MPa mm^2


@pytest.mark.parametrize(
    ("value", "kind", "text"),
    [
        (4.999e-8, "force", "4.999e-05 N/m"),
        (25.0, "force", "25000 N/m"),
        (0.1, "length", "100 um"),
        (150.0, "length", "150 mm"),
        (2e4, "length", "20 m"),
        (2e-5, "length", "20 nm"),
        (0.28, "toughness", "280 J/m^2"),
        (0.5, "energy", "0.5 J/m"),
        (0.03, "stress", "30 kPa"),
        (3000.0, "stress", "3 GPa"),
        (12.5, "angle", "12.5 deg"),
        (0.0, "length", "0 mm"),
    ],
)
def test_values_with_their_units(value: float, kind: str, text: str) -> None:
    assert MM_MPA.text(value, kind) == text  # type: ignore[arg-type]


def test_values_of_a_known_width() -> None:
    wide = replace(MM_MPA, width=20.0)
    assert wide.text(3.2, "force") == "64 N"  # 3.2 N/mm on 20 mm
    assert wide.text(1.0, "moment") == "0.02 N m"
    assert wide.text(1.0, "energy") == "0.02 J"
    assert wide.note() == "for a width of 20 mm"


def test_headings_have_units_and_whole_numbers_none() -> None:
    headings = [
        MM_MPA.heading(column)
        for column in (
            DISPLACEMENT,
            FORCE,
            Column("theta_deg", "degree"),
            Column("iterations", "1"),
            Column("seconds", "s"),
        )
    ]
    assert headings == ["displacement [mm]", "force [N/m]", "theta [deg]", "iterations", "seconds [s]"]


def test_a_table_is_read_by_its_first_line(tmp_path: Path) -> None:
    problem = replace(strip(), drive=MovedSide("top", np.pi / 2))
    numbers = np.array([0.1, 1 / 3])
    whole = np.array([1, 2])
    none = np.empty(0)
    energies = (numbers, numbers, numbers, numbers)
    curve = Curve(DISPLACEMENT, FORCE, numbers, numbers, whole, *energies, numbers, none, whole * 0, -whole)
    write_curve(tmp_path / "curve.csv", curve, problem, NANO)
    with (tmp_path / "curve.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    # the load acts on all of the body, from which no crack is measured
    assert list(rows[0])[:3] == ["displacement [nm]", "force [N/m]", "iterations"]
    assert not any("crack" in name for name in rows[0])
    assert [float(row["displacement [nm]"]) for row in rows] == numbers.tolist()
    assert [float(row["force [N/m]"]) for row in rows] == (2 * numbers).tolist()
    assert [row["iterations"] for row in rows] == ["1", "2"]


@pytest.mark.parametrize(
    ("metres", "digits", "shown"),
    [(8.04e-4, 2, "800 um"), (9.996e-7, 3, "1000 nm"), (-1.26e-4, 1, "-100 um"), (1.5e-9, 2, "1.5 nm")],
)
def test_few_digits_of_a_length_are_written_without_an_exponent(
    metres: float, digits: int, shown: str
) -> None:
    # lengths in nm by default; millimetres begin at 1000 um
    assert Laboratory(UnitSystem()).text(metres * 1e9, "length", digits) == shown


def test_values_of_columns_in_sentences() -> None:
    angle, length = Column("theta_deg", "degree"), Column("displacement", "L0")
    assert [angle.text(value) for value in (1.0, 74.1647)] == ["1 degree", "74.1647 degrees"]
    text = f"the path turns back at {angle.text(74.1647)}, {angle.text(1.0)} and {length.text(2.0)}"
    assert NANO.sentence(text) == "the path turns back at 74.1647 deg, 1 deg and 2 nm"
