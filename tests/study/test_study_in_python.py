"""Studies in Python: `parameter_study`, `Study.run`, and data frames."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from isopeel import InputError, StudyResults, load_case, load_study, parameter_study
from isopeel.study.outcome import Amount, Line, Outcome, Task

FILE = """
name = "tapes"
case = "tape-angle"
outputs = ["largest force"]

[set]
"discretization.mesh" = "80x2"

[[factor]]
key = "drive.angle"
values = ["60 deg", "90 deg"]

[[factor]]
key = "material.poissons_ratio"
from = 0.1
to = 0.4
count = 4
"""


def test_a_study_in_python_is_that_of_a_file(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(FILE)
    ratio = {"from": np.float64(0.1), "to": 0.4, "count": np.int64(4)}
    ways: list[object] = ["tape-angle", load_case("tape-angle")]
    for case in ways:
        study = parameter_study(
            case,  # type: ignore[arg-type]
            {"drive.angle": np.array(["60 deg", "90 deg"]), "material.poissons_ratio": ratio},
            values={"discretization.mesh": "80x2"},
            outputs=["largest force"],
            name="tapes",
        )
        of_file = load_study(str(tmp_path / "study.toml"))
        assert study.points == of_file.points
        assert study.factors == of_file.factors
        assert study.case.text == of_file.case.text
        assert (study.name, study.outputs) == (of_file.name, of_file.outputs)


@pytest.mark.parametrize(
    ("factors", "options", "message"),
    [
        ({"drive.angel": ["60 deg"]}, {}, "^factor.1, drive.angel: "),
        ({"drive.angle": "60 deg"}, {}, "^factor.1.values: '60 deg' .*a list"),
        ({"drive.angle": 60}, {}, "^factor.1.values: 60 .*a list"),
        ({"drive.angle": []}, {}, "^factor.1.values: "),
        ({}, {}, "^factor: "),
        ({"drive.angle": ["60 deg"]}, {"method": "random"}, "^design.method: 'random'"),
        ({"drive.angle": ["60 deg"]}, {"values": {"body.hight": "1 nm"}}, "^set.body.hight: "),
        ({"drive.angle": ["60 deg"]}, {"name": "a/b"}, "^name: 'a/b'"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(
    factors: dict[str, object], options: dict[str, object], message: str
) -> None:
    with pytest.raises(InputError, match=message) as error:
        parameter_study("tape-angle", factors, **options)  # type: ignore[arg-type]
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("options", "message"), [({"workers": 0}, "^workers: 0 "), ({"client": 5}, "^client: '5' .*address")]
)
def test_where_runs_are_computed_is_checked(options: dict[str, object], message: str) -> None:
    study = parameter_study("tape-angle", {"drive.angle": ["60 deg"]})
    with pytest.raises(InputError, match=message):
        study.run(**options)  # type: ignore[arg-type]


def _results() -> StudyResults:
    study = parameter_study("tape-angle", {"drive.angle": ["60 deg", "90 deg"]})
    line = Line("peel", np.arange(2.0), np.array([0.5, 1.5]), ("displacement", "force"), ("nm", "N/m"))
    done = Outcome("completed", readings={"largest force": Amount(1.5, "N/m")}, lines=(line,))
    return StudyResults(study, (done, Outcome("refused", "no")))


def test_results_are_data_frames_with_units() -> None:
    pandas: ModuleType = pytest.importorskip("pandas")
    results = _results()
    table = results.to_dataframe()
    assert table.index.tolist() == [1, 2]
    assert table["drive.angle [deg]"].tolist() == [60.0, 90.0]
    # a missing reading is a number, so that means leave it out
    assert table["largest force [N/m]"].dtype == np.float64
    assert table["largest force [N/m]"].mean() == 1.5
    assert table.loc[2, "cause"] == "no"
    curves = results.curves_to_dataframe()
    assert curves.columns.tolist() == ["run", "stage", "displacement [nm]", "force [N/m]"]
    assert curves["force [N/m]"].tolist() == [0.5, 1.5]
    assert isinstance(curves, pandas.DataFrame)


def test_without_pandas_one_line_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(ImportError, match=r"^pandas is needed .*pip install 'isopeel\[study\]'$"):
        _results().to_dataframe()


def test_run_without_a_folder_writes_no_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    computed = []

    def here(_self: object, tasks: Mapping[int, Task]) -> Iterator[tuple[int, Outcome]]:
        for number, task in tasks.items():
            computed.append(task.values)
            yield number, Outcome("completed", steps=number)

    monkeypatch.setattr("isopeel.study.execution.InProcesses.__call__", here)
    study = parameter_study("tape-angle", {"drive.angle": ["60 deg", "90 deg"]})
    results = study.run()
    assert [outcome.steps for outcome in results.outcomes] == [0, 1]
    assert not list(tmp_path.iterdir())
    # with a folder, finished runs are not computed again
    study.run("out")
    study.run("out")
    assert len(computed) == 4
    assert (tmp_path / "out" / "tables" / "runs.csv").exists()
