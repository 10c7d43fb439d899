"""No step gains energy without work of its drive, whatever the law, the shape and the path control."""

from dataclasses import replace

import numpy as np
import pytest
from paths import as_far_as_it_goes, energies, gained, paths, worth

from isopeel.common.path_control import PathControl
from isopeel.problem import strip
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.newton import NewtonResult, NewtonSettings
from isopeel.solve.solver import Solver
from isopeel.solve.step import Step
from isopeel.solve.trace import trace
from isopeel.splines.rows import row_space

CYLINDER = """
name = "cylinder-pull-off"
[body]
shape = "quarter-cylinder"
radius = "306.4 nm"
[material]
law = "neo-hooke"
youngs_modulus = "6.3294 MPa"
poissons_ratio = 0.45
[adhesion]
law = "exponential"
strength = "2.0892 MPa"
work_of_adhesion = "1.9792e-05 J/m^2"
length = "21.429 nm"
[discretization]
space = "N2"
mesh = "48x10"
across_degree = 2
grading = [200, 200]
[drive]
kind = "displacement"
side = "top"
angle = "90 deg"
to = "-0.14 nm"
step = "0.01 nm"
"""

CANTILEVERS = """
name = "dcb"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
length = "60 mm"
height = "2 mm"
[material]
law = "neo-hooke"
youngs_modulus = "70000 MPa"
poissons_ratio = 0.3
[adhesion]
law = "bilinear"
strength = "{strength} MPa"
rise = 0.1
work_of_adhesion = "0.3 N/mm"
length = "40 mm"
irreversible = {irreversible}
[held]
left = "xy"
[discretization]
space = "{space}"
mesh = "{mesh}"
[drive]
kind = "force"
side = "right"
angle = "90 deg"
to = "3 mm"
step = "0.3 mm"
"""

BLOCK = """
name = "block"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
length = "2 mm"
height = "20 mm"
[material]
law = "neo-hooke"
youngs_modulus = "1 MPa"
poissons_ratio = 0.0
[adhesion]
law = "exponential"
strength = "0.05 MPa"
work_of_adhesion = "0.001 N/mm"
[held]
left = "x"
[discretization]
space = "L1"
mesh = "1x1"
[drive]
kind = "displacement"
side = "top"
angle = "90 deg"
to = "{to} mm"
step = "{step} mm"
"""


def check(text: str, steps: list[Step]) -> None:
    assert max(gained(steps)) <= 1e-6 * worth(text)


@pytest.mark.long
def test_a_cylinder_does_not_climb_to_another_branch() -> None:
    """Pressed from -0.1075 to -0.1125 nm its energy rose by 34 % of its range."""
    (steps,) = paths(CYLINDER)
    check(CYLINDER, steps)
    assert np.ptp(energies(steps)) < 1e-5  # E0 L0^3; the other branch lies 9e-5 higher


def test_newton_ends_before_it_with_the_cause() -> None:
    steps, error = as_far_as_it_goes(CYLINDER, "newton")
    check(CYLINDER, steps)
    assert error is not None
    assert error.cause == "limit point"
    assert "-0.104239" in error.reason  # where its curve turns back


@pytest.mark.parametrize("path_control", ["newton", "auto"])
def test_a_state_of_more_energy_than_the_work_is_refused(
    path_control: PathControl, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As if Newton's method had met another branch, at all steps but the first few."""
    worth, space = 0.015 * 150, row_space("N2", (20, 2))
    found = Solver.equilibrium

    def elsewhere(solver: Solver, parameter: float, *, soon: bool = False) -> NewtonResult:
        one = found(solver, parameter, soon=soon)
        if parameter < 0.01:
            return one
        more = one.equilibrium.stored_energy + 1e-4 * worth
        return replace(one, equilibrium=replace(one.equilibrium, stored_energy=more))

    monkeypatch.setattr(Solver, "equilibrium", elsewhere)
    steps: list[Step] = []
    going = trace(strip(), space, np.linspace(0, 0.02, 5), NewtonSettings(path_control=path_control))
    if path_control == "newton":
        with pytest.raises(ConvergenceError, match="without work of the drive") as caught:
            steps.extend(iter(lambda: next(going), None))
        assert caught.value.cause == "energy without work"
        assert len(steps) == 2
    else:
        # the minimization of the energy returns to the branch
        steps = list(going)
        assert steps[-1].parameter == 0.02
        assert max(gained(steps)) <= 1e-6 * worth


@pytest.mark.parametrize("path_control", ["auto", "newton", "jump", "continuation"])
@pytest.mark.parametrize("irreversible", ["false", "true"])
def test_cantilevers_on_a_hopeless_mesh(path_control: PathControl, irreversible: str) -> None:
    text = CANTILEVERS.format(strength=30, irreversible=irreversible, space="N2", mesh="20x1")
    steps, _ = as_far_as_it_goes(text, path_control)
    assert len(steps) > 3
    check(text, steps)


def test_a_joint_that_breaks_within_one_step_is_cut_to_where_it_breaks() -> None:
    """A soft block comes off at 20 times its strength over E and what the joint opens by: 1.007 mm."""
    peak = 20 * 0.05 + 0.001 / np.e / 0.05
    text = BLOCK.format(to=4.0, step=2.0)
    (steps,) = paths(text)
    check(text, steps)
    (jump,) = [step for step in steps if step.kind == "jump"]
    assert jump.parameter == pytest.approx(peak, abs=2.0 / 16 + 0.05)
    # all that was stored: half of force times displacement, less what the joint takes
    assert jump.released_energy == pytest.approx(0.5 * 0.05 * 2 * peak - 0.001 * 2, rel=0.15)
    assert abs(steps[-1].reaction) < 1e-6


@pytest.mark.parametrize("step", [0.04, 0.3])
def test_the_place_of_the_jump_does_not_depend_on_the_step(step: float) -> None:
    (steps,) = paths(BLOCK.format(to=1.5, step=step))
    (jump,) = [one for one in steps if one.kind == "jump"]
    assert jump.parameter == pytest.approx(1.03, abs=step / 8 + 0.02)
