"""The validation table: its cheapest rows, what it writes, and how it ends."""

import csv
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from time import sleep
from typing import Any

import numpy as np
import pytest
from psutil import Process, wait_procs
from scipy.integrate import dblquad

from isopeel.cli import main
from isopeel.common.errors import InputError
from isopeel.common.processes import Done, WorkerLostError
from isopeel.report.document import to_markdown
from isopeel.results.provenance import Provenance
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.step import Step
from isopeel.validation import (
    bending,
    check,
    curvature,
    cylinder,
    mixed_mode,
    mode_ratios,
    patch,
    report,
    snap_back,
    tapes,
    two_cylinders,
)
from isopeel.validation.check import Result, Row
from isopeel.validation.report import CHECKS, make_document

#: The checks whose rows take seconds; the rows of the others take minutes.
QUICK = ("cantilever", "hertz", "bending", "curvature", "patch", "momentum", "layers", "arms", "separation")
#: One case of each other check, and what computes it; coarser than in the table where that will do.
CHEAPEST: dict[str, Any] = {
    "tapes": lambda: tapes.peel(tapes.Tape(30.0, 6.0, stretch=1.03), elements=(60, 2)),
    "cylinder": lambda: cylinder.pull_off(0.001, elements=(50, 12)),
    "modes": lambda: mode_ratios.grow(mode_ratios.Growing(0.5)),
    "cylinders": lambda: two_cylinders.meet(two_cylinders.CHECK.cases[0]),
    "mixed-mode": lambda: mixed_mode.crack(87.4),
    "snap-back": lambda: snap_back.follow(66.25),
}


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def assert_passed(result: Result) -> None:
    assert result.problems == ()
    assert {row.allowed for row in result.rows} != {None}
    assert [row for row in result.rows if not row.passed] == []
    for picture in result.pictures:
        assert picture.draw().axes


def assert_all_rows_pass(name: str) -> None:
    chosen = CHECKS[name]
    assert_passed(chosen.judge([chosen.compute(case) for case in chosen.cases]))


@pytest.mark.parametrize("name", QUICK)
def test_all_rows_of_a_quick_check_are_within_their_allowances(name: str) -> None:
    """The allowances are those of the table: from a millionth of a factor to two per cent of a pull-off."""
    assert_all_rows_pass(name)


@pytest.mark.parametrize("name", CHEAPEST)
def test_the_cheapest_row_of_another_check_is_within_its_allowance(name: str) -> None:
    assert_passed(CHECKS[name].judge([CHEAPEST[name]()]))


def test_rows_of_each_check_are_computed() -> None:
    assert sorted((*QUICK, *CHEAPEST)) == sorted(CHECKS)


@pytest.fixture
def _no_equilibria(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: object, **__: object) -> Iterator[Step]:
        raise ConvergenceError("an element is inverted", (), 0.5)
        yield

    monkeypatch.setattr(check, "trace", fails)


@pytest.mark.usefixtures("_no_equilibria")
def test_a_row_without_an_equilibrium_fails_with_a_reason() -> None:
    results = {}
    for name, chosen in CHECKS.items():
        result = results[name] = chosen.judge([chosen.compute(case) for case in chosen.cases])
        for picture in result.pictures:
            assert picture.draw().axes
        if name in ("curvature", "momentum"):  # which trace no path
            continue
        assert not result.passed
        assert all(np.isnan(row.computed) for row in result.rows)
        assert result.problems[0] == "no equilibrium at 0.5: an element is inverted"
    document = make_document(results, dict.fromkeys(CHECKS, 1.0), Provenance.of_this_process())
    judged = [row for result in results.values() for row in result.rows if row.allowed is not None]
    # 18 rows of the curvature and 9 of the momentum pass, and the other checks fail in the summary as well
    assert to_markdown(document).count("FAIL") == len(judged) - 27 + len(CHECKS) - 2


def test_rows_judge_by_what_is_allowed() -> None:
    assert Row(1.009, 1.0, 0.01, ()).passed
    assert not Row(0.989, 1.0, 0.01, ()).passed
    assert not Row(np.nan, 1.0, 0.01, ()).passed
    assert Row(2.0, 1.0, None, ()).passed
    assert Row(0.995, 1.0, 0.01, ()).share_of_allowed == pytest.approx(0.5)  # round-off of 0.995 - 1
    with pytest.raises(InputError, match="allowed"):
        Row(1.0, 1.0, 0.0, ())


def test_half_space_forces_are_those_over_cylindrical_coordinates() -> None:
    """The rings' angles and heights against the integral over radius and depth, at two gaps and powers."""

    def axial(radius: float, depth: float) -> float:
        height = gap + depth
        return float(2 * np.pi * radius * power * height / (radius**2 + height**2) ** (power / 2 + 1))

    for gap, power in ((1.0, 6), (1.7, 12)):
        volume = dblquad(axial, 0, np.inf, 0, np.inf, epsabs=0, epsrel=1e-9)[0]
        # the tolerance of the quadrature
        assert curvature.half_space(gap, power) == pytest.approx(volume, rel=1e-8)


def test_the_cases_are_the_requested_ones() -> None:
    plain = {tape.angle_deg for tape in tapes.CHECK.cases if tape.held and tape.stretch == 1}
    assert plain == {30.0, 60.0, 90.0, 120.0, 150.0}
    strains = [strip.bending_strain for strip in bending.CHECK.cases]
    assert sum(strain < 0.05 for strain in strains) == 10
    assert max(strains) == pytest.approx(0.15, rel=1e-3)  # the work is rounded to three digits
    tabor = [cylinder.tabor_parameter(strength) for strength in cylinder.CHECK.cases]
    assert max(tabor) / min(tabor) > 10**1.5
    assert max(tabor) > cylinder.CRACK_LIKE
    assert min(tabor) < cylinder.RIGID_LIKE


def test_the_error_of_the_patch_test_falls_with_the_number_of_gauss_points() -> None:
    for scheme in ("unbiased", "biased"):
        errors = [patch.press(patch.Pressing(scheme, points=points)).error for points in (3, 24)]
        # measured 0.0016 and 0.0019
        assert errors[1] < 0.01 * errors[0]


def in_this_process(
    tasks: Sequence[Callable[[], object]], workers: int, finished: Callable[[int, Done], None]
) -> list[Done]:
    return [Done(task(), 0.0) for task in tasks]


def test_the_command_writes_its_report(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(report, "compute_all", in_this_process)
    assert main(["validate", "--only", "curvature"]) == 0
    folder = Path("out/validation/curvature")
    assert {path.name for path in folder.iterdir()} == {"report.md", "report.html", "figures", "tables"}
    assert (folder / "figures/curvature-factors.png").read_bytes().startswith(b"\x89PNG")
    with (folder / "tables/curvature.csv").open(newline="") as file:
        heading, *rows = csv.reader(file)
    assert heading[-1] == "verdict"
    assert [row[-1] for row in rows].count("pass") == 18
    written = (folder / "report.md").read_text("utf-8")
    assert "isopeel validate --only curvature" in written
    assert "| Curved substrates | " in written
    shown = capsys.readouterr().out
    assert "18 of 18" in shown
    assert shown.endswith("the report is out/validation/curvature/report.md\n")


def test_a_deviation_beyond_what_is_allowed_ends_with_3(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    chosen = CHECKS["curvature"]

    def strict(outcomes: Iterable[Any]) -> Result:
        result = chosen.judge(tuple(outcomes))
        return replace(result, rows=(*result.rows[1:], replace(result.rows[0], expected=1.1)))

    monkeypatch.setitem(CHECKS, "curvature", replace(chosen, judge=strict))
    monkeypatch.setattr(report, "compute_all", in_this_process)
    assert main(["validate", "--only", "curvature", "--out", "here"]) == 3
    output = capsys.readouterr()
    assert output.err == "isopeel: rows with too large a deviation: 1; see here/curvature/report.md\n"
    assert "FAIL" in output.out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--only", "tape"], "isopeel: --only: 'tape' cannot be used; the checks are tapes, cantilever, "),
        (
            ["--out", "file"],
            "isopeel: --out: 'file' cannot be used; a folder that can be written is needed: ",
        ),
    ],
)
def test_what_makes_no_sense_is_refused_with_one_line(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("file").write_text("no folder")
    assert main(["validate", *arguments]) == 2
    error = capsys.readouterr().err
    assert error.startswith(message)
    assert error.count("\n") == 1


@pytest.mark.parametrize(
    ("error", "code", "message"),
    [
        (KeyboardInterrupt(), 130, "interrupted"),
        (WorkerLostError("a process was ended"), 2, "a process was ended"),
    ],
)
def test_what_ends_it_is_reported_with_one_line(
    error: BaseException,
    code: int,
    message: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def ended(*_: object) -> list[Done]:
        raise error

    monkeypatch.setattr(report, "compute_all", ended)
    assert main(["validate", "--only", "curvature"]) == code
    assert capsys.readouterr().err == f"isopeel: {message}\n"


@pytest.fixture
def under_way() -> Iterator[subprocess.Popen[bytes]]:
    """A validation with all its workers, and alone in its group of processes."""
    command = "import sys; from isopeel.cli import main; sys.exit(main(['validate', '--only', 'tapes']))"
    process = subprocess.Popen(
        [sys.executable, "-c", command],
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        # a worker, and a keeper of resources
        while len(Process(process.pid).children()) < 2:
            sleep(0.05)
        yield process
    finally:
        process.kill()
        if process.stderr is not None:
            process.stderr.close()
        process.wait()


@pytest.mark.posix
@pytest.mark.long
def test_ctrl_c_ends_it_at_once_and_leaves_nothing_behind(under_way: subprocess.Popen[bytes]) -> None:
    sleep(1.0)
    children = Process(under_way.pid).children()
    os.killpg(under_way.pid, signal.SIGINT)
    _, error = under_way.communicate(timeout=30)
    assert under_way.returncode == 130
    assert error == b"isopeel: interrupted\n"
    assert wait_procs(children, timeout=30)[1] == []


@pytest.mark.long
@pytest.mark.parametrize("name", CHEAPEST)
def test_all_rows_are_within_their_allowances(name: str) -> None:
    assert_all_rows_pass(name)
