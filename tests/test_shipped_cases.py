"""The shipped cases: each is whole, starts, and tells what its closed form or its paragraph says."""

from importlib import resources
from itertools import islice
from pathlib import Path

import pytest
from PIL import Image
from rich.console import Console

from isopeel.case import load_case, shipped_cases
from isopeel.post.closed_form import jkr_line_pull_off
from isopeel.run import run_case, stage_folders
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.trace import trace

DOCUMENT = Path(__file__).parents[1] / "docs" / "cases.md"
CASES = {
    "strip",
    "tape-angle",
    "double-cantilever",
    "cylinder-pull-off",
    "curved-substrate",
    "spatula",
    "press-and-peel",
}


def test_all_are_shipped() -> None:
    assert set(shipped_cases()) == CASES


@pytest.mark.parametrize("name", sorted(CASES))
def test_each_has_a_paragraph_and_a_picture(name: str) -> None:
    case = load_case(name)
    assert case.name == name
    document = DOCUMENT.read_text("utf-8")
    assert f"## {name}\n\n{case.about}\n" in document
    assert f"cases/{name}/picture.png" in document
    with resources.files("isopeel").joinpath("cases", name, "picture.png").open("rb") as file:
        assert Image.open(file).width >= 1000


@pytest.mark.parametrize("name", sorted(CASES))
def test_each_starts(name: str) -> None:
    """The first steps of the first stage, on the mesh of the case."""
    case = load_case(name)
    stage = case.stages()[0]
    settings = NewtonSettings(jumps=stage.jumps)
    steps = list(islice(trace(stage.problem, case.space(), stage.parameters, settings), 3))
    energies = [s.stored_energy + s.adhesive_energy + s.dissipated_energy for s in steps]
    assert [s.parameter for s in steps] == stage.parameters[:3].tolist()
    # a drive does work on a body at rest, once it has found its rest
    assert energies[2] > energies[1] or stage.jumps


@pytest.mark.long
@pytest.mark.parametrize("name", sorted(CASES - {"strip"}))
def test_each_runs_to_its_end(name: str, tmp_path: Path) -> None:
    case = load_case(name)
    run = run_case(case, tmp_path, Console(quiet=True))
    assert run.ending == "completed"
    for folder in stage_folders(case, tmp_path):
        assert {path.name for path in folder.iterdir()} == {
            "run.h5",
            "curve.csv",
            "summary.json",
            "curve.png",
            "shapes.png",
        }
    if name == "tape-angle":
        # what is left of the transient after 40 nm, and the mesh's oscillation
        assert run.curve.reaction[-1] == pytest.approx(0.030442, rel=2e-3)
    if name == "cylinder-pull-off":
        problem = case.problem()
        modulus = problem.body.material.youngs_modulus / (1 - problem.body.material.poissons_ratio**2)
        # a Tabor parameter of 2.3 is a little below the limit of a crack
        expected = jkr_line_pull_off(problem.adhesion.law.work_of_adhesion, modulus, 200.0)
        assert 2 * run.curve.reaction.max() == pytest.approx(expected, rel=0.03)
