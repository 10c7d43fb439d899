"""Univariate spline spaces: knot vectors, B-spline functions and their derivatives."""

from dataclasses import dataclass
from functools import cached_property
from typing import Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import solve_banded
from scipy.sparse import csr_array

from isopeel.common.arrays import FloatArray, IntArray, frozen
from isopeel.common.errors import InputError

Array = TypeVar("Array", FloatArray, IntArray)

HIGHEST_DEGREE = 30
ROUND_OFF = 1e-12  # knots closer than this, relative to their size, differ by round-off only


@dataclass(frozen=True, eq=False)
class SplineSpace:
    """All piecewise polynomials of a degree on an open knot vector, by their B-splines.

    `degree` is 1 to 30. `knot_vector` is nondecreasing, with its first and last knot repeated degree + 1
    times and its inner knots degree times at most, so that every function is continuous.
    Raises InputError otherwise, or when two knots differ by round-off only.
    """

    degree: int
    knot_vector: FloatArray

    def __post_init__(self) -> None:
        if not 1 <= self.degree <= HIGHEST_DEGREE:
            raise InputError("degree", self.degree, f"it must be 1 to {HIGHEST_DEGREE}")
        knots = frozen(self.knot_vector)
        object.__setattr__(self, "knot_vector", knots)
        if knots.ndim != 1 or knots.size < 2 * self.degree + 2:
            allowed = f"for degree {self.degree} at least {2 * self.degree + 2} knots are needed"
            raise InputError("knot_vector", f"shape {knots.shape}", allowed)
        if not np.all(np.isfinite(knots)):
            raise InputError("knot_vector", float(knots[~np.isfinite(knots)][0]), "knots must be finite")
        steps = np.diff(knots)
        tolerance = ROUND_OFF * np.abs(knots).max()
        for refused, allowed in (
            (steps < 0, "knots must not decrease"),
            ((steps > 0) & (steps <= tolerance), "knots that differ by round-off only must be made equal"),
        ):
            if np.any(refused):
                raise InputError("knot_vector", knots[np.argmax(refused) :][:2].tolist(), allowed)
        if self.elements < 1 or np.any(self.multiplicities[[0, -1]] != self.degree + 1):
            allowed = f"for degree {self.degree} the first and last knot must occur {self.degree + 1} times"
            raise InputError("knot_vector", knots[[0, -1]].tolist(), allowed)
        if np.any(self.multiplicities[1:-1] > self.degree):
            worst = self.breakpoints[np.argmax(self.multiplicities[1:-1]) + 1]
            allowed = f"an inner knot may occur {self.degree} times at most"
            raise InputError("knot_vector", float(worst), allowed)

    @classmethod
    def uniform(cls, degree: int, continuity: int, elements: int) -> Self:
        """Return equal elements on [0, 1] with one continuity, 0 to degree - 1, at all inner knots."""
        if elements < 1:
            raise InputError("elements", elements, "at least one element is needed")
        # A correctly rounded quotient makes the breakpoints of nested meshes equal to the last bit.
        return cls.on(degree, continuity, np.arange(elements + 1) / elements)

    @classmethod
    def on(cls, degree: int, continuity: int, breakpoints: ArrayLike) -> Self:
        """Return the elements between increasing breakpoints with one continuity, 0 to degree - 1."""
        if not 0 <= continuity < degree:
            raise InputError("continuity", continuity, f"for degree {degree} it must be 0 to {degree - 1}")
        places = np.asarray(breakpoints, dtype=np.float64)
        if places.ndim != 1 or places.size < 2 or not np.all(np.diff(places) > 0):
            raise InputError("breakpoints", breakpoints, "at least two are needed, in increasing order")
        repeats = np.full(places.size, degree - continuity)
        repeats[[0, -1]] = degree + 1
        return cls(degree, np.repeat(places, repeats))

    @cached_property
    def breakpoints(self) -> FloatArray:
        """The distinct knots, (elements + 1,)."""
        return _read_only(np.unique(self.knot_vector))

    @cached_property
    def multiplicities(self) -> IntArray:
        """The number of times that each breakpoint occurs in the knot vector, (elements + 1,)."""
        return _read_only(np.unique(self.knot_vector, return_counts=True)[1].astype(np.int64))

    @property
    def size(self) -> int:
        """The number of functions."""
        return self.knot_vector.size - self.degree - 1

    @property
    def elements(self) -> int:
        """The number of nonempty knot spans."""
        return self.breakpoints.size - 1

    @property
    def continuities(self) -> IntArray:
        """The number of continuous derivatives at each inner breakpoint, (elements - 1,)."""
        return self.degree - self.multiplicities[1:-1]

    @cached_property
    def greville(self) -> FloatArray:
        """The Greville points, means of degree successive knots, (size,)."""
        knots = np.lib.stride_tricks.sliding_window_view(self.knot_vector[1:-1], self.degree)
        # Relative to its first knot, the mean of equal knots is that knot to the last bit.
        return _read_only(knots[:, 0] + (knots - knots[:, :1]).mean(axis=1))

    @cached_property
    def first_functions(self) -> IntArray:
        """Index of the first of the degree + 1 functions that do not vanish on each element, (elements,)."""
        return _read_only(np.cumsum(self.multiplicities[:-1]) - 1 - self.degree)

    def element_of(self, points: ArrayLike) -> IntArray:
        """Return the element that contains each point, in the shape of the points.

        Elements are half open, the last one is closed. Raises InputError for a point outside the interval.
        """
        places = np.asarray(points, dtype=np.float64)
        start, end = self.breakpoints[0], self.breakpoints[-1]
        outside = ~((places >= start) & (places <= end))
        if np.any(outside):
            raise InputError("points", float(places[outside].flat[0]), f"points lie in [{start:g}, {end:g}]")
        found = np.searchsorted(self.breakpoints, places, side="right") - 1
        return np.minimum(found, self.elements - 1).astype(np.int64)

    def basis(
        self, points: ArrayLike, derivatives: int = 0, elements: ArrayLike | None = None
    ) -> tuple[FloatArray, IntArray]:
        """Return the functions that do not vanish at points (m,), with their derivatives.

        The first array, (derivatives + 1, m, degree + 1), has the values and derivatives; the second, (m,),
        has the index of the first function. With `elements` (m,), each point is evaluated with the
        polynomials of its element, also if it is outside of that: this gives one-sided values at breakpoints.
        Raises InputError for a point outside the interval. The NURBS Book (Piegl, Tiller), Eqs. 2.5 and 2.7.
        """
        places = np.atleast_1d(np.asarray(points, dtype=np.float64))
        holders = self.element_of(places) if elements is None else np.broadcast_to(elements, places.shape)
        orders = np.arange(min(derivatives, self.degree) + 1)
        # A derivative is the polar form with directions, homogeneous pairs (1, 0), in place of points (x, 1).
        is_point = np.arange(self.degree) < self.degree - orders[:, None, None]
        arguments = np.where(is_point, places[:, None], 1.0)
        factors = np.cumprod(np.append(1.0, self.degree - orders[:-1]))
        result = np.zeros((derivatives + 1, places.size, self.degree + 1))
        result[orders] = factors[:, None, None] * self.polar_weights(arguments, holders, is_point)
        return result, self.first_functions[holders]

    def polar_weights(self, arguments: ArrayLike, elements: ArrayLike, scales: ArrayLike = 1.0) -> FloatArray:
        """Return the weights (..., m, degree + 1) of the coefficients in the polar forms of elements (m,).

        The polar form (blossom) of a polynomial is symmetric in its arguments (..., m, degree), affine in
        each, and the polynomial itself where all are equal. Arguments may be homogeneous pairs with `scales`
        of the same shape. Ramshaw, Blossoms are polar forms (1989).
        """
        points, homogeneous = np.broadcast_arrays(np.asarray(arguments, dtype=np.float64), scales)
        last_before = self.first_functions[np.asarray(elements)] + self.degree
        weights = np.ones((*points.shape[:-1], 1))
        for degree in range(1, self.degree + 1):
            # Cox and de Boor: each function of the lower degree passes to itself and to its right neighbour.
            knots = self.knot_vector[last_before[:, None] + np.arange(1 - degree, degree + 1)]
            start, end = knots[:, :degree], knots[:, degree:]
            x, scale = points[..., degree - 1, None], homogeneous[..., degree - 1, None]
            rising = (x - scale * start) / (end - start) * weights
            falling = (scale * end - x) / (end - start) * weights
            weights = np.zeros((*points.shape[:-1], degree + 1))
            weights[..., 1:] = rising
            weights[..., :-1] += falling
        return weights

    def collocation(self, points: ArrayLike, derivative: int = 0) -> csr_array:
        """Return the matrix (m, size) from coefficients to values, or to a derivative, at points (m,)."""
        values, first = self.basis(points, derivative)
        columns = first[:, None] + np.arange(self.degree + 1)
        rows = np.arange(first.size + 1) * (self.degree + 1)
        return csr_array((values[derivative].ravel(), columns.ravel(), rows), shape=(first.size, self.size))

    def interpolate(self, values: ArrayLike) -> FloatArray:
        """Return the coefficients (size, ...) of the spline with these values (size, ...) at `greville`."""
        wanted = np.asarray(values, dtype=np.float64)
        if wanted.shape[:1] != (self.size,):
            raise InputError("values", wanted.shape, f"one per Greville point is needed, {self.size} in all")
        functions, first = self.basis(self.greville)
        columns = first[:, None] + np.arange(self.degree + 1)
        bands = np.zeros((2 * self.degree + 1, self.size))
        bands[self.degree + np.arange(self.size)[:, None] - columns, columns] = functions[0]
        solution = solve_banded((self.degree, self.degree), bands, wanted.reshape(self.size, -1))
        return np.asarray(solution, dtype=np.float64).reshape(wanted.shape)

    def support(self, function: int) -> tuple[float, float]:
        """Return the ends of the interval on which a function, 0 to size - 1, does not vanish."""
        if not 0 <= function < self.size:
            raise InputError("function", function, f"it must be 0 to {self.size - 1}")
        return float(self.knot_vector[function]), float(self.knot_vector[function + self.degree + 1])


def _read_only(array: Array) -> Array:
    array.setflags(write=False)
    return array
