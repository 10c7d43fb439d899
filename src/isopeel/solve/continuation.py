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

#: Share of the parameter's step over which its derivative is taken; the error goes with the square of it.
_DIFFERENCE = 1e-3
#: Most tangents of the corrections of one arc-length step; more mean that the step was too long.
_MOST_TANGENTS = 4
#: Number of tangents that the radius is chosen for.
USUAL_TANGENTS = 2
#: A chord tangent is used again if each correction leaves at most this share of the energy residual. A new
#: tangent takes as long as about twenty corrections.
_QUICK = 0.3
#: Share of Newton's tolerance for corrections with a chord tangent.
_LEFT = 0.01
#: Least cosine of the angles between the tangents at both ends of a step and its chord.
LEAST_COSINE = 0.8
#: The same where the radius may grow.
CALM_COSINE = 0.95
#: Least radius, as a share of the first radius.
SHORTEST = 2.0**-20
#: Largest share of the parameter in the tangent at a limit point; the error in the parameter is its square.
_TURNED = 1e-6
#: Share of the parameter's change in a step to which a value is approached before Newton's method finishes
#: it.
_MET = 1e-10
#: A trial of a root search along the curve is slow if more than this share of the last value remains.
_SLOW = 0.5
#: Number of points that such a search interpolates.
_INTERPOLATED = 4
#: Most trials of such a search: enough to halve a step down to round-off, even if each second trial is slow.
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
    tangents: int  # number that its corrections took

    @property
    def result(self) -> NewtonResult:
        """The point as a result of Newton's method."""
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
    units. Steps are Keller's: the tangent gives the guess, and corrections at right angles to it use the
    linearization there, which is made anew where it converges slowly (Keller, Numerical Solution of
    Bifurcation and Nonlinear Eigenvalue Problems, 1977).
    """

    def __init__(
        self, system: System, settings: NewtonSettings, y: FloatArray, parameter: float, step: float
    ) -> None:
        #: The system after the history of the last step.
        self.system = system
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
        """Return the share of the parameter in the tangent: 1/sqrt(2) at the start, zero at a limit point."""
        return self._scale * point.turning

    def cosine(self, one: Point, other: Point) -> float:
        """Return the cosine of the angle between the tangents of two points."""
        return self._inner(one.along, one.turning, other.along, other.turning)

    def straightness(self, one: Point, other: Point) -> float:
        """Return the least cosine of the angles between the tangents of two points and their chord.

        The angle with the chord is large where the second point lies on another stretch of the curve nearby.
        """
        y, p = other.unknown_values - one.unknown_values, other.parameter - one.parameter
        chord = np.sqrt(self._inner(y, p, y, p))
        ends = [self._inner(point.along, point.turning, y, p) / chord for point in (one, other)]
        return float(min(self.cosine(one, other), *ends))

    def beyond(self, point: Point, radius: float) -> Point:
        """Return the point at a distance along the tangent of another point; raises ConvergenceError."""
        row, corner = self._row(point)
        y = point.unknown_values + radius * point.along
        parameter = point.parameter + radius * point.turning
        return self._corrected(y, parameter, row, corner, point)

    def at_parameter(self, one: Point, other: Point, parameter: float) -> Point:
        """Return the point at a parameter between two points without a limit point between them.

        It is found by Newton's method from the chord. Next to a limit point, where there are two solutions,
        Newton's method may find the other one: then the parameter is first approached along the curve. Raises
        ConvergenceError.
        """
        share = (parameter - one.parameter) / (other.parameter - one.parameter)
        chord = one.unknown_values + share * (other.unknown_values - one.unknown_values)
        length, rises = self._along(one, other), other.parameter > one.parameter
        held = np.zeros(self.system.count)
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
        """Return the limit point between two points, whose tangents point in opposite directions.

        Raises ConvergenceError.
        """
        from scipy.interpolate import CubicHermiteSpline

        # the first guess is where the cubic through both points and tangents turns
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
        """Return the point between two others at which a function is zero; it has opposite signs at these.

        The first trial is at a guess of the distance, if there is one. The next trials follow from inverse
        interpolation of the distance over the function's values, at the four points closest to zero; after a
        slow trial the middle is tried.
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
        """Return the corrected guess, with a chord tangent that is made anew where it converges slowly."""
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
                # the magnitudes are summed, as terms of an indefinite tangent could cancel
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
                # a correction with a chord tangent leaves more error than one of Newton's method
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
        # the tangent before the last correction is not exact enough: near a limit point, where K is soft,
        # that correction is large
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
        system = self.system
        u, load = system.state(y, parameter)
        at, matrix = system.linearize(u, load=load)
        factor, negative = _factorized(matrix)
        values = at.residual
        if system.global_unknowns:
            missed, column, row = system.control.equation(u, parameter)
            values = np.append(values, missed)
            bordered = Bordered.of(factor, Border(column, row))
            factor = bordered
            if negative is not None and float(row @ bordered.eliminated) < 0:
                negative -= 1  # the prescribed displacement holds this direction
        h = self._difference
        by_parameter = (self._values(y, parameter + h) - self._values(y, parameter - h)) / (2 * h)
        return _Tangent(at, values, factor, by_parameter, negative, u, load)

    def _values(self, y: FloatArray, parameter: float) -> FloatArray:
        return self._forces(y, parameter)[1]

    def _forces(self, y: FloatArray, parameter: float) -> tuple[Equilibrium, FloatArray]:
        u, load = self.system.state(y, parameter)
        at = self.system.equilibrium(u, load)
        if not self.system.global_unknowns:
            return at, at.residual
        return at, np.append(at.residual, self.system.control.equation(u, parameter)[0])

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
