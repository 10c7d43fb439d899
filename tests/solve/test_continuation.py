"""Paths through limit points, against the closed form of a block that is pulled off by a softening force."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from isopeel.assembly.system import System
from isopeel.common.path_control import PathControl
from isopeel.physics.adhesion import Exponential
from isopeel.problem import MovedSide, Problem, PulledSide, strip
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.path import Path
from isopeel.solve.path_control import follow_path
from isopeel.solve.step import Step
from isopeel.solve.trace import trace
from isopeel.splines.rows import row_space

# a soft block on the van der Waals force: per area it gives 20 nm/E0, and the force softens by 0.3 E0/nm
HEIGHT, LENGTH = 20.0, 1.0
SPACE = row_space("L1", (1, 1))
R0, HAMAKER, POISSON = 0.4, 0.05, 0.2
REST = R0 / 15 ** (1 / 6)
PULL = np.arange(0.0, 3.01, 0.1)


def block() -> Problem:
    body = strip(length=LENGTH, height=HEIGHT, adhering_length=LENGTH)
    return replace(body, drive=MovedSide("top", np.pi / 2))


def tension(gap: float) -> float:
    """That of the flat law beyond its rest."""
    return HAMAKER / (2 * np.pi * R0**3) * ((R0 / gap) ** 3 / 3 - (R0 / gap) ** 9 / 45)


def stretch(stress: float) -> float:
    """Of a neo-Hookean block under a uniaxial nominal stress in plane strain, free at its sides."""
    first, shear = POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), 1 / (2 * (1 + POISSON))

    def across(along: float) -> float:
        # no stress across: mu (b - 1/b) + lambda ln(a b) / b = 0
        return float(brentq(lambda b: shear * (b * b - 1) + first * np.log(along * b), 0.5, 1.5, xtol=1e-15))

    def missed(along: float) -> float:
        bulk = first * float(np.log(along * across(along)))
        return shear * (along - 1 / along) + bulk / along - stress

    return float(brentq(missed, 0.9, 1.5, xtol=1e-15))


def pull(gap: float) -> float:
    """Displacement of the upper face at a gap: the path in closed form, single-valued in the gap."""
    return gap - REST + HEIGHT * (stretch(tension(gap)) - 1)


def gap_of(step: Step) -> float:
    bottom = SPACE.side_functions("bottom")
    return REST + float(step.displacement[bottom, 1].mean())


def path(path_control: PathControl) -> list[Step]:
    return list(trace(block(), SPACE, PULL, NewtonSettings(path_control=path_control)))


@pytest.fixture(scope="module")
def curve() -> list[Step]:
    return path("continuation")


def test_the_curve_is_that_of_the_closed_form(curve: list[Step]) -> None:
    gaps = [gap_of(step) for step in curve]
    # it is passed in order, backwards in the pull where it snaps back
    assert (np.diff(gaps) > 0).all()
    parameters = np.array([step.parameter for step in curve])
    assert np.diff(parameters).min() < 0
    np.testing.assert_allclose(parameters, [pull(gap) for gap in gaps], rtol=0, atol=1e-9)
    reactions = [step.reaction for step in curve]
    np.testing.assert_allclose(reactions, [LENGTH * tension(gap) for gap in gaps], rtol=0, atol=1e-9)
    assert set(PULL) <= {step.parameter for step in curve if step.kind == "requested"}


def test_a_force_that_is_unknown_follows_the_same_curve() -> None:
    """The force is the unknown, and the displacement where it acts the parameter."""
    problem = replace(block(), drive=PulledSide("top", np.pi / 2))
    steps = list(trace(problem, SPACE, PULL, NewtonSettings(path_control="continuation")))
    gaps = [gap_of(step) for step in steps]
    np.testing.assert_allclose([s.parameter for s in steps], [pull(gap) for gap in gaps], rtol=0, atol=1e-9)
    np.testing.assert_allclose([s.reaction for s in steps], [tension(gap) for gap in gaps], rtol=0, atol=1e-9)
    kinds = [step.kind for step in steps]
    first, second = (k for k, kind in enumerate(kinds) if kind == "limit point")
    assert {step.negative_eigenvalues for step in steps[first + 1 : second]} == {1}
    assert steps[-1].parameter == PULL[-1]


def test_a_joint_that_only_opens_snaps_back_as_if_it_could_heal() -> None:
    """Along the curve the gap grows, so that irreversible adhesion is never let close: one law, one curve."""
    law = Exponential(0.06, 0.02)
    body = strip(length=LENGTH, height=HEIGHT, adhering_length=LENGTH, law=law)
    problems = [
        body.changed(
            drive=MovedSide("top", np.pi / 2), adhesion=replace(body.adhesion, irreversible=irreversible)
        )
        for irreversible in (False, True)
    ]
    settings = NewtonSettings(path_control="continuation")
    ours, theirs = (list(trace(problem, SPACE, PULL, settings)) for problem in problems)
    # the steps between are others: the tangent that a stretch starts with may be that of closing
    for kind, count in (("limit point", 2), ("requested", 0)):
        one, other = ([step for step in steps if step.kind == kind] for steps in (ours, theirs))
        assert len(one) == len(other) >= count
        for attribute in ("parameter", "reaction"):
            found, expected = ([getattr(step, attribute) for step in steps] for steps in (one, other))
            # next to limit points, K is soft
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8)
    assert ours[-1].dissipated_energy == 0
    assert theirs[-1].dissipated_energy > 0.9 * law.work_of_adhesion * LENGTH


def test_a_curve_is_not_left_for_a_stretch_that_passes_nearby() -> None:
    """Projected forces have no energy balance to check; on a coarse mesh the curve runs back and forth."""
    degrees = np.arange(0.0, 96.0)
    problem, space = strip(traction="projected"), row_space("N4", (60, 2))
    settings = NewtonSettings(path_control="continuation")
    steps = list(trace(problem, space, np.radians(degrees), settings))
    limits = np.degrees([step.parameter for step in steps if step.kind == "limit point"])
    # each peak lies beyond the last one, by what the front moves along an element, and each dip likewise
    assert len(limits) >= 8
    assert (np.diff(limits[::2]) > 1).all()
    assert (np.diff(limits[1::2]) > 1).all()
    assert np.degrees(steps[-1].parameter) == pytest.approx(degrees[-1])


def test_its_limit_points_are_located(curve: list[Step]) -> None:
    first, second = (step for step in curve if step.kind == "limit point")
    highest = minimize_scalar(lambda gap: -pull(gap), bounds=(REST, 0.5), options={"xatol": 1e-10})
    lowest = minimize_scalar(pull, bounds=(0.4, 2.0), options={"xatol": 1e-10})
    # the parameter is stationary there, so that it is known far better than the place
    assert first.parameter == pytest.approx(-highest.fun, abs=1e-9)
    assert second.parameter == pytest.approx(lowest.fun, abs=1e-9)
    for step in (first, second):
        _, matrix = System(block(), SPACE).linearize(step.displacement)
        n = len(matrix.entries)
        dense = np.zeros((n, n))
        for j in range(n):
            for k in range(min(matrix.half_bandwidth + 1, n - j)):
                dense[j + k, j] = dense[j, j + k] = matrix.entries[j, k]
        values = np.linalg.eigvalsh(dense)
        assert np.abs(values).min() < 1e-5 * values.max()


def test_the_branch_between_them_is_unstable(curve: list[Step]) -> None:
    ends = [k for k, step in enumerate(curve) if step.kind == "limit point"]
    counted = [step.negative_eigenvalues for step in curve]
    assert set(counted[ends[0] + 1 : ends[1]]) == {1}
    assert {count for count in counted[: ends[0]] + counted[ends[1] + 1 :] if count is not None} == {0}


def test_a_jump_begins_at_the_limit_point_and_releases_its_energy(curve: list[Step]) -> None:
    jump = path("jump")
    k = next(k for k, step in enumerate(jump) if step.kind == "jump")
    before, after = jump[k - 1], jump[k]
    assert before.kind == "limit point"
    assert after.parameter == before.parameter
    limit = next(step for step in curve if step.kind == "limit point")
    assert before.parameter == pytest.approx(limit.parameter, abs=1e-9)
    fall = before.stored_energy + before.adhesive_energy - after.stored_energy - after.adhesive_energy
    assert after.released_energy == pytest.approx(fall, rel=1e-9)
    assert fall > 0
    # it reaches the curve
    assert after.parameter == pytest.approx(pull(gap_of(after)), abs=1e-9)


def test_controls_agree_where_they_end() -> None:
    ends = [path(path_control)[-1] for path_control in ("auto", "jump", "continuation")]
    for end in ends:
        assert end.parameter == PULL[-1]
        assert end.reaction == pytest.approx(ends[0].reaction, rel=1e-8)


def test_a_failed_attempt_leaves_the_last_state_bit_for_bit() -> None:
    problem = replace(strip(), drive=MovedSide("right", np.pi, "held"))
    space, settings = row_space("N2", (40, 2)), NewtonSettings(plain=True)
    going = follow_path(Path(System(problem, space), settings, ()), [0.0, 0.5, 300.0], ())
    steps = [next(going), next(going)]
    last = steps[-1].unknown_values.copy()
    with pytest.raises(ConvergenceError) as failed:
        next(going)
    assert failed.value.hint
    np.testing.assert_array_equal(steps[-1].unknown_values, last)
    (on,) = trace(problem, space, [1.0], settings, start=[step.state for step in steps])
    *_, never_failed = trace(problem, space, [0.0, 0.5, 1.0], settings)
    np.testing.assert_array_equal(on.unknown_values, never_failed.unknown_values)


@pytest.mark.parametrize("path_control", ["auto", "jump", "continuation"])
def test_a_path_continues_bit_for_bit_from_each_step_that_resumes(path_control: PathControl) -> None:
    settings = NewtonSettings(path_control=path_control)
    steps, states = [], []
    for step in trace(block(), SPACE, PULL, settings):
        steps.append(step)
        states.append(step.state)  # which has the solver state as long as the path exists
    resuming = [k for k, step in enumerate(steps) if step.resumes]
    assert 0 < len(resuming) < len(steps)
    assert resuming[-1] == len(steps) - 1
    for k in resuming:
        met = int(np.flatnonzero(steps[k].parameter == PULL)[0]) + 1
        rest = trace(block(), SPACE, PULL[met:], settings, start=[states[k]], passed=PULL[:met].tolist())
        again = [(step.parameter, step.reaction, step.kind, step.negative_eigenvalues) for step in rest]
        assert again == [(s.parameter, s.reaction, s.kind, s.negative_eigenvalues) for s in steps[k + 1 :]]
