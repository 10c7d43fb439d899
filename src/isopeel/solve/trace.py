"""The equilibrium path: one immutable step after the other, at the requested values of the parameter."""

from collections.abc import Iterable, Iterator, Sequence

from isopeel.assembly.constraints import constrain
from isopeel.assembly.loads import AssembledLoad
from isopeel.assembly.system import System
from isopeel.common.arrays import frozen
from isopeel.common.errors import InputError
from isopeel.common.interrupts import deferred
from isopeel.problem import Problem
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.path import Path
from isopeel.solve.path_control import controlled
from isopeel.solve.step import State, Step
from isopeel.splines.rows import RowSpace


@deferred()
def trace(
    problem: Problem,
    space: RowSpace,
    parameters: Iterable[float],
    settings: NewtonSettings | None = None,
    *,
    start: Sequence[State] = (),
    base: State | None = None,
    passed: Sequence[float] = (),
    contact_points: int | None = None,
) -> Iterator[Step]:
    """Trace the equilibria of a problem on a space through the given values of the drive's parameter.

    Each step starts from where the last states lead to (see `Predictor`), those of `start` among them, of
    which the last is the newest; without any, from the body as it is. A kept tangent is tried first, where
    forces have a potential (see `QuasiNewton`), then Newton's method from the parabola through the last
    three.
    Where the path is a stage after another, `base` is the state that the latter ended in: there the drive
    begins, with the parameter zero, and what is held stays where it is. Values that the path has `passed`
    before its start are met again where its curve turns back, under a control that follows it. The adhesive
    force has `contact_points` Gauss points on each element, by default one more than the highest degree
    along it.

    What is done where a step finds no equilibrium, the `control` of the settings says. Each requested value
    is met exactly; under controls other than `newton` there are steps of other kinds between.

    To stop early, break. Raises ConvergenceError where a step finds no equilibrium; all steps before it
    have been yielded. Raises InputError where problem, space, start and points do not fit together, or the
    memory does not suffice.
    """
    given = [*start] if base is None else [base, *start]
    for state in given:
        if state.displacement.shape != (space.size, 2):
            raise InputError("start", state.displacement.shape, f"the space has {space.size} functions")
    system = System(problem, space, contact_points, None if base is None else base.displacement)
    if given and given[-1].openings is not None:
        if given[-1].openings.shape != system.openings.shape:
            allowed = f"the adhesive force has {system.openings.shape} points"
            raise InputError("start", given[-1].openings.shape, allowed)
        system.openings = frozen(given[-1].openings)
    begins = base is not None and not start
    if base is not None and not start:
        start = [base._replace(parameter=0.0, past=(), memory=None)]
    settings = settings or NewtonSettings()
    _check_control(problem, settings)
    return controlled(Path(system, settings, start, begins=begins), parameters, passed)


def check_stage(problem: Problem, space: RowSpace, settings: NewtonSettings) -> None:
    """Check what can be known of a stage before the state that it begins with: a stage after another.

    Raises InputError where what is held meets what the drive moves or loads, nothing is left to move, or the
    path control needs an energy that the forces do not have. Whether adhesion holds the body, and where the
    substrate is, depends on that state.
    """
    constraints = constrain(problem, space, [])
    AssembledLoad.of(problem.drive, problem.body.shape, space, constraints)
    _check_control(problem, settings)


def _check_control(problem: Problem, settings: NewtonSettings) -> None:
    load = problem.drive.load
    if settings.control == "jump" and (
        problem.adhesion.traction == "projected" or (load is not None and load.follows)
    ):
        allowed = "projected and following forces have no energy that could fall; take continuation"
        raise InputError("drive.path_control", "jump", allowed)
