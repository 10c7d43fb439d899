"""Fits of curves that were computed with known values and noise."""

import numpy as np
import pytest

import isopeel
from isopeel.running.in_memory import traced_stages

pytestmark = pytest.mark.long

LAW = {"law": "exponential", "strength": "40 MPa", "work_of_adhesion": "0.02 J/m^2", "length": "150 nm"}
SETTINGS = {"discretization.mesh": "80x2", "drive.to": "60 deg", "drive.step": "2 deg", "reading": None}
CASE = isopeel.load_case("strip").with_values({"adhesion": LAW, **SETTINGS})


@pytest.fixture(scope="module")
def curve() -> isopeel.Curve:
    ((one, run),) = traced_stages(CASE)
    return one.laboratory.curve(run.curve)


def measured(curve: isopeel.Curve, first: float, count: int, seed: int) -> isopeel.Measured:
    """Points of a curve from an angle on, with noise of 1 %."""
    x = np.linspace(first, 60, count)
    y = np.interp(x, curve.parameter, curve.reaction)
    y += 0.01 * y.max() * np.random.default_rng(seed).standard_normal(count)
    return isopeel.Measured("twin.csv", ("rotation", "moment"), ("deg", "N m/m"), x, y)


def test_work_and_strength_are_found(curve: isopeel.Curve) -> None:
    start = {"adhesion.work_of_adhesion": "0.03 J/m^2", "adhesion.strength": "30 MPa"}
    found = isopeel.fit(CASE, measured(curve, 1, 60, 0), start, noise="1 %")
    work, strength = found.parameters
    # three standard errors of one seed; the benchmark has the share of many seeds
    assert work.value == pytest.approx(0.02, abs=3 * work.standard_error)
    assert strength.value == pytest.approx(40, abs=3 * strength.standard_error)
    assert work.relative_error < 0.01
    assert strength.relative_error < 0.1
    # 58 degrees of freedom: 99.8 % of all noise
    assert 30 < found.chi_square < 97


def test_steady_peeling_does_not_identify_the_strength(curve: isopeel.Curve) -> None:
    start = {"adhesion.strength": "38 MPa"}
    found = isopeel.fit(CASE, measured(curve, 55, 25, 1), start, noise="1 %")
    assert any(note.startswith("`adhesion.strength` cannot be identified") for note in found.notes)
