"""The summary of a run, for a JSON file."""

from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from typing import Any

import numpy as np

from isopeel.post.crack import jumps
from isopeel.post.findings import Findings, all_readings
from isopeel.post.laboratory import Laboratory
from isopeel.post.mesh_error import MeshChange
from isopeel.post.notes import mesh_notes, run_notes
from isopeel.post.plateau import onset_angle, plateau_mean
from isopeel.post.readings import Reading
from isopeel.problem import Column
from isopeel.results.curve import Curve
from isopeel.results.notes import with_one_remedy
from isopeel.results.run_file import StoredRun


def summarize(
    title: str, run: StoredRun, found: Findings, wall_time: float, changes: Sequence[MeshChange]
) -> dict[str, Any]:
    """Return the summary of a run as plain numbers and texts.

    `notes` give the reason if a value is None, or may be wrong.

    `readings` are in laboratory units, each with its own unit. All other numbers are those of the curve:
    parameter and reaction in the units of their columns, named in `units`, slopes per unit of the parameter.
    A jump is a step of that kind, or one that released more than a thousandth of the range of the energies.
    The process zones of several interfaces have their names. `wall_time` (seconds) is that of the whole run,
    with its compilation. `changes` are those on a finer space, by `mesh_changes`.
    """
    curve, attributes, failure = run.curve, run.attributes, run.failure
    window, plateau, closed_form = found.window, found.plateau, found.closed_form
    iterations = int(curve.iterations.sum())
    parameter, reaction = curve.parameter_column, curve.reaction_column
    # a bend in a straight line is the onset of peeling under a moment, not under a force
    onset = onset_angle(curve) if parameter.unit == "degree" else None
    strongest = int(np.argmax(np.abs(curve.reaction))) if len(curve) else None
    versions = {name: value for name, value in attributes.items() if name.startswith("version_")}
    return {
        "case": title,
        "run": run.identity,
        **{name: attributes[name] for name in ("space", "mesh", "dofs", "traction")},
        "units": {
            **{column.name: column.unit for column in (parameter, reaction)},
            **{name: attributes[name] for name in ("L0", "E0")},
        },
        "readings": [_reading(one, curve, found.laboratory) for one in all_readings(curve, found, onset)],
        "halves": found.halves,
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
        "process_zone": _zones(found, parameter.name),
        "notes": [
            {"subject": note.subject, "text": note.text}
            for note in with_one_remedy([*run_notes(run, found, onset), *mesh_notes(run, found, changes)])
        ],
        "finer_mesh": [_finer(change, parameter, reaction) for change in changes],
        "wall_time_s": wall_time,
        "corrections": iterations,
        "corrections_per_step": iterations / len(curve) if len(curve) else None,
        "jumps": [
            {parameter.name: float(curve.parameter[k]), "released_energy": float(curve.released_energy[k])}
            for k in np.flatnonzero(jumps(curve))
        ],
        "completed": run.ending == "completed",
        "failure": failure
        and {
            parameter.name: failure.parameter,
            "reason": found.laboratory.sentence(failure.reason),
            "cause": failure.cause,
            "hint": failure.hint,
            # JSON has no inf
            "iterations": [measure if isfinite(measure) else None for measure in failure.iterations],
        },
        "versions": {name.removeprefix("version_"): value for name, value in versions.items()},
        "git_revision": attributes.get("git_revision"),
    }


def _reading(reading: Reading, curve: Curve, laboratory: Laboratory) -> dict[str, Any]:
    """Return a reading in laboratory units, for JSON."""
    value, unit = laboratory.value(reading.value, reading.kind)
    internal = {"force": "E0 L0", "moment": "E0 L0^3", "energy": "E0 L0^3", "length": "L0"}.get(reading.kind)
    parameter = curve.parameter_column
    at = laboratory.column(parameter)
    deviation = reading.deviation
    return {
        "quantity": reading.name,
        "value": value,
        "unit": unit,
        "words": reading.words,
        "at": None if reading.at is None else {"value": reading.at * at.factor, "unit": at.name},
        "between": reading.between
        and {"values": [end * at.factor for end in reading.between], "unit": at.name},
        "closed_form": None
        if reading.theory is None
        else {"source": reading.source, "value": laboratory.value(reading.theory, reading.kind)[0]},
        "deviation_percent": None if deviation is None else 100 * deviation,
        "in_case_units": internal and {"value": reading.value, "unit": internal},
    }


def _zones(found: Findings, parameter: str) -> dict[str, Any]:
    """Return the process zone of the only interface, or those of several by their names."""
    zones = {name: one.summary(parameter) for name, one in found.zones.items()}
    return next(iter(zones.values())) if len(zones) == 1 else zones


def _finer(change: MeshChange, parameter: Column, reaction: Column) -> dict[str, float | None]:
    return {
        parameter.name: change.parameter,
        reaction.name: change.reaction,
        "on_finer_mesh": change.finer,
        "relative_change": change.relative if isfinite(change.relative) else None,
    }
