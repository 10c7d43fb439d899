"""Uzawa's loop: equilibria between updates of the multipliers of contact, at one value of the parameter."""

from dataclasses import replace

from isopeel.assembly.multipliers import remaining
from isopeel.assembly.system import System
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.newton import NewtonResult, NewtonSettings, newton

#: Most updates. Each leaves about 1/(1 + k h/E') of the gaps, with the stiffness k and the length h of an
#: element: a tenth with the stiffness that is chosen if none is given.
_MOST = 100


def augmented(system: System, found: NewtonResult, settings: NewtonSettings) -> NewtonResult:
    """Return the equilibrium whose points in contact have small gaps, from one after the system's history.

    Its `history` has the multipliers with which it was found. The same result is returned where no interface
    has multipliers. Raises ConvergenceError where the gaps stay large.
    """
    if not system.has_multipliers:
        return found
    if found.history is not None:
        system = system.after(found.history)
    for _ in range(_MOST):
        left = remaining(system, found.displacement)
        if left.is_allowed:
            return replace(found, history=system.maximum_openings, uncertain_energy=left.energy)
        system = system.after(left.history)
        before = found.iterations
        found = newton(system, found.unknown_values, found.parameter, settings)
        found = replace(found, iterations=before + found.iterations)
    reason = (
        f"after {_MOST} updates of the multipliers, points in contact at {left.name} have gaps up to"
        f" {left.gap:.3g} L0, more than the penetration {left.allowed:.3g} L0 that is allowed"
    )
    raise ConvergenceError(reason, found.iterations, found.parameter, "penetration")
