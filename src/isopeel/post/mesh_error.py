"""The change of a reaction on a finer space, which measures the discretization error of a state.

A stored state is transferred to the space with elements of half the length and, if there are few elements
across the height, with one degree more across. The equilibrium is computed there at the same parameter. If
the error is proportional to h^p, the change is 1 - 2^-p of the error, at least half of it for p >= 1. The
change can be smaller if elements are longer than the process zone: the front then sticks at the elements of
the finer space too, and only `post.resolution` detects it.
"""

from collections.abc import Mapping
from itertools import islice
from typing import NamedTuple

import numpy as np

from isopeel.assembly.interface import InterfacePoints
from isopeel.assembly.spaces import SpaceOfBodies, part_of_body, spaces_by_name
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.post.resolution import elements_are_tall
from isopeel.problem import Problem
from isopeel.results.fields import StoredState
from isopeel.results.run_file import StoredRun
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.jumps import jump_from
from isopeel.solve.newton import NewtonResult, NewtonSettings
from isopeel.solve.path import Path
from isopeel.solve.path_control import follow_path
from isopeel.solve.step import State
from isopeel.splines.finer import finer, transferred
from isopeel.splines.rows import RowSpace

#: States whose reaction is below this share of the largest one are left out: their error means little.
_LEAST = 0.05
#: The largest reaction is that of a plateau up to this factor times the last one: then one state is enough.
_STEADY = 1.2
#: Most steps to the largest reaction on the finer space: each costs some corrections.
_MOST_STEPS = 12
#: The same with the cut steps between them.
_MOST_STATES = 3 * _MOST_STEPS
#: Most unknowns of the finer space: with more, a state takes longer than a user should wait.
_MOST_UNKNOWNS = 200_000


class MeshChange(NamedTuple):
    """The reaction of a stored state, and that of its equilibrium on the finer space; in the curve's units.

    `finer` is None where no equilibrium was found there.
    """

    parameter: float
    reaction: float
    finer: float | None

    @property
    def relative(self) -> float:
        """Change over the smaller of the reactions on the finer space and of the run."""
        if self.finer is None:
            return np.inf
        return abs(self.finer - self.reaction) / max(abs(self.finer), abs(self.reaction))


def mesh_changes(
    problem: Problem, space: SpaceOfBodies, run: StoredRun, contact_points: int | None = None
) -> list[MeshChange]:
    """Return the changes on a finer space of the largest reaction and of that in the last stored state.

    The path to the largest reaction is traced on the finer space, from the stored state before it. States
    with a reaction near zero are left out, and all states if the finer space would be too large. The damage
    of an irreversible joint is that of each state, at the points of the finer space.
    """
    refined = {
        name: finer(own, tall=elements_are_tall(problem, space, name))
        for name, own in spaces_by_name(problem, space).items()
    }
    if 2 * sum(one.size for one in refined.values()) > _MOST_UNKNOWNS or not run.states:
        return []
    base = None if run.base is None else _transferred(problem, space, run.base, refined)
    try:
        system = System(problem, refined, contact_points, base)
    except InputError:
        # it needs more memory than there is
        return []
    looked_at, points = _compared(run), _points(problem, space, refined, contact_points)
    changes = []
    for state in looked_at:
        stored = _transferred(problem, space, state.displacement, refined)
        if system.irreversible:
            histories = [
                one.history(state.displacement, state.maximum_openings)
                if interface.has_history
                else np.zeros((len(interface.history_variables), *one.parameters.shape))
                for one, interface in zip(points, problem.faces, strict=True)
            ]
            joined = np.concatenate([one.ravel() for one in histories])
            system = system.after(joined.reshape(system.maximum_openings.shape))
        largest = None
        if state is not looked_at[-1]:
            largest = _change_of_largest(system, problem, run, stored, state)
        changes.append(largest or _change(system, problem, run, stored, state))
    return [change for change in changes if change is not None]


def _transferred(
    problem: Problem, space: SpaceOfBodies, displacement: FloatArray, refined: Mapping[str, RowSpace]
) -> FloatArray:
    """Return the coefficients (size, 2) of a displacement on the finer spaces."""
    parts = []
    for body in problem.bodies:
        own, part = part_of_body(problem, space, displacement, body.name)
        target = refined[body.name].weighted(body.shape)
        parts.append(transferred(own.weighted(body.shape), part, target))
    return np.concatenate(parts)


def _points(
    problem: Problem, space: SpaceOfBodies, refined: Mapping[str, RowSpace], contact_points: int | None
) -> list[InterfacePoints]:
    """Return the points of all interfaces on the finer spaces, to evaluate states of the space there."""
    found = []
    for name in problem.interface_names:
        parameters = InterfacePoints.of_contact(problem, refined, contact_points, name).parameters
        found.append(InterfacePoints(problem, space, parameters, interface=name))
    return found


def _compared(run: StoredRun) -> list[StoredState]:
    """Return the stored states to compare."""
    curve, last = run.curve, run.states[-1]
    size = np.abs(curve.reaction)
    strongest = int(np.argmax(size))
    if size[strongest] <= _STEADY * size[-1]:
        return [last]
    # the largest reaction may be at a limit point, which is at a slightly different place on the finer space
    at = abs(float(curve.parameter[strongest]))
    before = [state for state in run.states if state.step < strongest and abs(state.parameter) < at]
    return [*before[-1:], last]


def _change(
    system: System, problem: Problem, run: StoredRun, stored: FloatArray, state: StoredState
) -> MeshChange | None:
    curve, drive = run.curve, problem.drive
    reaction = float(curve.reaction[state.step])
    if abs(reaction) <= _LEAST * np.abs(curve.reaction).max():
        return None
    parameter = state.parameter / drive.parameter_column.factor
    found = _equilibrium(system, State(parameter, stored))
    if found is None:
        return MeshChange(state.parameter, reaction, None)
    refined = system.reaction(found.equilibrium, found.displacement, found.load, parameter)
    return MeshChange(state.parameter, reaction, float(refined * drive.reaction_column.factor))


def _change_of_largest(
    system: System, problem: Problem, run: StoredRun, stored: FloatArray, before: StoredState
) -> MeshChange | None:
    """Return the change of the largest reaction; None if no path reaches it on the finer space.

    The path starts at the stored state before it, which may lie well below: where a joint comes off, the
    error is largest at the largest reaction. On the finer space the joint may come off earlier.
    """
    curve, drive = run.curve, problem.drive
    strongest = int(np.argmax(np.abs(curve.reaction)))
    first, factor = before.step, drive.parameter_column.factor
    steps = np.linspace(first + 1, strongest, min(strongest - first, _MOST_STEPS)).round().astype(int)
    values = [before.parameter / factor, *(curve.parameter[steps] / factor)]
    # the stored state is not an equilibrium of the finer space
    settings = NewtonSettings(path_control="auto")
    path = Path(system, settings, [State(values[0], stored)], begins=True)
    largest = 0.0
    try:
        for step in islice(follow_path(path, values, ()), _MOST_STATES):
            if abs(step.reaction) < abs(largest) / 2:
                # the joint has come off
                break
            largest = max(largest, step.reaction, key=abs)
    except ConvergenceError:
        # the path ends there on the finer space
        pass
    if largest == 0.0:
        return None
    finer = largest * drive.reaction_column.factor
    return MeshChange(float(curve.parameter[strongest]), float(curve.reaction[strongest]), finer)


def _equilibrium(system: System, start: State) -> NewtonResult | None:
    """Return the equilibrium near a start, or the one that a descent of the energy reaches; else None."""
    path = Path(system, NewtonSettings(), [start])
    try:
        return path.solver.equilibrium(start.parameter)
    except ConvergenceError:
        if not system.has_potential:
            return None
    try:
        return jump_from(path, path.solver.starts(start.parameter), start.parameter).result
    except ConvergenceError:
        return None
