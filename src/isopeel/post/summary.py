"""The summary of a run: what was read from it, for a JSON file."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from math import isfinite
from typing import Any

import numpy as np

from isopeel.arrays import IntArray
from isopeel.post.closed_form import Expected, expected
from isopeel.post.fields import depth_inside
from isopeel.post.mesh_error import MeshChange
from isopeel.post.reading import PlateauReading, onset_angle, plateau_mean, read_plateau, unreadable
from isopeel.problem import Column, Problem
from isopeel.results.curve import Curve
from isopeel.results.notes import Note
from isopeel.results.run_file import StoredRun
from isopeel.solve.step import KINDS
from isopeel.splines.rows import RowSpace


@dataclass(frozen=True)
class Findings:
    """What is read from a run beyond its curve, and what theory says of it.

    `window` is where the plateau is read, if there is one; `inside` is how deep (in L0) the body has come to
    lie in the substrate.
    """

    window: tuple[float, float] | None
    plateau: PlateauReading | None
    closed_form: Expected | None
    inside: float


def find(problem: Problem, space: RowSpace, run: StoredRun, window: tuple[float, float] | None) -> Findings:
    """Read a run of a problem on a space."""
    # what theory says is of a body that begins at rest
    closed_form = expected(problem, space) if run.base is None else None
    period = closed_form.period if closed_form else None
    plateau = read_plateau(run.curve, window, period) if window else None
    return Findings(window, plateau, closed_form, depth_inside(problem, space, run.fields))


def summarize(
    title: str, run: StoredRun, found: Findings, wall_time: float, changes: Sequence[MeshChange]
) -> dict[str, Any]:
    """Collect what a run says, as plain numbers and texts; `notes` say why a value is None, or doubted.

    Parameter and reaction are in the units of their columns, which `units` names, slopes per unit of the
    parameter. A jump is a step of that kind, or one that released more than a thousandth of what the energies
    varied by. `wall_time` (seconds) is that of the whole run, with its compilation. `changes` are those on a
    finer space, by `mesh_changes`.
    """
    curve, attributes, failure = run.curve, run.attributes, run.failure
    window, plateau, closed_form = found.window, found.plateau, found.closed_form
    iterations = int(curve.iterations.sum())
    parameter, reaction = curve.parameter_column, curve.reaction_column
    # a straight line that bends tells when peeling begins under a moment, not under a force
    onset = onset_angle(curve) if parameter.unit == "degree" else None
    strongest = int(np.argmax(np.abs(curve.reaction))) if len(curve) else None
    versions = {name: value for name, value in attributes.items() if name.startswith("version_")}
    return {
        "case": title,
        **{name: attributes[name] for name in ("space", "mesh", "dofs", "traction")},
        "units": {
            **{column.name: column.unit for column in (parameter, reaction)},
            **{name: attributes[name] for name in ("L0", "E0")},
        },
        parameter.name: float(curve.parameter[-1]) if len(curve) else None,
        "peak": None
        if strongest is None
        else {
            reaction.name: float(curve.reaction[strongest]),
            parameter.name: float(curve.parameter[strongest]),
        },
        "plateau": window and plateau_mean(curve, window),
        "amplitude": plateau and plateau.amplitude,
        "slopes": plateau and {"rise": plateau.steepest_rise, "fall": plateau.steepest_fall},
        "drift": plateau and {"per_unit": plateau.drift, "of": plateau.drift_of},
        "window": plateau and list(plateau.window),
        "onset": onset,
        "closed_form": closed_form and asdict(closed_form),
        "notes": [asdict(note) for note in [*_notes(run, found, onset), *_mesh_notes(run, changes)]],
        "finer_mesh": [_finer(change, parameter, reaction) for change in changes],
        "wall_time_s": wall_time,
        "corrections": iterations,
        "corrections_per_step": iterations / len(curve) if len(curve) else None,
        "jumps": [
            {parameter.name: float(curve.parameter[k]), "released_energy": float(curve.released_energy[k])}
            for k in _jumps(curve)
        ],
        "completed": run.ending == "completed",
        "failure": failure
        and {
            parameter.name: failure.parameter,
            "reason": failure.reason,
            "cause": failure.cause,
            "hint": failure.hint,
            # JSON knows no inf
            "iterations": [measure if isfinite(measure) else None for measure in failure.iterations],
        },
        "versions": {name.removeprefix("version_"): value for name, value in versions.items()},
        "git_revision": attributes.get("git_revision"),
    }


def summary_rows(
    summary: Mapping[str, Any], parameter: Column, reaction: Column
) -> list[tuple[str, str, str]]:
    """A summary in words: of what, the value of the run, and that of theory, empty where there is none.

    The columns are those of the curve that the summary is of.
    """
    unit = short_unit(parameter)
    slopes, window, peak = summary["slopes"], summary["window"], summary["peak"]
    theory = summary["closed_form"] or {}
    rows = [
        ("space", f"{summary['space']}, {summary['mesh']}, {summary['dofs']} DOFs", ""),
        ("reached", _shown(summary[parameter.name], "g", unit), ""),
    ]
    if peak is not None:
        at = f" at {peak[parameter.name]:g} {unit}"
        value = _shown(peak[reaction.name], ".6g", reaction.unit) + at
        rows.append((f"largest {reaction.name}", value, ""))
    if summary["plateau"] is not None or theory:
        steady = _shown(theory.get("reaction"), ".5g", reaction.unit)
        rows.append(("plateau", _shown(summary["plateau"], ".6f", reaction.unit), steady))
    if slopes is not None:
        rows.append(("amplitude", _shown(summary["amplitude"], ".3e", reaction.unit), ""))
        steepest = f"{slopes['rise']:+.3e}, {slopes['fall']:+.3e} {reaction.unit}/{unit}"
        rows.append(("steepest slopes", steepest, ""))
        rows.append(("read between", f"{window[0]:g} and {window[1]:g} {unit}", ""))
    if summary["onset"] is not None or theory.get("onset") is not None:
        onset = _shown(theory.get("onset"), ".1f", unit)
        rows.append(("onset", _shown(summary["onset"], ".1f", unit), onset))
    if summary["jumps"]:
        released = sum(jump["released_energy"] for jump in summary["jumps"])
        rows.append(("jumps", f"{len(summary['jumps'])}, releasing {released:.4g} E0 L0^3", ""))
    for change in summary["finer_mesh"]:
        relative = change["relative_change"]
        told = "no equilibrium near it" if relative is None else f"{reaction.name} changes by {relative:.2%}"
        rows.append(("half the elements' length", f"{told}, at {change[parameter.name]:g} {unit}", ""))
    per_step = _shown(summary["corrections_per_step"], ".2f", "per step")
    rows.append(("corrections", f"{summary['corrections']}, {per_step}", ""))
    rows.append(("time", f"{summary['wall_time_s']:.1f} s", ""))
    return rows


def units_note(units: Mapping[str, Any]) -> str:
    """What the units of lengths and stresses are, such as "L0 = 1 nm, E0 = 2 GPa"."""
    return "L0 = {L0}, E0 = {E0}".format(**units)


def short_unit(column: Column) -> str:
    """The unit of a column as it stands behind a number."""
    return "deg" if column.unit == "degree" else column.unit


def _shown(value: float | None, digits: str, unit: str) -> str:
    return "-" if value is None else f"{value:{digits}} {unit}"


def _jumps(curve: Curve) -> IntArray:
    """Numbers of the steps that jumped."""
    if not len(curve):
        return np.empty(0, dtype=np.int64)
    varied = np.ptp(curve.stored_energy) + np.ptp(curve.adhesive_energy)
    jumped = curve.kind == KINDS.index("jump")
    return np.flatnonzero(jumped | (curve.released_energy > 1e-3 * varied))


def _notes(run: StoredRun, found: Findings, onset: float | None) -> list[Note]:
    window, closed_form = found.window, found.closed_form
    notes = []
    if found.inside:
        text = (
            f"a part that does not adhere, and feels no substrate, lies up to {found.inside:.2g} L0 inside it"
        )
        notes.append(Note("penetration", text))
    if window is None:
        if closed_form is not None:
            text = "plateau, amplitude and slopes: the case names no window to read them in"
            notes.append(Note("reading", text))
    elif reason := unreadable(run.curve, window, closed_form.period if closed_form else None):
        covered = plateau_mean(run.curve, window) is not None
        notes.append(Note("reading", f"{'' if covered else 'plateau, '}amplitude and slopes: {reason}"))
    if onset is None and run.curve.parameter_column.unit == "degree":
        notes.append(Note("reading", "onset: no peeling began"))
    return notes


#: Change of a reaction on a finer space that is worth a note. For an error that falls with the element size
#: or faster the error itself is at most twice that: 3 %.
MESH_CHANGE = 0.015


def _mesh_notes(run: StoredRun, changes: Sequence[MeshChange]) -> list[Note]:
    parameter, reaction = run.curve.parameter_column, run.curve.reaction_column
    length, height = str(run.attributes["mesh"]).split("x")
    notes = []
    for change in changes:
        if change.relative > MESH_CHANGE:
            at = f"{reaction.name} at {change.parameter:g} {short_unit(parameter)}"
            seen = (
                "has no equilibrium near it on elements of half the length"
                if change.finer is None
                else f"changes by {100 * change.relative:.2g} % on elements of half the length"
            )
            text = f"the mesh is too coarse: the {at} {seen}; try --mesh {2 * int(length)}x{height}"
            notes.append(Note("resolution", text))
    return notes


def _finer(change: MeshChange, parameter: Column, reaction: Column) -> dict[str, float | None]:
    return {
        parameter.name: change.parameter,
        reaction.name: change.reaction,
        "on_finer_mesh": change.finer,
        "relative_change": change.relative if isfinite(change.relative) else None,
    }
