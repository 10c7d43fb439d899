"""A wide block whose joint opens at its edge comes off as a whole: a jump, with the energy released."""

import pytest
from paths import as_far_as_it_goes, gained, paths, worth

from isopeel.solve import jumps
from isopeel.solve.convergence import HINTS
from isopeel.solve.descent import Descent
from isopeel.solve.path import Path

STAMP = """
name = "stamp"
[units]
length = "1 um"
stress = "1 MPa"
[body]
shape = "strip"
length = "500 um"
height = "1 mm"
[material]
law = "neo-hooke"
youngs_modulus = "2 MPa"
poissons_ratio = {nu}
[adhesion]
law = "{law}"
strength = "{strength} MPa"
{rise}
sliding_length = "0.1 um"
work_of_adhesion = "{W} J/m^2"
[discretization]
space = "N2.1"
mesh = "{mesh}"
grading = [0.02, 50]
[drive]
kind = "displacement"
side = "top"
angle = "90 deg"
transverse = "held"
to = "{to} um"
step = "{step} um"
"""


def stamp(**values: object) -> str:
    law = {"law": "bilinear", "rise": "rise = 0.1", "W": 0.1, "strength": 1}
    return STAMP.format(**law | {"nu": 0.49, "mesh": "30x6", "to": 20, "step": 4} | values)


CASES = {
    "as it was reported": stamp(),
    "compressible": stamp(nu=0.4, W=0.01, strength=0.2),
    "exponential": stamp(law="exponential", rise="", strength=0.3),
    "weak": stamp(W=0.02, strength=0.3),
}
#: On meshes as coarse as these some come off by more jumps than one, or not at all as requested.
OFF = ("compressible", "exponential", "weak")


@pytest.mark.parametrize("name", CASES)
def test_a_stamp_comes_off_with_the_energy_released(name: str) -> None:
    """Finer meshes ended as an inverted element; the smallest step was cut down to round-off before."""
    text = CASES[name]
    (steps,) = paths(text)
    jumps = [step for step in steps if step.kind == "jump"]
    assert jumps
    assert all(step.released_energy > 0.0 for step in jumps)
    assert max(gained(steps)) <= 1e-6 * worth(text)
    if name in OFF:
        assert steps[-1].reaction == pytest.approx(0.0, abs=1e-9)
        assert steps[-1].adhesive_energy == pytest.approx(0.0, abs=1e-9)
    # a limit point is located to a share of a step, and no further
    assert len(steps) < 60


def test_a_descent_stops_where_the_joint_is_half_open(monkeypatch: pytest.MonkeyPatch) -> None:
    """The body without its joint is not looked at there."""
    text = stamp(nu=0.4, W=0.01, strength=0.2, to=9.6)
    looked: list[float] = []

    def come_off(_path: Path, _descent: Descent, parameter: float) -> None:
        looked.append(parameter)

    monkeypatch.setattr(jumps, "_come_off", come_off)
    (steps,) = paths(text)
    (jump,) = [step for step in steps if step.kind == "jump"]
    assert jump.reaction > 5.0
    assert jump.adhesive_energy < -0.1
    assert not looked


@pytest.mark.parametrize(
    "values",
    [
        {"nu": 0.4, "W": 0.01, "strength": 0.2, "mesh": "60x8"},
        {"nu": 0.4, "W": 0.01, "strength": 0.2, "mesh": "60x10"},
    ],
)
def test_a_fine_mesh_comes_to_rest_by_itself(
    values: dict[str, object], monkeypatch: pytest.MonkeyPatch
) -> None:
    """After 200 corrections these were taken without their joint, which skips what lies on the way."""

    def come_off(_path: Path, _descent: Descent, _parameter: float) -> None:
        raise AssertionError("the fall has not come to rest")

    monkeypatch.setattr(jumps, "_come_off", come_off)
    (steps,) = paths(stamp(**values))
    assert steps[-1].adhesive_energy == pytest.approx(0.0, abs=1e-9)


def test_a_descent_that_does_not_converge_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jumps, "descend", lambda _system, start, *_rest: Descent(start, is_unfinished=True))
    steps, error = as_far_as_it_goes(stamp())
    assert steps[-1].reaction > 30.0
    assert error is not None
    assert error.cause == "long fall"
    assert "has not ended" in error.reason
    assert error.hint == HINTS["long fall"]
