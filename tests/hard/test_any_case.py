"""Any case file runs or is refused with one line, in seconds."""

import io
import signal
import tempfile
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from time import perf_counter
from types import FrameType
from typing import Any

import pytest
from cases import AROUND, BODIES, LAWS, MATERIALS, OPTIONS, SUBSTRATES, documents, lay_files, toml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import isopeel.running.stage_results
from isopeel.cli import main

# figures that Ctrl-C interrupts leave their files to be closed later
pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]

LIMIT = 60.0  # seconds: of a run some 0.3, and up to 15 where its laws or materials are compiled
PATIENCE = 30.0  # with a run of many steps


class HangError(Exception):
    """A case takes too long."""


@pytest.fixture(scope="module", autouse=True)
def _compiled(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Compile what all cases share, which may take longer than any of them, before one is timed."""
    folder = tmp_path_factory.mktemp("first")
    document = {"name": "first", "body": BODIES[0], "material": MATERIALS[0], "adhesion": LAWS[0]}
    document |= {"discretization": {"mesh": "8x2"}, "drive": {"to": "2 deg", "step": "1 deg"}}
    # SymPy takes seconds to load, and to derive its first formulas
    formulas = {"material": MATERIALS[-1], "adhesion": LAWS[-1], "substrate": SUBSTRATES[-1]}
    for name, changed in (("plain", document), ("formulas", document | formulas)):
        (folder / "case.toml").write_text(toml(changed))
        main(["run", str(folder / "case.toml"), "--out", str(folder / name)])


def outcome(text: str, options: list[str], figures: bool) -> tuple[int, str]:
    """The exit code of a case, and what it wrote to standard error; HangError where it does not end."""

    stopped: list[bool] = []

    def stop(_number: int, _frame: FrameType | None) -> None:
        if stopped or not list(Path(folder).glob("out/**/run.h5")):
            raise HangError(text)
        # it runs, but too many steps were requested
        stopped.append(True)
        signal.raise_signal(signal.SIGINT)

    written, error = io.StringIO(), io.StringIO()
    before = signal.signal(signal.SIGALRM, stop)
    began = perf_counter()
    with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        if not figures:
            patch.setattr(isopeel.running.stage_results, "save", lambda _, path: path.touch())
        Path(folder, "case.toml").write_text(text, encoding="utf-8")
        lay_files(Path(folder))
        signal.setitimer(signal.ITIMER_REAL, PATIENCE, LIMIT - PATIENCE)
        try:
            with redirect_stdout(written), redirect_stderr(error):
                code = main(["run", f"{folder}/case.toml", "--out", f"{folder}/out", *options])
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, before)
    assert perf_counter() - began < LIMIT + 1
    return code, error.getvalue()


def check(document: dict[str, Any], options: list[str], around: tuple[str, str], figures: bool) -> None:
    """Either it runs, or the reason is reported correctly."""
    code, error = outcome(toml(document).join(around), options, figures)
    assert "Traceback" not in error
    match code:
        case 0:
            assert error == ""
        case 2:
            assert error.startswith("isopeel: ")
            assert error.endswith("\n")
            assert len(error.splitlines()) == 1, error
            assert len(error) < 3000
        case 3:
            assert error.startswith("isopeel: no equilibrium at ")
        case 130:
            assert error.startswith("isopeel: interrupted; the converged steps are in ")
        case _:
            pytest.fail(f"exit code {code}: {error}")


def any_case(examples: int) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Draw so many cases, the same ones each time."""

    def decorate(test: Callable[..., None]) -> Callable[..., None]:
        drawn = given(
            documents(),
            st.sampled_from(OPTIONS),
            st.sampled_from(AROUND),
            st.integers(0, 49).map(lambda n: n == 0),
        )
        limited = settings(
            max_examples=examples,
            deadline=None,  # HangError shows it
            derandomize=True,
            database=None,
            suppress_health_check=list(HealthCheck),
        )
        return limited(drawn(test))

    return decorate


@any_case(60)
def test_a_case_runs_or_reports_a_reason(
    document: dict[str, Any], options: list[str], around: tuple[str, str], figures: bool
) -> None:
    check(document, options, around, figures)


@pytest.mark.long
@any_case(2000)
def test_two_thousand_cases(
    document: dict[str, Any], options: list[str], around: tuple[str, str], figures: bool
) -> None:
    check(document, options, around, figures)
