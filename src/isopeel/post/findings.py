"""The findings of a run: readings, fronts, closed forms, and notes on the discretization."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from isopeel.assembly.interface import InterfacePoints
from isopeel.assembly.spaces import SpaceOfBodies, spaces_by_name
from isopeel.common.units import UnitSystem
from isopeel.physics.adhesion import Contact
from isopeel.physics.joints import JointLaw
from isopeel.post.closed_form import Expected
from isopeel.post.contour import NO_TRACTION
from isopeel.post.crack import Fronts, fronts, jumps, release
from isopeel.post.energy import balance
from isopeel.post.fields import Depth, depths_inside
from isopeel.post.front_readings import FrontFlows, front_flows, front_readings
from isopeel.post.laboratory import Laboratory
from isopeel.post.locking import locking_notes
from isopeel.post.overlap import overlap_notes
from isopeel.post.plateau import PlateauReading
from isopeel.post.readings import (
    Reading,
    buckled,
    drive_test,
    fronts_at_the_end,
    halves,
    is_only_pressed,
    largest,
    pull_off,
    read,
    release_reading,
)
from isopeel.post.resolution import Zones, elements_are_tall
from isopeel.post.resolution_notes import oscillation_notes, peels, zone_note
from isopeel.post.sensitivities import sensitivity_notes, sensitivity_readings
from isopeel.post.steady_load import steady_load
from isopeel.post.steady_part import steady_part, steady_part_of_bodies
from isopeel.problem import Boundary, Problem
from isopeel.results.curve import Curve
from isopeel.results.notes import Note
from isopeel.results.run_file import StoredRun
from isopeel.splines.rows import RowSpace


@dataclass(frozen=True)
class Findings:
    """The values read from a run beyond its curve, and the closed form for them.

    The plateau is read in the `window`, if the case names one. `inside` are the largest depths (in L0) in a
    substrate or another body, by names of sides, as `body.bottom`. `period` is that of the oscillation by the
    mesh, in the unit of the parameter; it is also given if the closed form is not valid, for the reason
    `unproven`.
    `fronts` are those of the stored states, `flows` what flows to them where there are several bodies, and
    `zones` the elements there, all by the names of interfaces.
    `readings` are the quantities of interest of the drive, and `notes` those on the discretization.
    `tall` is whether the elements at the contact are too high.
    """

    window: tuple[float, float] | None
    plateau: PlateauReading | None
    closed_form: Expected | None
    inside: Mapping[str, Depth]
    period: float | None = None
    unproven: str = ""
    fronts: Mapping[str, Fronts] = field(default_factory=dict)
    flows: Mapping[str, FrontFlows] = field(default_factory=dict)
    readings: Sequence[Reading] = ()
    halves: str | None = None
    zones: Mapping[str, Zones] = field(default_factory=dict)
    notes: Sequence[Note] = ()
    laboratory: Laboratory = Laboratory(UnitSystem())  # noqa: RUF009 (both are frozen)
    tall: bool = False


#: The note on a run of several bodies or interfaces.
_NO_CLOSED_FORM = (
    "closed forms exist for one body with one interface, for a tape that is peeled off another body or"
    " off an equal tape at 90 degrees, and for a tape of layers"
)


def find(
    problem: Problem,
    space: SpaceOfBodies,
    run: StoredRun,
    window: tuple[float, float] | None,
    laboratory: Laboratory | None = None,
    contact_points: int | None = None,
) -> Findings:
    """Return the findings of a run of a problem on a space, shown in the units of a laboratory.

    The adhesive forces have `contact_points` Gauss points per element, as in `System`.
    """
    laboratory = laboratory or Laboratory.of(UnitSystem(), problem)
    if problem.is_single:
        own = spaces_by_name(problem, space)[problem.body.name]
        found = _of_one_body(problem, own, run, window, laboratory)
    else:
        found = _of_several(problem, space, run, window, laboratory, contact_points)
    return replace(
        found,
        readings=[*found.readings, *sensitivity_readings(run.curve, window)],
        notes=[*found.notes, *sensitivity_notes(run.curve, laboratory)],
    )


def _of_several(
    problem: Problem,
    space: SpaceOfBodies,
    run: StoredRun,
    window: tuple[float, float] | None,
    laboratory: Laboratory,
    contact_points: int | None,
) -> Findings:
    """Return the findings of a run of several bodies, or of one with several interfaces."""
    curve = run.curve
    named = zip(problem.interface_names, problem.faces, strict=True)
    found = {name: fronts(problem, space, run.states, name) for name, face in named if face.adheres}
    steady = steady_part_of_bodies(problem, space, run, window, found, laboratory)
    flows = _flows(problem, space, run)
    readings: list[Reading] = []
    if len(curve):
        readings = [*_listed(steady.reading(curve)), largest(curve), *buckled(curve)]
        for name, there in found.items():
            readings += fronts_at_the_end(curve, there, f", {name}" if len(found) > 1 else "")
        readings += _release_of_bodies(problem, space, curve, found, window)
        for name, flow in flows.items():
            last = flow.get(len(curve) - 1)
            readings += [] if last is None else front_readings(problem, last, name)
        if len(problem.bodies) > 1:
            readings += balance(problem, space, run, contact_points)
    zones = {
        name: Zones.of(problem, space, curve, {step: front.zone for step, front in there.items()}, name)
        for name, there in found.items()
    }
    resolved = [
        zone_note(problem, space, zones[name], laboratory, name)
        for name in found
        if zones[name].measured or peels(problem, space, run.states, name)
    ]
    return Findings(
        window,
        steady.plateau,
        steady.closed_form,
        depths_inside(problem, space, run.states),
        steady.period,
        steady.unproven,
        fronts=found,
        flows=flows,
        readings=readings,
        zones=zones,
        notes=[
            *([] if steady.closed_form or steady.unproven else [Note("reading", _NO_CLOSED_FORM)]),
            *overlap_notes(problem, space, run.states, laboratory),
            *(note for note in resolved if note is not None),
            *locking_notes(problem, space, laboratory),
            *_law_notes(problem),
            *_idle_notes(problem, space, run),
        ],
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
    curve, (name,) = run.curve, problem.interface_names
    test = drive_test(problem, curve)
    found = fronts(problem, space, run.states)
    steady = steady_part(problem, space, run, window, found, laboratory)
    readings: list[Reading] = []
    if len(curve):
        load = steady_load(problem, space, curve) if test == "tape" and run.base is None else None
        readings = [
            *_listed(load),
            *_listed(steady.reading(curve)),
            *read(problem, space, curve, found, window),
        ]
    used = {step: front.zone for step, front in _used(problem, curve, found).items()}
    zones = Zones.of(problem, space, curve, used)
    # Kendall's force does not depend on the bending of a tape; the start of peeling does
    starts = any(one.name == "initiation force" for one in readings)
    bends = steady.closed_form is None or test != "tape" or starts
    notes = locking_notes(problem, space, laboratory, bends=bends)
    if not is_only_pressed(problem, curve) and (zones.measured or peels(problem, space, run.states)):
        note = zone_note(problem, space, zones, laboratory, name)
        notes = notes if note is None else [note, *notes]
    if not notes:
        notes = oscillation_notes(problem, curve, steady.plateau, steady.window)
    return Findings(
        window,
        steady.plateau,
        steady.closed_form,
        depths_inside(problem, space, run.states),
        steady.period,
        steady.unproven,
        fronts={name: found},
        readings=readings,
        halves=halves(problem, test),
        zones={name: zones},
        notes=[*notes, *overlap_notes(problem, space, run.states, laboratory)],
        laboratory=laboratory,
        tall=elements_are_tall(problem, space),
    )


def _release_of_bodies(
    problem: Problem,
    space: SpaceOfBodies,
    curve: Curve,
    found: Mapping[str, Fronts],
    window: tuple[float, float] | None,
) -> list[Reading]:
    """Return the energy release rate of the only interface between two bodies, along its first face."""
    (name, there), *_ = [*found.items(), ("", {})]
    if len(problem.interfaces) != 1 or len(problem.bodies) == 1:
        return []
    released = release(problem, curve, there, window[0] if window else None, name)
    return _listed(released and release_reading(problem, space, released, name))


def _flows(problem: Problem, space: SpaceOfBodies, run: StoredRun) -> dict[str, FrontFlows]:
    """Return what flows to the front of each interface, seen from its first side, by its name."""
    if len(problem.bodies) == 1:
        return {}
    names = iter(problem.interface_names)
    seen = [[next(names) for _ in interface.faces] for interface in problem.interfaces]
    return {name: front_flows(problem, space, run.states, name) for name, *_ in seen}


def _law_notes(problem: Problem) -> list[Note]:
    """Return a note on each joint law that may give wrong results."""
    laws = dict.fromkeys(one.law for one in problem.interfaces if isinstance(one.law, JointLaw))
    return [Note("law", f"{law.name}: {law.doubt}") for law in laws if law.doubt]


def _idle_notes(problem: Problem, space: SpaceOfBodies, run: StoredRun) -> list[Note]:
    """Return a note on each interface between bodies that carries no traction in any stored state.

    The faces of a crack need not touch.
    """
    notes = []
    for name, face in zip(problem.interface_names, problem.faces, strict=True):
        if not isinstance(face.against, Boundary) or not (face.adheres or isinstance(face.law, Contact)):
            continue
        points = InterfacePoints.of_contact(problem, space, interface=name)
        least = NO_TRACTION * problem.body_of(face.boundary.body).material.youngs_modulus
        # a crack opens with the path, so that the first states carry most
        states = (points.state(one.displacement, one.maximum_openings).traction for one in run.states)
        if len(run.states) > 1 and all(np.abs(traction).max() <= least for traction in states):
            text = f"{name}: it carries no traction in any stored state; the bodies may be too far apart"
            notes.append(Note("reading", text))
    return notes


def _listed(reading: Reading | None) -> list[Reading]:
    return [] if reading is None else [reading]


def _used(problem: Problem, curve: Curve, found: Fronts) -> Fronts:
    """Return the fronts on which the readings depend: until a body that is pulled off comes off."""
    last = pull_off(problem, curve)
    return found if last is None else {step: front for step, front in found.items() if step <= last}


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
