"""The strip in isopeel and in a program of its own, on scikit-fem's elements and PARDISO."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import isopeel

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
# both stop at the same energy residual, after which only rounding tells them apart: 2e-13 at most
MOMENT_TOLERANCE = 1e-10


@pytest.fixture(autouse=True)
def _importable(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("skfem", "pypardiso"):
        pytest.importorskip(name)
    monkeypatch.syspath_prepend(BENCHMARKS)


@pytest.mark.parametrize("degree", [1, 2, 4])
def test_peers_find_the_same_equilibria(degree: int) -> None:
    from scikit_fem_strip import PEERS, Strip, trace

    mesh, angles = (40, 4), np.deg2rad(np.arange(0, 51, 2))
    strip = Strip(degree, mesh)
    ours = list(isopeel.trace(isopeel.strip(), isopeel.row_space(f"L{degree}", mesh), angles))
    for peer in PEERS.values():
        theirs = list(trace(strip, *peer(strip), angles))
        moments = [step.moment for step in theirs]
        np.testing.assert_allclose([step.reaction for step in ours], moments, rtol=0, atol=MOMENT_TOLERANCE)
        assert [len(step.iterations) for step in ours] == [step.iterations for step in theirs]


def test_no_time_is_taken_of_programs_that_disagree() -> None:
    from in_turn import Program, advance_in_turn
    from scikit_fem_strip import LoadStep

    def path(error: float) -> Iterator[LoadStep]:
        return (LoadStep(theta, theta + error * (theta > 1), 3) for theta in np.arange(3.0))

    _, largest = advance_in_turn([Program("one", path(0)), Program("other", path(9e-9))], 3)
    assert largest == pytest.approx(9e-9, rel=1e-6)  # 9e-9 is known to 2e-16 beside a moment of 2
    with pytest.raises(ArithmeticError, match=r"at 114\.592 degrees: one 2\.0000000000, other 2\.0000000200"):
        advance_in_turn([Program("one", path(0)), Program("other", path(2e-8))], 3)


def test_the_benchmark_prints_a_line_for_each_program() -> None:
    command = [sys.executable, "load_step.py", "--mesh", "40x4", "--from", "0.4", "--to", "1", "--block", "4"]
    done = subprocess.run(command, cwd=BENCHMARKS, capture_output=True, text=True, check=True)
    rows = {line.split()[0]: line.split()[1:] for line in done.stdout.splitlines() if line.strip()}
    assert float(rows["isopeel"][4]) == 1  # its time relative to itself
    for peer in ("plain", "forms", "hand-tuned"):
        assert rows[peer][3] == rows["isopeel"][3]  # iterations
