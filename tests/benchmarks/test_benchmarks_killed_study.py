"""The benchmark of a study whose processes are killed: how tables are compared, and the whole of it."""

import shutil
from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from typer.testing import CliRunner

from isopeel import StudyResults, parameter_study
from isopeel.study.outcome import Amount, Line, Outcome
from isopeel.study.table import write_tables

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def killed_study(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(BENCHMARKS)
    return import_module("killed_study")


def _written(folder: Path, force: float, end: float, seconds: float) -> Path:
    """Write the tables of one run."""
    study = parameter_study("tape-angle", {"drive.angle": ["60 deg"]})
    line = Line("force", np.arange(2.0), np.array([0.0, end]), ("displacement", "force"), ("nm", "N/m"))
    readings = {"largest force": Amount(force, "N/m")}
    outcome = Outcome("completed", readings=readings, lines=(line,), seconds=seconds)
    (folder / "tables").mkdir(parents=True)
    write_tables(StudyResults(study, (outcome,)), folder / "tables")
    return folder


def test_a_difference_in_the_last_bit_is_found(killed_study: ModuleType, tmp_path: Path) -> None:
    one = _written(tmp_path / "one", 1.5, 1.0, 2.0)
    assert killed_study.difference(one, _written(tmp_path / "slower", 1.5, 1.0, 3.0)) == ""
    other = _written(tmp_path / "reading", np.nextafter(1.5, 2), 1.0, 2.0)
    assert "largest force" in killed_study.difference(one, other)
    curve = _written(tmp_path / "curve", 1.5, np.nextafter(1.0, 2), 2.0)
    assert killed_study.difference(one, curve) == "run-000001: force"
    shutil.rmtree(curve)


def test_the_overhead_is_the_time_of_workers_without_a_run(killed_study: ModuleType, tmp_path: Path) -> None:
    study = killed_study.Study("one", _written(tmp_path / "one", 1.5, 1.0, 6.0), workers=2, wall=4.0)
    assert study.solving == 6.0
    assert study.overhead == pytest.approx(0.25, rel=1e-15)


@pytest.mark.long
def test_three_kills_change_no_bit(killed_study: ModuleType) -> None:
    pytest.importorskip("distributed")
    import typer

    app = typer.Typer()
    app.command()(killed_study.main)
    printed = CliRunner().invoke(app, ["--runs", "12", "--mesh", "40x1", "--to", "5"])
    assert printed.exit_code == 0, printed.output
    lines = {
        label: line.split()[-1]
        for line in printed.output.splitlines()
        for label in ("1 worker", "2 workers", "three kills")
        if line.strip().startswith(label)
    }
    assert lines == dict.fromkeys(("1 worker", "2 workers", "three kills"), "none")
    assert "12 of 12 runs were completed" in printed.output
