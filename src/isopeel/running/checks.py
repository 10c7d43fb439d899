"""What is checked before the first step of a run: later stages, memory, bodies, and discretization."""

from collections.abc import Sequence

from psutil import virtual_memory

from isopeel.common.errors import InputError
from isopeel.post.locking import locking_notes
from isopeel.post.overlap import overlap_notes_at_rest
from isopeel.post.resolution_notes import estimate_notes
from isopeel.results.notes import Note, with_one_remedy
from isopeel.running.stage_run import StageRun
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.trace import check_stage


def check_later_stages(runs: Sequence[StageRun]) -> None:
    """Check the stages after the first one, as far as possible before they begin.

    Raises InputError that names the stage; without this check the error could come after hours.
    """
    for number, one in enumerate(runs[1:], start=2):
        stage = one.stage
        try:
            check_stage(stage.problem, one.spaces, NewtonSettings(path_control=stage.path_control))
        except InputError as error:
            named = one.case.named(error)
            field = named.field.replace("drive.", f"drive.{number}.", 1)
            raise InputError(field, error.value, f"in stage {number}, {error.allowed}") from error
        check_memory(one)


def check_memory(one: StageRun) -> None:
    """Raise InputError where the displacements to store would fill the memory."""
    stage, column = one.stage, one.stage.problem.drive.parameter_column
    kept = min(abs(column.shown(stage.parameters[-1])) / stage.fields_every, len(stage.parameters))
    # they are in memory three times: as they are, in one array, and in the image of the file
    needed = 3 * 16 * sum(space.size for space in one.spaces.values()) * kept
    free = virtual_memory().available
    if needed > free:
        gib = f"{needed / 2**30:.1f} GiB of memory, and {free / 2**30:.1f} GiB are free"
        allowed = f"the displacements at its multiples need {gib}"
        raise InputError("output.fields_every", column.text(stage.fields_every), allowed)


def early_notes(runs: Sequence[StageRun], *, strict: bool) -> list[Note]:
    """Return the notes that need no results; raise InputError for the first one if `strict`."""
    notes: list[Note] = []
    for one in runs:
        problem, laboratory = one.stage.problem, one.laboratory
        notes += overlap_notes_at_rest(problem, one.spaces, laboratory)
        notes += estimate_notes(problem, one.spaces, laboratory)
        notes += locking_notes(problem, one.spaces, laboratory)
    found = with_one_remedy(list(dict.fromkeys(notes)))
    if found and strict:
        spaces, note = runs[0].spaces, found[0]
        mesh = ", ".join("{}x{}".format(*space.elements) for space in spaces.values())
        of_bodies = note.subject == "penetration"
        key = ("body", ", ".join(spaces)) if of_bodies else ("discretization.mesh", mesh)
        raise InputError(*key, f"{note.subject}: {note.text}")
    return found
