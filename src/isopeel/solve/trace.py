"""The equilibrium path: a sequence of immutable steps at the requested values of the parameter."""

from collections.abc import Iterable, Iterator, Sequence

from isopeel.assembly.constraints import constrain
from isopeel.assembly.load_term import load_terms
from isopeel.assembly.spaces import SpaceOfBodies, Spaces
from isopeel.assembly.system import System
from isopeel.common.errors import InputError
from isopeel.common.interrupts import deferred
from isopeel.problem import Load, Problem
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.path import Path
from isopeel.solve.path_control import follow_path
from isopeel.solve.step import State, Step


@deferred()
def trace(
    problem: Problem,
    space: SpaceOfBodies,
    parameters: Iterable[float],
    settings: NewtonSettings | None = None,
    *,
    start: Sequence[State] = (),
    base: State | None = None,
    passed: Sequence[float] = (),
    contact_points: int | None = None,
) -> Iterator[Step]:
    """Trace the equilibria of a problem on a space through the given values of the drive's parameter.

    Each step starts from an extrapolation of the accepted states (see `Predictor`). The states of `start` are
    accepted states too, the newest last; without any, the first step starts from the undeformed body. Where
    forces have a potential, the chord tangent is tried first (see `QuasiNewton`), then Newton's method from
    the parabola through the last three states.

    Where the path is a stage that follows another stage, `base` is the last state of the earlier stage. The
    drive begins there with the parameter zero, and held sides stay where they are. The values `passed` are
    those that the path met before its start: a path control that follows the curve meets them again where
    the curve turns back. The adhesive force has `contact_points` Gauss points on each element, by default one
    more than the highest degree along it.

    The `path_control` of the settings defines what happens where a step finds no equilibrium. Each requested
    value is met exactly; with path controls other than `newton` there are steps of other kinds between.

    To stop early, use `break`. Raises ConvergenceError where a step finds no equilibrium; all steps before it
    have been yielded. Raises InputError where problem, space, start and points do not fit together, or where
    the system needs more memory than there is.
    """
    given = [*start] if base is None else [base, *start]
    size = Spaces.on(problem, space).size
    for state in given:
        if state.displacement.shape != (size, 2):
            raise InputError("start", state.displacement.shape, f"the space has {size} functions")
    system = System(problem, space, contact_points, None if base is None else base.displacement)
    if given and given[-1].maximum_openings is not None:
        if given[-1].maximum_openings.shape != system.maximum_openings.shape:
            allowed = f"the adhesive force has {system.maximum_openings.shape} points"
            raise InputError("start", given[-1].maximum_openings.shape, allowed)
        system = system.after(given[-1].maximum_openings)
    begins = base is not None and not start
    if base is not None and not start:
        start = [base._replace(parameter=0.0, accepted_states=(), solver_state=None)]
    settings = settings or NewtonSettings()
    _check_path_control(problem, settings)
    return follow_path(Path(system, settings, start, begins=begins), parameters, passed)


def check_stage(problem: Problem, space: SpaceOfBodies, settings: NewtonSettings) -> None:
    """Check a stage that follows another stage, as far as possible without its initial state.

    Raises InputError where a held side meets one that the drive moves or loads, where no unknown is
    left, or where the path control needs an energy that the forces do not have. What depends on the initial
    state is not checked: whether adhesion holds the body, and where the substrate is.
    """
    spaces = Spaces.on(problem, space)
    load_terms(spaces, constrain(spaces, {}))
    _check_path_control(problem, settings)


def _check_path_control(problem: Problem, settings: NewtonSettings) -> None:
    follows = isinstance(problem.drive, Load) and problem.drive.follows
    has_potential = not follows and all(one.has_potential for one in problem.interfaces)
    has_multipliers = any(one.penetration is not None for one in problem.interfaces)
    if settings.path_control in ("jump", "continuation") and has_multipliers:
        allowed = "the multipliers of a contact with a penetration change at each state; use auto or newton"
        raise InputError("drive.path_control", settings.path_control, allowed)
    if settings.path_control == "jump" and not has_potential:
        without = "projected and following forces have no energy to minimize, nor those of two half-passes"
        allowed = f"{without}; use continuation"
        raise InputError("drive.path_control", "jump", allowed)
