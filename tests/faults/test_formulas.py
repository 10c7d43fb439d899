"""Formulas of laws with a pole in reach, or with constants that they do not use, are refused in one line."""

from pathlib import Path

import numpy as np
import pytest

import isopeel
from isopeel.cli import main
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.physics.adhesion import AdhesionLaw
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.batch import evaluate_law
from isopeel.physics.formula_poles import poles

W, D = 0.05, 0.4
LENNARD_JONES = "W*((d/r)**8/3 - 4/3*(d/r)**2)"
STRIP = isopeel.load_case("strip").text
LAW = 'law = "van-der-waals"\nhamaker_constant = "1e-19 J"\nequilibrium_distance = "0.4 nm"'


def at(law: AdhesionLaw, gaps: FloatArray) -> tuple[FloatArray, ...]:
    return evaluate_law(law.kernel, law.parameters, gaps, np.zeros_like(gaps))


def law(formula: str, **constants: float) -> isopeel.FormulaAdhesion:
    return isopeel.FormulaAdhesion(formula, {"W": W, "d": D, **constants})


@pytest.mark.parametrize(
    ("formula", "gap"),
    [
        ("-W*d/(r-d)", "0.4"),
        ("-W/(r/d - 1)**2", "0.4"),
        (f"{LENNARD_JONES} + 1e-3*W*d**2/(r - 2*d)**2", "0.8"),
        (f"{LENNARD_JONES} + 1e-3*W*d**2/(r**2 - 6*d*r + 9*d**2)", "1.2"),
        (f"{LENNARD_JONES} + 1e-6*W*d/(r - 100*d)", "40"),
        ("W*log((r - d)**2/d**2)*exp(-r/d)", "0.4"),
        ("-W*exp(-(r/d - 1)**2) + 1e-3*W*tan(r/d)*exp(-r/d)", "0.628319"),
    ],
)
def test_a_pole_where_a_joint_opens_is_named(formula: str, gap: str) -> None:
    with pytest.raises(InputError, match=f"it has a pole at the gap r = {gap}") as caught:
        law(formula)
    assert caught.value.field == "adhesion.potential"


@pytest.mark.parametrize(
    "formula",
    ["-W/cosh(r/d)", f"{LENNARD_JONES} + 0*sqrt(d - r)*W", f"{LENNARD_JONES} - W*sqrt(9 - r/d)*1e-9"],
)
def test_a_law_without_values_where_a_joint_opens_is_refused(formula: str) -> None:
    if "0*sqrt" in formula:  # which is no part of it any more, and does no harm
        assert law(formula).work_of_adhesion == pytest.approx(W, rel=1e-12)
        return
    with pytest.raises(InputError, match="it has no value at the gap r = "):
        law(formula)


@pytest.mark.parametrize(
    "formula", ["-W*exp(-((r-d)/d)**2) - 1e-4*W*d/r", "-W*exp(-(r/d - 1)**2) - 1e-3*W*d**2/(r+d)**2"]
)
def test_a_law_that_attracts_without_bound_is_refused(formula: str) -> None:
    with pytest.raises(InputError, match=r"it attracts without bound at the gap r = (0|-0.4)"):
        law(formula)


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_pole_below_the_equilibrium_bounds_the_gaps(mirrored: bool) -> None:
    # Lennard-Jones in the opening x = r, whose pole is at x = -d
    shifted = law(LENNARD_JONES.replace("d/r", "d/(r+d)"))
    plain = law(LENNARD_JONES)
    half = 0.5 if mirrored else 1.0
    gaps = half * np.array([-0.9, -0.1, 0.0, 0.3, 5.0]) * D
    chosen: tuple[AdhesionLaw, ...] = (shifted, plain)
    if mirrored:
        chosen = tuple(Mirrored(one) for one in chosen)
    one, other = chosen
    values = at(one, gaps)
    expected = at(other, gaps + half * D)
    for found, wanted in zip(values, expected, strict=True):
        # the same formula, rounded elsewhere: a gap of a tenth loses a digit
        np.testing.assert_allclose(found, wanted, rtol=1e-12, atol=1e-13 * np.abs(wanted).max())
    beyond = at(one, half * np.array([-1.1, -3.0]) * D)
    assert np.isnan(beyond).all()


@pytest.mark.parametrize(
    ("formula", "unused"),
    [
        (LENNARD_JONES.replace("W", "0.05"), "W"),
        (LENNARD_JONES.replace("d", "0.4"), "d"),
        (LENNARD_JONES, "s"),
    ],
)
def test_a_constant_that_is_not_used_is_named(formula: str, unused: str) -> None:
    with pytest.raises(InputError, match="the formula does not use it") as caught:
        law(formula, **({"s": 1.0} if unused == "s" else {}))
    assert caught.value.field == f"adhesion.constants.{unused}"


def test_other_formulas_use_their_constants_too() -> None:
    with pytest.raises(InputError, match=r"material.constants.c: 1.0 cannot be used; the formula does not"):
        isopeel.FormulaMaterial("m*(I1 - 3 - 2*log(J))/2 + m*(J - 1)**2", {"m": 1.0, "c": 1.0})
    with pytest.raises(InputError, match=r"substrate.constants.b: 2.0 cannot be used; the formula does not"):
        isopeel.FormulaSubstrate("a*sin(x/a)", {"a": 1.0, "b": 2.0})


@pytest.mark.parametrize(
    ("symmetric", "potential", "constants", "field"),
    [
        (False, "-W/(r/d - 1)**2", "", "adhesion.potential"),
        (True, f"{LENNARD_JONES} + 1e-3*W*d**2/(r - 2*d)**2", "", "adhesion.potential"),
        (True, LENNARD_JONES, ', unused = "3 nm"', "adhesion.constants.unused"),
        (False, LENNARD_JONES, ", n = 4", "adhesion.constants.n"),
    ],
)
def test_a_case_with_such_a_formula_is_refused_in_one_line(
    symmetric: bool,
    potential: str,
    constants: str,
    field: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    written = f'law = "formula"\npotential = "{potential}"\nsymmetric = {str(symmetric).lower()}\n'
    written += f'constants = {{ W = "0.05 J/m^2", d = "0.4 nm"{constants} }}'
    file = tmp_path / "case.toml"
    file.write_text(STRIP.replace(LAW, written))
    assert main(["run", str(file), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"isopeel: {field}: ")
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("power", [1, 2, 3, 6])
@pytest.mark.parametrize("place", [-3.21, 1e-9, 0.7, 1234.5])
def test_a_pole_is_found_where_it_is(power: int, place: float) -> None:
    places = np.concatenate([-np.geomspace(1e-12, 1e9, 48_001)[::-1], np.geomspace(1e-12, 1e9, 48_001)])
    (found,) = poles(lambda x: np.cos(x / place) + (0.1 * place) ** power / (x - place) ** power, places)
    assert found == pytest.approx(place, rel=1e-9)  # an interval of a thousandth, cut to round-off
    # a peak of a hundredth of its place, of any height, is none
    assert len(poles(lambda x: 1e9 / (1 + ((x - place) / (0.01 * place)) ** (2 * power)), places)) == 0
