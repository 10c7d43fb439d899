"""The energy balance of several bodies: what the drive does, and what each body and each interface takes."""

from typing import TypeAlias

import numpy as np

from isopeel.assembly.loops import Sums, add_terms
from isopeel.assembly.spaces import SpaceOfBodies
from isopeel.assembly.system import System
from isopeel.post.crack import jumps, work_between
from isopeel.post.readings import Reading
from isopeel.problem import Problem
from isopeel.results.fields import StoredState
from isopeel.results.run_file import StoredRun

#: Stored energies of bodies, and adhesive and dissipated energies of interfaces, by their names.
Energies: TypeAlias = dict[str, float]


def balance(
    problem: Problem,
    space: SpaceOfBodies,
    run: StoredRun,
    contact_points: int | None = None,
) -> list[Reading]:
    """Return the work of the drive between the first and the last stored state, and what each part takes.

    The energies of parts are those of the curve: stored ones of bodies, and adhesive and dissipated ones of
    interfaces. Their sum, with the energy released in jumps, is compared with the work, which is a sum over
    the steps of the curve by the trapezoidal rule. There is no balance of one state, and none where maximum
    openings of an irreversible joint are not known.
    """
    curve, states = run.curve, run.states
    if len(states) < 2:
        return []
    first, last = states[0], states[-1]
    between = first.parameter, last.parameter
    system = System(problem, space, contact_points, run.base)
    if system.irreversible and not all(_are_known(system, state) for state in (first, last)):
        return []
    before, after = energies(system, first), energies(system, last)
    taken = {name: after[name] - before[name] for name in after}
    work = work_between(problem, curve, first.step, last.step)
    jumped = jumps(curve)[first.step + 1 : last.step + 1]
    released = float(curve.released_energy[first.step + 1 : last.step + 1][jumped].sum())
    readings = [Reading("work of the drive", work, "energy", between=between)]
    if released:
        readings.append(Reading("energy released in jumps", released, "energy", between=between))
    readings += [
        Reading(f"energy of {name}", value, "energy", between=between) for name, value in taken.items()
    ]
    total = sum(taken.values()) + released
    words = "of all bodies and interfaces" + (", and released" if released else "")
    readings.append(Reading("energy in all", total, "energy", None, work, "work", words, between))
    return readings


def _are_known(system: System, state: StoredState) -> bool:
    openings = state.maximum_openings
    return openings.size == system.maximum_openings.size and bool(np.isfinite(openings).all())


def energies(system: System, state: StoredState) -> Energies:
    """Return the energy of each body and each interface in a state, as in the assembly.

    An interface between two bodies has the name of both of its sides that are integrated.
    """
    problem, u = system.problem, np.ascontiguousarray(state.displacement)
    history = (state.maximum_openings if system.irreversible else system.maximum_openings).ravel()
    names, sides = [body.name for body in problem.bodies], iter(problem.interface_names)
    for interface in problem.interfaces:
        of_faces = [next(sides) for _ in interface.faces]
        names += len(of_faces) * [" and ".join(of_faces)]
    found: Energies = {}
    for number, name in enumerate(names):
        sums = Sums(np.zeros(u.shape), np.empty((0, 0)), 0, False)
        terms = system.equations.terms.only([number])
        stored, adhesive, dissipated, _ = add_terms(terms, history, np.zeros(1), u, sums)
        found[name] = found.get(name, 0.0) + stored + adhesive + dissipated
    return found
