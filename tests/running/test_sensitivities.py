"""Sensitivities of a run are the derivatives that runs with other values of the parameters have."""

from typing import Any

import numpy as np
import pytest

from isopeel.case import Case, load_case
from isopeel.common.errors import InputError
from isopeel.running.in_memory import stage_results
from isopeel.solve.newton import NewtonSettings

#: What the issue asks for. Central differences of fourth order have an error of 1e-9 with the shares below.
ALLOWED = 1e-6
#: Shares of the parameter in the differences: round-off of the reaction, 1e-13 with the tolerance below, is
#: divided by it.
SHARE = 1e-3


@pytest.fixture
def tightened(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let all runs converge to round-off: reactions are otherwise known to 5e-9 only."""
    _, *others = NewtonSettings.__init__.__defaults__ or ()
    monkeypatch.setattr(NewtonSettings.__init__, "__defaults__", (1e-28, *others))


def reactions(case: Case) -> list[Any]:
    """Return the curves of the stages."""
    return [results.run.curve for results in stage_results(case)]


def check(case: Case, keys: list[str], allowed: float = ALLOWED) -> None:
    """Compare sensitivities of all stages with central differences, as shares of the largest one."""
    runs = [results.run for results in stage_results(case, keys)]
    assert runs[-1].ending == "completed"
    found = [run.curve for run in runs]
    for k, key in enumerate(keys):
        value, unit = found[0].sensitive_to[k].value, found[0].sensitive_to[k].unit

        def curves(share: float, key: str = key, value: float = value, unit: str = unit) -> list[Any]:
            other = value * (1 + share)
            return reactions(case.with_values({key: f"{other!r} {unit}" if unit else other}))

        varied = {multiple: curves(multiple * SHARE) for multiple in (-2, -1, 1, 2)}
        for stage, curve in enumerate(found):
            one = {multiple: curves[stage] for multiple, curves in varied.items()}
            for other in one.values():
                np.testing.assert_array_equal(other.parameter, curve.parameter)
            far, near = one[2].reaction - one[-2].reaction, one[1].reaction - one[-1].reaction
            expected = (8 * near - far) / (12 * SHARE * value)
            deviation = np.abs(curve.sensitivities[:, k] - expected).max() / np.abs(expected).max()
            assert deviation < allowed, f"{key}, stage {stage}: {deviation:.1e}"


@pytest.mark.usefixtures("tightened")
def test_of_a_reversible_strip() -> None:
    values = {"discretization.mesh": "40x2", "drive.to": "12 deg", "drive.step": "1 deg", "reading": None}
    keys = ["adhesion.hamaker_constant", "material.youngs_modulus", "material.poissons_ratio", "body.height"]
    check(load_case("strip").with_values(values), keys)


@pytest.mark.parametrize(
    ("key", "says"),
    [
        ("adhesion.hamaker", "the case states no 'hamaker' there"),
        ("adhesion.law", "one number is needed"),
        ("drive.to", "does not depend on it"),
        ("discretization.mesh", "does not depend on it"),
        ("", "the case states no '' there"),
    ],
)
def test_what_is_no_parameter(key: str, says: str) -> None:
    with pytest.raises(InputError, match=says) as caught:
        next(stage_results(load_case("strip"), [key]))
    assert caught.value.field == key or not key


def test_a_run_without_them_has_none() -> None:
    values = {"discretization.mesh": "40x2", "drive.to": "2 deg", "drive.step": "1 deg", "reading": None}
    (results,) = stage_results(load_case("strip").with_values(values))
    assert results.run.curve.sensitive_to == ()
    assert results.run.curve.sensitivities.shape == (3, 0)
