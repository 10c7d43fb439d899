"""The balance of energy along a path: what a step gains or releases beyond the work of its drive.

A body in equilibrium gains energy by the work of its drive alone, dissipated energy counted. So a step after
which there is more of it lies on another branch, which the body cannot have reached: a method that solves
equations, as Newton's, does not know. One after which there is less has passed a fall of energy, which may be
a jump, or physics that a long step has left out.
"""

from typing import NamedTuple

import numpy as np

from isopeel.assembly.system import System
from isopeel.solve.step import AcceptedState

#: Of the work of adhesion times the adhering length: energy that any step may gain.
GAIN = 1e-6
#: Of the drive's work in a step: what does not come from it is looked at. The smallest jumps over a snap-back
#: release some 1e-2 of it, and what the trapezoidal rule misses is some 1e-4 where a path is steep.
MISFIT = 1e-3
#: Of the work of the largest reaction of late: what a step may release or gain at most by the error of the
#: trapezoidal rule. Where that is more, a straight line between its ends hides what the reaction does. The
#: steps of the shipped cylinder, which read well, miss up to 1.5e-2 as it snaps on.
SLIGHT = 2e-2
#: On a smooth branch the error of the trapezoidal rule falls by eight with half of the step, to fifth order;
#: what a jump releases stays. So an energy that falls by this is such an error.
CUBIC = 1 / 5
#: How often the error of the trapezoidal rule, as the last states tell it, a step may be off. Eight paths of
#: tapes, cantilevers and pads have the same rows for 0.5 to 16; but branches are followed inside of steps 28
#: times at 4, 45 at 2 and 153 at 0.5.
_SAFETY = 4.0
#: Of an energy: its round-off, over the sums that it is made of.
ROUND_OFF = 1e-12
#: Of the work: what reactions are known to (see `isopeel.solve.quasi_newton`), with a margin of ten.
_REACTION = 1e-7


class Misfit(NamedTuple):
    """What a step gained without work, negative where it released energy, and whether that is too much."""

    gained: float
    gains: bool
    releases: bool
    is_slight: bool = False  # so little of the work that the trapezoidal rule may have missed it

    @property
    def fits(self) -> bool:
        """Whether the step neither gains nor releases too much."""
        return not (self.gains or self.releases)


NO_MISFIT = Misfit(0.0, gains=False, releases=False)


def released(one: AcceptedState, other: AcceptedState) -> float:
    """Work of the drive from one state to another, by the trapezoidal rule, less what the energy gained."""
    return one.energy + (one.rate + other.rate) / 2 * (other.parameter - one.parameter) - other.energy


def simpson_misfits(one: AcceptedState, half: AcceptedState, other: AcceptedState) -> tuple[float, float]:
    """Energy gained without work in both halves of a step, by the parabola through its three rates.

    Over both it is Simpson's rule (Davis and Rabinowitz, Methods of Numerical Integration, Sec. 2.2).
    """
    twelfth = (other.parameter - one.parameter) / 24
    before = twelfth * (5 * one.rate + 8 * half.rate - other.rate)
    beyond = twelfth * (5 * other.rate + 8 * half.rate - one.rate)
    return half.energy - one.energy - before, other.energy - half.energy - beyond


def gain_allowed(system: System) -> float:
    """Energy that any step of a system may gain without work: a share of what all of the joint is worth."""
    worth = system.problem.adhesion.law.work_of_adhesion * float(system.adhesive.weights.sum())
    return GAIN * worth + energy_round_off(system)


def energy_round_off(system: System) -> float:
    """Round-off of the stored energy: densities are differences of invariants that are near one."""
    return float(np.finfo(float).eps) * system.energy_scale


def misfit(last: list[AcceptedState], other: AcceptedState, allowed: float) -> Misfit:
    """Judge the step from the last of some states to another, by what is `allowed` or by its own work.

    The error of the trapezoidal rule over a step h is h^3/6 times the second divided difference of the rate
    (Davis and Rabinowitz, Methods of Numerical Integration, Sec. 2.1.4), which the last three states tell.
    """
    one = last[-1]
    p, rate = one.parameter, one.rate
    step = other.parameter - p
    size = abs(step)
    most = max(abs(rate), abs(other.rate)) * size
    round_off = ROUND_OFF * max(abs(one.energy), abs(other.energy)) + _REACTION * most
    error = 0.0
    if len(last) > 2:
        a, b = last[-3], last[-2]
        before, width = p - b.parameter, b.parameter - a.parameter
        if before * width > 0 and before * step > 0:
            change = (rate - b.rate) / before - (b.rate - a.rate) / width
            error = _SAFETY * size**3 / 6 * abs(change / (p - a.parameter))
    gained = -released(one, other)
    # where all energies are small beside that of the joint, as of a tape that buckles, the work tells
    # beside the largest reaction of late: as one fades, its relative error means nothing
    largest = max(abs(state.rate) for state in (*last, other))
    slight = max(SLIGHT * size * largest, MISFIT * allowed) + round_off
    enough = min(allowed, MISFIT * most) + min(error, slight) + round_off
    # whatever the reaction does between the ends, more than both tell of is not taken from the rule's error
    work = max(rate * step, other.rate * step)
    climbs = other.energy - one.energy - work > MISFIT * (most + allowed) + round_off
    is_slight = abs(gained) <= slight and not climbs
    return Misfit(gained, climbs or not gained <= enough, not -gained <= enough, is_slight)
