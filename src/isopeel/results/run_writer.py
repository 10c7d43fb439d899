"""Writing the file of a run while it goes on."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from errno import ENOENT
from pathlib import Path
from time import perf_counter
from types import MappingProxyType, TracebackType
from typing import Self

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.problem import Drive
from isopeel.results.curve import Curve
from isopeel.results.fields import Field, Fields
from isopeel.results.journal import Journal, Record
from isopeel.results.run_file import Ending, Failure, StoredRun, write_run
from isopeel.solve.step import Step

_SAVE_SECONDS = 1.0
_SAVE_SHARE = 0.02  # of the time may go into saving


class RunWriter:
    """Consumer of steps that keeps the file of a run up to date: about once a second, and when it is closed.

    The steps in between are in its journal, one by one. The first save removes the `outdated` files, which
    were made from an earlier run, and lists them in `removed`; `saved` says that it was made.

    The displacement and the maximum openings are kept at the first step at or beyond each multiple of
    `field_interval` (in the unit of the parameter's column), and at the last step; `base` is the displacement
    of the state that a stage begins with. Each save replaces the file as a whole, so that it is sound
    whatever ends the process: an exception, a kill, a full disk. A run that goes on after a stored one, read
    without its journal, takes the steps after that; until all that the journal holds have come again, file
    and journal stay as they are.

    Raises OSError where the file cannot be written. A folder that vanished is made again first, with all that
    has come.
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
    ) -> None:
        self._path = path
        self._drive = drive
        self._outdated = outdated
        self._rows: list[Step] = []
        self._journaled = journaled
        self._fields: Fields[Field] = Fields(field_interval)
        nothing = StoredRun(
            case_text,
            Curve.of([], drive),
            MappingProxyType({}),
            attributes,
            "running",
            base=base,
            field_interval=field_interval,
        )
        #: What has been stored before, and how the run stands but for the steps since then.
        self._run = replace(after or nothing, case_text=case_text, ending="running", failure=None)
        self._fields.take_all(self._run.states)
        self._last = self._run.last
        self._resumes = True
        self._journal: Journal | None = None
        self._next_save = 0.0
        self.saved: bool = False
        #: Files of an earlier run that the first save has removed.
        self.removed: list[Path] = []

    def __enter__(self) -> Self:
        """Touch nothing yet: the first step replaces an earlier run, and so does an end without one."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Save what has come."""
        try:
            ended = self.ending not in ("running", "interrupted")
            whole = ended or (len(self._rows) > 0 and self._resumes and not self._is_behind)
            if whole:
                self._save()
        finally:
            if self._journal is not None:
                self._journal.close()
        # else, or where the save failed, the journal holds what the file does not
        if self._journal is not None and whole:
            self._journal.remove()

    def append(self, step: Step) -> None:
        """Take a step."""
        # the row without its field, which would fill the memory
        empty = np.empty((0, 2))
        row = replace(
            step,
            displacement=empty,
            maximum_openings=empty,
            unknown_values=empty[:, 0],
            accepted_states=(),
            solver_state=None,
        )
        self._rows.append(row)
        self._resumes = step.resumes
        if step.resumes:
            self._last = step.state
        kept = Field(step.displacement, step.maximum_openings)
        self._fields.take(float(self._drive.parameter_column.shown(step.parameter)), kept)
        if self._is_behind:
            return
        if step.resumes and (self._journal is None or perf_counter() >= self._next_save):
            self._save()
        elif self._journal is not None:
            number = len(self._run.curve) + len(self._rows) - 1
            self._journal.append(number, Record(Curve.of([row], self._drive), kept))

    @property
    def _is_behind(self) -> bool:
        """Whether the journal of the run that goes on holds more than has come since."""
        return len(self._rows) <= self._journaled and self._journaled > 0

    @property
    def curve(self) -> Curve:
        """The curve as far as it has come."""
        return self._run.curve.followed_by([Curve.of(self._rows, self._drive)])

    @property
    def ending(self) -> Ending:
        """How the run ended, if it did."""
        return self._run.ending

    def end(self, ending: Ending, failure: Failure | None = None) -> None:
        """Note how the run ended."""
        self._run = replace(self._run, ending=ending, failure=failure)

    def _save(self) -> None:
        began = perf_counter()
        run = replace(self._run, curve=self.curve, last=self._last).with_states(self._fields.all())
        try:
            write_run(self._path, run)
        except FileNotFoundError as error:
            # who removes the folder of a run that goes on does not mean to lose what is in the memory only
            self._path.parent.mkdir(parents=True)
            write_run(self._path, run)
            reason = "its folder vanished; it is there again, with all that converged"
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
