"""Runs that are interrupted and resumed, compared with whole ones."""

import signal
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from isopeel import Step
from isopeel.case import Case
from isopeel.results.run_file import read_run
from isopeel.running.resume import resume_case
from isopeel.running.run import run_case
from isopeel.solve.trace import trace

QUIET = Console(quiet=True)


def check_resumed_run(
    case: Case, whole: Path, stages: Sequence[str], steps: int, place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Interrupt a run in a new folder after some steps, resume it, and compare it bit for bit."""
    left = [steps]

    def interrupted(*arguments: Any, **options: Any) -> Iterator[Step]:
        for step in trace(*arguments, **options):
            yield step
            left[0] -= 1
            if left[0] == 0:
                signal.raise_signal(signal.SIGINT)

    with monkeypatch.context() as patch:
        patch.setattr("isopeel.running.stage_trace.trace", interrupted)
        assert run_case(case, place, QUIET).run.ending == "interrupted"
    assert resume_case(place, QUIET).run.ending == "completed"
    for stage in stages:
        expected, continued = (read_run(folder / stage / "run.h5") for folder in (whole, place))
        for name in ("reaction", "dissipated_energy"):
            np.testing.assert_array_equal(getattr(continued.curve, name), getattr(expected.curve, name))
        for one, other in zip(continued.states, expected.states, strict=True):
            np.testing.assert_array_equal(one.displacement, other.displacement)
            np.testing.assert_array_equal(one.maximum_openings, other.maximum_openings)
