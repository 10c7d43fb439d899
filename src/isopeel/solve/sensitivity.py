"""Sensitivities: the derivatives of the reaction by parameters of the problem, along a path.

At an equilibrium R(y, p, h; m) = 0 of unknowns y, the drive's parameter p and the history h before the step

    K dy/dm = -(dR/dm + dR/dh . dh/dm),    dr/dm = dr/dy . dy/dm + (dr/dm + dr/dh . dh/dm at fixed y),

where p is fixed: direct differentiation (Michaleris, Tortorelli and Vidal, Int. J. Numer. Meth. Engng. 37,
1994). The history after the step, h' = H(y, h; m), is differentiated in the same way. So the derivatives of
history and displacement are carried from step to step, with one solution for each parameter and step. Without
a history, and where K is symmetric, the one solution K a = dr/dy serves all parameters (adjoint method, same
source): dr/dm = dr/dm at fixed y - a . dR/dm. The derivatives at fixed y are central differences of the same
state on problems with other parameters, which the caller builds: they include all that depends on the
parameter, such as the geometry or the placing of bodies.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple, TypeAlias

import numpy as np

from isopeel.assembly.sizes import extent
from isopeel.assembly.spaces import HELD
from isopeel.assembly.system import Equilibrium, System
from isopeel.common.arrays import BoolArray, FloatArray, IntArray
from isopeel.common.errors import InputError
from isopeel.matrix.band import BandMatrix
from isopeel.matrix.bordered import Bordered
from isopeel.matrix.factor import Factor, SingularError
from isopeel.solve.stability import inertia
from isopeel.solve.step import Step

_AHEAD = ((0.0, -25 / 12), (1.0, 4.0), (2.0, -3.0), (3.0, 4 / 3), (4.0, -1 / 4))
#: Shifts and weights of differences of fourth order (Fornberg, Math. Comp. 51, 1988): the central one, and
#: those to one side, for parameters that cannot be varied to the other.
STENCILS = (
    ((-2.0, 1 / 12), (-1.0, -2 / 3), (1.0, 2 / 3), (2.0, -1 / 12)),
    _AHEAD,
    tuple((-shift, -weight) for shift, weight in _AHEAD),
)
#: Change of the drive's parameter that moves a body by this share of its size, for dR/dp.
_SMALL_MOTION = 1e-7


class Variant(NamedTuple):
    """The same system with a parameter that is larger by `shift`, and its weight in the difference."""

    system: System
    shift: float
    weight: float
    unknowns: IntArray  # (count,) for each of its unknowns, the number in the system that is varied


class Rates(NamedTuple):
    """Derivatives of a state by a parameter: of its displacement (size, 2) and of its history."""

    displacement: FloatArray
    history: FloatArray


def variant_of(system: System, other: System, shift: float, weight: float) -> Variant:
    """Return a system as a variant of another one. Raises InputError where their unknowns differ."""
    mine, theirs = system.constraints.unknowns, other.constraints.unknowns
    # where sides are tied, functions follow others only on meshes that do not match
    counts_differ = system.count != other.count or mine.shape != theirs.shape
    if counts_differ or ((mine == HELD) != (theirs == HELD)).any():
        raise InputError("mesh", None, "the mesh or its unknowns change")
    if system.maximum_openings.shape != other.maximum_openings.shape:
        raise InputError("mesh", None, "the elements of an interface change")
    numbers = np.arange(other.count)
    moves = mine != HELD
    numbers[theirs[moves]] = mine[moves]
    return Variant(other, shift, weight, numbers)


class Sensitivities:
    """The sensitivities of the steps of one path, which it receives in their order.

    `variants` has those of each parameter, and `rates` the derivatives of the state that the path begins
    with, where it is not the bodies as they are; None where these do not exist, so that all sensitivities are
    NaN. `history` is the history of that state.
    """

    def __init__(
        self,
        system: System,
        variants: Sequence[Sequence[Variant]],
        history: FloatArray | None = None,
        rates: Sequence[Rates] | None = (),
    ) -> None:
        self._begins = rates is not None
        self._system = system if history is None else system.after(history)
        #: The systems of each parameter, whose weighted sums are derivatives.
        self.variants = variants
        #: The same with the terms alone that depend on the parameter, for derivatives at fixed unknowns.
        self._partial = [_of_differing(system, several) for several in variants]
        if rates:
            self._history = [one.history for one in rates]
        else:
            at_rest = [[one.system.maximum_openings for one in several] for several in variants]
            self._history = [_history_rate(*one) for one in zip(variants, at_rest, strict=True)]
        #: Which variables of the history have no known derivative.
        self._unknown: BoolArray = np.zeros(self._system.maximum_openings.shape, dtype=np.bool_)
        self._last: _Solution | None = None

    def of(self, step: Step) -> tuple[float, ...]:
        """Return dr/dm of each parameter at the next step of the path, at a fixed parameter of the drive.

        It is NaN at a limit point, where it does not exist, and as long as the state depends on the history
        of such a point. Units are those of the problem, and of the shifts of the variants.
        """
        system, history = self._system, step.maximum_openings
        exists = self._begins and step.kind != "limit point"
        found = self._solved(system, step) if exists else None
        stays = history == system.maximum_openings
        if found is not None and system.irreversible:
            self._history = [
                _history_rate(several, _values(several, found.at(k, self._history), _committed))
                for k, several in enumerate(self.variants)
            ]
        # a history that goes on from here is known again
        self._unknown = self._unknown & stays if found is not None else self._unknown | ~stays
        self._system, self._last = system.after(history), found
        if found is None or self._unknown.any():
            return (np.nan,) * len(self.variants)
        return tuple(found.reactions)

    def rates(self) -> list[Rates] | None:
        """Return the derivatives of the state of the last step; None where they do not exist."""
        last = self._last
        if last is None or self._unknown.any():
            return None
        moved = [
            _total(several, last.at(k, self._history), _displaced) for k, several in enumerate(self.variants)
        ]
        return [Rates(*one) for one in zip(moved, self._history, strict=True)]

    def _solved(self, system: System, step: Step) -> "_Solution | None":
        """Return dr/dm and dy/dm of each parameter; None where the tangent is singular."""
        y, p = step.unknown_values, step.parameter
        u, load = system.state(y, p)
        equilibrium, matrix = system.linearize(u, load=load)
        try:
            factor: Factor = inertia(system, matrix, u, p).factor
        except SingularError:
            return None
        # derivatives have errors of first order in that of the state
        y = y - factor.solve(_residual(system, equilibrium, u, p))
        found = _Solution(p, y, system.maximum_openings, factor)
        gradient = _gradient(system, y, p)
        # dr/dy . K^-1: one solution for all parameters; those with a history need dy/dm in any case
        adjoint: FloatArray | None = None
        if gradient is not None and not system.irreversible and _is_symmetric(matrix, factor):
            adjoint = factor.solve(gradient)
        for k, several in enumerate(self.variants):
            fixed = _Moving(p, y, np.zeros(system.count), found.history, self._history[k])
            partial = _total(self._partial[k], fixed, _balance)
            found.partial.append(partial[:-1])
            if adjoint is not None:
                found.reactions.append(float(partial[-1] - adjoint @ partial[:-1]))
            elif gradient is not None:
                found.reactions.append(float(partial[-1] + gradient @ found.rate(k)))
            else:
                whole = _total(several, found.at(k, self._history), _balance)
                found.reactions.append(float(whole[-1]))
        return found


def _is_symmetric(matrix: BandMatrix, factor: Factor) -> bool:
    """Return whether a matrix is symmetric with the border that its factor may have."""
    border = factor.border if isinstance(factor, Bordered) else None
    return matrix.storage == "symmetric" and (border is None or np.array_equal(border.column, border.row))


def _of_differing(system: System, variants: Sequence[Variant]) -> list[Variant]:
    """Return variants without the terms that are the same in all of them: their differences cancel.

    All terms are kept where the coefficients of the same unknowns differ, or those that the drive moves.
    """
    mine, kept = system.constraints, set()
    for one in variants:
        other = one.system.constraints
        if not (
            np.array_equal(mine.offset, other.offset)
            and np.array_equal(mine.unknowns, other.unknowns)
            and np.array_equal(mine.driven, other.driven)
            and all(map(np.array_equal, mine.tied.followers, other.tied.followers))
            and all(
                np.array_equal(a.points, b.points) and a.factor == b.factor and a.constraint == b.constraint
                for a, b in zip(mine.motions, other.motions, strict=True)
            )
        ):
            return list(variants)
        kept |= {*system.equations.terms.differing(one.system.equations.terms)}
    if system.irreversible:
        kept |= {t for t, term in enumerate(system.terms) if term in system.interfaces}
    return [one._replace(system=one.system.only(sorted(kept))) for one in variants]


class _Moving(NamedTuple):
    """A state, from a history, and the rates at which its unknowns and the history change."""

    parameter: float
    unknown_values: FloatArray
    rate: FloatArray
    history: FloatArray
    history_rate: FloatArray


@dataclass(frozen=True, eq=False)
class _Solution:
    """A state, the factor of its tangent, and for each parameter of the problem dr/dm and dR/dm (count,).

    The latter are at fixed unknowns.
    """

    parameter: float
    unknown_values: FloatArray
    history: FloatArray  # before the step
    factor: Factor
    reactions: list[float] = field(default_factory=list)
    partial: list[FloatArray] = field(default_factory=list)
    _rates: dict[int, FloatArray] = field(default_factory=dict)

    def rate(self, number: int) -> FloatArray:
        """Return dy/dm (count,) of the parameter of a number."""
        if number not in self._rates:
            self._rates[number] = -self.factor.solve(self.partial[number])
        return self._rates[number]

    def at(self, number: int, history_rates: Sequence[FloatArray]) -> _Moving:
        """Return the state as it changes by the parameter of a number."""
        rate, history_rate = self.rate(number), history_rates[number]
        return _Moving(self.parameter, self.unknown_values, rate, self.history, history_rate)


#: A function of a variant, its unknowns and the drive's parameter.
_Function: TypeAlias = Callable[[Variant, FloatArray, float], FloatArray]


def _values(variants: Sequence[Variant], at: _Moving, of: _Function) -> list[FloatArray]:
    """Return the values of a function in all variants, for a state that changes with the parameter."""
    values = []
    for one in variants:
        if one.system.irreversible:
            history = at.history + one.shift * at.history_rate
            # a negative number is a state of its own, such as that of a point that has not closed yet
            history = np.where(at.history < 0, history, np.maximum(history, 0.0))
            one = one._replace(system=one.system.after(history))
        moved = (at.unknown_values + one.shift * at.rate)[one.unknowns]
        values.append(of(one, moved, at.parameter))
    return values


def _total(variants: Sequence[Variant], at: _Moving, of: _Function) -> FloatArray:
    """Return the total derivative of a function by the parameter."""
    return _weighted(variants, _values(variants, at, of))


def _weighted(variants: Sequence[Variant], values: Sequence[FloatArray]) -> FloatArray:
    total = variants[0].weight * values[0]
    for one, value in zip(variants[1:], values[1:], strict=True):
        total += one.weight * value
    return total


def _history_rate(variants: Sequence[Variant], histories: Sequence[FloatArray]) -> FloatArray:
    """Return the derivative of a history, from its values in all variants."""
    waits = np.min(histories, axis=0) < 0
    rate: FloatArray = np.where(waits, 0.0, _weighted(variants, histories))
    return rate


def with_sensitivities(steps: Iterable[Step], sensitivities: Sensitivities | None) -> Iterator[Step]:
    """Yield the steps of a path, with their sensitivities if there are any."""
    for step in steps:
        yield step if sensitivities is None else replace(step, sensitivities=sensitivities.of(step))


def _committed(one: Variant, y: FloatArray, parameter: float) -> FloatArray:
    """Return the history after a step to unknowns y (count,)."""
    return one.system.commit(_displaced(one, y, parameter))


def _displaced(one: Variant, y: FloatArray, parameter: float) -> FloatArray:
    """Return the coefficients (size, 2) of the displacement."""
    return one.system.state(y, parameter)[0]


def _balance(one: Variant, y: FloatArray, parameter: float) -> FloatArray:
    """Return residual (count,), in the order of the system that is varied, and the reaction (1,)."""
    system = one.system
    u, load = system.state(y, parameter)
    equilibrium = system.equilibrium(u, load)
    found = np.empty(system.count + 1)
    found[one.unknowns] = _residual(system, equilibrium, u, parameter)
    found[-1] = system.reaction(equilibrium, u, load, parameter)
    return found


def _residual(system: System, equilibrium: Equilibrium, u: FloatArray, parameter: float) -> FloatArray:
    """Return the residual of all unknowns (count,)."""
    if not system.global_unknowns:
        return equilibrium.residual
    return np.append(equilibrium.residual, parameter - system.control.displacement(u))


def _gradient(system: System, y: FloatArray, parameter: float) -> FloatArray | None:
    """Return dr/dy (count,); None where it is not symmetric to dR/dp, as forces have no potential."""
    if system.global_unknowns:
        return np.append(np.zeros(system.count - 1), 1.0)
    if system.control.raises_load:
        return system.constraints.condense(system.control.pattern())
    if not system.has_potential:
        return None
    fastest = float(np.abs(system.constraints.rate(parameter)).max())
    small = _SMALL_MOTION * extent(system.problem) / fastest
    ahead, behind = (
        system.equilibrium(system.state(y, parameter + sign * small)[0]).residual for sign in (1, -1)
    )
    gradient: FloatArray = (ahead - behind) / (2 * small)
    return gradient
