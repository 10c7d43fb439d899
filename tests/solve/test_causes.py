"""Why a step finds no equilibrium: each cause, where it is true."""

from dataclasses import replace

import numpy as np
import pytest

from isopeel.assembly.system import System
from isopeel.matrix.factor import SingularError
from isopeel.physics.adhesion.formula import FormulaAdhesion
from isopeel.problem import MovedSide, Problem, PulledSide, strip
from isopeel.solve import continuation_control, jumps, stability
from isopeel.solve import newton as newton_module
from isopeel.solve.convergence import HINTS, ConvergenceError
from isopeel.solve.descent import Descent
from isopeel.solve.newton import NewtonSettings, newton
from isopeel.solve.path import Path
from isopeel.solve.trace import trace
from isopeel.splines.rows import row_space

SPACE = row_space("N2", (40, 2))


def failure(problem: Problem, parameters: list[float], settings: NewtonSettings) -> ConvergenceError:
    with pytest.raises(ConvergenceError) as caught:
        list(trace(problem, SPACE, parameters, settings))
    assert caught.value.hint == HINTS[caught.value.cause]
    return caught.value


def test_an_inverted_element_is_reported_with_its_place() -> None:
    """The right face is pushed through the body, which starts at rest."""
    system = System(replace(strip(), drive=MovedSide("right", np.pi, "held")), SPACE)
    with pytest.raises(ConvergenceError) as caught:
        newton(system, np.zeros(system.count), 300.0, NewtonSettings())
    assert caught.value.cause == "inverted element"
    located = caught.value.located(system)
    assert located.cause == "inverted element"
    assert "det F = -" in located.reason
    assert "X = (" in located.reason


def test_a_limit_point_is_reported_where_the_curve_turns_back() -> None:
    found = failure(strip(), np.radians(np.arange(0.0, 150.0)).tolist(), NewtonSettings(plain=True))
    assert found.cause == "limit point"
    # the curve itself does turn back, before the parameter that has no equilibrium near
    settings = NewtonSettings(path_control="continuation")
    steps = trace(strip(), SPACE, np.radians(np.arange(0.0, 150.0)), settings)
    limit = next(step for step in steps if step.kind == "limit point")
    assert found.parameter - np.radians(1.0) < limit.parameter < found.parameter


def test_too_few_iterations_are_reported() -> None:
    found = failure(strip(), [0.0, 0.02], NewtonSettings(plain=True, iteration_limit=2))
    assert found.cause == "iteration limit"
    assert len(found.iterations) == 2


def test_a_force_that_is_not_finite_is_reported() -> None:
    """A law with a pole at the substrate has no value below it."""
    law = FormulaAdhesion("W*((s/r)**8/3 - 4/3*(s/r)**2)", {"W": 0.03, "s": 0.25})
    system = System(strip(law=law), SPACE)
    below = np.zeros((SPACE.size, 2))
    below[:, 1] = -2 * law.equilibrium_gap
    with pytest.raises(ConvergenceError) as caught:
        newton(system, system.unknown_values(below, 0.0), 0.0, NewtonSettings())
    assert caught.value.cause == "non-finite traction"
    assert caught.value.reason == "the forces are not finite"


def test_a_singular_tangent_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    """A pivot that vanishes to the last bit needs a special tangent: here the factorization is replaced."""

    def singular(_matrix: object) -> None:
        raise SingularError("pivot 7 is zero")

    monkeypatch.setattr(newton_module, "factorize", singular)
    found = failure(strip(), [0.0], NewtonSettings(plain=True))
    assert found.cause == "singular tangent"
    assert "pivot 7" in found.reason


def test_a_curve_that_begins_at_a_singular_tangent_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    """The factor of an indefinite tangent may be refused too: it escaped as an error of the matrix."""

    def singular(_matrix: object) -> None:
        raise SingularError("pivot 7 is zero")

    monkeypatch.setattr(continuation_control, "_regular", lambda *_: None)
    monkeypatch.setattr(stability, "factorize", singular)
    found = failure(strip(), [0.0, 0.1], NewtonSettings(path_control="continuation"))
    assert found.cause == "singular tangent"
    assert "pivot 7" in found.reason


def test_a_failed_line_search_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    """Round-off ends a search: it is handed such an end here, far from any equilibrium."""
    system = System(strip(), SPACE)
    path = Path(system, NewtonSettings(iteration_limit=1, path_control="auto"), ())
    monkeypatch.setattr(
        jumps, "descend", lambda _system, start, *_rest: Descent(start, line_search_failed=True)
    )
    with pytest.raises(ConvergenceError) as caught:
        jumps.jump_from(path, [np.zeros(system.count)], 0.02)
    assert caught.value.cause == "line search"
    assert "the line search of the descent failed" in caught.value.reason


def test_a_force_beyond_the_joints_strength_finds_no_equilibrium() -> None:
    """Raised, a dead force passes the largest that the joint can bear: there is none beyond, and no jump."""
    problem = replace(strip(), drive=PulledSide("top", np.pi / 2, control="force"))
    found = failure(problem, [0.0, 0.1, 100.0], NewtonSettings(path_control="auto"))
    assert found.cause == "limit load"
    assert "no equilibrium was found beyond 0.214788 E0 L0" in found.reason
