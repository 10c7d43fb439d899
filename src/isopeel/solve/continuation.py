"""The equilibrium path as a curve, through limit points, by steps of its arc length."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from isopeel.assembly.system import Equilibrium, System
from isopeel.common.arrays import FloatArray
from isopeel.matrix.band import BandMatrix
from isopeel.matrix.bordered import Border, Bordered
from isopeel.matrix.factor import Factor, NotPositiveDefiniteError, SingularError
from isopeel.matrix.factorize import factorize
from isopeel.matrix.ldl import BandLDL
from isopeel.solve.newton import INVERTED, ConvergenceError, NewtonResult, NewtonSettings

#: Of the parameter's step: over which its derivative is taken. The error is of the square, and of round-off.
_DIFFERENCE = 1e-3
#: Tangents that the corrections of one arc-length step take; more mean that it was too long.
_MOST_TANGENTS = 4
#: Tangents that the radius is chosen for.
USUAL_TANGENTS = 2
#: Of the energy residual before: a kept tangent is quick enough where a correction leaves no more. A new one
#: takes as long as some twenty corrections.
_QUICK = 0.3
#: Of Newton's tolerance: the one for corrections with a kept tangent.
_LEFT = 0.01
#: Cosine of the angles between the tangents at both ends of a step and its chord, at least.
LEAST_COSINE = 0.8
#: The same where the radius may grow.
CALM_COSINE = 0.95
#: Of the first radius: a shorter step is given up.
SHORTEST = 2.0**-20
#: Share of the parameter in the tangent at a limit point, at most: its error in the parameter is the square.
_TURNED = 1e-6
#: Of the change of the parameter in a step: how near its value is approached before Newton's method ends it.
_MET = 1e-10
#: Of the value before: a trial of a search along the curve that comes no nearer is slow.
_SLOW = 0.5
#: Points that such a search interpolates.
_INTERPOLATED = 4
#: Trials of such a search: enough to halve a step down to round-off, were each second one slow.
_MOST_TRIALS = 120


@dataclass(frozen=True, eq=False)
class Point:
    """An equilibrium on the curve, and the curve's unit tangent there, in the metric of its arc length."""

    parameter: float
    unknown_values: FloatArray  # (count,)
    along: FloatArray  # (count,), the tangent's part of the unknowns
    turning: float  # the tangent's part of the parameter: it vanishes at a limit point
    negative: int | None  # eigenvalues of the tangent matrix; not known without a potential
    displacement: FloatArray
    load: float
    equilibrium: Equilibrium
    iterations: tuple[float, ...]
    tangents: int  # that its corrections took

    @property
    def result(self) -> NewtonResult:
        """The same as Newton's method has it."""
        return NewtonResult(
            self.unknown_values, self.displacement, self.load, self.equilibrium, self.iterations
        )


class _Tangent(NamedTuple):
    """Linearization of F(y, p) at a state."""

    at: Equilibrium
    values: FloatArray  # F, (count,)
    factor: Factor  # of dF/dy
    by_parameter: FloatArray  # dF/dp, (count,)
    negative: int | None
    displacement: FloatArray
    load: float


class Curve:
    """Equilibria F(y, p) = 0 as a curve, near a state whose slope dy/dp gives its arc length a scale.

    ds^2 = |dy|^2 / n + (scale dp)^2 over the n unknowns of the displacement, where `scale` is the root of
    |dy/dp|^2 / n at the first point: there the parameter and the unknowns count the same, whatever their
    units. Steps are Keller's: the tangent as a guess, and corrections at right angles to it by the
    linearization there, made anew where it does not lead on quickly (Keller, Numerical Solution of
    Bifurcation and Nonlinear Eigenvalue Problems, 1977).
    """

    def __init__(
        self, system: System, settings: NewtonSettings, y: FloatArray, parameter: float, step: float
    ) -> None:
        self._system = system
        self._threshold = settings.tolerance * system.energy_scale
        self._difference = _DIFFERENCE * abs(step)
        self._n = system.constraints.count
        tangent = self._linearize(y, parameter)
        slope = -tangent.factor.solve(tangent.by_parameter)
        self._scale = float(np.sqrt(slope[: self._n] @ slope[: self._n] / self._n))
        size = np.sqrt(2.0) * self._scale
        direction = np.sign(step)
        #: Where the curve begins.
        self.start = Point(
            parameter,
            y,
            direction * slope / size,
            float(direction / size),
            tangent.negative,
            tangent.displacement,
            tangent.load,
            tangent.at,
            (),
            0,
        )
        #: Radius that the first step of the parameter would have.
        self.radius = float(size * abs(step))

    def share(self, point: Point) -> float:
        """Share of the parameter in the tangent: 1/sqrt(2) at the start, and zero at a limit point."""
        return self._scale * point.turning

    def cosine(self, one: Point, other: Point) -> float:
        """Of the angle between the tangents of two points."""
        return self._inner(one.along, one.turning, other.along, other.turning)

    def straightness(self, one: Point, other: Point) -> float:
        """The least cosine of the angles between the tangents of two points and the chord.

        The chord is the one to tell where another stretch of the curve, which passes nearby, was met.
        """
        y, p = other.unknown_values - one.unknown_values, other.parameter - one.parameter
        chord = np.sqrt(self._inner(y, p, y, p))
        ends = [self._inner(point.along, point.turning, y, p) / chord for point in (one, other)]
        return float(min(self.cosine(one, other), *ends))

    def beyond(self, point: Point, radius: float) -> Point:
        """The point at a distance along the tangent of another; raises ConvergenceError."""
        row, corner = self._row(point)
        y = point.unknown_values + radius * point.along
        parameter = point.parameter + radius * point.turning
        return self._corrected(y, parameter, row, corner, point)

    def at_parameter(self, one: Point, other: Point, parameter: float) -> Point:
        """The point at a parameter between two with no limit point in between; raises ConvergenceError.

        Newton's method from the chord finds it. Next to a limit point, where there are two, it may find the
        other one: then the parameter is approached along the curve first.
        """
        share = (parameter - one.parameter) / (other.parameter - one.parameter)
        chord = one.unknown_values + share * (other.unknown_values - one.unknown_values)
        length, rises = self._along(one, other), other.parameter > one.parameter
        held = np.zeros(self._system.count)
        try:
            found = self._corrected(chord, parameter, held, 1.0, other)
            if (found.turning > 0) == rises and 0 <= self._along(one, found) <= length:
                return found
        except (ConvergenceError, SingularError):
            pass

        def missed(point: Point) -> float:
            return point.parameter - parameter

        near = self._between(one, other, missed, _MET * abs(other.parameter - one.parameter))
        return self._corrected(near.unknown_values, parameter, held, 1.0, other)

    def limit_point(self, one: Point, other: Point) -> Point:
        """The limit point between two, whose tangents point forth and back; raises ConvergenceError."""
        from scipy.interpolate import CubicHermiteSpline

        # where a cubic through both, with their tangents, turns
        length = self._along(one, other)
        ends = [0.0, length], [one.parameter, other.parameter], [one.turning, other.turning]
        turns = [float(at) for at in CubicHermiteSpline(*ends).derivative().roots() if 0 < at < length]
        return self._between(one, other, self.share, _TURNED, turns[0] if turns else None)

    def _between(
        self,
        one: Point,
        other: Point,
        function: Callable[[Point], float],
        enough: float,
        guess: float | None = None,
    ) -> Point:
        """The point between two where a function vanishes, which has different signs there.

        The first trial is at a guess of the distance, if there is one. To the next one leads inverse
        interpolation of the distance by the function's values, at up to four points next to zero; where a
        trial came no nearer, the middle.
        """
        from scipy.interpolate import krogh_interpolate

        first = one
        tried = [(function(point), self._along(first, point), point) for point in (one, other)]
        falls, last, slow = tried[0][0] > 0, np.inf, False
        low, high = 0.0, tried[1][1]
        for _ in range(_MOST_TRIALS):
            tried = sorted(tried, key=lambda trial: abs(trial[0]))[:_INTERPOLATED]
            values, places, points = zip(*tried, strict=True)
            at, guess = guess or float(krogh_interpolate(values, places, 0.0)), None
            if slow or not low < at < high:
                at = (low + high) / 2
            found = self.beyond(points[0], (at - places[0]) / self.cosine(first, points[0]))
            value, at = function(found), self._along(first, found)
            if abs(value) <= enough:
                break
            slow, last = not slow and abs(value) > _SLOW * last, abs(value)
            tried.append((value, at, found))
            if (value > 0) == falls:
                low = max(low, at)
            else:
                high = min(high, at)
        return found

    def _corrected(
        self, y: FloatArray, parameter: float, row: FloatArray, corner: float, towards: Point
    ) -> Point:
        """Correct a guess with the tangent there, which is made anew where it does not lead on quickly."""
        measures: list[float] = []
        for tangents in range(1, _MOST_TANGENTS + 1):
            t = self._linearize(y, parameter)
            eliminated = t.factor.solve(t.by_parameter)
            at, values, threshold, last = t.at, t.values, self._threshold, np.inf
            while True:
                if not np.isfinite(values).all() or at.lowest_determinant <= 0:
                    raise ConvergenceError(INVERTED, tuple(measures), parameter)
                partial = t.factor.solve(values)
                change = float(row @ partial) / (corner - float(row @ eliminated))
                correction = -partial - change * eliminated
                # with signs, terms of an indefinite tangent could cancel
                measure = float(np.abs(values * correction).sum()) / len(y)
                measures.append(measure)
                if not np.isfinite(measure):
                    raise ConvergenceError("the arc-length step diverges", tuple(measures), parameter)
                y, parameter = y + correction, parameter + change
                if measure <= threshold:
                    return self._point(y, parameter, towards, tuple(measures), tangents)
                if measure > _QUICK * last:
                    break
                at, values = self._forces(y, parameter)
                # what a correction with a tangent of elsewhere leaves is more than Newton's method would
                threshold, last = _LEFT * self._threshold, measure
        raise ConvergenceError("the arc-length step does not converge", tuple(measures), parameter)

    def _point(
        self,
        y: FloatArray,
        parameter: float,
        towards: Point,
        iterations: tuple[float, ...],
        tangents: int,
    ) -> Point:
        # the tangent before the last correction would not do: near a limit point that is large, as K is soft
        t = self._linearize(y, parameter)
        row, corner = self._row(towards)
        eliminated = t.factor.solve(t.by_parameter)
        turning = 1.0 / (corner - float(row @ eliminated))
        along = -turning * eliminated
        size = np.sqrt(self._inner(along, turning, along, turning))
        if not np.isfinite(size) or t.at.lowest_determinant <= 0:
            raise ConvergenceError(INVERTED, iterations, parameter)
        return Point(
            parameter,
            y,
            along / size,
            float(turning / size),
            t.negative,
            t.displacement,
            t.load,
            t.at,
            iterations,
            tangents,
        )

    def _linearize(self, y: FloatArray, parameter: float) -> _Tangent:
        system = self._system
        u, load = system.state(y, parameter)
        at, matrix = system.linearize(u, load=load)
        factor, negative = _factorized(matrix)
        values = at.residual
        if system.load_is_unknown:
            missed, column, row = system.control(u, parameter)
            values = np.append(values, missed)
            bordered = Bordered.of(factor, Border(column, row))
            factor = bordered
            if negative is not None and float(row @ bordered.eliminated) < 0:
                negative -= 1  # what the control holds
        h = self._difference
        by_parameter = (self._values(y, parameter + h) - self._values(y, parameter - h)) / (2 * h)
        return _Tangent(at, values, factor, by_parameter, negative, u, load)

    def _values(self, y: FloatArray, parameter: float) -> FloatArray:
        return self._forces(y, parameter)[1]

    def _forces(self, y: FloatArray, parameter: float) -> tuple[Equilibrium, FloatArray]:
        u, load = self._system.state(y, parameter)
        at = self._system.equilibrium(u, load)
        if not self._system.load_is_unknown:
            return at, at.residual
        return at, np.append(at.residual, self._system.control(u, parameter)[0])

    def _row(self, point: Point) -> tuple[FloatArray, float]:
        row = point.along / self._n
        row[self._n :] = 0.0
        return row, self._scale**2 * point.turning

    def _inner(self, y: FloatArray, p: float, other_y: FloatArray, other_p: float) -> float:
        n = self._n
        return float(y[:n] @ other_y[:n]) / n + self._scale**2 * p * other_p

    def _along(self, one: Point, other: Point) -> float:
        y, p = other.unknown_values - one.unknown_values, other.parameter - one.parameter
        return self._inner(one.along, one.turning, y, p)


def _factorized(matrix: BandMatrix) -> tuple[Factor, int | None]:
    try:
        return factorize(matrix), 0 if matrix.storage == "symmetric" else None
    except NotPositiveDefiniteError:
        factor = BandLDL.of(matrix)
        return factor, factor.negative
