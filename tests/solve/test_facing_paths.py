"""Paths of two blocks that adhere to each other, in closed form: each is half of one on a substrate."""

from dataclasses import replace
from itertools import pairwise, product
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from test_continuation import HAMAKER, HEIGHT, LENGTH, PULL, R0, REST, pull, tension

from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.common.path_control import PathControl
from isopeel.physics.adhesion import Exponential, VanDerWaals
from isopeel.physics.batch import evaluate_law
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.problem import (
    Body,
    Boundary,
    Interface,
    MovedSide,
    Problem,
    PulledSide,
    Scheme,
    Support,
    strip,
)
from isopeel.problem.place import placed
from isopeel.results.layout import Layout
from isopeel.results.provenance import Provenance
from isopeel.results.run_file import read_run, run_attributes
from isopeel.results.run_writer import RunWriter
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.step import Step
from isopeel.solve.trace import trace
from isopeel.splines.nurbs import rectangle
from isopeel.splines.rows import row_space

SPACES = {"upper": row_space("L1", (1, 1)), "lower": row_space("L1", (1, 1))}
SCHEMES: tuple[Scheme, ...] = ("unbiased", "biased", "two-half-pass")


def blocks(scheme: Scheme = "unbiased", *, irreversible: bool = False) -> Problem:
    """Two blocks of half the height of the one on a substrate, so that they give as much."""
    half, material = rectangle(LENGTH, HEIGHT / 2), strip().body.material
    upper = Body(placed(half, (0.0, REST), 0.0), material, "upper")
    lower = Body(placed(half, (0.0, -HEIGHT / 2), 0.0), material, "lower")
    joint = Interface(upper.side("bottom"), VanDerWaals(HAMAKER, R0), lower.side("top"), scheme=scheme)
    if irreversible:
        law = Exponential(0.06, 0.02)
        upper = replace(upper, shape=half)
        joint = replace(joint, law=law, irreversible=True)
    beside = [Support(body.side("left"), (0,)) for body in (upper, lower)]
    held = *beside, Support(lower.side("bottom"), (1,))
    drive = MovedSide(Boundary("upper", "top"), np.pi / 2)
    return Problem("blocks", (upper, lower), (joint,), held, drive)


def path(problem: Problem, path_control: PathControl) -> list[Step]:
    return path_of(problem, PULL, path_control)


def path_of(problem: Problem, parameters: FloatArray, path_control: PathControl) -> list[Step]:
    return list(trace(problem, SPACES, parameters, NewtonSettings(path_control=path_control)))


def gap_of(step: Step) -> float:
    size = SPACES["upper"].size
    upper, lower = step.displacement[:size], step.displacement[size:]
    bottom, top = SPACES["upper"].side_functions("bottom"), SPACES["lower"].side_functions("top")
    return REST + float(upper[bottom, 1].mean() - lower[top, 1].mean())


@pytest.mark.parametrize("scheme", SCHEMES)
def test_the_curve_through_the_snap_back_is_that_of_the_closed_form(scheme: Scheme) -> None:
    """Also that of two half passes: equal and opposite tractions act on equal areas."""
    steps = path(blocks(scheme), "continuation")
    gaps = [gap_of(step) for step in steps]
    assert (np.diff(gaps) > 0).all()
    parameters = np.array([step.parameter for step in steps])
    assert np.diff(parameters).min() < 0
    # as of the one block: both are solved to the tolerance
    np.testing.assert_allclose(parameters, [pull(gap) for gap in gaps], rtol=0, atol=1e-9)
    reactions = [step.reaction for step in steps]
    np.testing.assert_allclose(reactions, [LENGTH * tension(gap) for gap in gaps], rtol=0, atol=1e-9)
    assert [step.kind for step in steps].count("limit point") == 2
    assert set(PULL) <= {step.parameter for step in steps if step.kind == "requested"}


@pytest.mark.parametrize("scheme", ["unbiased", "biased"])
def test_a_jump_releases_the_energy_of_the_closed_form(scheme: Scheme) -> None:
    steps = path(blocks(scheme), "jump")
    (before, after) = next((one, other) for one, other in pairwise(steps) if other.kind == "jump")
    assert after.parameter == before.parameter
    fall = before.stored_energy + before.adhesive_energy - after.stored_energy - after.adhesive_energy
    assert after.released_energy == pytest.approx(fall, rel=1e-9)
    assert fall > 0
    assert after.parameter == pytest.approx(pull(gap_of(after)), abs=1e-9)
    assert steps[-1].parameter == PULL[-1]


def test_two_half_passes_end_at_the_limit_point_with_its_cause() -> None:
    """They have no energy, by which a path would jump where it turns back."""
    with pytest.raises(ConvergenceError, match=r"the path turns back at 1\.28989 L0") as failed:
        path(blocks("two-half-pass"), "auto")
    highest = minimize_scalar(lambda gap: -pull(gap), bounds=(REST, 0.5), options={"xatol": 1e-10})
    # it is found to a part of the last step, which was halved 9 times
    assert failed.value.parameter == pytest.approx(-highest.fun, abs=0.1 / 2**8)


@pytest.mark.parametrize("irreversible", [False, True])
@pytest.mark.parametrize(
    ("scheme", "path_control"),
    [
        *product(("unbiased", "biased"), ("auto", "jump", "continuation")),
        ("two-half-pass", "continuation"),  # forces without an energy have nothing to jump by
    ],
)
def test_a_path_continues_from_its_file_bit_for_bit(
    scheme: Scheme, path_control: PathControl, irreversible: bool, tmp_path: Path
) -> None:
    """The history of both sides is stored, each with its name."""
    problem = blocks(scheme, irreversible=irreversible)
    settings = NewtonSettings(path_control=path_control)
    provenance = Provenance({}, "", "", "", "")
    steps, whole = trace(problem, SPACES, PULL, settings), []
    with RunWriter(
        tmp_path / "run.h5",
        problem.drive,
        "",
        run_attributes(problem, SPACES, provenance),
        layout=Layout.of(problem, SPACES),
    ) as file:
        # up to a step that resumes, after the joint has opened
        for step in steps:
            whole.append(step)
            file.append(step)
            if step.resumes and gap_of(step) > REST + 0.5:
                break
    first = len(whole)
    whole += steps
    assert first < len(whole)
    state = read_run(tmp_path / "run.h5").last
    assert state is not None
    met = int(np.flatnonzero(whole[first - 1].parameter == PULL)[0]) + 1
    rest = list(trace(problem, SPACES, PULL[met:], settings, start=[state], passed=PULL[:met].tolist()))
    assert len(rest) == len(whole) - first
    for one, other in zip(rest, whole[first:], strict=True):
        assert (one.parameter, one.reaction, one.kind) == (other.parameter, other.reaction, other.kind)
        np.testing.assert_array_equal(one.displacement, other.displacement)
        np.testing.assert_array_equal(one.maximum_openings, other.maximum_openings)
    if irreversible:
        # each side holds its half of the damage
        assert whole[-1].dissipated_energy > 0.9 * 0.02 * LENGTH


def test_a_point_that_slides_off_the_end_of_the_other_side_is_the_cause() -> None:
    """The upper block is moved along the lower one; its last point is (1 - 1/sqrt(3))/2 from the end."""
    problem = blocks("biased")
    supports = tuple(one for one in problem.supports if one.boundary.body == "lower")
    slides = replace(problem, supports=supports, drive=MovedSide(Boundary("upper", "top"), 0.0, "held"))
    end = LENGTH * (1 - 1 / np.sqrt(3)) / 2
    with pytest.raises(
        ConvergenceError, match=r"a point of upper\.bottom slides past the end of lower\.top"
    ) as failed:
        path_of(slides, np.linspace(0.0, 2 * end, 9), "newton")
    assert failed.value.cause == "lost partner"
    assert failed.value.parameter >= end


def test_points_that_turn_away_within_the_reach_of_the_law_are_a_cause() -> None:
    """As those of a soft joint under a tape that is folded back: they were no cause of a failure."""
    problem = blocks("biased")
    system = System(problem, SPACES)
    (term,), (law, middle) = system.facing, (problem.interfaces[0].law, LENGTH / 2)
    centre, points = np.array([middle, REST]), system.spaces.control_points()[: SPACES["upper"].size]

    def turned(degrees: float) -> FloatArray:
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        u = np.zeros((system.spaces.size, 2))
        u[: len(points)] = (points - centre) @ np.array([[c, s], [-s, c]]) + [middle, middle + REST] - points
        return u

    # the Gauss points are at (1 -+ 1/sqrt(3))/2 of the side
    gaps = middle + REST + middle * np.array([-1, 1]) / np.sqrt(3) * np.sin(np.radians(80))
    energies = evaluate_law(law.kernel, law.parameters, gaps, np.zeros(2))[0]
    expected = np.abs(energies).sum() * middle
    for states in ((80.0, 100.0), (100.0, 80.0)):
        off, away = term.energy_without_partner(*map(turned, states))
        assert off == 0.0
        # both are evaluated to round-off
        assert away == pytest.approx(expected, rel=1e-12)
    assert term.energy_without_partner(turned(70.0), turned(80.0)) == (0.0, 0.0)


def test_two_arms_that_slide_on_each_other_buckle_together() -> None:
    """Forces S that pull the ends of both arms apart turn them about by an angle t.

    Each arm bends as a beam, and the ends slide on each other by (h + g) t + e, where the tensions S t and
    -S t along the arms elongate them by e in sum. So the forces do the work S ((h + g) t^2/2 + e t), against
    E'I t^2/L + E'h e^2/(4 L). The least work is done at E'I/L = S (h + g)/2 + S^2 L/(E'h).
    """
    height, length, law = 4.0, 560.0, VanDerWaals(0.05, 0.4)
    gap, material = law.equilibrium_gap, strip().body.material
    upper = Body(placed(rectangle(length, height), (0.0, gap), 0.0), material, "upper")
    lower = Body(placed(rectangle(length, height), (0.0, -height), 0.0), material, "lower")
    joint = Interface(upper.side("bottom"), law, lower.side("top"))
    held = Support(upper.side("left"), (0, 1)), Support(lower.side("left"), (0,))
    drive = PulledSide(((upper.side("right"), 1.0), (lower.side("right"), -1.0)), np.pi / 2)
    problem = Problem("arms", (upper, lower), (joint,), held, drive)
    spaces = dict.fromkeys(("upper", "lower"), row_space("N2", (140, 2), 2))
    steps = trace(problem, spaces, [0.0, 0.05], NewtonSettings(path_control="auto"))
    found = next(step.reaction for step in steps if step.kind == "bifurcation")
    modulus = plane_strain_modulus(material)
    bending, stretching = modulus * height**3 / 12, modulus * height
    buckling = max(np.roots([length / stretching, (height + gap) / 2, -bending / length]).real)
    # beams without shear, whose ends do not turn against the joint: -11, -4 and -1 % for L/h = 35, 70 and 140
    assert found == pytest.approx(buckling, rel=0.015)
