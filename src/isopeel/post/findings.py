"""The findings of a run: readings, fronts, closed forms, and notes on the discretization."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from isopeel.assembly.spaces import SpaceOfBodies, spaces_by_name
from isopeel.common.units import UnitSystem
from isopeel.post.closed_form import Expected
from isopeel.post.closed_form.expected import invalid, theory
from isopeel.post.crack import Fronts, crack_length_at, fronts, joint_ends, jumps
from isopeel.post.fields import depths_inside
from isopeel.post.laboratory import Laboratory, kind_of
from isopeel.post.locking import locking_notes
from isopeel.post.plateau import PlateauReading, plateau_mean, read_plateau
from isopeel.post.readings import (
    DRIFT,
    LAST,
    Reading,
    buckled,
    cracks,
    drift,
    drive_test,
    halves,
    is_only_pressed,
    largest,
    pull_off,
    read,
    steady_window,
)
from isopeel.post.resolution import Zones, elements_are_tall
from isopeel.post.resolution_notes import oscillation_notes, peels, zone_notes
from isopeel.post.steady_load import steady_load
from isopeel.problem import Load, Problem
from isopeel.results.curve import Curve
from isopeel.results.notes import Note
from isopeel.results.run_file import StoredRun
from isopeel.splines.rows import RowSpace


@dataclass(frozen=True)
class Findings:
    """The values read from a run beyond its curve, and the closed form for them.

    The plateau is read in the `window`, if the case names one. `inside` are the largest depths (in L0) in a
    substrate, by names of sides, as `body.bottom`. `period` is that of the oscillation by the mesh, in the
    unit of the parameter; it is also given if the closed form is not valid, for the reason `unproven`.
    `fronts` are those of the stored states, and `zones` the elements there, both by the names of interfaces.
    `readings` are the quantities of interest of the drive, and `doubts` the notes on the discretization.
    `tall` is whether the elements at the contact are too high.
    """

    window: tuple[float, float] | None
    plateau: PlateauReading | None
    closed_form: Expected | None
    inside: Mapping[str, float]
    period: float | None = None
    unproven: str = ""
    fronts: Mapping[str, Fronts] = field(default_factory=dict)
    readings: Sequence[Reading] = ()
    halves: str | None = None
    zones: Mapping[str, Zones] = field(default_factory=dict)
    doubts: Sequence[Note] = ()
    laboratory: Laboratory = Laboratory(UnitSystem())  # noqa: RUF009 (both are frozen)
    tall: bool = False


#: The note on a run of several bodies or interfaces.
_OF_ONE_BODY = (
    "closed forms, energy release rates and checks of the discretization exist for one body with one"
    " interface only"
)


def find(
    problem: Problem,
    space: SpaceOfBodies,
    run: StoredRun,
    window: tuple[float, float] | None,
    laboratory: Laboratory | None = None,
) -> Findings:
    """Return the findings of a run of a problem on a space, shown in the units of a laboratory."""
    laboratory = laboratory or Laboratory.of(UnitSystem(), problem)
    if problem.is_single:
        own = spaces_by_name(problem, space)[problem.body.name]
        return _of_one_body(problem, own, run, window, laboratory)
    curve = run.curve
    plateau = read_plateau(curve, window, None) if window else None
    steady = window if window and plateau_mean(curve, window) is not None else steady_window(curve)
    found = {name: fronts(problem, space, run.states, name) for name in problem.interface_names}
    readings: list[Reading] = []
    if len(curve):
        mean = plateau_mean(curve, steady) if steady else None
        readings += [_steady(curve, mean, steady, plateau, None)] if steady and mean is not None else []
        readings += [largest(curve), *buckled(curve)]
        for name, there in found.items():
            readings += cracks(curve, there, f", {name}" if len(found) > 1 else "")
    zones = {
        name: Zones.of(problem, space, curve, {step: front.zone for step, front in there.items()}, name)
        for name, there in found.items()
    }
    return Findings(
        window,
        plateau,
        None,
        depths_inside(problem, space, run.states),
        fronts=found,
        readings=readings,
        zones=zones,
        doubts=[Note("reading", _OF_ONE_BODY)],
        laboratory=laboratory,
    )


def _of_one_body(
    problem: Problem,
    space: RowSpace,
    run: StoredRun,
    window: tuple[float, float] | None,
    laboratory: Laboratory,
) -> Findings:
    """Return the findings of a run of one body with one interface."""
    curve = run.curve
    said = theory(problem, space)
    form, unproven = said.form, said.reason
    if form is not None and run.base is not None:
        # a later stage reaches the same steady state by another path; but if the tape slides, the stage
        # before has stretched the part that lies on the substrate
        slides = problem.adhesion.sliding_length is None and isinstance(problem.drive, Load)
        form = None if slides else replace(form, onset=None)
    period = form.period if form else None
    plateau = read_plateau(curve, window, period) if window else None
    found = fronts(problem, space, run.states)
    steady = window if window and plateau_mean(curve, window) is not None else None
    test = drive_test(problem, curve)
    reason = None
    if steady is not None:
        reason = _invalid(problem, curve, found, form, steady, laboratory)
    elif test in ("moment", "tape"):
        steady, reason = _own_window(problem, curve, found, form, laboratory)
        if steady is None and window is None:
            reason = f"no part of the run has a steady {curve.reaction_column.name}"
    elif form is not None:
        reason = "the end was not lifted far enough: the free arm does not yet point along the force"
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
        load = steady_load(problem, space, curve) if test == "tape" and run.base is None else None
        if load is not None:
            readings.insert(0, load)
    inside = depths_inside(problem, space, run.states)
    used = {step: front.zone for step, front in _used(problem, curve, found).items()}
    zones = Zones.of(problem, space, curve, used)
    # Kendall's force does not depend on the bending of a tape; the start of peeling does
    bends = form is None or test != "tape" or any(one.name == "initiation force" for one in readings)
    doubts = locking_notes(problem, space, laboratory, bends=bends)
    if not is_only_pressed(problem, curve) and (zones.measured or peels(problem, space, run.states)):
        doubts = zone_notes(problem, space, zones, laboratory) + doubts
    if not doubts:
        doubts = oscillation_notes(problem, curve, plateau, steady)
    return Findings(
        window,
        plateau,
        form,
        inside,
        period,
        unproven,
        {problem.interface_names[0]: found},
        readings,
        halves(problem, test),
        {problem.interface_names[0]: zones},
        doubts,
        laboratory,
        elements_are_tall(problem, space),
    )


def _used(problem: Problem, curve: Curve, found: Fronts) -> Fronts:
    """Return the fronts on which the readings depend: until a body that is pulled off comes off."""
    last = pull_off(problem, curve)
    return found if last is None else {step: front for step, front in found.items() if step <= last}


def _own_window(
    problem: Problem,
    curve: Curve,
    found: Fronts,
    form: Expected | None,
    laboratory: Laboratory,
) -> tuple[tuple[float, float] | None, str | None]:
    """Return a window where the case names none, and why the closed form is not valid there, or None.

    The window is the first of the last parts of the curve that is steady, and in which the closed form is
    valid if there is one.
    """
    windows = [window for share in LAST if (window := steady_window(curve, share))]
    reasons = [_invalid(problem, curve, found, form, window, laboratory) for window in windows]
    for window, reason in zip(windows, reasons, strict=True):
        if reason is None:
            return window, None
    return (windows[0], reasons[0]) if windows else (None, None)


def _invalid(
    problem: Problem,
    curve: Curve,
    found: Fronts,
    form: Expected | None,
    window: tuple[float, float],
    laboratory: Laboratory,
) -> str | None:
    """Return why a closed form is not valid in a window; None where it is, or where there is none."""
    if form is None:
        return None
    lengths = [crack_length_at(problem, curve, found, at) for at in window]
    return invalid(form, lengths, joint_ends(problem)[1], laboratory.length)


class Shown(NamedTuple):
    """A curve and its findings in laboratory units, for figures and tables of several runs."""

    curve: Curve
    plateau: PlateauReading | None
    closed_form: Expected | None
    period: float | None


def in_laboratory(curve: Curve, found: Findings) -> Shown:
    """Return a curve, its plateau and its closed form in the units in which they are shown."""
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
    """Return the mean reaction in a window, with drift and oscillation; steady where the drift is small."""
    words, rise = "mean", 0.0
    if mean:
        # the oscillation does not change the fit of the plateau
        rise = plateau.drift * (window[1] - window[0]) / mean if plateau else drift(curve, window)
        words += f", drift {_drifted(rise)}"
        if plateau:
            words += f", oscillation {100 * plateau.amplitude / abs(mean):.2g} %"
    # if a closed form is valid the state is steady, and the drift comes from the oscillation by the mesh
    name = "steady" if form or abs(rise) <= DRIFT else "mean"
    kind = kind_of(curve.reaction_column)
    theory, source = (form.reaction, form.source) if form else (None, "")
    return Reading(f"{name} {curve.reaction_column.name}", mean, kind, None, theory, source, words, window)


def _drifted(rise: float) -> str:
    """Return a drift in words, without digits that are round-off."""
    return f"{100 * rise:+.2g} %" if abs(rise) > 1e-4 else "below 0.01 %"


def all_readings(curve: Curve, found: Findings, onset: float | None) -> list[Reading]:
    """Return all readings, in the order of the table."""
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
