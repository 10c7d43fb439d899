"""A cause of failure: a point slides off the end of the side of another body that it adheres to."""

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

    Beyond the end of the other side a point has no partner, so that the energy of the interface jumps there.
    The state at the parameter of the error is extrapolated from the last ones.
    """
    if error.cause not in _OF_A_JUMP or not path.history or not path.system.facing:
        return error
    system, last = path.system, path.history[-1]
    before, _ = system.state(last.unknown_values, last.parameter)
    beyond, _ = system.state(path.solver.parabola(error.parameter), error.parameter)
    for term in system.facing:
        if term.energy_off_the_end(before, beyond) > path.gain_allowed:
            own, other = boundary_names([term.adhesion.boundary, term.against])
            reason = f"a point of {own} slides off the end of {other}, where the energy jumps; {error.reason}"
            return ConvergenceError(reason, error.iterations, error.parameter, "lost partner")
    return error
