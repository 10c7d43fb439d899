"""The first equilibrium under held loads, which are applied in parts."""

from dataclasses import replace

import numpy as np

from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.newton import NewtonResult, NewtonSettings, newton

#: Smallest part that is tried: as a share of the loads that have an equilibrium, and of all held loads.
_SMALL, _SMALLEST = 2.0**-7, 2.0**-20


def applied_in_parts(system: System, parameter: float, settings: NewtonSettings) -> NewtonResult | None:
    """Return the equilibrium under all held loads; None where there is none without them either.

    Each part starts from the line through the last two equilibria. It is halved where no stable equilibrium
    is found from there. Raises ConvergenceError, with the cause "held load", where the smallest part fails.
    """
    try:
        found = newton(system.under(0.0), np.zeros(system.count), parameter, settings)
    except ConvergenceError:
        return None
    # an unloaded body that is not stable may be so under its loads
    stable = found.definite is not False
    iterations, slope = found.iterations, np.zeros(system.count)
    share, part = 0.0, 0.5
    while share < 1.0:
        aim = min(share + part, 1.0)
        lighter = system if aim == 1.0 else system.under(aim)
        new = _from(lighter, found.unknown_values + (aim - share) * slope, parameter, settings)
        if new is None or (stable and new.definite is False):
            part /= 2
            if part < max(_SMALL * share, _SMALLEST):
                found_under = f"an equilibrium is found under {100 * share:.3g} % of the held loads"
                reason = f"{found_under}, and no stable one near it under larger ones"
                if not share:
                    reason = f"no stable equilibrium is found, even under {_SMALLEST:.0e} of the held loads"
                raise ConvergenceError(reason, (), parameter, "held load")
            continue
        slope = (new.unknown_values - found.unknown_values) / (aim - share)
        iterations += new.iterations
        found, share, part = new, aim, 2 * part
    return replace(found, iterations=iterations)


def _from(
    system: System, start: FloatArray, parameter: float, settings: NewtonSettings
) -> NewtonResult | None:
    try:
        return newton(system, start, parameter, settings)
    except ConvergenceError:
        return None
