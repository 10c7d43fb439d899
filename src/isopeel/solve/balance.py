"""The balance of energy along a path: the energy that a step gains or releases beyond the work of its drive.

The energy of a body in equilibrium, dissipated energy included, grows by the work of its drive alone. A step
that gains more lies on another branch, which the body cannot have reached; Newton's method, which only solves
equations, cannot detect this. In a step that gains less, energy was released: by a jump, or by physics that a
long step has missed.
"""

from typing import NamedTuple

import numpy as np

from isopeel.assembly.system import System
from isopeel.solve.step import AcceptedState

#: Energy that any step may gain without work, as a share of the work of adhesion times the adhering length.
GAIN = 1e-6
#: Share of the drive's work in a step above which energy from elsewhere is examined. The smallest jumps over
#: a snap-back release about 1e-2 of the work; the trapezoidal rule misses about 1e-4 where a path is steep.
MISFIT = 1e-3
#: Share of the work of the largest recent reaction that the error of the trapezoidal rule may reach. A larger
#: error means that the reaction is not linear between the ends of the step. Steps of the shipped cylinder,
#: whose results are right, miss up to 1.5e-2 as it snaps on.
SLIGHT = 2e-2
#: On a smooth branch the error of the trapezoidal rule falls by a factor of eight with half of the step, to
#: fifth order; the energy that a jump releases stays. An energy that falls by this factor is such an error.
CUBIC = 1 / 5
#: Factor on the estimated error of the trapezoidal rule up to which the misfit of a step is accepted. Eight
#: paths of tapes, cantilevers and pads have the same rows for factors of 0.5 to 16; but branches are followed
#: inside steps 28 times at 4, 45 times at 2 and 153 times at 0.5.
_SAFETY = 4.0
#: Round-off of an energy, as a share of the sums that it is made of.
ROUND_OFF = 1e-12
#: Accuracy of reactions as a share of the work (see `isopeel.solve.quasi_newton`), with a margin of ten.
_REACTION = 1e-7


class Allowance(NamedTuple):
    """The energy that any step may gain without work, and whether that is at most a share of its work."""

    most: float
    by_work: bool

    def of_step(self, work: float) -> float:
        """Return the energy that a step may gain, by the size of its work."""
        return min(self.most, MISFIT * work) if self.by_work else self.most

    @property
    def slight(self) -> float:
        """The part of it that any step may gain or release, whatever its work."""
        return MISFIT * self.most if self.by_work else self.most


class Misfit(NamedTuple):
    """The energy that a step gained without work (negative: released), and whether it is too much."""

    gained: float
    gains: bool
    releases: bool
    is_slight: bool = False  # small enough to be an error of the trapezoidal rule

    @property
    def fits(self) -> bool:
        """Return whether the step neither gains nor releases too much energy."""
        return not (self.gains or self.releases)


NO_MISFIT = Misfit(0.0, gains=False, releases=False)


def released(one: AcceptedState, other: AcceptedState) -> float:
    """Return the work of the drive between two states, by the trapezoidal rule, minus the energy gained."""
    return one.energy + (one.rate + other.rate) / 2 * (other.parameter - one.parameter) - other.energy


def simpson_misfits(one: AcceptedState, half: AcceptedState, other: AcceptedState) -> tuple[float, float]:
    """Return the energies gained without work in both halves of a step, by the parabola through three rates.

    Their sum is Simpson's rule (Davis and Rabinowitz, Methods of Numerical Integration, Sec. 2.2).
    """
    twelfth = (other.parameter - one.parameter) / 24
    before = twelfth * (5 * one.rate + 8 * half.rate - other.rate)
    beyond = twelfth * (5 * other.rate + 8 * half.rate - one.rate)
    return half.energy - one.energy - before, other.energy - half.energy - beyond


def on_one_branch(one: AcceptedState, other: AcceptedState) -> bool:
    """Return whether the energy between two near states comes from the work, without any allowance."""
    step = other.parameter - one.parameter
    change = abs(other.rate - one.rate) * abs(step) / 6
    round_off = ROUND_OFF * max(abs(one.energy), abs(other.energy))
    return abs(released(one, other)) <= change + round_off + MISFIT * abs(one.rate * step)


def can_be_joined(one: AcceptedState, other: AcceptedState, step: float, allowed: float) -> bool:
    """Return whether a curve can join two states, by their energies.

    `step` is a usual step of the parameter, and `allowed` the energy that it may gain.
    """
    misfits = released(one, other)
    most = MISFIT * max(abs(one.rate), abs(other.rate)) * abs(step)
    # next to a limit point, where the rate goes with the root of the parameter, the error of the trapezoidal
    # rule is half of this
    change = abs((other.rate - one.rate) * (other.parameter - one.parameter)) / 3
    return abs(misfits) <= most and -misfits <= allowed + change


def joint_energy(system: System) -> float | None:
    """Return the work of adhesion of all interfaces times their areas; None if there is contact alone."""
    worth = sum(
        term.adhesion.law.work_of_adhesion * float(term.table.weights.sum()) for term in system.interfaces
    )
    return worth if worth or not system.interfaces else None


def allowance(joint: float | None, last: AcceptedState | None, round_off: float) -> Allowance:
    """Return the energy that a step may gain without work, after the last accepted state.

    It is a share of the energy of the `joint`. Contact without adhesion has none (None): its share is that of
    the energy which its bodies store. It is not bounded by the work of the step: bodies that slide without
    friction do no work but that of the discretization. This work changes its sign several times on each
    element, so that the trapezoidal rule may miss all of it.
    """
    if joint is not None:
        return Allowance(GAIN * joint + round_off, by_work=True)
    stored = 0.0 if last is None else abs(last.energy)
    return Allowance(GAIN * stored + round_off, by_work=False)


def energy_round_off(system: System) -> float:
    """Return the round-off of the stored energy, whose densities are differences of numbers near one."""
    return float(np.finfo(float).eps) * system.energy_scale


def misfit(last: list[AcceptedState], other: AcceptedState, allowed: Allowance, round_off: float) -> Misfit:
    """Return the misfit of the step from the last accepted state to another one.

    It is judged by the energy `allowed`, by the work of the step and by the `round_off` of the energies: that
    may be larger than the work where a weak joint holds a stiff body. The error of the trapezoidal rule over
    a step h is h^3/6 times the second divided difference of the rate (Davis and Rabinowitz, Methods of
    Numerical Integration, Sec. 2.1.4), which is taken from the last three states.
    """
    one = last[-1]
    p, rate = one.parameter, one.rate
    step = other.parameter - p
    size = abs(step)
    most = max(abs(rate), abs(other.rate)) * size
    round_off += ROUND_OFF * max(abs(one.energy), abs(other.energy)) + _REACTION * most
    error = 0.0
    if len(last) > 2:
        a, b = last[-3], last[-2]
        before, width = p - b.parameter, b.parameter - a.parameter
        if before * width > 0 and before * step > 0:
            change = (rate - b.rate) / before - (b.rate - a.rate) / width
            error = _SAFETY * size**3 / 6 * abs(change / (p - a.parameter))
    gained = -released(one, other)
    # the work decides where all energies are small beside that of the joint, as in a tape that buckles.
    # The largest recent reaction is the scale: the relative error of a vanishing one means nothing
    largest = max(abs(state.rate) for state in (*last, other))
    slight = max(SLIGHT * size * largest, allowed.slight) + round_off
    enough = allowed.of_step(most) + min(error, slight) + round_off
    # energy above the work by either end's reaction is never an error of the rule
    work = max(rate * step, other.rate * step)
    climbs = other.energy - one.energy - work > MISFIT * most + allowed.slight + round_off
    is_slight = abs(gained) <= slight and not climbs
    return Misfit(gained, climbs or not gained <= enough, not -gained <= enough, is_slight)
