"""A run replaces an earlier run of the same case that goes no further, and nothing else without --force."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

import isopeel
from isopeel.cli import main
from isopeel.report.folder import replaced, take_folder

SMALL = ("--mesh", "10x1", "--space", "L1", "--step", "1", "--to")
OUT = Path("out/strip")


pytestmark = pytest.mark.usefixtures("in_own_folder", "without_figures")


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def the_error(capsys: pytest.CaptureFixture[str]) -> str:
    error = capsys.readouterr().err
    assert error.startswith("isopeel: ")
    assert error.count("\n") == 1
    return error


def notes(folder: Path) -> str:
    (folder / "notes.txt").write_text("mine")
    return "notes.txt"


def hidden(folder: Path) -> str:
    (folder / ".git").mkdir()
    (folder / ".git" / "config").write_text("mine")
    return ".git"


def a_table(folder: Path) -> str:
    (folder / "curve.csv").write_text("gap,force\n0,1\n")
    return "curve.csv"


def a_summary(folder: Path) -> str:
    (folder / "summary.json").write_text(json.dumps({"thesis": "all of it"}))
    return "summary.json"


def a_figure(folder: Path) -> str:
    (folder / "figures").mkdir()
    (folder / "figures" / "curve.png").write_bytes(b"\x89PNG drawn by hand")
    return "figures/curve.png"


def another_figure(folder: Path) -> str:
    (folder / "figures").mkdir()
    (folder / "figures" / "setup.svg").write_text("<svg/>")
    return "figures/setup.svg"


def no_run(folder: Path) -> str:
    (folder / "run.h5").write_bytes(b"a measurement")
    return "run.h5"


def a_page(folder: Path) -> str:
    (folder / "report.html").write_text("<p>isopeel is what I used</p>")
    return "report.html"


def in_a_stage(folder: Path) -> str:
    (folder / "1-press").mkdir()
    (folder / "1-press" / "curve.png").write_bytes(b"a photograph")
    return "1-press/curve.png"


FOREIGN = [notes, hidden, a_table, a_summary, a_figure, another_figure, no_run, a_page, in_a_stage]


@pytest.mark.parametrize("plant", FOREIGN)
def test_what_is_of_no_run_is_refused_and_stays(
    plant: Callable[[Path], str], capsys: pytest.CaptureFixture[str]
) -> None:
    Path("mine").mkdir()
    named, before = plant(Path("mine")), contents(Path("mine"))
    assert main(["run", "strip", *SMALL, "1", "--out", "mine"]) == 2
    error = the_error(capsys)
    assert f"'mine' cannot be used; it contains {named}" in error or f"{named} in it is not a run" in error
    assert "--force" in error
    assert contents(Path("mine")) == before


@pytest.mark.parametrize("plant", [notes, a_table, another_figure, in_a_stage])
def test_with_force_only_files_of_a_run_are_replaced(
    plant: Callable[[Path], str], capsys: pytest.CaptureFixture[str]
) -> None:
    Path("mine").mkdir()
    named = Path("mine", plant(Path("mine")))
    before = named.read_bytes()
    assert main(["run", "strip", *SMALL, "1", "--out", "mine", "--force"]) == 0
    if plant is a_table:
        assert f"removed {named}\n" in capsys.readouterr().out
    else:
        assert named.read_bytes() == before


def test_notes_beside_a_run_of_the_case_are_refused_too(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL, "1"]) == 0
    for name in ("notes.txt", "a.md", "b.md", "c.md"):
        (OUT / name).write_text("mine")
    before = contents(OUT)
    assert main(["run", "strip", *SMALL, "1"]) == 2
    assert "it contains a.md, b.md, c.md and 1 more, which are not part of a run" in the_error(capsys)
    assert contents(OUT) == before


def test_a_run_of_another_case_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL, "2", "--out", "mine"]) == 0
    other = isopeel.load_case("strip").text.replace('name = "strip"', 'name = "other"')
    Path("other.toml").write_text(other)
    before = contents(Path("mine"))
    capsys.readouterr()
    assert main(["run", "other.toml", *SMALL, "3", "--out", "mine"]) == 2
    assert "it contains a run of the case 'strip'" in the_error(capsys)
    assert contents(Path("mine")) == before
    assert main(["run", "other.toml", *SMALL, "1", "--out", "mine", "--force"]) == 0
    assert isopeel.Case.parse(isopeel.read_run(Path("mine/run.h5")).case_text).name == "other"


@pytest.mark.parametrize("options", [("2",), ("1",), ("3", "--step", "1.5"), ("3", "--step", "3")])
def test_a_finished_run_is_not_replaced_by_a_shorter_one(
    options: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "strip", *SMALL, "3"]) == 0
    before = contents(OUT)
    capsys.readouterr()
    assert main(["run", "strip", *SMALL, *options]) == 2
    error = the_error(capsys)
    assert "it contains a longer run of 'strip': 4 steps, to 3 deg, and this one has" in error
    assert contents(OUT) == before
    assert main(["run", "strip", *SMALL, *options, "--force"]) == 0
    assert contents(OUT) != before


def test_a_longer_run_replaces_one_and_lists_the_removed_files(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["run", "strip", *SMALL, "2"]) == 0
    assert main(["plot", "out/strip", "--only", "curve"]) == 0
    assert main(["report", "out/strip"]) == 0
    capsys.readouterr()
    assert main(["run", "strip", *SMALL, "2"]) == 0
    message = capsys.readouterr().out
    assert "replaces the run of strip in out/strip: 3 steps, to 2 deg" in message
    (removed,) = [line for line in message.splitlines() if line.startswith("removed ")]
    gone = {"curve.csv", "summary.json", "curve.png", "shapes.png", "report.html", "figures/curve.png"}
    assert set(removed.removeprefix("removed ").split(", ")) == {f"out/strip/{name}" for name in gone}
    for options in (("2",), ("3",), ("3", "--step", "0.5"), ("4", "--mesh", "8x1", "--step", "0.5")):
        assert main(["run", "strip", *SMALL, *options, "--out", "other"]) == 0


def test_a_run_of_another_case_of_the_same_name_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL, "2"]) == 0
    before = contents(OUT)
    capsys.readouterr()
    text = isopeel.load_case("strip").text
    for one, other, table in (
        ('"2 GPa"', '"70 GPa"', "material"),
        ('"10 nm"', '"12 nm"', "body"),
        ('"1e-19 J"', '"2e-19 J"', "adhesion"),
    ):
        assert text.count(f"= {one}") >= 1
        Path("other.toml").write_text(text.replace(f"= {one}", f"= {other}", 1))
        assert main(["run", "other.toml", *SMALL, "2"]) == 2
        assert f"a run of another case 'strip', with other values in [{table}]" in the_error(capsys)
    assert contents(OUT) == before
    assert main(["run", "other.toml", *SMALL, "2", "--force"]) == 0


@pytest.mark.parametrize("resumed", [False, True])
def test_a_finished_run_is_kept_until_another_one_has_finished(
    resumed: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "strip", *SMALL, "3"]) == 0
    finished = (OUT / "run.h5").read_bytes()
    with monkeypatch.context() as patch:
        patch.setattr("isopeel.running.stage_steps.check", _interrupting(2))
        assert main(["run", "strip", *SMALL, "3"]) == 130
    aside = OUT / "run.earlier.h5"
    assert f"the earlier finished run is kept: {aside}" in capsys.readouterr().out
    assert isopeel.read_run(OUT / "run.h5").ending == "interrupted"
    assert aside.read_bytes() == finished
    again = ["resume", "out/strip"] if resumed else ["run", "strip", *SMALL, "3", "--force"]
    assert main(again) == 0
    assert not aside.exists()


def test_nothing_is_kept_of_a_run_that_was_not_replaced(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert main(["run", "strip", *SMALL, "2"]) == 0
    before = contents(OUT)
    with monkeypatch.context() as patch:
        patch.setattr("isopeel.running.stage_steps.RunWriter.append", lambda *_: _interrupting(1)())
        assert main(["run", "strip", *SMALL, "2"]) == 130
    assert contents(OUT) == before


def test_a_run_with_fewer_stages_is_shorter(capsys: pytest.CaptureFixture[str]) -> None:
    text = isopeel.load_case("strip").text
    drive = text[text.index("[drive]") : text.index("[reading]")]
    one = text.replace(drive, drive.replace("[drive]", "[[drive]]"))
    two = text.replace(drive, 2 * drive.replace("[drive]", "[[drive]]"))
    Path("one.toml").write_text(one)
    Path("two.toml").write_text(two)
    assert main(["run", "two.toml", *SMALL, "1", "--step", "1", "--control", "newton"]) in (0, 3)
    before = contents(OUT)
    capsys.readouterr()
    assert main(["run", "one.toml", *SMALL, "1"]) == 2
    assert "'out/strip' cannot be used; it contains" in the_error(capsys)
    assert contents(OUT) == before


@pytest.mark.parametrize("ending", ["interrupted", "running"])
def test_an_unfinished_run_is_not_replaced_unless_forced(
    ending: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with monkeypatch.context() as patch:
        if ending == "interrupted":
            patch.setattr("isopeel.running.stage_steps.check", _interrupting(2))
            assert main(["run", "strip", *SMALL, "3"]) == 130
        else:
            patch.setattr("isopeel.results.run_writer.RunWriter.end", lambda *_: None)
            assert main(["run", "strip", *SMALL, "1"]) == 0
    assert isopeel.read_run(OUT / "run.h5").ending == ending
    before = contents(OUT)
    capsys.readouterr()
    assert main(["run", "strip", *SMALL, "3"]) == 2
    error = the_error(capsys)
    assert "`isopeel resume out/strip` continues it, and --force starts a new run" in error
    assert contents(OUT) == before
    assert main(["resume", "out/strip", "--to", "3"]) == 0
    assert main(["run", "strip", *SMALL, "3"]) == 0


@pytest.mark.parametrize(
    ("command", "file"),
    [
        (["law", "exponential", "--out", "mine.png"], "mine.png"),
        (["spaces", "L1", "--out", "mine.svg"], "mine.svg"),
        (["report", "out/strip", "--out", "mine.html"], "mine.html"),
        (["plot", "out/strip", "--only", "curve", "--out", "mine"], "mine/curve.png"),
        (["compare", "out/strip", "other", "--out", "mine"], "mine/compare.csv"),
        (["compare", "out/strip", "other", "--out", "mine"], "mine/compare.png"),
        (["export", "out/strip", "--out", "mine"], "mine/body-0000.vtu"),
    ],
)
def test_no_other_command_replaces_what_isopeel_did_not_write(
    command: list[str], file: str, capsys: pytest.CaptureFixture[str]
) -> None:
    for folder in ("out/strip", "other"):
        assert main(["run", "strip", *SMALL, "1", "--out", folder]) == 0
    Path("mine").mkdir()
    Path(file).write_text("my own work with isopeel")
    capsys.readouterr()
    assert main(command) == 2
    assert f"isopeel did not write {file}" in the_error(capsys)
    assert Path(file).read_text() == "my own work with isopeel"
    assert main([*command, "--force"]) == 0
    assert main(command) == 0  # which it wrote itself


@pytest.mark.parametrize("name", ["curve.csv", "summary.json", "shapes.png"])
def test_resuming_replaces_no_file_that_isopeel_did_not_write(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr("isopeel.running.stage_steps.check", _interrupting(2))
        assert main(["run", "strip", *SMALL, "3"]) == 130
    (OUT / name).write_text("my own work with isopeel")
    before = contents(OUT)
    capsys.readouterr()
    assert main(["resume", "out/strip"]) == 2
    assert f"isopeel did not write out/strip/{name}; move it to another folder" in the_error(capsys)
    assert contents(OUT) == before
    (OUT / name).unlink()
    assert main(["resume", "out/strip"]) == 0


def test_a_screenshot_replaces_no_other_picture(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("pyvista")
    assert main(["run", "strip", *SMALL, "1"]) == 0
    for mine in ("photo.png", "in/photo.PNG", "link.png"):
        Path(mine).parent.mkdir(exist_ok=True)
        if mine == "link.png":
            Path(mine).symlink_to("photo.png")
        else:
            Path(mine).write_bytes(b"\x89PNG drawn by hand")
        capsys.readouterr()
        command = ["view", "out/strip", "--screenshot", mine]
        before = Path(mine).read_bytes()
        assert main(command) == 2
        error = the_error(capsys)
        assert (
            f"isopeel did not write {mine}" in error or f"{mine!r} cannot be used; it is a symbolic" in error
        )
        assert Path(mine).read_bytes() == before
    assert main(["view", "out/strip", "--screenshot", "photo.png", "--force"]) == 0
    assert main(["view", "out/strip", "--screenshot", "photo.png"]) == 0  # which it wrote itself


def test_an_export_lists_what_it_removes(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL, "3", "--fields-every", "1"]) == 0
    assert main(["export", "out/strip"]) == 0
    assert main(["run", "strip", *SMALL, "3", "--fields-every", "2"]) == 0
    capsys.readouterr()
    assert main(["export", "out/strip"]) == 0
    gone = [f"out/strip/paraview/{name}-0003.vtu" for name in ("body", "adhesive-side")]
    assert f"removed {', '.join(gone)}\n" in capsys.readouterr().out


def a_thesis(folder: Path) -> str:
    (folder / "report.md").write_text("# My own\n")
    return "report.md"


def a_page_of_mine(folder: Path) -> str:
    (folder / "report.html").write_text("<p>isopeel is what I used</p>")
    return "report.html"


def a_drawing(folder: Path) -> str:
    (folder / "figures").mkdir()
    (folder / "figures" / "bending-drift.png").write_bytes(b"\x89PNG drawn by hand")
    return "figures/bending-drift.png"


def a_measured_table(folder: Path) -> str:
    (folder / "tables").mkdir()
    (folder / "tables" / "bending.csv").write_text("angle,force\n")
    return "tables/bending.csv"


def another_folder(folder: Path) -> str:
    (folder / "raw").mkdir()
    (folder / "raw" / "data.csv").write_text("1\n")
    return "raw"


def in_a_part(folder: Path) -> str:
    (folder / "bending-table3").mkdir()
    (folder / "bending-table3" / "notes.txt").write_text("mine")
    return "bending-table3"


def a_measurement(folder: Path) -> str:
    (folder / "records.h5").write_bytes(b"\x89HDF\r\n measured, for isopeel")
    return "records.h5"


@pytest.mark.parametrize("command", ["paper", "validate"])
@pytest.mark.parametrize(
    "plant",
    [notes, a_thesis, a_page_of_mine, a_drawing, a_measured_table, another_folder, in_a_part, a_measurement],
)
def test_a_report_is_written_to_no_folder_of_something_else(
    command: str, plant: Callable[[Path], str], capsys: pytest.CaptureFixture[str]
) -> None:
    Path("mine").mkdir()
    named, before = plant(Path("mine")), contents(Path("mine"))
    only = "table3" if command == "paper" else "bending"
    assert main([command, "--only", only, "--out", "mine"]) == 2
    assert f"'mine' cannot be used; it contains {named}, which is not of a report" in the_error(capsys)
    assert contents(Path("mine")) == before


def test_a_report_replaces_a_report_and_prints_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("isopeel.paper.report.execute", lambda *_: None)
    for options in ([], [], ["--mesh", "m1"]):
        assert main(["paper", "--only", "table3", *options, "--out", "mine"]) == 0
    (Path("mine") / "table3" / "notes.txt").write_text("mine")
    capsys.readouterr()
    assert main(["paper", "--only", "table3", "--out", "mine"]) == 2
    assert "it contains table3/notes.txt, which is not of a report" in the_error(capsys)
    assert main(["paper", "--only", "table3", "--out", "mine", "--force"]) == 0
    assert "replaces the report in mine/table3" in capsys.readouterr().out
    assert (Path("mine") / "table3" / "notes.txt").read_text() == "mine"


def test_the_stored_reports_are_taken_for_reports() -> None:
    docs = Path(__file__).parents[2] / "docs"
    for name in ("paper", "validation"):
        assert take_folder(docs / name, "", lambda _: False) == docs / name
        assert replaced(docs / name) == f"replaces the report in {docs / name}"


def _interrupting(number: int) -> Callable[[], None]:
    count = 0

    def check() -> None:
        nonlocal count
        count += 1
        if count == number:
            raise KeyboardInterrupt

    return check
