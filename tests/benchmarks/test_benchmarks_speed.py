"""The benchmarks of speed: what they count is counted by hand here, and each runs on a small case."""

import sys
from collections import Counter
from dataclasses import replace
from functools import partial
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

import isopeel
from isopeel.assembly.system import System
from isopeel.paper.study import MESHES, SPACES

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture(autouse=True)
def _importable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(BENCHMARKS)


def printed(benchmark: str, *options: str) -> list[list[str]]:
    """Words of the lines that a benchmark prints."""
    app = typer.Typer()
    app.command()(import_module(benchmark).main)
    result = CliRunner().invoke(app, options, catch_exceptions=False)
    assert result.exit_code == 0
    return [line.split() for line in result.stdout.splitlines()]


@pytest.mark.parametrize("joined", [1, 3])
def test_operations_of_a_factorization_are_those_of_cholesky_s_method(joined: int) -> None:
    from work import below, factorization, solution

    n, b = 10, 3
    # elements of b + 1 unknowns each, of which one or three meet the next one
    A = np.diag(np.full(n, 10.0))
    for start in range(0, n - b, b + 1 - joined):
        A[start : start + b + 1, start : start + b + 1] += np.ones((b + 1, b + 1))
    columns = np.array([[A[j + k, j] if j + k < n else 0.0 for k in range(b + 1)] for j in range(n)])
    L, flops, entries = np.tril(A), 0, 0
    for j in range(n):
        L[j, j] **= 0.5
        flops += 1
        (rows,) = np.nonzero(L[:, j])
        rows = rows[rows > j]
        entries += len(rows)
        for i in rows:
            L[i, j] /= L[j, j]
            flops += 1
        for i in rows:
            for k in rows[rows <= i]:
                L[i, k] -= L[i, j] * L[k, j]
                flops += 2
    np.testing.assert_allclose(L, np.linalg.cholesky(A), rtol=0, atol=1e-14)  # a few roundings of 3
    assert entries < b * n if joined == 1 else entries == b * n - 6
    assert factorization(below(columns)).flops == flops
    # there and back, in each row a division, and two operations for each entry beside
    assert solution(below(columns)).flops == 2 * (n + 2 * entries)


def test_operations_of_one_element_by_hand() -> None:
    from work import body_forces, body_tangent

    table = System(isopeel.strip(), isopeel.row_space("L1", (1, 1))).body
    # four points; both rows have two functions, of which values and derivatives are made at two points
    lines = 2 * 2 * 2 * 2 * (2 + 2)
    # of two components two derivatives from two rows, which the size of a rectangle goes into
    derivatives = 2 * 2 * 4
    neo_hooke = 3 + 32 + 17 + 13
    assert body_forces(table) == 2 * lines + 4 * (2 * derivatives + neo_hooke + 2)
    # of any other element there are two products in each component of F, and three in those of the way back
    other = replace(table, rectangles=np.zeros_like(table.rectangles))
    gradient = 2 * 2 * 4
    assert body_forces(other) == body_forces(table) + 4 * (2 * gradient + 4)
    between_rows = 4 * (3 + 4 + 3) * 2
    # of each row with itself ten of sixteen entries, and all sixteen between them
    entries = 2 * (3 * 2 * 16 + 10 * 9) + 4 * 2 * 16 + 16 * 9
    assert body_tangent(table) == 4 * (5 + 60 + between_rows) + entries
    pulled_back = 4 * 4 * 5 + 10 * 4
    assert body_tangent(other) == body_tangent(table) + 4 * pulled_back


def test_the_work_of_a_longer_strip_is_in_proportion() -> None:
    from work import tangent

    one, two = (
        tangent(System(isopeel.strip(length=k, adhering_length=k), isopeel.row_space("N2.1", (k, 3))))
        for k in (20, 40)
    )
    assert two.flops == pytest.approx(2 * one.flops, rel=1e-12)  # sums of integers
    # a spline space has three functions more than elements, so that 23 become 43
    assert 43 / 23 <= two.moved / one.moved <= 2


def test_exponents_are_fitted() -> None:
    from scaling import exponent

    sizes = [1e3, 2e3, 5e3, 1e4]
    assert exponent(sizes, [3e-7 * n**1.25 for n in sizes]) == pytest.approx(1.25, abs=1e-12)  # rounding
    assert np.isnan(exponent([1e3], [1.0]))


def test_families_grow() -> None:
    from scaling import FAMILIES, family

    grown = [[(strip.length, strip.mesh) for strip in family(name, "L1", (200, 10))] for name in FAMILIES]
    assert grown[0][-1] == (2000.0, (2000, 10))
    assert [mesh for _, mesh in grown[1]] == [(100, 10), (200, 10), (400, 10)]
    assert [mesh for _, mesh in grown[2]] == [(200, 5), (200, 10), (200, 20)]
    longest = family("longer", "L1", (200, 10))[-1].problem
    assert longest.adhesion.end * 2000 == pytest.approx(1950, rel=1e-12)  # its free end is as long as ever
    with pytest.raises(isopeel.InputError, match="--growth"):
        family("thicker", "L1", (200, 10))


@pytest.mark.chord_tangent
def test_a_step_is_what_its_parts_are() -> None:
    from peeling import Strip
    from profile_step import profile

    unwatched = System.equilibrium
    found = profile(Strip("L1", (20, 2)), reach=4.0, coarse=1.0, steps=3)
    corrections = sum(len(step.iterations) for step in found.steps)
    assert len(found.steps) == 3
    # each correction is a solution with the chord tangent, and each step evaluates one residual more, but
    # where the evaluation after its last correction is skipped
    assert found.clock.calls["solve"] == found.clock.calls["update"] == corrections
    assert corrections <= found.clock.calls["forces"] <= corrections + 3
    # one more tangent is needed to check the stability of the last state
    assert found.clock.calls["tangent"] - found.clock.calls["factor"] in (0, 1)
    assert 0 < sum(found.share(part) for part in found.clock.seconds) < 1
    assert System.equilibrium is unwatched


def test_profile_step_prints_four_tables(monkeypatch: pytest.MonkeyPatch) -> None:
    import machine

    # no time is looked at: few repeats, and a small array, will do
    monkeypatch.setattr(machine, "ceiling", partial(machine.ceiling, 1))
    monkeypatch.setattr(machine, "least_seconds", partial(machine.least_seconds, budget=0.0))
    lines = printed("profile_step", "--space", "L1", "--mesh", "20x2", "--reach", "4", "--steps", "2")
    rows = [line for line in lines if line[:2] == ["L1", "20x2"]]
    parts = ["forces", "tangent", "factor", "solve", "update"]
    assert [row[2] for row in rows[2:-1]] == parts
    # the time of a step is what it was, and more than that of the same calls at best, which is next to none
    measured, dgemm = map(float, rows[-1][2:4])
    assert measured == float(rows[1][2]) > dgemm >= 0
    unknowns = System(isopeel.strip(), isopeel.row_space("L1", (20, 2))).constraints.count
    assert rows[0][2] == str(unknowns)


def test_scaling_prints_a_line_for_each_strip(monkeypatch: pytest.MonkeyPatch) -> None:
    import scaling

    # processes of their own would take most of the time
    monkeypatch.setattr(scaling, "measure_alone", scaling.measure)
    lines = printed(
        *("scaling", "--space", "L1", "--growth", "along", "--mesh", "20x2"),
        *("--reach", "4", "--steps", "2"),
    )
    rows = [line for line in lines if line[:2] == ["L1", "along"]]
    assert [row[3] for row in rows] == ["10x2", "20x2", "40x2"]


def test_study_prints_a_line_for_each_run() -> None:
    lines = printed(
        "study", "--mesh", "m1", "--space", "L1", "--space", "N2", "--to", "0.2", "--processes", "1"
    )
    rows = {line[0]: line for line in lines if line[1:2] == ["m1"]}
    assert set(rows) == {"L1", "N2"}
    for row in rows.values():
        assert row[2] == "3"  # 0, 0.1 and 0.2 degrees
        assert row[-1] == "0.2"


def test_ablation_prints_a_line_for_each_method() -> None:
    from ablations.methods import METHODS

    # those with compiled functions of their own would take minutes
    names = [method.name for method in METHODS if not method.compiles]
    chosen = [argument for name in names for argument in ("--method", name)]
    lines = printed("ablation", "--mesh", "m1", "--space", "L1", "--to", "1", *chosen)
    text = [" ".join(line) for line in lines]
    assert [sum(line.startswith(name) for line in text) for name in names] == [1] * len(names)
    assert min(method.lines for method in METHODS) > 0
    # the path is the same without any of them: of eleven steps the moments agree to 1e-8, as the solver's do
    differences = [float(line[-1]) for line in lines if " ".join(line).startswith(tuple(names))]
    assert max(differences) < 1e-8


def test_the_study_is_all_published_runs() -> None:
    from study import chosen_runs

    assert len(chosen_runs(None, None)) == len(SPACES) * len(MESHES) == 27
    assert [run.name for run in chosen_runs(["N2"], ["m1", "m3"])] == ["N2-m1", "N2-m3"]
    with pytest.raises(isopeel.InputError, match="--space"):
        chosen_runs(["N3"], None)


def test_a_first_run_finds_empty_caches() -> None:
    from start_up import Command, timed

    empty = "import os; assert not os.path.exists(os.environ['NUMBA_CACHE_DIR'])"
    assert len(timed(Command("first", [sys.executable, "-c", empty], 2, first=True))) == 2
    assert len(timed(Command("any", [sys.executable, "-c", "pass"], 3))) == 3


def test_start_up_prints_a_line_for_each_command(monkeypatch: pytest.MonkeyPatch) -> None:
    import start_up

    whole = start_up.commands(5, 2, ["strip"])[-1]
    assert whole.label == "isopeel run strip, the first"
    assert whole.arguments[1:] == ["run", "strip"]
    cheap = [start_up.Command("nothing", [sys.executable, "-c", "pass"], 2)]
    monkeypatch.setattr(start_up, "commands", lambda *_: cheap)
    took = Counter({"numba": 0.6, "numpy": 0.39, "typer": 0.01})
    monkeypatch.setattr(start_up, "imports", lambda *_: took)
    lines = printed("start_up")
    assert [line[:2] for line in lines if line[:1] == ["nothing"]] == [["nothing", "2"]]
    # what takes less than 3 % is not named
    named = [line for line in lines if line[:1] in (["numba"], ["numpy"], ["typer"], ["others"])]
    assert named == [["numba", "0.60", "60", "%"], ["numpy", "0.39", "39", "%"], ["others", "0.01", "1", "%"]]
