"""Where an equilibrium loses its stability the path locates the bifurcation and takes the stable branch."""

from dataclasses import replace
from math import cos, pi, sqrt

import numpy as np
import pytest
from paths import gained, paths, worth

from isopeel.assembly.system import System
from isopeel.problem import Support, strip
from isopeel.solve.bifurcation import _preferred
from isopeel.solve.newton import NewtonResult, NewtonSettings
from isopeel.solve.path import Path
from isopeel.solve.step import Found, Step
from isopeel.splines.rows import row_space

TAPE = """
name = "tape-180"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
length = "20 mm"
height = "0.1 mm"
[material]
law = "neo-hooke"
youngs_modulus = "300 MPa"
poissons_ratio = 0.3
[adhesion]
law = "exponential"
strength = "0.5 MPa"
work_of_adhesion = "0.1 N/mm"
length = "17 mm"
sliding_length = "0.1 mm"
[discretization]
space = "N2.1"
mesh = "80x2"
[drive]
kind = "force"
side = "right"
angle = "180 deg"
{rest}
"""

PET = """
name = "pet180"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
length = "4 mm"
height = "25 um"
[material]
law = "neo-hooke"
youngs_modulus = "4 GPa"
poissons_ratio = 0.4
[adhesion]
law = "bilinear"
strength = "1 MPa"
rise = 0.1
work_of_adhesion = "50 J/m^2"
length = "3 mm"
[discretization]
space = "N2.1"
mesh = "160x2"
{drives}
"""

STRIP = """
name = "film"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
length = "20 mm"
height = "0.2 mm"
[material]
law = "neo-hooke"
youngs_modulus = "1000 MPa"
poissons_ratio = 0.3
[adhesion]
law = "exponential"
strength = "1e-6 MPa"
work_of_adhesion = "1e-7 N/mm"
length = "5 mm"
[substrate]
gap = "3 mm"
[held]
left = "xy"
[discretization]
space = "N2"
mesh = "24x2"
across_degree = 2
[drive]
{drive}
"""

HELD = 'kind = "displacement"\nside = "right"\nangle = "180 deg"\ntransverse = "held"'
FREE = 'kind = "force"\nside = "right"\nangle = "180 deg"'


def kendall(E: float, nu: float, h: float, W: float, angle: float) -> float:
    """Force per width: S^2 / (2 E' h) + S (1 - cos a) = W."""
    stiffness, a = E / (1 - nu**2) * h, 1 - cos(angle)
    return stiffness * (sqrt(a * a + 2 * W / stiffness) - a)


def euler(shape: float) -> tuple[float, float]:
    """Critical shortening and force per width of the strip: shape x E' I / L^2."""
    E, h, length = 1000 / (1 - 0.3**2), 0.2, 20.0
    force = shape * E * h**3 / 12 / length**2
    return force / (E * h) * length, force


def bifurcations(steps: list[Step]) -> list[Step]:
    return [step for step in steps if step.kind == "bifurcation"]


def test_a_tape_pulled_back_folds_over_and_peels() -> None:
    """It used to crumple into loops: plateau 0.0714, largest force 0.31, for 0.04998."""
    text = TAPE.format(rest='to = "9 mm"\nstep = "0.25 mm"')
    (steps,) = paths(text)
    plateau = [step.reaction for step in steps if step.parameter >= 7.5]
    expected = kendall(300.0, 0.3, 0.1, 0.1, pi)
    # the process zone, and the mesh of this shortened tape
    assert np.mean(plateau) == pytest.approx(expected, rel=0.01)
    assert max(step.reaction for step in steps) < 1.05 * expected
    assert max(gained(steps)) <= 1e-6 * worth(text)


def test_polyester_is_pulled_at_180_degrees_without_a_turn_before() -> None:
    drives = '[drive]\nkind = "force"\nside = "right"\nangle = "180 deg"\nto = "4 mm"\nstep = "0.1 mm"'
    (steps,) = paths(PET.format(drives=drives))
    # 1 mm free, folded over after 2 mm; the curvature still grows, as the free arm is short: 1 %
    assert steps[-1].reaction == pytest.approx(kendall(4000.0, 0.4, 0.025, 0.05, pi), rel=0.01)
    (lost,) = bifurcations(steps)
    # a column clamped where the joint ends, which gives way: (pi/2)^2 E' I / L^2 is an upper bound
    critical = (pi / 2) ** 2 * 4000 / (1 - 0.4**2) * 0.025**3 / 12 / 1.0**2
    assert 0.7 * critical < lost.reaction < critical


def test_polyester_is_pulled_at_180_degrees_after_a_turn() -> None:
    drives = """
[[drive]]
kind = "rotation"
side = "right"
to = "150 deg"
step = "10 deg"
[[drive]]
kind = "force"
side = "right"
angle = "180 deg"
to = "2.5 mm"
step = "0.1 mm"
"""
    steps = paths(PET.format(drives=drives))[-1]
    assert steps[-1].reaction == pytest.approx(kendall(4000.0, 0.4, 0.025, 0.05, pi), rel=0.02)
    assert {step.kind for step in steps} <= {"requested", "between"}


@pytest.mark.parametrize("step", ["0.0004 mm", "0.005 mm", "0.02 mm"])
def test_a_strip_between_two_clamps_buckles_at_eulers_load(step: str) -> None:
    """Whether the step is a small part of the critical shortening, or three times that."""
    text = STRIP.format(drive=f'{HELD}\nto = "0.04 mm"\nstep = "{step}"')
    (steps,) = paths(text)
    (lost,) = bifurcations(steps)
    shortening, force = euler(4 * pi**2)
    # shear and the thickness take off some (h/L)^2, the mesh adds as much
    assert lost.parameter == pytest.approx(shortening, rel=0.01)
    # the clamps keep the ends from growing thicker
    assert lost.reaction == pytest.approx(force, rel=0.02)
    assert all(step.negative_eigenvalues in (0, None) for step in steps)
    # buckled, the force hardly grows while the shortening does six times
    assert steps[-1].reaction == pytest.approx(force, rel=0.02)
    assert np.ptp(steps[-1].displacement[:, 1]) > 0.1


@pytest.mark.parametrize("step", [0.0001, 0.00037, 0.0004, 0.001])
def test_no_step_is_made_on_the_unstable_branch_before_that(step: float) -> None:
    """A tangent of a stable state served on: up to two steps lay beyond the bifurcation that came next."""
    (steps,) = paths(STRIP.format(drive=f'{HELD}\nto = "0.012 mm"\nstep = "{step} mm"'))
    assert len(bifurcations(steps)) == 1
    assert np.diff([one.parameter for one in steps]).min() > 0.0


@pytest.mark.parametrize("share", [1e-4, 1e-3, 0.009])
def test_a_bifurcation_right_after_a_step_is_one(share: float) -> None:
    """It was taken for another branch, because the states of both sides were far from each other."""
    step = 0.0066441406 / 6 / (1 + share / 6)
    (steps,) = paths(STRIP.format(drive=f'{HELD}\nto = "{8 * step} mm"\nstep = "{step} mm"'))
    (lost,) = bifurcations(steps)
    assert lost.parameter == pytest.approx(0.0066441406, rel=1e-3)
    assert lost.parameter == pytest.approx(6 * step, abs=0.01 * step)


@pytest.mark.parametrize("step", [0.0000125, 0.0001])
def test_a_bifurcation_is_located_under_an_unknown_load(step: float) -> None:
    (steps,) = paths(STRIP.format(drive=f'{FREE}\nto = "0.0006 mm"\nstep = "{step} mm"'))
    (lost,) = bifurcations(steps)
    # to a thousandth of the step or of itself, whichever is less
    assert lost.parameter == pytest.approx(4.12e-4, abs=1e-6)
    assert np.diff([one.parameter for one in steps]).min() > 0.0


@pytest.mark.parametrize(("to", "drive"), [(0.0068, HELD), (0.00042, FREE), (0.0066441406, HELD)])
def test_the_last_step_is_checked(to: float, drive: str) -> None:
    """However little it lies beyond the bifurcation, and whatever tangent was used."""
    (steps,) = paths(STRIP.format(drive=f'{drive}\nto = "{to} mm"\nstep = "{to / 17} mm"'))
    beyond = to > (6.64424e-3 if drive == HELD else 4.1196e-4)
    assert len(bifurcations(steps)) == beyond
    assert steps[-1].negative_eigenvalues in (0, None)
    assert (np.ptp(steps[-1].displacement[:, 1]) > 1e-3) == beyond


def test_a_column_that_is_free_at_its_end_buckles_at_a_sixteenth_of_that() -> None:
    text = STRIP.format(drive=f'{FREE}\nto = "0.002 mm"\nstep = "0.0001 mm"')
    (steps,) = paths(text)
    (lost,) = bifurcations(steps)
    assert lost.reaction == pytest.approx(euler(pi**2 / 4)[1], rel=0.01)
    assert steps[-1].reaction == pytest.approx(lost.reaction, rel=0.02)


def test_a_column_under_a_dead_load_finds_its_buckled_state() -> None:
    """A little above the critical load, where the elastica has a closed form to the first order."""
    critical = euler(pi**2 / 4)[1]
    load = 1.02 * critical
    text = STRIP.format(drive=f'{FREE}\ncontrol = "force"\nto = "{load} N/mm"\nstep = "{load / 6} N/mm"')
    (steps,) = paths(text)
    (lost,) = bifurcations(steps)
    assert lost.parameter == pytest.approx(critical, rel=0.01)
    # P/P_c = 1 + k^2/2 and the tip at (4 L/pi) k, k the sine of half of the slope there (Timoshenko and Gere)
    tip = 4 * 20 / pi * sqrt(2 * (steps[-1].parameter / lost.parameter - 1))
    assert np.abs(steps[-1].displacement[:, 1]).max() == pytest.approx(tip, rel=0.1)


def test_continuation_stays_on_the_unstable_branch_and_reports_it() -> None:
    text = STRIP.format(drive=f'{HELD}\nto = "0.02 mm"\nstep = "0.002 mm"')
    (steps,) = paths(text, "continuation")
    shortening, force = euler(4 * pi**2)
    message = {step.negative_eigenvalues for step in steps if step.parameter > 1.2 * shortening}
    assert 1 in message
    assert 0 not in message
    assert steps[-1].reaction == pytest.approx(force * 0.02 / shortening, rel=0.02)


def test_newton_stays_on_it_where_nothing_is_gained() -> None:
    text = STRIP.format(drive=f'{HELD}\nto = "0.02 mm"\nstep = "0.002 mm"')
    (steps,) = paths(text, "newton")
    assert all(step.negative_eigenvalues is None for step in steps)
    shortening, force = euler(4 * pi**2)
    assert steps[-1].reaction == pytest.approx(force * 0.02 / shortening, rel=0.02)


def test_the_branch_away_from_the_substrate_is_taken_beside_a_body_without_an_interface() -> None:
    """Its infinite gaps made all sums equal, so that the last branch was taken."""
    one = strip()
    beside = replace(one.body, name="beside")
    held = Support(beside.side("left"), (0, 1))
    problem = replace(one, bodies=(one.body, beside), supports=(*one.supports, held))
    space = row_space("N2", (4, 1))
    path = Path(System(problem, {one.body.name: space, "beside": space}), NewtonSettings(), ())
    y, rest = np.zeros(path.system.count), np.zeros((2 * space.size, 2))
    at = path.system.equilibrium(rest)
    near, far = (Found(NewtonResult(0.0, y, rest + rise, 0.0, at, ())) for rise in (0.1, 0.2))
    # mirror images: both have the same energy, and no point is inside the substrate
    for tried in ([(1.0, near), (1.0, far)], [(1.0, far), (1.0, near)]):
        assert _preferred(path, tried, 2.0) is far
