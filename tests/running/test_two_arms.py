"""A run whose drive acts on two arms while a load is held: its table, its file, and how it is resumed."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from isopeel.cli import main
from isopeel.running.run_reader import read_stages
from two_arms import PULLED_APART, TWO_ARMS

CASE = (
    TWO_ARMS
    + """
[drive]
kind = "force"
angle = "90 deg"
to = "1 nm"
step = "0.25 nm"
"""
    + PULLED_APART
    + """
[[load]]
boundary = "upper.top"
start = "10 nm"
force = "1e-4 N/m"
angle = "90 deg"
"""
)


def table(folder: Path) -> dict[str, list[float]]:
    with (folder / "curve.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    names = [name for name in rows[0] if name.partition(" ")[0] not in ("kind", "seconds")]
    return {name.partition(" ")[0]: [float(row[name]) for row in rows] for name in names}


@pytest.mark.usefixtures("without_figures")
def test_reactions_and_works_are_tabulated_stored_and_resumed(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(CASE, "utf-8")
    whole, short = tmp_path / "whole", tmp_path / "short"
    assert main(["run", str(tmp_path / "case.toml"), "--out", str(whole)]) == 0
    columns = table(whole)
    force = np.array(columns["force"])
    # the load bends the upper arm by itself: less force is needed to open by as much
    assert force[0] < 0 < force[-1]
    np.testing.assert_array_equal(columns["upper.right"], force)
    np.testing.assert_array_equal(columns["lower.right"], -force)
    # energies take the works of both: the trapezoidal rule is exact to second order in the step
    energy, load = np.array(columns["stored_energy"]), np.array(columns["load_work"])
    stored = read_stages(whole)[0].run.curve
    work = float(np.sum((stored.reaction[1:] + stored.reaction[:-1]) / 2)) * 0.25
    assert stored.boundaries == ("upper.right", "lower.right")
    change = stored.stored_energy[-1] - stored.stored_energy[0]
    assert change == pytest.approx(work + stored.load_work[-1] - stored.load_work[0], rel=1e-3)
    assert (energy[-1] > energy[0], load[-1] > load[0]) == (True, True)
    assert main(["run", str(tmp_path / "case.toml"), "--to", "0.5 nm", "--out", str(short)]) == 0
    assert main(["resume", str(short), "--to", "1 nm"]) == 0
    assert table(short) == columns


PUSHED = (
    TWO_ARMS
    + """
[drive]
kind = "force"
boundary = "upper.right"
angle = "-90 deg"
to = "3 nm"
step = "1 nm"
"""
)


def test_bodies_that_overlap_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The gap between the arms is 1 nm wide, and no contact keeps it open."""
    case = tmp_path / "case.toml"
    case.write_text(PUSHED, "utf-8")
    command = ["run", str(case), "--strict", "--out", str(tmp_path / "out")]
    assert main(command) == 0
    said = "note: the bodies upper and lower overlap from 2 nm on, by up to "
    assert said in capsys.readouterr().out
    (note,) = (
        note["text"]
        for note in json.loads((tmp_path / "out" / "summary.json").read_text("utf-8"))["notes"]
        if note["subject"] == "penetration"
    )
    assert said.removeprefix("note: ") in note
    # at the start it is a note, and an error where the run is strict
    moved = ["--set", "body.2.at=['0 nm', '-1 nm']", "--force"]
    assert main([*command, *moved]) == 2
    overlap = "the bodies upper and lower overlap at the start, by up to 1 nm: there is no contact"
    error = capsys.readouterr().err
    assert f"body: 'upper, lower' cannot be used; penetration: {overlap}" in error
    assert main(["run", str(case), "--out", str(tmp_path / "other"), *moved]) == 0
    assert f"note: {overlap}" in capsys.readouterr().out
