"""A cause of failure: a point loses its partner on the side of another body that it adheres to."""

from isopeel.problem.boundary import boundary_names
from isopeel.solve.convergence import Cause, ConvergenceError
from isopeel.solve.path import Path

#: Causes that a jump of the energy may have.
_OF_A_JUMP: tuple[Cause, ...] = (
    "energy without work",
    "instability",
    "stalled residual",
    "line search",
    "iteration limit",
)


def with_lost_partner(path: Path, error: ConvergenceError) -> ConvergenceError:
    """Return the error, with a point that loses its partner as its cause, where one does.

    A point has no partner beyond the end of the other side, and where it turns away from that side, as that
    of a soft joint of a tape which is folded back. The energy of the interface jumps there. The state at the
    parameter of the error is extrapolated from the last ones.
    """
    if error.cause not in _OF_A_JUMP or not path.history or not path.system.facing:
        return error
    system, last = path.system, path.history[-1]
    before, _ = system.state(last.unknown_values, last.parameter)
    beyond, _ = system.state(path.solver.parabola(error.parameter), error.parameter)
    for term in system.facing:
        off, away = term.energy_without_partner(before, beyond)
        if max(off, away) > path.gain_allowed:
            own, other = boundary_names([term.adhesion.boundary, term.against])
            what = f"slides past the end of {other}" if off > away else f"turns away from {other}"
            reason = f"a point of {own} {what}, where the energy jumps; {error.reason}"
            return ConvergenceError(reason, error.iterations, error.parameter, "lost partner")
    return error
