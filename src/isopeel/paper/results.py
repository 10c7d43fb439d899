"""The finished runs, for the sections of the report."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from isopeel.paper.execution import Store
from isopeel.paper.published import Figures
from isopeel.paper.reading import WINDOW, Readable, Reading, Window
from isopeel.paper.record import Record
from isopeel.paper.study import Run
from isopeel.results.run_file import StoredRun


@dataclass(frozen=True, eq=False)
class Results:
    """Records of runs, their figures, and the store with their fields, for pictures."""

    records: Mapping[Run, Record]
    store: Store
    readables: dict[Run, Readable] = field(init=False)

    def __post_init__(self) -> None:
        """Make the cache of running means."""
        readables = {run: Readable(record) for run, record in self.records.items()}
        object.__setattr__(self, "readables", readables)

    def figures(self, run: Run, window: Window = WINDOW, reading: Reading = Reading.MEAN) -> Figures | None:
        """Return the figures of a run in a window; None if it was not run, or ended before."""
        return self.readables[run].read(window, reading) if run in self.readables else None

    def amplitude(self, run: Run) -> float | None:
        """Return the amplitude dM in the default window, in E0 L0^3; None as for the figures."""
        figures = self.figures(run)
        return None if figures is None else figures.amplitude / 1e3

    def stored(self, run: Run) -> StoredRun:
        """Return the whole run, with its fields. Raises InputError if it is not in the store."""
        return self.store.read(run)
