"""One state of a body, ready to be drawn, and the window of a picture of it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import ceil

import numpy as np

from isopeel.assembly.interface import InterfacePoints
from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.post.fields import SampledFields, sample_fields, side_positions
from isopeel.problem import Problem
from isopeel.splines.nurbs import Side
from isopeel.splines.rows import RowSpace

#: Cells along and across a body with which curves and fields look smooth.
SMOOTH = (300, 16)

_OPPOSITE: dict[Side, Side] = {"left": "right", "right": "left", "bottom": "top", "top": "bottom"}
_NO_PULL = 1e-6  # of Young's modulus: less is round-off
_ALIKE = 0.95  # of the strongest pull


@dataclass(frozen=True)
class Window:
    """A rectangle of the plane, (from, to) each way."""

    x: tuple[float, float]
    y: tuple[float, float]

    @property
    def aspect(self) -> float:
        """Width over height."""
        return (self.x[1] - self.x[0]) / (self.y[1] - self.y[0])


@dataclass(frozen=True, eq=False)
class BodyState:
    """One state of the body, ready to be drawn."""

    parameter: float
    fields: SampledFields
    adhering: FloatArray  # (n, 2) positions along the adhering part of the side
    attraction: FloatArray  # (n,) of the substrate there
    opposite: FloatArray  # (n, 2) positions on the other side of the body
    driven: FloatArray  # (3, 2) start, middle and end of the driven side


def body_state(
    problem: Problem,
    space: RowSpace,
    parameter: float,
    displacement: FloatArray,
    per_element: tuple[int, int] | None = None,
    maximum_openings: FloatArray | None = None,
) -> BodyState:
    """Return a state of the body for pictures, from the coefficients (size, 2) of a displacement.

    An irreversible joint needs its `maximum_openings` (`InterfacePoints.state`). By default an element has so
    many cells that curves and fields look smooth, on coarse and on graded meshes too. Raises as
    `sample_fields`.
    """
    adhesion = problem.adhesion
    along = np.linspace(adhesion.start, adhesion.end, 10 * max(space.elements) + 1)
    interface = InterfacePoints(problem, space, along[:, None]).state(displacement, maximum_openings)
    opposite = side_positions(problem, space, displacement, _OPPOSITE[adhesion.side], along)
    driven = side_positions(problem, space, displacement, problem.drive.side, np.array([0.0, 0.5, 1.0]))
    largest = (np.diff(axis.breakpoints).max() for axis in (space.rows[0], space.across))
    smooth = [ceil(cells * size) for cells, size in zip(SMOOTH, largest, strict=True)]
    cells = per_element or (smooth[0], smooth[1])
    return BodyState(
        parameter,
        sample_fields(problem, space, displacement, cells),
        interface.position[:, 0],
        -interface.normal_traction[:, 0],
        opposite,
        driven,
    )


def stress_scale(states: Iterable[BodyState]) -> float:
    """Return the largest |I1| of all states, which is the end of the colour scale."""
    # an invariant below 1e-6 is the round-off of a body at rest
    return max(1e-6, *(float(np.nanmax(np.abs(state.fields.first_invariant))) for state in states))


def whole_window(states: Iterable[BodyState]) -> Window:
    """Return a window around the body in all states, with space for labels."""
    points = np.concatenate([state.fields.position.reshape(-1, 2) for state in states])
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.05 * float(np.max(high - low))
    (left, bottom), (right, top) = (low - margin).tolist(), (high + margin).tolist()
    return Window((left, right), (bottom, top))


def front_window(problem: Problem, state: BodyState) -> Window:
    """Return a window around the strongest attraction, with a margin."""
    attraction = state.attraction
    # where there is no attraction yet, a front will start at the end next to the drive
    from_drive = np.linalg.norm(state.adhering - state.driven[1], axis=1)
    pulls = attraction.max() > _NO_PULL * problem.body.material.youngs_modulus
    # of several places with nearly the same attraction, such as the troughs of a wave, the one next to the
    # drive
    front = attraction > _ALIKE * attraction.max() if pulls else np.full(len(attraction), True)
    at = int(np.argmin(np.where(front, from_drive, np.inf)))
    through = state.opposite[at] - state.adhering[at]
    length = float(np.linalg.norm(np.diff(state.adhering, axis=0), axis=1).sum())
    thickness = float(np.linalg.norm(through))
    # of a body that is thick for its adhering part, such as a cylinder, only the part next to the substrate
    size = min(thickness, length / 2)
    x, y = (state.adhering[at] + through * size / thickness / 2).tolist()
    half_width, half_height = 1.6 * size, 0.65 * size
    return Window((x - half_width, x + half_width), (y - half_height, y + half_height))


def adheres_to(problem: Problem) -> str:
    """Return what the body adheres to, in words."""
    return "mirror plane" if isinstance(problem.adhesion.law, Mirrored) else "substrate"


def common_view(
    problem: Problem,
    space: RowSpace,
    fields: Mapping[float, FloatArray],
    maximum_openings: Mapping[float, FloatArray] | None = None,
) -> tuple[Window, float]:
    """Return a window for all states of a run, and their largest |I1|; one state at a time, to save memory.

    `fields` maps parameters to coefficients (size, 2) of displacements, and `maximum_openings` to those of an
    irreversible joint. The window holds the body. Where the body is thick for its adhering part, such as a
    cylinder, it holds the fronts only, which would be invisible otherwise.
    """
    windows, scale, history = [], 0.0, maximum_openings or {}
    for value, displacement in fields.items():
        state = body_state(problem, space, value, displacement, maximum_openings=history.get(value))
        length = float(np.linalg.norm(np.diff(state.adhering, axis=0), axis=1).sum())
        thickness = float(np.linalg.norm(state.opposite - state.adhering, axis=1).max())
        windows.append(whole_window([state]) if thickness < length else front_window(problem, state))
        scale = max(scale, stress_scale([state]))
    x, y = (
        (min(low for low, _ in ends), max(high for _, high in ends))
        for ends in ([window.x for window in windows], [window.y for window in windows])
    )
    return Window(x, y), scale
