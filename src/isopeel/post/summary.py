"""The summary of a run: what was read from it, for a JSON file."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from math import isfinite
from typing import Any, NamedTuple

import numpy as np

from isopeel.post.closed_form import Expected
from isopeel.post.closed_form.expected import invalid, theory
from isopeel.post.crack import Front, crack_length_at, fronts, joint_ends, jumps
from isopeel.post.fields import depth_inside
from isopeel.post.laboratory import Laboratory, kind_of
from isopeel.post.locking import locking_notes
from isopeel.post.mesh_error import MeshChange
from isopeel.post.reading import PlateauReading, onset_angle, plateau_mean, read_plateau, unreadable
from isopeel.post.readings import (
    FAR,
    LAST,
    Reading,
    drive_test,
    halves,
    is_only_pressed,
    read,
    steady_window,
)
from isopeel.post.resolution import Zones, oscillation_notes, peels, zone_notes
from isopeel.post.stability import stability_notes
from isopeel.problem import Column, Problem
from isopeel.results.curve import Curve
from isopeel.results.notes import Note
from isopeel.results.run_file import StoredRun
from isopeel.splines.rows import RowSpace
from isopeel.units import UnitSystem


@dataclass(frozen=True)
class Findings:
    """What is read from a run beyond its curve, and what theory says of it.

    `window` is where the plateau is read, if the case names one; `inside` is how deep (in L0) the body has
    come to lie in the substrate. `period` is that of the mesh's oscillation, in the parameter's unit, also
    where the closed form is not valid, for the reason that `unproven` gives. `fronts` are those of the stored
    states, `readings` what a user of the drive looks for. `zones` are the elements at the fronts, and
    `doubts` what is to be said of the discretization.
    """

    window: tuple[float, float] | None
    plateau: PlateauReading | None
    closed_form: Expected | None
    inside: float
    period: float | None = None
    unproven: str = ""
    fronts: Mapping[float, Front] = field(default_factory=dict)
    readings: Sequence[Reading] = ()
    halves: str | None = None
    zones: Zones = field(default_factory=Zones)
    doubts: Sequence[Note] = ()
    laboratory: Laboratory = Laboratory(UnitSystem())  # noqa: RUF009 (both are frozen)


def find(
    problem: Problem,
    space: RowSpace,
    run: StoredRun,
    window: tuple[float, float] | None,
    laboratory: Laboratory | None = None,
) -> Findings:
    """Read a run of a problem on a space, to be shown in the units of a laboratory."""
    laboratory = laboratory or Laboratory.of(UnitSystem(), problem)
    curve = run.curve
    said = theory(problem, space)
    form, unproven = said.form, said.reason
    if form is not None and run.base is not None:
        # a stage after another one comes to the same steady state, but not by the same way; what lies on the
        # substrate without being held was stretched by the stage before
        slides = problem.adhesion.sliding_length is None and problem.drive.load is not None
        form = None if slides else replace(form, onset=None)
    period = form.period if form else None
    plateau = read_plateau(curve, window, period) if window else None
    found = fronts(problem, space, run.fields)
    steady = window if window and plateau_mean(curve, window) is not None else None
    test = drive_test(problem, curve)
    reason = None
    if steady is not None:
        reason = _invalid(problem, found, form, steady, laboratory)
    elif test in ("moment", "tape"):
        steady, reason = _own_window(problem, curve, found, form, laboratory)
        if steady is None and window is None:
            reason = f"no part of the run has a steady {curve.reaction_column.name}"
    elif form is not None:
        reason = "the end was not lifted far enough for a tape to turn into its direction"
    if steady is None and run.base is not None:
        form = None
    if form is not None and reason:
        unproven, form = f"{form.source} is not shown: {reason}", None
    readings: list[Reading] = []
    if len(curve):
        readings = read(problem, curve, found, window)
        mean = plateau_mean(curve, steady) if steady else None
        if steady and mean is not None:
            readings.insert(0, _steady(curve, mean, steady, plateau, form))
    inside = depth_inside(problem, space, run.fields)
    zones = Zones.of(problem, space, {at: front.zone for at, front in found.items()})
    doubts = locking_notes(problem, space, laboratory)
    if not is_only_pressed(problem, curve) and (zones.measured or peels(problem, space, run.fields)):
        doubts = zone_notes(problem, space, zones, laboratory) + doubts
    if not doubts:
        swing = None if plateau is None else (plateau.mean, plateau.amplitude)
        doubts = oscillation_notes(problem, swing, int(jumps(curve).sum()))
    return Findings(
        window,
        plateau,
        form,
        inside,
        period,
        unproven,
        found,
        readings,
        halves(problem, test),
        zones,
        doubts,
        laboratory,
    )


def _own_window(
    problem: Problem,
    curve: Curve,
    found: Mapping[float, Front],
    form: Expected | None,
    laboratory: Laboratory,
) -> tuple[tuple[float, float] | None, str | None]:
    """Where a curve is read that the case names no window of, and why the closed form does not hold there.

    The first part of its end that is steady, and where the closed form holds if there is one.
    """
    windows = [window for share in LAST if (window := steady_window(curve, share))]
    reasons = [_invalid(problem, found, form, window, laboratory) for window in windows]
    for window, reason in zip(windows, reasons, strict=True):
        if reason is None:
            return window, None
    return (windows[0], reasons[0]) if windows else (None, None)


def _invalid(
    problem: Problem,
    found: Mapping[float, Front],
    form: Expected | None,
    window: tuple[float, float],
    laboratory: Laboratory,
) -> str | None:
    """Why a closed form does not hold in a window; None where it does, or there is none."""
    if form is None:
        return None
    lengths = [crack_length_at(found, at) for at in window]
    return invalid(form, lengths, joint_ends(problem)[1], laboratory.length)


class Shown(NamedTuple):
    """A curve and what was read from it in laboratory units, for figures and tables of several runs."""

    curve: Curve
    plateau: PlateauReading | None
    closed_form: Expected | None
    period: float | None


def in_laboratory(curve: Curve, found: Findings) -> Shown:
    """Convert a curve, its plateau and its closed form to the units that they are shown in."""
    laboratory, plateau, form = found.laboratory, found.plateau, found.closed_form
    p, r = (laboratory.column(column).factor for column in (curve.parameter_column, curve.reaction_column))
    return Shown(
        laboratory.curve(curve),
        plateau
        and replace(
            plateau,
            window=(plateau.window[0] * p, plateau.window[1] * p),
            mean=plateau.mean * r,
            drift=plateau.drift * r / p,
            amplitude=plateau.amplitude * r,
            steepest_rise=plateau.steepest_rise * r / p,
            steepest_fall=plateau.steepest_fall * r / p,
        ),
        form
        and replace(
            form,
            reaction=form.reaction * r,
            onset=None if form.onset is None else form.onset * p,
            period=None if form.period is None else form.period * p,
        ),
        None if found.period is None else found.period * p,
    )


def _steady(
    curve: Curve,
    mean: float,
    window: tuple[float, float],
    plateau: PlateauReading | None,
    form: Expected | None,
) -> Reading:
    """The steady reaction in a window, with its drift and its oscillation in percent where they were read."""
    words = "mean"
    if plateau and mean:
        drift = 100 * plateau.drift * (window[1] - window[0]) / mean
        oscillation = 100 * plateau.amplitude / abs(mean)
        words += f", drift {drift:+.2g} %, oscillation {oscillation:.2g} %"
    kind = kind_of(curve.reaction_column)
    theory, source = (form.reaction, form.source) if form else (None, "")
    return Reading(f"steady {curve.reaction_column.name}", mean, kind, None, theory, source, words, window)


def summarize(
    title: str, run: StoredRun, found: Findings, wall_time: float, changes: Sequence[MeshChange]
) -> dict[str, Any]:
    """Collect what a run says, as plain numbers and texts; `notes` say why a value is None, or doubted.

    `readings` are in laboratory units, each with its own. All other numbers are those of the curve: parameter
    and reaction in the units of their columns, which `units` names, slopes per unit of the parameter. A jump
    is a step of that kind, or one that released more than a thousandth of what the energies varied by.
    `wall_time` (seconds) is that of the whole run, with its compilation. `changes` are those on a finer
    space, by `mesh_changes`.
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
        "readings": [_reading(one, curve, found.laboratory) for one in _all_readings(curve, found, onset)],
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
        "process_zone": found.zones.summary(parameter.name),
        "notes": [asdict(note) for note in [*_notes(run, found, onset), *_mesh_notes(run, found, changes)]],
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
            "reason": failure.reason,
            "cause": failure.cause,
            "hint": failure.hint,
            # JSON knows no inf
            "iterations": [measure if isfinite(measure) else None for measure in failure.iterations],
        },
        "versions": {name.removeprefix("version_"): value for name, value in versions.items()},
        "git_revision": attributes.get("git_revision"),
    }


def _all_readings(curve: Curve, found: Findings, onset: float | None) -> list[Reading]:
    """What was read, in the order of the table."""
    readings = list(found.readings)
    form = found.closed_form
    if onset is not None:
        theory, source = (form.onset, form.source) if form else (None, "")
        readings.append(Reading("onset", onset, "angle", None, theory, source))
    jumped = np.flatnonzero(jumps(curve))
    readings += [
        Reading(
            "jump", float(curve.released_energy[k]), "energy", float(curve.parameter[k]), words="released"
        )
        for k in jumped
    ]
    return readings


def _reading(reading: Reading, curve: Curve, laboratory: Laboratory) -> dict[str, Any]:
    """A reading in laboratory units, for JSON."""
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


class Row(NamedTuple):
    """A row of the table of a summary: of what, its value, that of theory, and how far they are apart."""

    name: str
    value: str
    theory: str = ""
    deviation: str = ""


def summary_rows(summary: Mapping[str, Any], curve: Curve, found: Findings) -> list[Row]:
    """A summary in words; cells are empty where there is nothing to say."""
    laboratory = found.laboratory
    parameter = curve.parameter_column
    rows = [Row("space", f"{summary['space']}, {summary['mesh']}, {summary['dofs']} DOFs")]
    if not len(curve):
        rows.append(Row("reached", "-"))
    else:
        rows.append(Row("reached", laboratory.parameter(parameter, float(curve.parameter[-1]))))
    readings = _all_readings(curve, found, None)
    rows += [_row(reading, parameter, laboratory) for reading in readings if reading.name != "jump"]
    if (found.window or found.closed_form) and not any(
        reading.name.startswith("steady") for reading in readings
    ):
        form = found.closed_form
        kind = kind_of(curve.reaction_column)
        told = f"{laboratory.text(form.reaction, kind)}\n  {form.source}" if form else ""
        rows.append(Row(f"steady {curve.reaction_column.name}", "-", told))
    plateau = found.plateau
    if plateau is not None:
        reaction, at = laboratory.column(curve.reaction_column), laboratory.column(parameter)
        kind = kind_of(curve.reaction_column)
        rows.append(Row("amplitude", laboratory.both(plateau.amplitude, kind, 4)))
        slopes = (plateau.steepest_rise, plateau.steepest_fall)
        values = ", ".join(f"{slope * reaction.factor / at.factor:+.4g}" for slope in slopes)
        rows.append(Row("steepest slopes", f"{values} {reaction.name} per {at.name}"))
    form = found.closed_form
    if summary["onset"] is not None or (form and form.onset is not None):
        onset = None if form is None else form.onset
        rows.append(Row("onset", _angle(summary["onset"]), "" if onset is None else _angle(onset)))
    if summary["jumps"]:
        released = [jump["released_energy"] for jump in summary["jumps"]]
        largest = int(np.argmax(released))
        at_which = laboratory.parameter(parameter, summary["jumps"][largest][parameter.name])
        text = f"{len(released)}, releasing {laboratory.text(sum(released), 'energy', 4)}"
        if len(released) > 1:
            text += f"; the largest {laboratory.text(released[largest], 'energy', 4)} at {at_which}"
        else:
            text += f" at {at_which}"
        rows.append(Row("jumps", text))
    rows += _zone_rows(found, parameter)
    for change in summary["finer_mesh"]:
        relative = change["relative_change"]
        name = curve.reaction_column.name
        told = "no equilibrium near it" if relative is None else f"{name} changes by {relative:.2%}"
        at_which = laboratory.parameter(parameter, change[parameter.name])
        rows.append(Row("half the elements' length", f"{told}, at {at_which}"))
    per_step = summary["corrections_per_step"]
    told = "-" if per_step is None else f"{per_step:.2f} per step"
    rows.append(Row("corrections", f"{summary['corrections']}, {told}"))
    rows.append(Row("time", f"{summary['wall_time_s']:.1f} s"))
    return rows


def _row(reading: Reading, parameter: Column, laboratory: Laboratory) -> Row:
    value = laboratory.both(reading.value, reading.kind)
    if reading.at is not None:
        value += f" at {laboratory.parameter(parameter, reading.at)}"
    words = reading.words
    if reading.between is not None:
        first, last = (laboratory.parameter(parameter, end) for end in reading.between)
        words += f", {first} to {last}"
    if words:
        value += f"\n  {words}"
    if reading.theory is None:
        return Row(reading.name, value)
    theory = f"{laboratory.text(reading.theory, reading.kind)}\n  {reading.source}"
    deviation = reading.deviation
    return Row(reading.name, value, theory, "" if deviation is None else f"{100 * deviation:+.2g} %")


def _zone_rows(found: Findings, parameter: Column) -> list[Row]:
    """How many elements the process zone has, and needs."""
    laboratory, zones = found.laboratory, found.zones
    told, needed = [], None
    if zones.last is not None:
        at, zone = zones.last
        told.append(f"{zone.elements:.2g} at {laboratory.parameter(parameter, at)}")
        needed = zone.needed
    if zones.estimated is not None:
        told.append(f"{zones.estimated.elements:.2g} estimated")
        needed = zones.estimated.needed
    return [Row("elements in the zone", f"{', '.join(told)}; {needed:.2g} needed")] if told else []


def _angle(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g} deg"


def short_unit(column: Column) -> str:
    """The unit of a column as it stands behind a number."""
    return "deg" if column.unit == "degree" else column.unit


def _notes(run: StoredRun, found: Findings, onset: float | None) -> list[Note]:
    window, laboratory = found.window, found.laboratory
    notes = [*found.doubts]
    if found.inside:
        depth = laboratory.text(found.inside, "length", 2)
        text = f"a part that does not adhere, and feels no substrate, lies up to {depth} inside it"
        notes.append(Note("penetration", text))
    notes += stability_notes(run.curve, laboratory)
    for reading in found.readings:
        deviation = reading.deviation
        # a crack's length differs from that of an arm clamped at its front by what the front gives way
        if deviation is None or abs(deviation) <= FAR or reading.kind in ("length", "toughness"):
            continue
        text = (
            f"{reading.name}: the run is {100 * deviation:+.3g} % off {reading.source},"
            f" {laboratory.text(reading.theory or 0.0, reading.kind)}; up to {100 * FAR:g} % is usual:"
            " compare a finer mesh, a later window and smaller steps"
        )
        notes.append(Note("closed form", text))
    if found.unproven:
        notes.append(Note("reading", f"closed form: {found.unproven}"))
    if window is None:
        if found.closed_form is not None:
            text = "plateau, amplitude and slopes: the case names no window to read them in"
            notes.append(Note("reading", text))
    elif reason := unreadable(
        run.curve, window, found.period, partial(laboratory.parameter, run.curve.parameter_column)
    ):
        covered = plateau_mean(run.curve, window) is not None
        notes.append(Note("reading", f"{'' if covered else 'plateau, '}amplitude and slopes: {reason}"))
    if onset is None and run.curve.parameter_column.unit == "degree":
        notes.append(Note("reading", "onset: no peeling began"))
    return notes


#: Change of a reaction on a finer space that is worth a note. For an error that falls with the element size
#: or faster the error itself is at most twice that: 3 %.
MESH_CHANGE = 0.015


def _mesh_notes(run: StoredRun, found: Findings, changes: Sequence[MeshChange]) -> list[Note]:
    parameter, reaction = run.curve.parameter_column, run.curve.reaction_column
    length, height = str(run.attributes["mesh"]).split("x")
    notes = []
    for change in changes:
        if change.relative > MESH_CHANGE:
            at = f"{reaction.name} at {found.laboratory.parameter(parameter, change.parameter)}"
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
