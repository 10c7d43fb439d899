"""The command `isopeel study`, with two short runs."""

import csv
from pathlib import Path

import h5py
import pytest

from isopeel.cli import main

STUDY = """
name = "angles"
case = "tape-angle"
outputs = ["largest force", "length of a whale"]

[set]
"discretization.mesh" = "40x1"
"drive.to" = "1 nm"
"drive.step" = "0.5 nm"
"reading" = { window = ["0.5 nm", "1 nm"] }

[[factor]]
key = "drive.angle"
values = ["60 deg", "90 deg"]
"""
#: What may differ if the same study is computed again.
OF_THE_MACHINE = ("seconds", "host")


def _rows(folder: Path) -> list[dict[str, str]]:
    with (folder / "tables" / "runs.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        for name in OF_THE_MACHINE:
            assert row.pop(name)
    return rows


@pytest.mark.usefixtures("in_own_folder")
def test_a_study_writes_tables_figures_and_a_report(capsys: pytest.CaptureFixture[str]) -> None:
    Path("study.toml").write_text(STUDY)
    arguments = ["study", "study.toml", "--scheduler", "processes", "--workers", "1"]
    assert main(arguments) == 0
    printed = capsys.readouterr().out
    assert "2 runs, 0 of them are finished already" in printed
    assert "no run has the reading 'length of a whale'; there are " in printed
    out = Path("out/angles")
    rows = _rows(out)
    assert [row["drive.angle [deg]"] for row in rows] == ["60.0", "90.0"]
    with h5py.File(out / "tables" / "curves.h5") as file:
        for number, row in enumerate(rows, start=1):
            force = file[f"run-{number:06d}/force"]
            assert force.attrs["unit"] == "N/m"
            assert float(row["largest force [N/m]"]) == max(force[()])
    parquet = pytest.importorskip("pyarrow.parquet")
    table = parquet.read_table(out / "tables" / "runs.parquet")
    assert table["largest force [N/m]"].to_pylist() == [float(row["largest force [N/m]"]) for row in rows]
    assert (out / "figures" / "output-1.png").exists()
    assert "Study angles" in (out / "report.html").read_text()
    # a study that grew computes what is new
    Path("study.toml").write_text(STUDY.replace('"90 deg"]', '"90 deg", "120 deg"]'))
    assert main(arguments) == 0
    assert "3 runs, 2 of them are finished already" in capsys.readouterr().out
    assert _rows(out)[:2] == rows


@pytest.mark.usefixtures("in_own_folder")
def test_bad_input_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["study", "none.toml"]) == 2
    assert capsys.readouterr().err.startswith("isopeel: STUDY: 'none.toml' cannot be used; it does not exist")
    Path("study.toml").write_text(STUDY.replace("drive.angle", "drive.angel"))
    assert main(["study", "study.toml"]) == 2
    message = capsys.readouterr().err
    assert message.startswith("isopeel: factor.1, drive.angel: ")
    assert message.count("\n") == 1
    assert not Path("out").exists()
