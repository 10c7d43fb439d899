"""The notes on a run: which of its results may be wrong, and which are missing."""

from collections.abc import Sequence
from functools import partial
from math import ceil, log2
from operator import itemgetter

from isopeel.post.findings import Findings
from isopeel.post.mesh_error import MeshChange
from isopeel.post.plateau import plateau_mean, unreadable
from isopeel.post.readings import FAR
from isopeel.post.stability import stability_notes
from isopeel.results.notes import Note, Remedy
from isopeel.results.run_file import StoredRun

#: Change of a reaction on a finer space above which there is a note. If the error is proportional to the
#: element size to the power of 3/4 or more, it is at most 2.5 times the change: 3 %. With a limit of 1.5 %, a
#: pressed cylinder on elements longer than its contact had no note: its force changed by 1.45 %, and was
#: 3.2 % too large.
MESH_CHANGE = 0.012


def run_notes(run: StoredRun, found: Findings, onset: float | None) -> list[Note]:
    """Return all notes on a run except those of a finer mesh."""
    window, laboratory = found.window, found.laboratory
    notes = [*found.notes]
    if found.inside:
        side, deepest = max(found.inside.items(), key=itemgetter(1))
        face = f"the side {side}" if len(found.fronts) > 1 else "the face"
        depth = laboratory.text(deepest.depth, "length", 2)
        text = f"a part of {face} without adhesion is up to {depth} inside the {deepest.inside}"
        notes.append(Note("penetration", text))
    notes += stability_notes(run.curve, laboratory)
    for reading in found.readings:
        deviation = reading.deviation
        # the front is compliant, so the crack length differs from that of an arm clamped at its front, and so
        # does what the drive releases per crack length; the J-integral does not depend on it
        by_length = reading.kind in ("length", "toughness") and not reading.name.startswith("J-integral")
        if deviation is None or abs(deviation) <= FAR or by_length:
            continue
        text = (
            f"{reading.name}: the run deviates by {100 * deviation:+.3g} % from {reading.source},"
            f" {laboratory.text(reading.theory or 0.0, reading.kind)}; a deviation up to {100 * FAR:g} % is"
            " usual: compare a finer mesh, a later window and smaller steps"
        )
        notes.append(Note("closed form", text))
    if found.unproven:
        notes.append(Note("reading", f"closed form: {found.unproven}"))
    if window is None:
        if found.closed_form is not None:
            text = "plateau, amplitude and slopes: the case has no window for them, reading.window"
            notes.append(Note("reading", text))
    elif reason := unreadable(
        run.curve, window, found.period, partial(laboratory.parameter, run.curve.parameter_column)
    ):
        covered = plateau_mean(run.curve, window) is not None
        notes.append(Note("reading", f"{'' if covered else 'plateau, '}amplitude and slopes: {reason}"))
    if onset is None and run.curve.parameter_column.unit == "degree":
        notes.append(Note("reading", "onset: peeling did not begin"))
    return notes


def _more(change: MeshChange) -> int:
    """Return the factor on the number of elements with which a reaction changes by less than MESH_CHANGE.

    The change is assumed to fall with the square of the element size.
    """
    if change.finer is None:
        return 2
    return int(2 ** min(max(ceil(log2(change.relative / MESH_CHANGE) / 2), 1), 3))


def mesh_notes(run: StoredRun, found: Findings, changes: Sequence[MeshChange]) -> list[Note]:
    """Return notes on the reactions that change by more than MESH_CHANGE on a finer mesh."""
    parameter, reaction = run.curve.parameter_column, run.curve.reaction_column
    # several bodies have several meshes, so no mesh is proposed
    meshes = str(run.attributes["mesh"]).split(", ")
    notes = []
    for change in changes:
        if change.relative > MESH_CHANGE:
            at = f"{reaction.name} at {found.laboratory.parameter(parameter, change.parameter)}"
            seen = (
                "has no equilibrium nearby"
                if change.finer is None
                else f"changes by {100 * change.relative:.2g} %"
            )
            text = f"the mesh is too coarse: on elements of half the length, the {at} {seen}"
            remedy = None
            if len(meshes) == 1:
                length, height = meshes[0].split("x")
                more = _more(change)
                remedy = Remedy((more * int(length), (more if found.tall else 1) * int(height)))
            notes.append(Note("resolution", text, remedy))
    return notes
