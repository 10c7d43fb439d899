"""Computing runs: in processes of their own, only what is not finished, whatever interrupted it before."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from isopeel.case import Case, load_case, with_options
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.paper.execution import Report, Store, execute
from isopeel.paper.record import Record, read_records, write_records
from isopeel.paper.study import Run
from isopeel.results.run_file import StoredRun


@dataclass(frozen=True)
class ShortRun(Run):
    """A run of few steps on few elements."""

    @property
    def range_deg(self) -> tuple[float, float]:
        return (0.0, 20.0) if self.base is None else (10.0, 14.0)

    @property
    def angles_deg(self) -> FloatArray:
        start, end = self.range_deg
        # a step of 90 degrees ends the run of L2, where the elements cannot follow
        return np.append(np.arange(start, end + 1, 2.0), [110.0] if self.space == "L2" else [])

    @property
    def case(self) -> Case:
        return with_options(
            load_case("strip"),
            space=self.space,
            mesh="20x2",
            to=20.0,
            traction=self.traction,
            contact_points=self.contact_points,
        )


@dataclass
class Watch:
    """Records its calls, and interrupts after so many finished runs."""

    interrupt_after: int = 99
    names: list[str] = field(default_factory=list)
    reports: list[Report] = field(default_factory=list)

    def report(self, report: Report) -> None:
        self.reports.append(report)

    def skipped(self, run: Run) -> None:
        self.names.append(f"{run.name} skipped")

    def finished(self, run: Run, stored: StoredRun) -> None:
        self.names.append(run.name)
        if len(self.names) == self.interrupt_after:
            raise KeyboardInterrupt


RUNS = [
    ShortRun("N2", "m1"),
    ShortRun("L2", "m1"),
    ShortRun("N2", "m1", "projected"),
    ShortRun("L1", "m1", contact_points=5),
    ShortRun("N2", "m1", timed=True),
]
BY_NAME = {run.name: run for run in (*RUNS, ShortRun("L1", "m1"))}
NAMES = {"N2-m1", "L2-m1", "N2-m1-projected", "L1-m1", "L1-m1-5points", "N2-m1-timed"}


def _written(store: Store, name: str) -> int:
    return store.path(BY_NAME[name]).stat().st_mtime_ns


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Store:
    """All runs, not interrupted."""
    store = Store(tmp_path_factory.mktemp("whole"))
    watch = Watch()
    execute(RUNS, store, 2, watch)
    assert set(watch.names) == NAMES
    return store


def test_what_is_there_is_not_computed_again(whole: Store) -> None:
    watch = Watch()
    execute(RUNS, whole, 2, watch)
    assert watch.names == []


def test_a_run_that_ends_early_is_finished(whole: Store) -> None:
    stored = whole.read(ShortRun("L2", "m1"))
    assert stored.ending == "not converged"
    assert stored.failure is not None
    assert stored.failure.parameter == 110.0
    assert len(stored.curve) == 11


def test_variants_start_from_the_state_of_their_base(whole: Store) -> None:
    base, points = (whole.read(run).curve for run in (ShortRun("L1", "m1"), RUNS[3]))
    assert points.parameter.tolist() == [10.0, 12.0, 14.0]
    at = np.isin(base.parameter, points.parameter)
    # on this mesh the number of points matters in the first digits, but the moments are of one kind
    np.testing.assert_allclose(points.reaction, base.reaction[at], rtol=0.1)
    assert np.all(points.reaction != base.reaction[at])


def test_an_interrupted_study_continues_to_the_same_results(whole: Store, tmp_path: Path) -> None:
    store = Store(tmp_path)
    first = Watch(interrupt_after=2)
    with pytest.raises(KeyboardInterrupt):
        execute(RUNS, store, 1, first)
    # one more run may have been finished, unseen, before its process was ended
    kept = {name: _written(store, name) for name in NAMES if store.finished(BY_NAME[name]) is not None}
    assert set(first.names) <= set(kept)
    second = Watch()
    execute(RUNS, store, 1, second)
    assert set(second.names) == NAMES - set(kept)
    assert kept == {name: _written(store, name) for name in kept}
    for run in BY_NAME.values():
        ours, theirs = store.read(run), whole.read(run)
        np.testing.assert_array_equal(ours.curve.reaction, theirs.curve.reaction)
        np.testing.assert_array_equal(ours.curve.iterations, theirs.curve.iterations)
        assert ours.failure == theirs.failure


def test_a_broken_or_outdated_file_is_computed_anew(whole: Store, tmp_path: Path) -> None:
    store, run = Store(tmp_path), ShortRun("N2", "m1")
    content = whole.path(run).read_bytes()
    store.path(run).write_bytes(content[: len(content) // 2])
    assert store.finished(run) is None
    # the same name, but another range of angles and so another key
    store.path(Run("N2", "m1")).write_bytes(content)
    assert store.finished(Run("N2", "m1")) is None
    assert store.finished(run) is not None
    with pytest.raises(InputError, match="N2-m1"):
        store.read(Run("N2", "m1"))


def test_records_are_read_back_as_they_were(whole: Store, tmp_path: Path) -> None:
    stored = {run: whole.read(run) for run in RUNS}
    records = {
        Run(run.space, run.mesh, run.traction, run.contact_points, run.timed): Record.of(run, found)
        for run, found in stored.items()
    }
    write_records(tmp_path / "records.h5", records)
    again = read_records(tmp_path / "records.h5")
    assert list(again) == sorted(records, key=lambda run: run.name)
    for run, record in records.items():
        np.testing.assert_array_equal(again[run].moments, record.moments)
        # the angles are not stored: those of the whole run are known
        np.testing.assert_array_equal(again[run].angles_deg, run.angles_deg[: len(record.moments)])
        for name in ("dofs", "corrections", "seconds", "failed_at_deg", "reason", "started", "software"):
            assert getattr(again[run], name) == getattr(record, name)
        assert again[run].step_seconds == record.step_seconds
        assert again[run].step_corrections == record.corrections / len(record.moments)
        assert again[run].continues is record.continues
    (tmp_path / "text").write_text("no HDF5")
    with pytest.raises(InputError, match="text"):
        read_records(tmp_path / "text")
