"""Elements that are too large for the peeling front: said before the first step, and in the summary."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from isopeel.case import Case, load_case, shipped_cases, with_options
from isopeel.cli import main
from isopeel.physics.adhesion import Contact
from isopeel.post.front import front_profile, process_zone
from isopeel.post.laboratory import Laboratory
from isopeel.post.resolution import estimated, needed_elements, process_zone_length
from isopeel.post.resolution_notes import estimate_notes
from isopeel.results.notes import with_one_remedy
from isopeel.running.run import run_case
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.trace import trace
from isopeel.splines.rows import row_space

HALF_BEAM = """\
name = "turon"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
length = "150 mm"
height = "1.98 mm"
[material]
law = "neo-hooke"
youngs_modulus = "150 GPa"
poissons_ratio = 0.0
[adhesion]
law = "bilinear"
strength = "60 MPa"
work_of_adhesion = "0.352 N/mm"
rise = 0.02
length = "95 mm"
symmetric = true
irreversible = true
[held]
left = "xy"
[discretization]
space = "L1"
mesh = "38x2"
[drive]
kind = "force"
side = "right"
angle = "90 deg"
to = "1.6 mm"
step = "0.1 mm"
"""

STAMP = """\
name = "stamp"
[units]
length = "1 um"
stress = "1 MPa"
[body]
length = "500 um"
height = "1 mm"
[material]
law = "neo-hooke"
youngs_modulus = "2 MPa"
poissons_ratio = 0.49
[adhesion]
law = "bilinear"
strength = "1 MPa"
rise = 0.1
sliding_length = "0.1 um"
work_of_adhesion = "0.1 J/m^2"
[discretization]
space = "N2.1"
mesh = "60x20"
[drive]
kind = "displacement"
side = "top"
angle = "90 deg"
transverse = "held"
to = "40 um"
step = "1 um"
"""

STRIP = """\
name = "strip"
[body]
length = "200 nm"
height = "10 nm"
[material]
law = "neo-hooke"
youngs_modulus = "1 GPa"
poissons_ratio = 0.3
[adhesion]
law = "{law}"
{keys}
length = "180 nm"
[discretization]
space = "{space}"
mesh = "{mesh}"
[drive]
to = "70 deg"
step = "2 deg"
"""
EXPONENTIAL = 'strength = "100 MPa"\nwork_of_adhesion = "0.03 J/m^2"'


pytestmark = pytest.mark.usefixtures("without_figures")


def strip(space: str, mesh: str) -> Case:
    return Case.parse(STRIP.format(law="exponential", keys=EXPONENTIAL, space=space, mesh=mesh))


def as_proposed(case: Case, text: str) -> Case:
    """The case on the mesh, and with the grading, that a note takes."""
    mesh, grading = (re.search(pattern, text) for pattern in (r"mesh = '(\d+x\d+)'", r"grading = (\[.*?\])"))
    assert mesh is not None
    case = with_options(case, mesh=mesh[1])
    if grading is None:
        return case
    table = f"[discretization]\ngrading = {grading[1]}\n"
    return Case.parse(ungraded(case).replace("[discretization]\n", table))


def ungraded(case: Case) -> str:
    """The text of a case without its grading."""
    return re.sub(r"grading = \[[^\]]*\]\n", "", case.text)


def message(case: Case) -> str:
    """What is said before the first step."""
    laboratory = Laboratory.of(case.units.system(), case.problem())
    notes = with_one_remedy(estimate_notes(case.problem(), case.spaces(), laboratory))
    return " ".join(note.text for note in notes)


@pytest.mark.parametrize(
    "case",
    [
        Case.parse(HALF_BEAM),
        Case.parse(STAMP),
        strip("L1", "60x2"),
        strip("N2", "50x2"),
        strip("N2.1", "30x2"),
        with_options(load_case("cylinder-pull-off"), mesh="20x24"),
    ],
    ids=["half beam", "stamp", "L1", "N2", "N2.1", "cylinder"],
)
def test_too_large_elements_get_a_note_whose_remedy_suffices(case: Case) -> None:
    text = message(case)
    assert not message(as_proposed(case, text))
    for space in re.findall(r"space = '([^']+)'", text):
        assert not message(with_options(case, space=space))


@pytest.mark.parametrize(("mesh", "strength"), [("12x24", 1.2), ("60x12", 2.4), ("100x10", 4.8)])
def test_a_grading_is_proposed_for_a_front_that_stays(mesh: str, strength: float) -> None:
    text = ungraded(load_case("cylinder-pull-off")).replace("1.2 MPa", f"{strength} MPa")
    case = with_options(Case.parse(text), mesh=mesh)
    found = message(case)
    assert "with grading = [" in found
    assert not message(as_proposed(case, found))


@pytest.mark.parametrize("length", [20, 200, 2000])
def test_a_strength_is_proposed_if_no_mesh_suffices(length: float) -> None:
    """Wide pads have two fronts, far apart, which their elements cannot both be graded towards."""
    case = Case.parse(STAMP.replace('"500 um"', f'"{length} mm"').replace('"1 MPa"\nrise', '"3 MPa"\nrise'))
    text = message(case)
    assert "mesh = '" not in text
    strength = re.search(r"with a strength of ([\d.]+) (k?Pa|MPa) or less", text)
    assert strength is not None
    softer = Case.parse(case.text.replace('strength = "3 MPa"', f'strength = "{strength[1]} {strength[2]}"'))
    mesh = re.search(r"mesh = '(\d+x\d+)'", message(softer))
    assert mesh is not None
    assert not message(with_options(softer, mesh=mesh[1]))


@pytest.mark.parametrize("case", [strip("N2", "20x2"), strip("L2", "18x2"), strip("N2", "30x1")])
def test_the_notes_of_a_run_name_one_sufficient_mesh(case: Case, tmp_path: Path) -> None:
    run_case(case, tmp_path, Console(quiet=True))
    notes = json.loads((tmp_path / "summary.json").read_text("utf-8"))["notes"]
    assert sum(note["subject"] == "resolution" for note in notes) > 1
    (mesh,) = [name for note in notes for name in re.findall(r"mesh = '(\d+x\d+)'", note["text"])]
    run_case(with_options(case, mesh=mesh), tmp_path / "finer", Console(quiet=True))
    left = json.loads((tmp_path / "finer" / "summary.json").read_text("utf-8"))["notes"]
    assert not any(note["subject"] == "resolution" for note in left)


@pytest.mark.parametrize("name", shipped_cases())
def test_shipped_cases_resolve_their_fronts(name: str) -> None:
    case = load_case(name)
    assert not message(case)
    problem = case.problem()
    for name, face in zip(problem.interface_names, problem.faces, strict=True):
        found = estimated(problem, case.spaces(), name)
        if isinstance(face.law, Contact):
            # it has no process zone
            assert found is None
            continue
        assert found is not None
        assert found.elements_in_reach > found.elements > found.needed


def test_a_strict_run_is_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "case.toml"
    file.write_text(HALF_BEAM, "utf-8")
    assert main(["run", str(file), "--strict", "--out", str(tmp_path / "out")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("isopeel: discretization.mesh: '38x2' cannot be used; resolution: 0.29 elements")
    assert not (tmp_path / "out").exists()


def test_the_summary_has_the_same_notes(tmp_path: Path) -> None:
    run_case(Case.parse(HALF_BEAM), tmp_path, Console(quiet=True))
    summary = json.loads((tmp_path / "summary.json").read_text("utf-8"))
    texts = " ".join(note["text"] for note in summary["notes"])
    (mesh,) = re.findall(r"use mesh = '(\d+)x2'", texts)
    # 38 elements are 0.29 in the zone
    assert int(mesh) >= 38 / 0.29
    zones = summary["process_zone"]
    # what elements do not resolve looks as long as they are
    assert zones["estimated"]["elements"] < zones["measured"]["elements"] < zones["measured"]["needed"]


#: On fine meshes, with factors that are the same for all.
@pytest.mark.parametrize(
    ("law", "keys"),
    [
        ("exponential", EXPONENTIAL),
        ("bilinear", 'strength = "40 MPa"\nwork_of_adhesion = "0.03 J/m^2"\nrise = 0.1'),
        ("van-der-waals", 'hamaker_constant = "1e-19 J"\nequilibrium_distance = "0.4 nm"'),
    ],
)
def test_the_estimate_is_right_within_a_quarter(law: str, keys: str) -> None:
    case = Case.parse(STRIP.format(law=law, keys=keys, space="N2.1", mesh="200x2"))
    (stage,) = case.stages()
    *_, last = trace(stage.problem, case.space(), stage.parameters, NewtonSettings(path_control="auto"))
    zone = process_zone(front_profile(stage.problem, case.space(), last.displacement))
    found = estimated(stage.problem, case.space())
    assert zone is not None
    assert found is not None
    assert found.zone == pytest.approx(zone.length, rel=0.25)


def test_a_joint_that_only_holds_has_no_front(tmp_path: Path) -> None:
    """The given half beam, hardly lifted: elements are too large for a front that is nowhere yet."""
    held = HALF_BEAM.replace('to = "1.6 mm"\nstep = "0.1 mm"', 'to = "0.01 mm"\nstep = "0.01 mm"')
    run_case(Case.parse(held), tmp_path, Console(quiet=True))
    notes = json.loads((tmp_path / "summary.json").read_text("utf-8"))["notes"]
    assert not any("process zone" in note["text"] for note in notes)


def test_the_shorter_length_governs() -> None:
    # E' W/sigma^2 = 1, of slender and of thick bodies
    assert process_zone_length(1.0, 1e-3) == pytest.approx(0.47 * 1e-3**0.75, rel=0.01)
    assert process_zone_length(1.0, 1e6) == pytest.approx(1.45, rel=0.01)


@pytest.mark.parametrize(
    ("name", "needed"), [("L1", 1.0), ("L2", 0.9), ("L4", 0.45), ("N2", 1.0), ("N4", 0.7), ("N2.1", 0.5)]
)
def test_spaces_need_elements_by_their_functions(name: str, needed: float) -> None:
    assert needed_elements(row_space(name, (9, 1)).rows[0]) == needed


def test_a_bar_that_is_pulled_has_no_front() -> None:
    bar = STAMP.replace("poissons_ratio = 0.49", "poissons_ratio = 0.0")
    assert not message(Case.parse(bar))
    held = STAMP.replace("[discretization]", '[held]\nleft = "x"\nright = "x"\n[discretization]')
    assert not message(Case.parse(held))


def test_notes_are_few_where_the_plateau_is_right() -> None:
    """Within 3 % wherever nothing is said, on meshes from hopeless to fine."""
    fine = np.mean(moments(strip("N2.1", "200x2")))
    for space, mesh in (("N2.1", "60x2"), ("N2.1", "40x2"), ("N2", "60x2"), ("L2", "60x2"), ("N2", "30x2")):
        case = strip(space, mesh)
        wrong = abs(np.mean(moments(case)) / fine - 1)
        assert wrong < 0.03 or message(case), (space, mesh)
        assert wrong > 0.001 or not message(case), (space, mesh)


def moments(case: Case) -> list[float]:
    """Those of the last 20 degrees, in which the front passes several elements."""
    (stage,) = case.stages()
    path = trace(stage.problem, case.space(), stage.parameters, NewtonSettings(path_control="auto"))
    return [step.reaction for step in path][-10:]
