"""A run without files has the results of a run with files."""

import json
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from isopeel.case import load_case
from isopeel.results.run_file import read_run
from isopeel.running.in_memory import stage_results
from isopeel.running.run import run_case

#: What differs from run to run.
OF_THE_RUN = ("run", "wall_time_s")


@pytest.mark.usefixtures("without_figures")
def test_the_results_are_those_of_a_run_with_files(tmp_path: Path) -> None:
    case = load_case("press-and-peel").with_values({"discretization.mesh": "40x2"})
    run_case(case, tmp_path, Console(quiet=True))
    stages = list(stage_results(case))
    folders = sorted(path.parent for path in tmp_path.glob("*/run.h5"))
    assert len(stages) == len(folders) > 1
    for found, folder in zip(stages, folders, strict=True):
        stored = read_run(folder / "run.h5")
        np.testing.assert_array_equal(found.run.curve.reaction, stored.curve.reaction)
        assert [state.step for state in found.run.states] == [state.step for state in stored.states]
        summary = json.loads((folder / "summary.json").read_text())
        for name in OF_THE_RUN:
            assert summary.pop(name) != found.summary.pop(name)
        assert json.loads(json.dumps(found.summary)) == summary
