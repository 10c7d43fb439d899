"""Runs killed at any instant: the file opens, nothing is lost, and resuming ends in the same bits."""

import random
from collections.abc import Callable
from pathlib import Path

import pytest
from killing import (
    Outcome,
    has_journal,
    in_a_fork,
    is_being_written,
    is_prefix,
    leftovers,
    run_files,
    stored_bits,
)

import isopeel
from isopeel.case import Case, with_options
from isopeel.cli import main

_STRIP = isopeel.load_case("strip").text
_LAW = _STRIP[_STRIP.index('law = "van-der-waals"') : _STRIP.index('length = "150 nm"')]
_EXPONENTIAL = (
    'law = "exponential"\nstrength = "60 MPa"\nwork_of_adhesion = "0.03 J/m^2"\nirreversible = true\n'
)

CASES: dict[str, Callable[[], Case]] = {
    "smooth": lambda: with_options(
        isopeel.load_case("strip"), space="N2.1", mesh="160x8", to="60", step="0.2"
    ),
    "enriched": lambda: with_options(
        isopeel.load_case("strip"), space="L1+N2", mesh="160x4", to="60", step="0.2"
    ),
    # weaker than the strip's law, so that a coarse mesh resolves the front
    "irreversible": lambda: with_options(
        Case.parse(_STRIP.replace(_LAW, _EXPONENTIAL)), space="N2.1", mesh="100x3", to="70", step="0.2"
    ),
    # without a potential: Newton's method throughout
    "projected": lambda: with_options(
        isopeel.load_case("strip"), space="N2", mesh="160x4", to="40", step="0.2", traction="projected"
    ),
    "jumps in stages": lambda: with_options(
        isopeel.load_case("press-and-peel"), space="N2.1", mesh="60x2", to="60", step="0.5"
    ),
}


class Reference:
    """An uninterrupted run, and how long it takes in a fork."""

    def __init__(self, name: str, scratch: Path) -> None:
        self.case = scratch / "case.toml"
        self.case.write_text(CASES[name]().text)
        self.folder = scratch / "whole"
        assert main(["run", str(self.case), "--out", str(self.folder)]) == 0  # compiles, too
        self.bits = [stored_bits(path) for path in run_files(self.folder)]
        self.runs = [isopeel.read_run(path) for path in run_files(self.folder)]
        self.seconds = float(sum(run.curve.seconds.sum() for run in self.runs))


def kill_and_resume(reference: Reference, scratch: Path, seed: int, kills: int, figures: bool) -> int:
    """Kill a run and what resumes it, again and again, and let the last one end; return how often."""
    chance = random.Random(seed)
    out, done = scratch / f"out{seed}", 0
    reached: dict[Path, int] = {}
    command = ["run", str(reference.case), "--out", str(out)]
    # the first one is early, so that there is one whatever the machine
    moments = [has_journal(out, 50), *(some_moment(chance, reference.seconds, out) for _ in range(kills - 1))]
    while True:
        ended = in_a_fork(
            command,
            scratch,
            moments[done] if done < len(moments) else lambda _: False,
            save_seconds=chance.choice([0.02, 0.1, 1.0]),
            figures=figures,
        )
        if ended.code == 0:
            break
        assert ended.code == -9, ended.said
        done += 1
        check_files(reference, out, ended, reached)
        if run_files(out):
            command = ["resume", str(out)]
    assert leftovers(out) == set()
    assert [stored_bits(path) for path in run_files(out)] == reference.bits
    return done


def some_moment(chance: random.Random, seconds: float, out: Path) -> Callable[[float], bool]:
    """At some time, or then as soon as a file is being written, or as soon as there is a journal."""
    moment = chance.choice([0.0, chance.uniform(0.0, seconds)])
    event = chance.choice(
        [lambda _: True, is_being_written(out), has_journal(out, chance.randrange(50, 200_000))]
    )
    return lambda passed: passed > moment and event(passed)


def check_files(reference: Reference, out: Path, ended: Outcome, reached: dict[Path, int]) -> None:
    """Every file opens, and holds all steps that were taken, by the last process and by those before."""
    for path, whole in zip(run_files(out), reference.runs, strict=False):
        run = isopeel.read_run(path)
        assert is_prefix(run, whole)
        assert len(run.curve) >= max(ended.taken.get(str(path), 0), reached.get(path, 0))
        reached[path] = len(run.curve)
        last = run.states[-1]
        assert last.step == len(run.curve) - 1
        for state in whole.states:
            if state.step == last.step:
                assert last.displacement.tobytes() == state.displacement.tobytes()
                assert last.maximum_openings.tobytes() == state.maximum_openings.tobytes()


@pytest.mark.parametrize("name", CASES)
def test_a_killed_run_ends_as_if_nothing_had_happened(name: str, tmp_path: Path) -> None:
    assert kill_and_resume(Reference(name, tmp_path), tmp_path, seed=1, kills=2, figures=name == "smooth") > 0


@pytest.mark.long
def test_a_hundred_kills(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    kills, seed = 0, 10
    references = []
    for number, name in enumerate(CASES):
        scratch = tmp_path / str(number)
        scratch.mkdir()
        references.append(Reference(name, scratch))
    while kills < 100:
        reference = references[seed % len(references)]
        kills += kill_and_resume(reference, reference.case.parent, seed, kills=5, figures=False)
        seed += 1
    with capsys.disabled():
        print(f"\n{kills} kills of {seed - 10} runs, each of which ended bitwise as the uninterrupted one")
