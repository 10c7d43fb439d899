"""What a run would be: its unknowns, the elements in its process zones, its steps, and its expected time."""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

from rich.console import Console

from isopeel.case import Case
from isopeel.common.interrupts import check
from isopeel.post.resolution import estimated
from isopeel.results.notes import Note
from isopeel.running.checks import check_later_stages, early_notes
from isopeel.running.previous_run import check_foreign
from isopeel.running.stage_run import StageRun, stage_runs
from isopeel.running.stage_trace import steps_of
from isopeel.solve.convergence import ConvergenceError

#: Steps that are computed to estimate the time, after the first one, which may wait for the compiler; and the
#: seconds after which no more are.
_TIMED, _SECONDS = 20, 2.0


@dataclass(frozen=True)
class ZonePreview:
    """The estimated process zone of an interface, and the elements in it."""

    interface: str
    length: str
    elements: float
    needed: float


@dataclass(frozen=True)
class StagePreview:
    """The size of a stage."""

    stage: str
    steps: int
    dofs: int
    discretizations: tuple[str, ...]
    process_zones: tuple[ZonePreview, ...]


@dataclass(frozen=True)
class Preview:
    """The stages of a run, its notes before the first step, and its expected time in seconds.

    The time is None where no second step was found; `source` is how it was estimated.
    """

    case: str
    stages: tuple[StagePreview, ...]
    notes: tuple[Note, ...]
    expected_seconds: float | None
    source: str

    def as_json(self) -> dict[str, Any]:
        """Return plain numbers and texts."""
        notes = [{"subject": note.subject, "text": note.text} for note in self.notes]
        return asdict(self) | {"notes": notes}

    def print(self, console: Console) -> None:
        """Print it in a few lines."""
        for one in self.stages:
            console.print(
                f"{one.stage}: {one.steps} steps, {one.dofs} DOFs, {'; '.join(one.discretizations)}",
                soft_wrap=True,
            )
            for zone in one.process_zones:
                console.print(
                    f"  {zone.interface}: {zone.elements:.3g} elements in the process zone of {zone.length} "
                    f"(estimated); the space needs {zone.needed:.2g}",
                    soft_wrap=True,
                )
        for note in self.notes:
            console.print(f"note: {note.text}", soft_wrap=True)
        time = "unknown" if self.expected_seconds is None else _duration(self.expected_seconds)
        console.print(f"expected time: {time}, {self.source}", soft_wrap=True)


def preview(case: Case, out: Path, *, strict: bool = False, force: bool = False) -> Preview:
    """Check a case and its folder as a run does, and return what a run would be; no file is written.

    Raises the errors that `run_case` raises before its first step, and KeyboardInterrupt.
    """
    if not force:
        check_foreign(out)
    runs = stage_runs(case, out)
    check_later_stages(runs)
    notes = early_notes(runs, strict=strict)
    seconds, source = _expected(runs)
    return Preview(case.name, tuple(map(_stage, runs)), tuple(notes), seconds, source)


def _stage(one: StageRun) -> StagePreview:
    problem = one.stage.problem
    zones = []
    for name in problem.interface_names:
        found = estimated(problem, one.spaces, name)
        if found is not None:
            length = one.laboratory.text(found.zone, "length", 3)
            zones.append(ZonePreview(name, length, found.elements, found.needed))
    meshes = [f"{space.name} {space.elements[0]}x{space.elements[1]}" for space in one.spaces.values()]
    dofs = 2 * sum(space.size for space in one.spaces.values())
    # the first parameter is the state at the start
    return StagePreview(one.place.title, len(one.stage.parameters), dofs, tuple(meshes), tuple(zones))


def _expected(runs: Sequence[StageRun]) -> tuple[float | None, str]:
    """Return the expected time of all stages, from that of a few steps of the first one."""
    total = sum(len(one.stage.parameters) for one in runs)
    times: list[float] = []
    try:
        steps = iter(steps_of(runs[0]))
        with closing(steps):  # type: ignore[type-var]
            next(steps)
            began = last = perf_counter()
            for _ in steps:
                check()
                now = perf_counter()
                times.append(now - last)
                last = now
                if len(times) == _TIMED or now - began > _SECONDS:
                    break
    except ConvergenceError as error:
        return None, f"as the first steps find no equilibrium: {error.reason}"
    if not times:
        return None, "as there is one step only"
    mean = sum(times) / len(times)
    source = (
        f"{total} steps of {1e3 * mean:.3g} ms, the mean of the {len(times)} steps after the first one. "
        "These were computed and not stored. Steps at a front that jumps take longer. The start of the "
        "program, its compilation and its figures are not included"
    )
    return mean * total, source


def _duration(seconds: float) -> str:
    if seconds < 1:
        return "less than 1 s"
    if seconds < 120:
        return f"{seconds:.2g} s"
    return f"{seconds / 60:.2g} min" if seconds < 7200 else f"{seconds / 3600:.2g} h"
