"""Write the file of a run while the run is computed."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from errno import ENOENT
from pathlib import Path
from time import perf_counter
from types import TracebackType
from typing import Self

from isopeel.common.arrays import FloatArray
from isopeel.problem import Drive
from isopeel.results.curve import Curve, DifferentiatedBy, row_of
from isopeel.results.fields import KeptStates, StoredState
from isopeel.results.journal import Journal, Record
from isopeel.results.layout import Layout
from isopeel.results.run_file import Ending, Failure, StoredRun, write_run
from isopeel.solve.step import Step

_SAVE_SECONDS = 1.0
_SAVE_SHARE = 0.02  # of the time, at most, for saving
_UNKNOWN = Layout()


class RunWriter:
    """A consumer of steps that saves the file of a run about once a second, and when it is closed.

    The steps in between are in its journal, one by one. The first save removes the `outdated` files, which
    were made from an earlier run, and lists them in `removed`; `saved` is whether it was made.

    The displacement and the maximum openings are stored at the first step at or beyond each multiple of
    `field_interval` (in the unit of the parameter's column), and at the last step; `base` is the displacement
    of the initial state of a stage. The steps have sensitivities to the `sensitive_to` parameters. Each save
    replaces the file as a whole, so that the file is valid also after an exception, a kill or a full disk. A
    run that continues a stored one, read without its journal, appends its steps; file and journal do not
    change until all steps of the journal have been computed again.

    Raises OSError if the file cannot be written. If the folder has been removed, it is made again first, with
    all steps so far.
    """

    def __init__(
        self,
        path: Path,
        drive: Drive,
        case_text: str,
        attributes: Mapping[str, str | int],
        field_interval: float = 10.0,
        outdated: Sequence[Path] = (),
        base: FloatArray | None = None,
        after: StoredRun | None = None,
        journaled: int = 0,
        layout: Layout = _UNKNOWN,
        sensitive_to: tuple[DifferentiatedBy, ...] = (),
    ) -> None:
        self._path = path
        self._drive = drive
        self._sensitive_to = sensitive_to
        self._outdated = outdated
        self._rows: list[Step] = []
        self._journaled = journaled
        nothing = StoredRun(
            case_text,
            Curve.of([], drive, sensitive_to),
            (),
            attributes,
            "running",
            base=base,
            field_interval=field_interval,
        )
        #: The run as it was stored before, without the steps since then.
        self._run = replace(
            after or nothing, case_text=case_text, ending="running", failure=None, layout=layout
        )
        self._kept = KeptStates(field_interval, self._run.states)
        self._last = self._run.last
        self._resumes = True
        self._journal: Journal | None = None
        self._next_save = 0.0
        self.saved: bool = False
        #: Files of an earlier run that the first save has removed.
        self.removed: list[Path] = []

    def __enter__(self) -> Self:
        """Change no file yet: an earlier run is replaced at the first step, or at the end without a step."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Save the steps so far."""
        try:
            ended = self.ending not in ("running", "interrupted")
            whole = ended or (len(self._rows) > 0 and self._resumes and not self._is_behind)
            if whole:
                self._save()
        finally:
            if self._journal is not None:
                self._journal.close()
        # else, or where the save failed, the journal holds the steps that the file lacks
        if self._journal is not None and whole:
            self._journal.remove()

    def append(self, step: Step) -> None:
        """Add a step."""
        row = row_of(step)
        self._rows.append(row)
        self._resumes = step.resumes
        if step.resumes:
            self._last = step.state
        number = len(self._run.curve) + len(self._rows) - 1
        state = StoredState.of(step, self._drive)._replace(step=number)
        self._kept.take(state)
        if self._is_behind:
            return
        if step.resumes and (self._journal is None or perf_counter() >= self._next_save):
            self._save()
        elif self._journal is not None:
            self._journal.append(Record(self._curve_of([row]), state))

    @property
    def _is_behind(self) -> bool:
        """Whether the journal of the continued run holds more steps than have been computed since."""
        return len(self._rows) <= self._journaled and self._journaled > 0

    @property
    def curve(self) -> Curve:
        """The curve so far."""
        return self._run.curve.followed_by([self._curve_of(self._rows)])

    def _curve_of(self, rows: list[Step]) -> Curve:
        return Curve.of(rows, self._drive, self._sensitive_to)

    @property
    def ending(self) -> Ending:
        """How the run ended; "running" before its end."""
        return self._run.ending

    def end(self, ending: Ending, failure: Failure | None = None) -> None:
        """Set how the run ended."""
        self._run = replace(self._run, ending=ending, failure=failure)

    def _save(self) -> None:
        began = perf_counter()
        run = replace(self._run, curve=self.curve, last=self._last, states=self._kept.all())
        try:
            write_run(self._path, run)
        except FileNotFoundError as error:
            # somebody has removed the folder of this run: save the steps that are in memory
            self._path.parent.mkdir(parents=True)
            write_run(self._path, run)
            reason = "its folder vanished; it was made again, with all converged steps"
            raise FileNotFoundError(ENOENT, reason, str(self._path)) from error
        if not self.saved:
            for path in self._outdated:
                if os.path.lexists(path):
                    path.unlink()
                    self.removed.append(path)
            self.saved = True
            self._journal = Journal(self._path, run.identity)
        elif self._journal is not None:
            self._journal.clear()
        now = perf_counter()
        self._next_save = now + max(_SAVE_SECONDS, (now - began) / _SAVE_SHARE)
