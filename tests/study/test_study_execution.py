"""The runs of a study are stored when they are finished, and survive the loss of processes."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from dying import Dying
from filelock import FileLock

from isopeel.common.errors import InputError
from isopeel.study.execution import InProcesses, Store, compute
from isopeel.study.outcome import LOST, Amount, Line, Outcome, Task, read_outcome, write_outcome

LINE = Line("peel", np.arange(3.0), np.array([0.1, 1 / 3, np.pi]), ("rotation", "moment"), ("deg", "N m/m"))
OUTCOME = Outcome(
    "completed", "", {"largest moment": Amount(np.pi, "N m/m")}, ("a note",), (LINE,), 3, 7, 1.5, "here"
)


class Counting:
    """Computes tasks here, and counts them."""

    def __init__(self, fails_after: int = 100) -> None:
        self.computed: list[int] = []
        self._fails_after = fails_after

    def __call__(self, tasks: Mapping[int, Task]) -> Iterator[tuple[int, Outcome]]:
        for number in tasks:
            if len(self.computed) == self._fails_after:
                raise KeyboardInterrupt
            self.computed.append(number)
            yield number, OUTCOME


def _tasks(count: int) -> list[Task]:
    return [Task("text", {"body.height": f"{number} nm"}) for number in range(count)]


def _ignore(number: int, outcome: Outcome) -> None:
    assert number >= 0
    assert outcome.ending


def test_an_outcome_is_read_as_it_was_written(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    write_outcome(OUTCOME, path)
    found = read_outcome(path)
    assert found is not None
    np.testing.assert_array_equal(found.lines[0].reaction, LINE.reaction)
    assert found.lines[0].names == LINE.names
    assert found.lines[0].units == LINE.units
    for name in ("ending", "cause", "readings", "notes", "steps", "corrections", "seconds", "host"):
        assert getattr(found, name) == getattr(OUTCOME, name)
    assert found.lines[0].sensitivities.shape == (3, 0)
    rates = LINE._replace(sensitivities=np.arange(6.0).reshape(3, 2))
    write_outcome(replace(OUTCOME, lines=(rates,)), path)
    again = read_outcome(path)
    assert again is not None
    np.testing.assert_array_equal(again.lines[0].sensitivities, rates.sensitivities)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    assert read_outcome(path) is None
    assert read_outcome(tmp_path / "none.h5") is None


def test_finished_runs_are_not_computed_again(tmp_path: Path) -> None:
    store, tasks = Store(tmp_path), _tasks(5)
    interrupted = Counting(fails_after=2)
    with pytest.raises(KeyboardInterrupt):
        compute(tasks, store, interrupted, _ignore)
    later = Counting()
    compute(tasks, store, later, _ignore)
    assert sorted(interrupted.computed + later.computed) == [0, 1, 2, 3, 4]
    # a study that grew computes what is new, in any order
    grown = Counting()
    found = compute([*_tasks(7)[::-1]], store, grown, _ignore)
    assert sorted(grown.computed) == [0, 1]
    assert len(found) == 7
    # another case is another run
    again = Counting()
    compute([Task("other", tasks[0].values)], store, again, _ignore)
    assert again.computed == [0]


def test_one_process_computes_in_a_folder(tmp_path: Path) -> None:
    with (
        FileLock(tmp_path / ".lock"),
        pytest.raises(InputError, match=r"--out: .*another process runs in it"),
    ):
        compute(_tasks(1), Store(tmp_path), Counting(), _ignore)


def test_the_loss_of_a_process_costs_its_run_only(tmp_path: Path) -> None:
    """One run is lost once, and computed again; one is lost each time, and given up."""
    tasks = [
        Dying(text, {"deaths": str(tmp_path / f"run{number}")}) for number, text in enumerate(["a", "aaaaa"])
    ]
    store = Store(tmp_path)
    found = compute(tasks, store, InProcesses(2), _ignore)
    assert found[0] == Outcome("completed", steps=1)
    assert found[1].ending == LOST
    assert "ended from outside 3 times" in found[1].cause
    # it is computed again by the same command
    assert [store.read(task) is None for task in tasks] == [False, True]


def test_more_runs_than_wait_for_a_process(tmp_path: Path) -> None:
    tasks = [Dying("", {"deaths": str(tmp_path / f"run{number}")}) for number in range(7)]
    assert compute(tasks, None, InProcesses(1), _ignore) == [Outcome("completed")] * 7
