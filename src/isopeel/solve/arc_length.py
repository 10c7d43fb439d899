"""The equilibrium path as a curve with an arc length, through limit points: its points and its tangents."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from isopeel.assembly.system import Equilibrium, System
from isopeel.common.arrays import FloatArray
from isopeel.matrix.factor import Factor
from isopeel.solve.convergence import INVERTED, ConvergenceError
from isopeel.solve.newton import NewtonResult, NewtonSettings
from isopeel.solve.stability import inertia

#: Share of the parameter's step over which its derivative is taken; the error goes with the square of it.
_DIFFERENCE = 1e-3
#: Most tangents of the corrections of one arc-length step; more mean that the step was too long.
_MOST_TANGENTS = 4
#: A chord tangent is used again if each correction leaves at most this share of the energy residual. A new
#: tangent takes as long as about twenty corrections.
_QUICK = 0.3
#: Share of Newton's tolerance for corrections with a chord tangent.
_LEFT = 0.01


@dataclass(frozen=True, eq=False)
class Point:
    """An equilibrium on the curve, and the curve's unit tangent there, in the metric of its arc length."""

    result: NewtonResult
    along: FloatArray  # (count,), the tangent's part of the unknowns
    turning: float  # the tangent's part of the parameter: it vanishes at a limit point
    negative: int | None  # eigenvalues of the tangent matrix; not known without a potential
    tangents: int  # number that its corrections took

    @property
    def parameter(self) -> float:
        """Parameter of the equilibrium."""
        return self.result.parameter

    @property
    def unknown_values(self) -> FloatArray:
        """Unknowns (count,) of the equilibrium."""
        return self.result.unknown_values


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

    Where joints hold bodies together, the integral of the squared motion of their faces against each other
    stands in place of |dy|^2 / n. While a joint parts, its faces move on even where the bodies move back. In
    the other metric the curve of a crack that snaps back has corners of more than a right angle, where points
    begin to be damaged.

    All methods raise SingularError where a tangent is singular.
    """

    def __init__(
        self, system: System, settings: NewtonSettings, y: FloatArray, parameter: float, step: float
    ) -> None:
        #: The system after the history of the last step.
        self.system = system
        self._threshold = settings.tolerance * system.energy_scale
        self._difference = _DIFFERENCE * abs(step)
        self._n = system.constraints.count
        self._jumps = system.jump_rates()
        tangent = self._linearize(y, parameter)
        slope = -tangent.factor.solve(tangent.by_parameter)
        self._scale = float(np.sqrt(self._product(slope, slope)))
        size = np.sqrt(2.0) * self._scale
        direction = np.sign(step)
        result = NewtonResult(parameter, y, tangent.displacement, tangent.load, tangent.at, ())
        #: Where the curve begins.
        self.start = Point(result, direction * slope / size, float(direction / size), tangent.negative, 0)
        #: Radius that the first step of the parameter would have.
        self.radius = float(size * abs(step))

    @property
    def has_corners(self) -> bool:
        """Whether its tangent may jump: where a point of a joint begins to be damaged, opens or closes."""
        return self._jumps is not None

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

    def distance(self, one: Point, other: Point) -> float:
        """Return the distance of a point along the tangent of another one."""
        y, p = other.unknown_values - one.unknown_values, other.parameter - one.parameter
        return self._inner(one.along, one.turning, y, p)

    def beyond(self, point: Point, radius: float) -> Point:
        """Return the point at a distance along the tangent of another point; raises ConvergenceError."""
        row, corner = self._row(point)
        y = point.unknown_values + radius * point.along
        parameter = point.parameter + radius * point.turning
        return self._corrected(y, parameter, row, corner, point)

    def at_parameter(self, y: FloatArray, parameter: float, towards: Point) -> Point:
        """Return the point at a parameter that Newton's method finds from y (count,).

        Its tangent points in the direction of that of another point. Raises ConvergenceError.
        """
        return self._corrected(y, parameter, np.zeros(self.system.count), 1.0, towards)

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
        result = NewtonResult(parameter, y, t.displacement, t.load, t.at, iterations)
        return Point(result, along / size, float(turning / size), t.negative, tangents)

    def _linearize(self, y: FloatArray, parameter: float) -> _Tangent:
        u, load = self.system.state(y, parameter)
        at, matrix = self.system.linearize(u, load=load)
        negative, factor = inertia(self.system, matrix, u, parameter)
        h = self._difference
        by_parameter = (self._forces(y, parameter + h)[1] - self._forces(y, parameter - h)[1]) / (2 * h)
        return _Tangent(at, self._values(at, u, parameter), factor, by_parameter, negative, u, load)

    def _forces(self, y: FloatArray, parameter: float) -> tuple[Equilibrium, FloatArray]:
        u, load = self.system.state(y, parameter)
        at = self.system.equilibrium(u, load)
        return at, self._values(at, u, parameter)

    def _values(self, at: Equilibrium, u: FloatArray, parameter: float) -> FloatArray:
        if not self.system.global_unknowns:
            return at.residual
        return np.append(at.residual, self.system.control.equation(u, parameter)[0])

    def _row(self, point: Point) -> tuple[FloatArray, float]:
        """Return the equation of the plane normal to the tangent of a point: its row and its corner."""
        row = point.along / self._n
        row[self._n :] = 0.0
        if self._jumps is not None:
            row[: self._n] = self._jumps.T @ (self._jumps @ point.along[: self._n])
        return row, self._scale**2 * point.turning

    def _inner(self, y: FloatArray, p: float, other_y: FloatArray, other_p: float) -> float:
        return self._product(y, other_y) + self._scale**2 * p * other_p

    def _product(self, y: FloatArray, other: FloatArray) -> float:
        n = self._n
        if self._jumps is None:
            return float(y[:n] @ other[:n]) / n
        return float((self._jumps @ y[:n]) @ (self._jumps @ other[:n]))
