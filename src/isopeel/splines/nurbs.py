"""NURBS curves and surfaces: exact shapes, their derivatives and their refinement.

Equations are those of Piegl and Tiller, The NURBS Book. Lengths are in the unit of the control points.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import comb, cos, pi, sin
from typing import Literal, Self, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike

from isopeel.common.arrays import FloatArray, IntArray, frozen
from isopeel.common.errors import InputError
from isopeel.splines import refinement
from isopeel.splines.space import SplineSpace

Side: TypeAlias = Literal["left", "right", "bottom", "top"]
Refine: TypeAlias = Callable[[SplineSpace, FloatArray], tuple[SplineSpace, FloatArray]]

ACCURACY = 1e-14  # of lengths and areas, relative to the extent of the control points


@dataclass(frozen=True, eq=False)
class NurbsCurve:
    """A NURBS curve in the plane or in space, Eq. 4.1.

    `control_points` are (size, 2) or (size, 3), `weights` (size,) and positive. Raises InputError otherwise.
    """

    space: SplineSpace
    control_points: FloatArray
    weights: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "control_points", frozen(self.control_points))
        object.__setattr__(self, "weights", frozen(self.weights))
        _check(self.control_points, self.weights, (self.space.size,))

    @property
    def dimension(self) -> int:
        """The number of coordinates, 2 or 3."""
        return int(self.control_points.shape[-1])

    @cached_property
    def homogeneous_points(self) -> FloatArray:
        """Control points times weights, and the weights, (size, dimension + 1)."""
        return _homogeneous(self.control_points, self.weights)

    def evaluate(self, points: ArrayLike) -> FloatArray:
        """Return the curve (..., dimension) at points (...)."""
        values: FloatArray = self.derivatives(points, 0)[0]
        return values

    def derivatives(self, points: ArrayLike, order: int) -> FloatArray:
        """Return the curve and its derivatives, (order + 1, ..., dimension), at points (...)."""
        return _quotients(self._homogeneous_derivatives(points, order)[:, None])[:, 0]

    def homogeneous(self, points: ArrayLike) -> FloatArray:
        """Return the curve times its weight function, and that function, (..., dimension + 1), at points."""
        values: FloatArray = self._homogeneous_derivatives(points, 0)[0]
        return values

    def _homogeneous_derivatives(self, points: ArrayLike, order: int) -> FloatArray:
        functions, active = _functions(self.space, points, order)
        values: FloatArray = np.einsum("k...i,...ic->k...c", functions, self.homogeneous_points[active])
        return values

    def insert_knots(self, knots: ArrayLike) -> Self:
        """Return the same curve with these knots added."""
        return self._refined(lambda space, points: refinement.insert_knots(space, points, knots))

    def elevate(self, times: int) -> Self:
        """Return the same curve with its degree raised by `times`."""
        return self._refined(lambda space, points: refinement.elevate(space, points, times))

    def k_refine(self, times: int, knots: ArrayLike) -> Self:
        """Return the same curve with its degree raised by `times`, and these knots added after that."""
        return self._refined(lambda space, points: refinement.k_refine(space, points, times, knots))

    def length(self, end: float | None = None) -> float:
        """Return the length of the curve, or of its part up to a parameter.

        Raises InputError for a parameter outside the interval.
        """
        points, extent = _centred(self.control_points)
        centred = NurbsCurve(self.space, points, self.weights)
        breakpoints = self.space.breakpoints
        if end is not None:
            self.space.element_of(end)  # raises outside
            breakpoints = np.append(breakpoints[breakpoints < end], end)
        return _integral(
            lambda places: np.linalg.norm(centred.derivatives(places, 1)[1], axis=-1),
            breakpoints,
            ACCURACY * extent,
        )

    def _refined(self, refine: Refine) -> Self:
        space, points = refine(self.space, self.homogeneous_points)
        return type(self)(space, points[..., :-1] / points[..., -1:], points[..., -1])


@dataclass(frozen=True, eq=False)
class NurbsSurface:
    """A NURBS surface in the plane or in space over the parameters xi and eta, Eq. 4.11.

    `spaces` are the spaces along xi and eta, with sizes n and m. `control_points` are (n, m, 2) or (n, m, 3),
    `weights` are (n, m) and positive. Raises InputError otherwise. Methods broadcast xi and eta, to (...).
    """

    spaces: tuple[SplineSpace, SplineSpace]
    control_points: FloatArray
    weights: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "control_points", frozen(self.control_points))
        object.__setattr__(self, "weights", frozen(self.weights))
        _check(self.control_points, self.weights, (self.spaces[0].size, self.spaces[1].size))

    @property
    def dimension(self) -> int:
        """The number of coordinates, 2 or 3."""
        return int(self.control_points.shape[-1])

    @cached_property
    def homogeneous_points(self) -> FloatArray:
        """Control points times weights, and the weights, (n, m, dimension + 1)."""
        return _homogeneous(self.control_points, self.weights)

    def evaluate(self, xi: ArrayLike, eta: ArrayLike) -> FloatArray:
        """Return the surface, (..., dimension)."""
        values: FloatArray = _quotients(self._homogeneous_derivatives(xi, eta, 0))[0, 0]
        return values

    def jacobian(self, xi: ArrayLike, eta: ArrayLike) -> FloatArray:
        """Return the derivatives of the surface by xi and eta, (..., dimension, 2)."""
        partial = _quotients(self._homogeneous_derivatives(xi, eta, 1))
        return np.stack([partial[1, 0], partial[0, 1]], axis=-1)

    def second_derivatives(self, xi: ArrayLike, eta: ArrayLike) -> FloatArray:
        """Return the second derivatives of the surface by xi and eta, (..., dimension, 2, 2)."""
        partial = _quotients(self._homogeneous_derivatives(xi, eta, 2))
        along_xi = np.stack([partial[2, 0], partial[1, 1]], axis=-1)
        along_eta = np.stack([partial[1, 1], partial[0, 2]], axis=-1)
        return np.stack([along_xi, along_eta], axis=-1)

    def weight_function(self, xi: ArrayLike, eta: ArrayLike) -> FloatArray:
        """Return the common denominator of the rational functions, (...)."""
        return self._homogeneous_derivatives(xi, eta, 0)[0, 0, ..., -1]

    def insert_knots(self, knots: ArrayLike, direction: Literal[0, 1]) -> Self:
        """Return the same surface with these knots added along xi (0) or eta (1)."""
        return self._refined(direction, lambda space, points: refinement.insert_knots(space, points, knots))

    def elevate(self, times: int, direction: Literal[0, 1]) -> Self:
        """Return the same surface with its degree along xi (0) or eta (1) raised by `times`."""
        return self._refined(direction, lambda space, points: refinement.elevate(space, points, times))

    def k_refine(self, times: int, knots: ArrayLike, direction: Literal[0, 1]) -> Self:
        """Return the same surface, elevated along xi (0) or eta (1), and these knots added after that."""
        return self._refined(
            direction, lambda space, points: refinement.k_refine(space, points, times, knots)
        )

    def boundary(self, side: Side) -> NurbsCurve:
        """Return the curve at the start ("left") or end ("right") of xi, or that ("bottom", "top") of eta."""
        check_side("side", side)
        across = 0 if side in ("left", "right") else 1
        end = 0 if side in ("left", "bottom") else -1
        points, weights = (
            np.moveaxis(array, across, 0)[end] for array in (self.control_points, self.weights)
        )
        return NurbsCurve(self.spaces[1 - across], points, weights)

    def area(self) -> float:
        """Return the area of a planar surface, by Green's theorem. Raises InputError for one in space."""
        if self.dimension != 2:
            raise InputError("control_points", f"{self.dimension} coordinates", "2 are needed for an area")
        points, extent = _centred(self.control_points)
        centred = NurbsSurface(self.spaces, points, self.weights)

        def circulation(side: Side) -> float:
            curve = centred.boundary(side)

            def swept(places: FloatArray) -> FloatArray:
                (x, y), (dx, dy) = np.moveaxis(curve.derivatives(places, 1), -1, 1)
                density: FloatArray = (x * dy - y * dx) / 2
                return density

            return _integral(swept, curve.space.breakpoints, ACCURACY * extent**2)

        return abs(circulation("bottom") + circulation("right") - circulation("top") - circulation("left"))

    def _homogeneous_derivatives(self, xi: ArrayLike, eta: ArrayLike, order: int) -> FloatArray:
        """Return derivatives up to an order in each direction, (order + 1, order + 1, ..., dimension + 1)."""
        along_xi, rows = _functions(self.spaces[0], xi, order)
        along_eta, columns = _functions(self.spaces[1], eta, order)
        active = self.homogeneous_points[rows[..., :, None], columns[..., None, :]]
        summed = np.einsum("k...i,...ijc->k...jc", along_xi, active)
        result: FloatArray = np.einsum("l...j,k...jc->kl...c", along_eta, summed)
        return result

    def _refined(self, direction: Literal[0, 1], refine: Refine) -> Self:
        if direction not in (0, 1):
            raise InputError("direction", direction, "it must be 0 (along xi) or 1 (along eta)")
        space, points = refine(self.spaces[direction], np.moveaxis(self.homogeneous_points, direction, 0))
        points = np.moveaxis(points, 0, direction)
        spaces = (space, self.spaces[1]) if direction == 0 else (self.spaces[0], space)
        return type(self)(spaces, points[..., :-1] / points[..., -1:], points[..., -1])


def check_side(field: str, side: str) -> None:
    """Raise InputError unless a side is one of the four."""
    if side not in get_args(Side):
        raise InputError(field, side, f"it must be one of {', '.join(get_args(Side))}")


def rectangle(length: float, height: float) -> NurbsSurface:
    """Return a rectangle of one element: its lower left corner is the origin, and xi is along its length."""
    for field, value in (("length", length), ("height", height)):
        if not 0 < value < np.inf:
            raise InputError(field, value, "it must be positive")
    linear = SplineSpace.uniform(1, 0, 1)
    corners = np.array([[[0.0, 0.0], [0.0, height]], [[length, 0.0], [length, height]]])
    return NurbsSurface((linear, linear), corners, np.ones((2, 2)))


def annulus_sector(inner_radius: float, outer_radius: float, angle: float) -> NurbsSurface:
    """Return a sector of an annulus about the origin, of one element, from the x axis to an angle below pi.

    xi runs clockwise along the arcs, to the x axis, and eta outwards from the inner arc. So the Jacobian is
    positive. The arcs are exact: quadratic, with weights 1, cos(angle/2), 1 (Sec. 7.3).
    """
    if not 0 < inner_radius < np.inf:
        raise InputError("inner_radius", inner_radius, "it must be positive")
    if not inner_radius < outer_radius < np.inf:
        raise InputError("outer_radius", outer_radius, f"it must exceed the inner radius, {inner_radius:g}")
    if not 0 < angle < pi:
        raise InputError("angle", angle, "it must be above 0 and below pi")
    # The tangents at both ends of an arc meet at half its angle, at radius / cos(angle/2).
    middle = cos(angle / 2)
    arc = np.array([[cos(angle), sin(angle)], [1.0, sin(angle / 2) / middle], [1.0, 0.0]])
    points = arc[:, None, :] * np.array([inner_radius, outer_radius])[:, None]
    weights = np.repeat([[1.0], [middle], [1.0]], 2, axis=1)
    return NurbsSurface((SplineSpace.uniform(2, 1, 1), SplineSpace.uniform(1, 0, 1)), points, weights)


def _check(control_points: FloatArray, weights: FloatArray, sizes: tuple[int, ...]) -> None:
    if control_points.shape not in ((*sizes, 2), (*sizes, 3)) or not np.all(np.isfinite(control_points)):
        allowed = f"they must be finite and of shape {(*sizes, 2)} or {(*sizes, 3)}"
        raise InputError("control_points", f"shape {control_points.shape}", allowed)
    if weights.shape != sizes:
        raise InputError("weights", f"shape {weights.shape}", f"one per control point is needed, {sizes}")
    refused = ~((weights > 0) & np.isfinite(weights))
    if np.any(refused):
        raise InputError("weights", float(weights[refused][0]), "weights must be positive and finite")


def _homogeneous(control_points: FloatArray, weights: FloatArray) -> FloatArray:
    return frozen(np.concatenate([control_points * weights[..., None], weights[..., None]], axis=-1))


def _centred(control_points: FloatArray) -> tuple[FloatArray, float]:
    """Return the points relative to the first one, so that a far origin costs no digits, and their extent."""
    points = control_points.reshape(-1, control_points.shape[-1])
    return control_points - points[0], float(np.linalg.norm(np.ptp(points, axis=0)))


def _functions(space: SplineSpace, points: ArrayLike, order: int) -> tuple[FloatArray, IntArray]:
    """Return functions (order + 1, ..., degree + 1) at points (...), and their indices (..., degree + 1)."""
    places = np.asarray(points, dtype=np.float64)
    functions, first = space.basis(places.ravel(), order)
    active = first[:, None] + np.arange(space.degree + 1)
    support = (*places.shape, space.degree + 1)
    return functions.reshape(order + 1, *support), active.reshape(support)


def _quotients(homogeneous: FloatArray) -> FloatArray:
    """Return the derivatives (K, L, ..., d) of A/w from those of (A, w), (K, L, ..., d + 1); Eq. 4.20."""
    numerators, weights = homogeneous[..., :-1], homogeneous[..., -1:]
    result = np.empty_like(numerators)
    for k, m in np.ndindex(numerators.shape[:2]):
        remainder = numerators[k, m].copy()
        for i, j in np.ndindex(k + 1, m + 1):
            if (i, j) != (0, 0):
                remainder -= comb(k, i) * comb(m, j) * weights[i, j] * result[k - i, m - j]
        result[k, m] = remainder / weights[0, 0]
    return result


def _integral(
    function: Callable[[FloatArray], FloatArray], breakpoints: FloatArray, accuracy: float
) -> float:
    """Return the integral of a function over all elements, by Gauss's rule.

    Each interval is halved until the sum over both halves agrees with that over the interval.
    """
    nodes, gauss_weights = np.polynomial.legendre.leggauss(16)

    def gauss(start: FloatArray, end: FloatArray) -> FloatArray:
        half = (end - start)[:, None] / 2
        return (function(start[:, None] + half * (nodes + 1)) * half) @ gauss_weights

    start, end = breakpoints[:-1], breakpoints[1:]
    whole = gauss(start, end)
    total = 0.0
    while whole.size:
        middle = (start + end) / 2
        halves = np.stack([gauss(start, middle), gauss(middle, end)])
        open_ = np.abs(halves.sum(axis=0) - whole) > accuracy
        total += float(halves[:, ~open_].sum())
        start, end = (
            np.concatenate([start[open_], middle[open_]]),
            np.concatenate([middle[open_], end[open_]]),
        )
        whole = halves[:, open_].ravel()
    return total
