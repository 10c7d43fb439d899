"""A patch from a file in splinepy's JSON format."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, ClassVar, get_args

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import Length, Meaning, Positive
from isopeel.problem.shapes.base import check_positive, parameter_at_length
from isopeel.problem.shapes.spline_file import read_surface
from isopeel.splines.nurbs import NurbsSurface, Side
from isopeel.splines.space import SplineSpace

#: Points along xi and along eta at which the Jacobian is checked. With few spans there are more, since a fold
#: may be small beside a span.
POINTS_PER_SPAN, POINTS_OF_FEW, FEW_SPANS = 5, 16, 1000
#: Bounds of an extent: a coordinate times a unit length, of which each is between 1e-12 and 1e12 in a case.
SMALLEST, LARGEST = 1e-24, 1e24
#: Number of times that the interval around a minimum of the Jacobian is quartered: to 1e-6 of a span.
ZOOMS = 8
#: Largest ratio of two weights: a Jacobian is proportional to their squares, and has sixteen digits.
WEIGHTS_APART = 1e6
#: Least ratio of a side to the extent of the patch, and of the least Jacobian to the largest: half of the
#: digits.
LEAST = 1e-8


@dataclass(frozen=True)
class Patch:
    """A plane NURBS patch from a file, whose coordinates are in units of `unit_length`.

    The file is what `splinepy.io.json.export` writes of one surface, encoded or not:

        {"SplineList": [{"SplineType": "NURBS", "para_dim": 2, "dim": 2, "degrees": [2, 1],
          "knot_vectors": [[0, 0, 0, 1, 1, 1], [0, 0, 1, 1]],
          "control_points": [[0, 0], [5, 0], [10, 2], [0, 3], [5, 3], [10, 5]],
          "weights": [1, 1, 1, 1, 1, 1]}]}

    The index of control points along xi runs fastest. A "BSpline" has no weights, a "RationalBezier" no knot
    vectors, and a "Bezier" neither of them; other keys are ignored. The knots are mapped to [0, 1].
    Coordinates are not changed: the lower side, eta = 0, may be at any place. The file is read once, when the
    object is made. Raises InputError if it cannot be read, and for a patch that folds.
    """

    name: ClassVar[str] = "patch"
    usual_hold: ClassVar[Side] = "left"

    file: Annotated[
        Path,
        Meaning(
            "path of a file that splinepy wrote, from the folder of the case",
            "shape.json",
            see="howto/shape.md",
        ),
    ]
    unit_length: Annotated[
        Positive[Length],
        Meaning(
            "length of one unit of the coordinates in the file",
            "1 um",
            usual="the unit of length of the case",
        ),
    ] = 1.0

    def __post_init__(self) -> None:
        """Read the file."""
        object.__setattr__(self, "file", Path(self.file))
        check_positive(unit_length=self.unit_length)
        try:
            with np.errstate(all="ignore"):  # numbers that become infinite are refused below
                surface = self._surface
                _check_size(surface)
                _check_orientation(surface)
        except InputError as error:
            reason = f"in the file, {error.field} {error.value}: {error.allowed}"
            raise InputError("body.file", str(self.file), reason) from error
        except ValueError as error:
            raise InputError("body.file", str(self.file), str(error)) from error

    def surface(self) -> NurbsSurface:
        """Return the patch of the file."""
        return self._surface

    def adhering_part(self, length: float) -> tuple[float, float]:
        """Return the parameters of a length from the left end; raises InputError beyond the right end."""
        return 0.0, parameter_at_length(self._surface.boundary("bottom"), length)

    @cached_property
    def _surface(self) -> NurbsSurface:
        drawn = read_surface(self.file)
        apart = float(drawn.weights.max() / drawn.weights.min())
        if not apart <= WEIGHTS_APART:
            raise ValueError(
                f"its weights differ by a factor of {apart:.3g}; {WEIGHTS_APART:g} is allowed at most"
            )
        # a common factor of all weights does not change the shape; with weights up to 1 products are finite
        weights = drawn.weights / drawn.weights.max()
        return NurbsSurface(drawn.spaces, drawn.control_points * self.unit_length, weights)


def _check_size(surface: NurbsSurface) -> None:
    """Raise ValueError unless the patch has a size that a body can have."""
    extent = float(np.ptp(surface.control_points.reshape(-1, 2), axis=0).max())
    # an extent of zero is a point, which is refused as a fold
    if extent and not SMALLEST <= extent <= LARGEST:
        raise ValueError(
            f"its extent is {extent:.3g} units of the case; it must lie between {SMALLEST:g} and {LARGEST:g}"
        )


def _check_orientation(surface: NurbsSurface) -> None:
    """Raise ValueError unless the Jacobian is positive at points of all knot spans, and along all sides.

    At the corners it may vanish: two sides of a disc meet there in a straight line.
    """
    few = surface.spaces[0].elements * surface.spaces[1].elements <= FEW_SPANS
    xi, eta = (_points(space, POINTS_OF_FEW if few else POINTS_PER_SPAN) for space in surface.spaces)
    determinants = _determinants(surface, xi, eta)
    along = _determinants(surface, xi, surface.spaces[1].breakpoints[[0, -1]])
    across = _determinants(surface, surface.spaces[0].breakpoints[[0, -1]], eta)
    if np.all(determinants < 0):
        raise ValueError(
            "its Jacobian is negative everywhere: swap or reverse the directions, so that xi runs along the "
            "lower side and eta to its left"
        )
    _check_positive_inside(determinants, xi, eta)
    _check_positive_inside(*_least_of(surface, determinants, xi, eta))
    extent = float(np.ptp(surface.control_points.reshape(-1, 2), axis=0).max())
    for side in get_args(Side):
        if not surface.boundary(side).length() > LEAST * extent:
            raise ValueError(f"the side {side} has no length: a patch has four sides, not three")
    least = LEAST * float(determinants.max())
    for name, values in (
        *zip(("bottom", "top"), along.T, strict=True),
        *zip(("left", "right"), across, strict=True),
    ):
        if not values.min() > least:
            raise ValueError(f"its map is singular along the side {name}, where control points coincide")
    if not determinants.min() > least:
        i, j = np.unravel_index(np.argmin(determinants), determinants.shape)
        raise ValueError(f"its map is singular at xi = {xi[i]:.6g}, eta = {eta[j]:.6g}")


def _least_of(
    surface: NurbsSurface, determinants: FloatArray, xi: FloatArray, eta: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return determinants (9, 9) around the least one, with their xi and eta, at a fine spacing.

    A fold may be a thin line, which coarser points miss.
    """
    i, j = np.unravel_index(np.argmin(determinants), determinants.shape)
    places, sizes = (xi[i], eta[j]), [np.diff(line).max(initial=0.0) for line in (xi, eta)]
    for _ in range(ZOOMS):
        # the corners are excluded: the Jacobian may vanish there
        x, y = (
            np.clip(place + size * np.linspace(-1, 1, 9), line[0], line[-1])
            for place, size, line in zip(places, sizes, (xi, eta), strict=True)
        )
        values = _determinants(surface, x, y)
        i, j = np.unravel_index(np.argmin(values), values.shape)
        places, sizes = (x[i], y[j]), [size / 4 for size in sizes]
    return values, x, y


def _check_positive_inside(determinants: FloatArray, xi: FloatArray, eta: FloatArray) -> None:
    if not np.all(determinants > 0):
        i, j = np.unravel_index(np.argmin(determinants), determinants.shape)
        raise ValueError(f"the patch must not fold, as it does at xi = {xi[i]:.6g}, eta = {eta[j]:.6g}")


def _points(space: SplineSpace, count: int) -> FloatArray:
    start, end = space.breakpoints[:-1, None], space.breakpoints[1:, None]
    points: FloatArray = start + (end - start) * (np.arange(count) + 0.5) / count
    return points.ravel()


def _determinants(surface: NurbsSurface, xi: FloatArray, eta: FloatArray) -> FloatArray:
    """Return determinants (n, m) of the Jacobian, times a positive factor, for all of xi (n,) and eta (m,).

    That of a rational map A/w is det(A_xi, A_eta, A) / w^3 with its homogeneous points A.
    """
    # relative to one point, so that a far origin costs no digits
    centred = surface.control_points - surface.control_points[0, 0]
    # scaled to a size of 1, so that products stay finite
    centred, weights = centred / (np.abs(centred).max() or 1.0), surface.weights / surface.weights.max()
    homogeneous = NurbsSurface(surface.spaces, centred, weights).homogeneous_points
    along, across = surface.spaces

    def derivatives(by_xi: int, by_eta: int) -> FloatArray:
        columns = along.collocation(xi, by_xi) @ homogeneous.reshape(along.size, -1)
        columns = columns.reshape(xi.size, across.size, 3).swapaxes(0, 1).reshape(across.size, -1)
        grid: FloatArray = across.collocation(eta, by_eta) @ columns
        return grid.reshape(eta.size, xi.size, 3).swapaxes(0, 1)

    parts = [derivatives(1, 0), derivatives(0, 1), derivatives(0, 0)]
    return np.asarray(np.linalg.det(np.stack(parts, axis=-2)) / parts[2][..., 2] ** 3)
