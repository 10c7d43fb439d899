"""The strip in isopeel and in programs of its own, on other libraries' elements and solvers."""

import subprocess
import sys
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

if TYPE_CHECKING:
    from comparison import Comparison
    from programs import Block

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
ELEMENTS = (20, 2)
# the face pulls the strip up, and part of it past the strongest adhesion
ANGLES = np.deg2rad(np.arange(0, 21, 2)).tolist()
# all stop at the same energy residual, so that they differ by round-off only: 1e-13 at most
MOMENT_TOLERANCE = 1e-10


@pytest.fixture(autouse=True)
def _importable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(BENCHMARKS)


@cache
def moments_of_isopeel(degree: int) -> list[float]:
    from peers.names import ISOPEEL
    from programs import Program

    ours = Program(ISOPEEL, degree, ELEMENTS)
    ours.begin(ANGLES)
    moments = [step.moment for step in ours.finish().steps]
    ours.close()
    return moments


@pytest.mark.parametrize(
    ("peer", "degree"),
    [
        ("plain", 2),
        ("forms", 4),
        ("tuned", 1),
        ("tuned", 4),
        ("felupe", 4),
        ("ngsolve", 4),
        ("nutils", 4),
        ("dolfinx", 1),
    ],
)
def test_peers_find_the_same_equilibria(peer: str, degree: int) -> None:
    from programs import GoneError, Program

    try:
        program = Program(peer, degree, ELEMENTS)
    except GoneError as error:
        pytest.skip(str(error))
    program.begin(ANGLES)
    theirs = program.finish()
    program.close()
    moments = moments_of_isopeel(degree)
    assert len(moments) == len(ANGLES)
    assert theirs.stopped is None
    np.testing.assert_allclose([step.moment for step in theirs.steps], moments, rtol=0, atol=MOMENT_TOLERANCE)
    assert all(step.assembly is not None and step.solution is not None for step in theirs.steps)


class Prescribed:
    """A program with prescribed moments, and a prescribed end."""

    def __init__(self, label: str, error: float = 0.0, *, count: int = 9, gone: bool = False) -> None:
        self.label, self.versions = label, {"library": "1"}
        self._error, self._left, self._gone, self.closed = error, count, gone, False

    def begin(self, angles: Sequence[float]) -> None:
        self._angles = angles

    def finish(self) -> "Block":
        from peers.newton import LoadStep
        from programs import Block, GoneError

        if self._gone:
            raise GoneError("it ended with status -11")
        angles = self._angles
        found = angles[: self._left]
        self._left -= len(found)
        stopped = "none after 25 iterations" if len(found) < len(angles) else None
        return Block([LoadStep(t + self._error * (t > 1), 3, 0.1) for t in found], stopped, 1.0)

    def close(self) -> None:
        self.closed = True


def compared(*programs: Prescribed) -> "Comparison":
    from comparison import Comparison, Entry

    comparison = Comparison([Entry(program) for program in programs])
    comparison.trace([0.0, 1.0, 2.0], timed=True)
    return comparison


def test_no_time_is_shown_of_a_program_that_disagrees() -> None:
    right, wrong = Prescribed("right", 9e-9), Prescribed("wrong", 2e-8)
    comparison = compared(Prescribed("isopeel"), right, wrong)
    assert [entry.program.label for entry in comparison.entries] == ["isopeel", "right"]
    # 9e-9 is known to 2e-16 beside a moment of 2
    assert comparison.largest_difference == pytest.approx(9e-9, rel=1e-6)
    assert comparison.notes == [
        "wrong is left out: its moment at 114.592 degrees is 2.0000000200, not 2.0000000000 E0 L0^3"
    ]
    assert wrong.closed
    assert not comparison.ended


def test_the_comparison_ends_where_a_program_finds_no_equilibrium() -> None:
    comparison = compared(Prescribed("isopeel"), Prescribed("other", count=2))
    assert comparison.notes == [
        "no equilibrium at 114.592 degrees, where the comparison ends: other (none after 25 iterations)"
    ]
    assert comparison.ended
    assert [len(entry.steps) for entry in comparison.entries] == [2, 2]


def test_a_program_that_breaks_does_not_end_the_others() -> None:
    comparison = compared(Prescribed("isopeel"), Prescribed("broken", gone=True), Prescribed("other"))
    assert comparison.notes == ["broken is left out: it ended with status -11"]
    assert [len(entry.steps) for entry in comparison.entries] == [3, 3]


def test_the_end_of_a_process_is_reported() -> None:
    from peers.names import ISOPEEL
    from programs import GoneError, Program

    program = Program(ISOPEEL, 1, ELEMENTS)
    program._process.kill()
    program.begin([0.0])
    with pytest.raises(GoneError, match="it ended with status -9"):
        program.finish()


def test_programs_are_started_without_what_slows_them(monkeypatch: pytest.MonkeyPatch) -> None:
    from programs import environment

    monkeypatch.setenv("OPENBLAS_CORETYPE", "Haswell")
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    assert "OPENBLAS_CORETYPE" not in environment()
    assert environment()["OMP_NUM_THREADS"] == "1"


def test_the_benchmark_prints_a_line_for_each_program() -> None:
    for name in ("skfem", "pypardiso"):
        pytest.importorskip(name)
    command = [sys.executable, "load_step.py", "--mesh", "20x2", "--from", "0.4", "--to", "1", "--block", "4"]
    command += ["--peers", "plain,tuned,dolfinx"]
    done = subprocess.run(command, cwd=BENCHMARKS, capture_output=True, text=True, check=True)
    rows = {line.split()[-9]: line.split()[-8:] for line in done.stdout.splitlines() if len(line.split()) > 8}
    assert rows["isopeel"][:2] == ["-", "-"]
    assert float(rows["isopeel"][6]) == 1  # its time relative to itself
    for peer in ("plain", "tuned"):
        assert float(rows[peer][0]) > 0
    assert "DOLFINx is left out" in done.stdout  # of degree 2


def test_too_coarse_a_mesh_is_refused() -> None:
    command = [sys.executable, "load_step.py", "--mesh", "10x2"]
    done = subprocess.run(command, cwd=BENCHMARKS, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert (
        done.stderr == "load_step: --mesh: '10x2' cannot be used; 3/4 of the elements along x must adhere\n"
    )
