"""Translation predictor: a state shifted by one element. On equal elements a front peels each like the last.

Each function takes the coefficients of the same function of the next element towards the driven side. Near
that side, whose own deformation must not be shifted, the body moves rigidly: it follows the functions of the
hinge, where the bending is uniform, and rotates by the bending of one element there.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from isopeel.assembly.constraints import condense
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import compiled, inner
from isopeel.splines.nurbs import Side
from isopeel.splines.space import SplineSpace

#: Distance at which a side's own deformation has decayed (Saint-Venant), in lengths of the side.
_DECAYED = 2.0


@dataclass(frozen=True, eq=False)
class TranslationPredictor:
    """The function that each function takes its coefficients from, and the functions that move rigidly."""

    system: System
    ahead: IntArray  # (size,) index of the same function of the next element
    rigid: IntArray  # indices of the functions near the driven side
    hinge: IntArray  # (3,) a function next to them, and the same function of the elements before and beyond
    points: FloatArray  # (size, 2) control points of the body
    followers: FloatArray  # (count,) number of coefficients tied to each unknown

    @classmethod
    def of(cls, system: System) -> Self | None:
        """Return the predictor of a front that runs along rows of elements from their end, or else None."""
        problem = system.problem
        if len(problem.bodies) > 1 or len(problem.interfaces) != 1:
            return None
        side, space = problem.driven_side, system.space
        along = side in ("left", "right") and problem.adhesion.side in ("bottom", "top")
        if side is None or not along or space.elements[0] < 2:
            return None
        rows = list(zip(space.rows, space.offsets[:-1], space.offsets[1:], strict=True))
        ahead = np.arange(space.size)
        for row, start, stop in rows:
            stride = _stride(row, side)
            ahead[start:stop] = np.clip(ahead[start:stop] + stride, start, stop - 1)
        points = system.spaces.control_points()
        height, length = (_extent(points[space.side_functions(name)]) for name in (side, "bottom"))
        from_side = np.abs(space.greville[:, 0] - (1.0 if side == "right" else 0.0))
        # in a row in the middle, the function nearest to the side that its deformation does not reach
        row, start, stop = rows[len(rows) // 2]
        of_row = np.arange(start, stop)
        evenly_bent = of_row[from_side[of_row] >= _DECAYED * height / length]
        if not len(evenly_bent):
            return None
        here = evenly_bent[np.argmin(from_side[evenly_bent])]
        hinge = here + _stride(row, side) * np.array([0, -1, 1])
        if not (start <= hinge.min() and hinge.max() < stop):
            return None
        (rigid,) = np.nonzero(from_side <= from_side[here])
        unknowns = system.constraints.unknowns
        followers = np.bincount(unknowns[unknowns >= 0], minlength=system.constraints.count)
        return cls(system, ahead, rigid, hinge, points, followers.astype(np.float64))

    def change(self, change: FloatArray, displacement: FloatArray) -> FloatArray:
        """Return a small change of unknowns (count,) shifted by one element, at coefficients (size, 2)."""
        ahead = np.zeros(self.system.constraints.count)
        _translate(
            self.system.constraints.unknowns,
            change,
            self.points,
            displacement,
            self.ahead,
            self.rigid,
            self.hinge,
            self.followers,
            ahead,
        )
        return ahead

    def parameter(self, parameter: float, displacement: FloatArray) -> float:
        """Return the parameter of the drive after a translation by one element of coefficients (size, 2)."""
        constraints = self.system.constraints
        rate = constraints.rate(parameter)
        size = float(np.vdot(rate, rate))
        if size == 0.0:
            # a prescribed load does not change
            return parameter
        work = _rise(self.points, displacement, self.hinge, constraints.driven, rate)
        return parameter + work / size


def _stride(row: SplineSpace, side: Side) -> int:
    """Return the index difference of a function and the same one of the next element towards a side."""
    numbers = row.first_functions
    middle = len(numbers) // 2
    stride = int(numbers[middle] - numbers[middle - 1])
    return stride if side == "right" else -stride


def _extent(points: FloatArray) -> float:
    """Return the distance from the first of some points (n, 2) to the last."""
    return float(np.linalg.norm(points[-1] - points[0]))


@inner
def _turn(points: FloatArray, displacement: FloatArray, hinge: IntArray) -> tuple[float, float]:
    """Return cosine and sine of the rotation from one element to the next, at the hinge."""
    at = np.empty((3, 2))
    for k in range(3):
        for i in range(2):
            at[k, i] = points[hinge[k], i] + displacement[hinge[k], i]
    x0, y0 = at[0, 0] - at[1, 0], at[0, 1] - at[1, 1]
    x1, y1 = at[2, 0] - at[0, 0], at[2, 1] - at[0, 1]
    cosine, sine = x0 * x1 + y0 * y1, x0 * y1 - y0 * x1
    size = np.sqrt(cosine**2 + sine**2)
    return cosine / size, sine / size


@compiled
def _rise(
    points: FloatArray, displacement: FloatArray, hinge: IntArray, driven: IntArray, rate: FloatArray
) -> float:
    """Return the motion of the driven functions in a translation with the hinge, times a rate (n, 2)."""
    cosine, sine = _turn(points, displacement, hinge)
    here, beyond = hinge[0], hinge[2]
    x0, y0 = points[here, 0] + displacement[here, 0], points[here, 1] + displacement[here, 1]
    total = 0.0
    for k in range(len(driven)):
        f = driven[k]
        x, y = points[f, 0] + displacement[f, 0], points[f, 1] + displacement[f, 1]
        moved_x = points[here, 0] + displacement[beyond, 0] + cosine * (x - x0) - sine * (y - y0) - x
        moved_y = points[here, 1] + displacement[beyond, 1] + sine * (x - x0) + cosine * (y - y0) - y
        total += moved_x * rate[k, 0] + moved_y * rate[k, 1]
    return total


@compiled
def _translate(
    unknowns: IntArray,
    change: FloatArray,
    points: FloatArray,
    displacement: FloatArray,
    ahead: IntArray,
    rigid: IntArray,
    hinge: IntArray,
    followers: FloatArray,
    result: FloatArray,
) -> None:
    """Set the result (count,), which is zero, to a change of the unknowns (count,) shifted by one element."""
    u, translated, position = np.zeros(unknowns.shape), np.empty(unknowns.shape), np.empty(unknowns.shape)
    here, before, beyond = hinge[0], hinge[1], hinge[2]
    for f in range(len(u)):
        for i in range(2):
            position[f, i] = points[f, i] + displacement[f, i]
            if unknowns[f, i] >= 0:
                u[f, i] = change[unknowns[f, i]]
    for f in range(len(u)):
        for i in range(2):
            translated[f, i] = u[ahead[f], i]
    cosine, sine = _turn(points, displacement, hinge)
    # the change of the angle between the elements
    angle = _angle(position, u, here, beyond) - _angle(position, u, before, here)
    for f in rigid:
        x = u[f, 0] - u[here, 0] - angle * (position[f, 1] - position[here, 1])
        y = u[f, 1] - u[here, 1] + angle * (position[f, 0] - position[here, 0])
        translated[f, 0] = u[beyond, 0] + cosine * x - sine * y
        translated[f, 1] = u[beyond, 1] + sine * x + cosine * y
    condense(unknowns, translated, result)
    for n in range(len(result)):
        result[n] /= followers[n]


@inner
def _angle(position: FloatArray, change: FloatArray, one: int, other: int) -> float:
    """Return the rotation of the line between two positions by a small change of all positions (size, 2)."""
    x, y = position[other, 0] - position[one, 0], position[other, 1] - position[one, 1]
    turned = x * (change[other, 1] - change[one, 1]) - y * (change[other, 0] - change[one, 0])
    return float(turned / (x * x + y * y))
