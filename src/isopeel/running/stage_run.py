"""The run of one stage of a case: where its files are, where it begins, and how far it is."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from isopeel.case import Case, Stage
from isopeel.post.laboratory import Laboratory
from isopeel.results.run_file import StoredRun
from isopeel.running.folder import Place, places
from isopeel.solve.step import State
from isopeel.splines.rows import RowSpace


@dataclass(frozen=True, eq=False)
class StageRun:
    """A stage to run, with the spaces of all bodies, by their names, and the place of its files."""

    case: Case
    stage: Stage
    spaces: Mapping[str, RowSpace]
    place: Place
    base: State | None = None  # the last state of the stage before
    stored: StoredRun | None = None  # the run so far

    @property
    def laboratory(self) -> Laboratory:
        """The units in which its outputs are shown."""
        return Laboratory.of(self.case.units.system(), self.stage.problem, self.case.width)

    @property
    def met(self) -> int:
        """Number of parameters that the run has met, up to the state that it continues from."""
        last = None if self.stored is None else self.stored.last
        if last is None:
            return 0
        (found,) = np.nonzero(self.stage.parameters == last.parameter)
        return int(found[0]) + 1 if len(found) else 0

    @property
    def is_complete(self) -> bool:
        """Whether the run has completed the stage."""
        completed = self.stored is not None and self.stored.ending == "completed"
        return completed and self.met == len(self.stage.parameters)


def stage_runs(case: Case, out: Path) -> list[StageRun]:
    """Return the stages of a case, as they begin in a folder."""
    spaces, stages = case.spaces(), case.stages()
    found = places(case.name, [stage.name for stage in stages], out)
    return [StageRun(case, stage, spaces, place) for stage, place in zip(stages, found, strict=True)]
