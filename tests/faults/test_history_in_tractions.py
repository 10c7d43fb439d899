"""Tractions that are reported, exported and drawn are those that the solver has, in every stage."""

import base64
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from isopeel.assembly.interface import InterfacePoints
from isopeel.assembly.system import System
from isopeel.case import Case, with_options
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.html_report.content import stage_content
from isopeel.physics.batch import evaluate_law
from isopeel.post.front import front_profile, process_zones
from isopeel.post.grids import side_grids, side_mesh
from isopeel.results.fields import StoredState
from isopeel.running.resume import resume_case
from isopeel.running.run import run_case
from isopeel.running.run_reader import StoredStage, read_stages

pytestmark = pytest.mark.usefixtures("without_figures")

HEAD = """
name = "reopened"
[units]
length = "1 mm"
stress = "1 MPa"
"""

#: A stiff block of area 1, opened by 0.5, closed, and reopened by 0.4.
BLOCK = (
    HEAD
    + """
[body]
length = "1 mm"
height = "1 mm"
[material]
law = "neo-hooke"
youngs_modulus = "1e5 MPa"
poissons_ratio = 0.0
[adhesion]
law = "bilinear"
strength = "1 MPa"
work_of_adhesion = "0.5 N/mm"
rise = 0.1
irreversible = true
[held]
left = "x"
[discretization]
space = "L1"
mesh = "1x1"
[output]
fields_every = "0.1 mm"
"""
)


def drive(kind: str, name: str, side: str, to: str, step: str, more: str = "") -> str:
    keys = {"name": name, "kind": kind, "side": side, "to": to, "step": step}
    return "[[drive]]\n" + "".join(f'{key} = "{value}"\n' for key, value in keys.items()) + f"{more}\n"


def lift(name: str, to: float, step: float, side: str = "top") -> str:
    return drive("displacement", name, side, f"{to} mm", f"{step} mm", 'angle = "90 deg"')


BLOCK_STAGES = lift("open", 0.5, 0.05) + lift("close", -0.5, 0.05) + lift("reopen", 0.4, 0.1)

#: A soft cantilever whose front runs, and that is let back in part, then pulled on.
CANTILEVER = (
    HEAD
    + """
[body]
length = "24 mm"
height = "1 mm"
[material]
law = "neo-hooke"
youngs_modulus = "2 MPa"
poissons_ratio = 0.45
[adhesion]
law = "exponential"
strength = "0.01 MPa"
work_of_adhesion = "0.0005 N/mm"
length = "19 mm"
irreversible = true
[held]
left = "xy"
[discretization]
space = "N2.1"
mesh = "72x2"
[output]
fields_every = "0.1 mm"
"""
)
CANTILEVER_STAGES = (
    lift("open", 1.2, 0.1, "right") + lift("close", -0.6, 0.1, "right") + lift("reopen", 0.9, 0.1, "right")
)

#: A tape that holds along a wavy substrate as well, pushed along it and pulled off.
SLIDING = (
    HEAD
    + """
[body]
length = "20 mm"
height = "1 mm"
[material]
law = "neo-hooke"
youngs_modulus = "2 MPa"
poissons_ratio = 0.3
[adhesion]
law = "exponential"
strength = "0.02 MPa"
work_of_adhesion = "0.002 N/mm"
length = "15 mm"
sliding_length = "0.3 mm"
[substrate]
kind = "wavy"
amplitude = "0.1 mm"
wavelength = "10 mm"
[discretization]
space = "N2"
mesh = "40x2"
[output]
fields_every = "0.1 mm"
"""
)
SLIDING_STAGES = drive(
    "displacement", "push", "right", "0.2 mm", "0.05 mm", 'angle = "0 deg"\ntransverse = "held"'
) + lift("pull", 0.5, 0.1, "right")

#: A tape on a wavy substrate, to which van der Waals forces see no curvature; only a circle's is constant.
WAVY = """
name = "wavy"
[body]
length = "60 nm"
height = "6 nm"
[material]
law = "neo-hooke"
youngs_modulus = "2 GPa"
poissons_ratio = 0.2
[adhesion]
law = "van-der-waals"
hamaker_constant = "1e-19 J"
equilibrium_distance = "0.4 nm"
traction = "{traction}"
[substrate]
kind = "wavy"
amplitude = "0.05 nm"
wavelength = "10 nm"
[discretization]
space = "N2.1"
mesh = "80x2"
[output]
fields_every = "1 deg"
"""
PEEL = drive("rotation", "peel", "right", "4 deg", "1 deg") + drive(
    "rotation", "farther", "right", "4 deg", "1 deg"
)

CASES = {
    "block": BLOCK + BLOCK_STAGES,
    "cantilever": CANTILEVER + CANTILEVER_STAGES,
    "sliding on waves": SLIDING + SLIDING_STAGES,
    "wavy": WAVY.format(traction="reference") + PEEL,
    "wavy, projected": WAVY.format(traction="projected") + PEEL,
}
QUIET = Console(quiet=True)


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """All cases, run once."""
    found = {}
    for name, text in CASES.items():
        found[name] = tmp_path_factory.mktemp("run") / "out"
        run_case(Case.parse(text), found[name], QUIET)
    return found


def integral(stage: StoredStage, state: StoredState) -> FloatArray:
    """The force on the body, of the tractions that are read from the file."""
    points = InterfacePoints.of_contact(stage.stage.problem, stage.spaces["body"])
    found = points.state(state.displacement, state.maximum_openings)
    force: FloatArray = np.einsum("nk,nkc->c", points.lengths, found.traction)
    return force


@pytest.mark.parametrize("name", CASES)
def test_stored_tractions_integrate_to_the_assembled_force(name: str, folders: dict[str, Path]) -> None:
    for stage in read_stages(folders[name]):
        problem, run = stage.stage.problem, stage.run
        system = System(problem, stage.spaces["body"], base=run.base)
        assert len(run.states) >= 2
        largest = 0.0
        for state in run.states:
            if problem.adhesion.irreversible:
                system = system.after(state.maximum_openings)
            loose = system.without_joint().equilibrium(state.displacement).forces
            forces = loose - system.equilibrium(state.displacement).forces
            expected = forces[stage.spaces["body"].side_functions("bottom")].sum(axis=0)
            # of the sum of sizes, a few times the net force: the round-off of both sums, and of stiff bodies
            size = max(np.abs(forces).sum(), 1e-9 * np.abs(loose).sum())
            np.testing.assert_allclose(integral(stage, state), expected, atol=1e-12 * size)
            largest = max(largest, float(np.abs(expected).max()))
        assert largest > 1e-3 * problem.adhesion.law.work_of_adhesion


def envelope(opening: float) -> float:
    """Attraction of the block's law, whose kinks are rounded."""
    law = Case.parse(BLOCK + BLOCK_STAGES).stages()[0].problem.adhesion.law
    _, traction, _ = evaluate_law(law.kernel, law.parameters, np.array([opening]), np.zeros(1))
    return -float(traction[0])


def packed(text: str) -> FloatArray:
    return np.frombuffer(base64.b64decode(text), "<f4").astype(np.float64)


def test_the_block_has_force_over_area_in_every_stage_and_output(folders: dict[str, Path]) -> None:
    """At an opening of 0.1 in stage 3, 0.926 was drawn, where the force is 0.1118 on an area of 1."""
    secant = envelope(0.5) / 0.5
    for number, stage in enumerate(read_stages(folders["block"])):
        problem, run, space = stage.stage.problem, stage.run, stage.spaces["body"]
        content: dict[str, Any] = stage_content(stage, stage.found(), 10_000_000)
        drawn = {one["step"]: packed(one["faces"][0]["adhesion"]) for one in content["states"]}
        for state in run.states:
            force = run.curve.reaction[state.step]
            opening = state.displacement[:2, 1].mean()
            if number and opening > 0:
                # the block stretches by 1e-5 of its height; Newton's tolerance, where it is closed
                assert force == pytest.approx(secant * opening, rel=1e-4, abs=1e-9)
            (grid,) = side_grids(problem, space, side_mesh(problem, space, 2), [state])
            outputs = {
                "profile": -front_profile(
                    problem, space, state.displacement, maximum_openings=state.maximum_openings
                ).adhesive_traction,
                "export": -grid.point_data["normal adhesive traction [E0]"],
                "page": drawn[state.step],
            }
            for tension in outputs.values():
                # Newton's tolerance, 4-byte numbers of the page, and tractions that vary by 1e-5 along it
                np.testing.assert_allclose(tension, force, atol=1e-5 + 1e-4 * abs(force))
    assert state.parameter == pytest.approx(0.4)
    assert force == pytest.approx(0.447, abs=1e-3)


def test_the_cantilever_has_a_front_where_it_was_unloaded(folders: dict[str, Path]) -> None:
    """Damage stays: while the arm closes, the front stays where it was, and the joint weakens beyond it."""
    opened, closed, _ = read_stages(folders["cantilever"])
    zones = [
        list(process_zones(one.stage.problem, one.spaces, one.run.states).values())
        for one in (opened, closed)
    ]
    assert len(zones[0]) >= 3
    assert len(zones[1]) == len(closed.run.states)
    last = zones[0][-1]
    for zone in zones[1]:
        # it lies between the place where the joint was lost and the front
        assert abs(zone.position - last.position) < last.length
        assert zone.peak < last.peak


def test_a_resumed_run_has_the_history_of_one_that_was_not(folders: dict[str, Path], tmp_path: Path) -> None:
    case = Case.parse(CANTILEVER + CANTILEVER_STAGES)
    run_case(with_options(case, to="0.5 mm"), tmp_path / "out", QUIET)
    resume_case(tmp_path / "out", QUIET, to="0.9 mm")
    for one, other in zip(read_stages(tmp_path / "out"), read_stages(folders["cantilever"]), strict=True):
        assert one.run.states[-1].maximum_openings.any()
        for there in other.run.states:
            here = one.run.nearest(there.parameter)
            assert here.parameter == there.parameter
            np.testing.assert_array_equal(here.maximum_openings, there.maximum_openings)
            np.testing.assert_array_equal(integral(one, here), integral(other, there))


def test_an_irreversible_joint_without_its_history_has_no_profile(folders: dict[str, Path]) -> None:
    stage = read_stages(folders["block"])[-1]
    problem, run = stage.stage.problem, stage.run
    displacement = run.states[-1].displacement
    with pytest.raises(InputError, match="openings"):
        front_profile(problem, stage.spaces["body"], displacement)
    reversible = problem.changed(adhesion=replace(problem.adhesion, irreversible=False))
    front_profile(reversible, stage.spaces["body"], displacement)
