"""What a command prints for other programs: JSON, nothing, a log; exit codes, and completion."""

import json
import logging
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from command_output import FILES, SMALL, summary, the_error

from isopeel.cli import completion, main
from isopeel.common.errors import InputError
from isopeel.splines.rows import row_space

pytestmark = pytest.mark.usefixtures("in_own_folder", "without_figures")
ROOT = Path(__file__).parents[2]


def test_json_is_one_object_with_readings_notes_and_files(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL, "--json"]) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    found = json.loads(printed.out)
    (stage,) = found["stages"]
    written = summary(Path("out/strip"))
    assert (found["ending"], found["folder"]) == ("completed", "out/strip")
    assert stage["readings"] == written["readings"] != []
    assert stage["notes"] == written["notes"] != []
    assert (stage["completed"], stage["failure"]) == (True, None)
    assert set(stage["files"]) == {f"out/strip/{name}" for name in FILES}
    # a complete run is reported again
    assert main(["resume", "out/strip", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == found


def test_json_of_a_run_without_equilibrium_has_the_failure(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ("--mesh", "10x1", "--space", "L1", "--to", "80", "--step", "20", "--control", "newton")
    assert main(["run", "strip", *arguments, "--json"]) == 3
    found = json.loads(capsys.readouterr().out)
    (stage,) = found["stages"]
    assert (found["ending"], stage["completed"]) == ("not converged", False)
    assert stage["failure"] == summary(Path("out/strip"))["failure"] is not None


def test_quiet_prints_errors_only(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL, "-q"]) == 0
    shown = capsys.readouterr()
    assert (shown.out, shown.err) == ("", "")
    assert main(["run", "strip", "--mesh", "0x10", "--quiet", "--json"]) == 2
    assert "--mesh" in the_error(capsys)


def test_verbose_logs_stages_and_steps_to_standard_error(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL, "-q", "-v"]) == 0
    stages = capsys.readouterr()
    assert stages.out == ""
    assert "strip begins: 4 steps after 0; body: L1 (20, 2)" in stages.err
    assert re.search(r"strip: completed, 4 steps, \d+ corrections", stages.err)
    assert "requested step" not in stages.err
    assert main(["run", "strip", *SMALL, "-q", "-vv"]) == 0
    assert capsys.readouterr().err.count("requested step") == 4
    # nothing is left for the next command of this process
    assert logging.getLogger("isopeel").handlers == []


def test_a_dry_run_writes_nothing_and_states_the_size(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL, "--dry-run"]) == 0
    assert "strip: 4 steps, 126 DOFs, L1 20x2" in capsys.readouterr().out
    assert main(["run", "strip", *SMALL, "--dry-run", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert not Path("out").exists()
    (stage,) = found["stages"]
    assert (found["case"], stage["steps"], stage["dofs"]) == ("strip", 4, 126)
    assert found["expected_seconds"] > 0
    # three steps after the first one are timed, and all four are counted
    assert found["source"].startswith("4 steps of ")
    assert "mean of the 3 steps" in found["source"]
    # the estimate and the notes are those of the run
    assert main(["run", "strip", *SMALL, "-q"]) == 0
    zone = summary(Path("out/strip"))["process_zone"]["estimated"]
    (previewed,) = stage["process_zones"]
    assert previewed["elements"] == pytest.approx(zone["elements"], rel=1e-14)  # the order of a sum
    assert any("too stiff" in note["text"] for note in found["notes"])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["strip", "--mesh", "0x10"], "--mesh"),
        (["strip", "--strict", *SMALL], "resolution: 0.23 elements"),
        (["strip", "--out", "other"], "--out"),
    ],
)
def test_a_dry_run_refuses_what_a_run_refuses(
    arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("other").mkdir()
    Path("other/notes.txt").write_text("of something else")
    assert main(["run", *arguments, "--dry-run"]) == 2
    assert words in the_error(capsys)


def test_the_page_has_the_exit_codes() -> None:
    from isopeel.cli.base import BAD_INPUT, COMPLETED, NOT_CONVERGED
    from isopeel.common.interrupts import INTERRUPTED

    page = (ROOT / "docs/command-line.md").read_text("utf-8")
    codes = {int(code) for code in re.findall(r"^\| (\d+) \|", page, re.MULTILINE)}
    assert codes == {COMPLETED, BAD_INPUT, NOT_CONVERGED, INTERRUPTED}


@pytest.mark.parametrize("command", [[], ["run"], ["spaces"]])
def test_short_and_long_help_are_the_same(command: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*command, "--help"]) == 0
    long = capsys.readouterr().out
    assert main([*command, "-h"]) == 0
    assert capsys.readouterr().out == long
    assert "-h" in long


def completed(words: str) -> list[str]:
    """What bash is offered for the last word of a command line."""
    script = "import sys; sys.argv = ['isopeel']; from isopeel.cli import main; sys.exit(main())"
    variables = {
        "COMP_WORDS": words,
        "COMP_CWORD": str(words.count(" ")),
        "_ISOPEEL_COMPLETE": "complete_bash",
    }
    found = subprocess.run(
        [sys.executable, "-P", "-c", script],
        env=os.environ | variables,
        capture_output=True,
        text=True,
        check=True,
    )
    return found.stdout.split()


def test_a_shell_completes_cases_and_files() -> None:
    Path("stripes").mkdir()
    Path("stripe.toml").write_text("")
    Path("strip.txt").write_text("")
    assert completed("isopeel run stri") == ["strip", "stripe.toml", "stripes/"]


def test_values_of_options_are_completed() -> None:
    assert completion.path_controls("") == ["newton", "auto", "jump", "continuation"]
    assert completion.checks("tap") == ["tapes"]
    assert completion.laws("bili") == ["bilinear"]
    assert completion.parts("table") != []
    assert completion.spaces("Q1N") == ["Q1N2", "Q1N2.1"]


@pytest.mark.parametrize("name", completion.SPACES)
def test_offered_spaces_exist(name: str) -> None:
    try:
        assert row_space(name, (4, 2)).size > 0
    except InputError as error:
        pytest.fail(str(error))
