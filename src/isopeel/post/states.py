"""One state of all bodies, ready to be drawn, and the window of a picture of them."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from isopeel.assembly.interface import InterfacePoints
from isopeel.assembly.spaces import SpaceOfBodies, spaces_by_name
from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.substrates import Substrate
from isopeel.post.driven import driven_boundaries, tied_with
from isopeel.post.fields import SampledFields, sample_fields, side_positions
from isopeel.post.front import attraction_of
from isopeel.problem import Boundary, Problem
from isopeel.results.fields import StoredState
from isopeel.splines.nurbs import Side
from isopeel.splines.rows import RowSpace

#: Cells along and across a body with which curves and fields look smooth.
SMOOTH = (300, 16)

_OPPOSITE: dict[Side, Side] = {"left": "right", "right": "left", "bottom": "top", "top": "bottom"}
_NO_PULL = 1e-6  # of Young's modulus: less is round-off
_ALIKE = 0.95  # of the strongest pull


@dataclass(frozen=True)
class Window:
    """A rectangle of the plane, (from, to) in each direction."""

    x: tuple[float, float]
    y: tuple[float, float]

    @property
    def aspect(self) -> float:
        """Width over height."""
        return (self.x[1] - self.x[0]) / (self.y[1] - self.y[0])


@dataclass(frozen=True, eq=False)
class Face:
    """The adhering part of a side in one state, at points (n, 2) along it."""

    position: FloatArray
    attraction: FloatArray  # (n,) of what it adheres to
    opposite: FloatArray  # (n, 2) positions on the other side of the body
    adheres: bool  # not in contact alone

    @property
    def length(self) -> float:
        """Of its chords."""
        return float(np.linalg.norm(np.diff(self.position, axis=0), axis=1).sum())


@dataclass(frozen=True, eq=False)
class DrawnState:
    """One state, ready to be drawn."""

    parameter: float
    bodies: Mapping[str, SampledFields]  # by name
    faces: Mapping[str, Face]  # by the names of interfaces
    driven: FloatArray  # (k, 3, 2) start, middle and end of each driven side


def drawn_state(
    problem: Problem,
    space: SpaceOfBodies,
    state: StoredState,
    per_element: Mapping[str, tuple[int, int]] | None = None,
) -> DrawnState:
    """Return a state of all bodies for pictures.

    By default an element has so many cells that curves and fields look smooth, on coarse and on graded meshes
    too; `per_element` has other numbers of cells by names of bodies. Raises as `sample_fields` and
    `InterfacePoints.state`.
    """
    spaces, u = spaces_by_name(problem, space), state.displacement
    cells = per_element or {name: smooth_cells(own) for name, own in spaces.items()}
    faces = {}
    for name, interface in zip(problem.interface_names, problem.faces, strict=True):
        body = interface.boundary.body
        along = np.linspace(interface.start, interface.end, 10 * max(spaces[body].elements) + 1)
        points = InterfacePoints(problem, space, along[:, None], interface=name)
        found = points.state(u, state.maximum_openings)
        opposite = side_positions(problem, space, u, _OPPOSITE[interface.side], along, body)
        pull = attraction_of(problem, found, name)
        faces[name] = Face(found.position[:, 0], pull[:, 0], opposite, interface.adheres)
    ends, driven = np.array([0.0, 0.5, 1.0]), driven_boundaries(problem)
    return DrawnState(
        state.parameter,
        {name: sample_fields(problem, space, u, cells[name], name) for name in spaces},
        faces,
        np.stack([side_positions(problem, space, u, one.side, ends, one.body) for one in driven]),
    )


def smooth_cells(space: RowSpace) -> tuple[int, int]:
    """Return numbers of cells of an element with which curves and fields look smooth."""
    largest = (np.diff(axis.breakpoints).max() for axis in (space.rows[0], space.across))
    along, across = (ceil(cells * size) for cells, size in zip(SMOOTH, largest, strict=True))
    return along, across


def stress_scale(states: Iterable[DrawnState]) -> float:
    """Return the largest |I1| of all states, which is the end of the colour scale."""
    # an invariant below 1e-6 is the round-off of a body at rest
    found = (fields.first_invariant for state in states for fields in state.bodies.values())
    return max(1e-6, *(float(np.nanmax(np.abs(values))) for values in found))


def whole_window(states: Iterable[DrawnState]) -> Window:
    """Return a window around the bodies in all states, with space for labels."""
    fields = (fields for state in states for fields in state.bodies.values())
    points = np.concatenate([one.position.reshape(-1, 2) for one in fields])
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.05 * float(np.max(high - low))
    (left, bottom), (right, top) = (low - margin).tolist(), (high + margin).tolist()
    return Window((left, right), (bottom, top))


def adhering_names(problem: Problem) -> list[str]:
    """Return the names of the interfaces that adhere, seen from each side; of all where none does."""
    named = list(zip(problem.interface_names, problem.faces, strict=True))
    return [name for name, face in named if face.adheres] or [name for name, _ in named]


def front_names(problem: Problem) -> list[str]:
    """Return those of the `adhering_names` that are of the first side of an interface: one for each front."""
    first = [one.boundary for one in problem.interfaces]
    return [name for name in adhering_names(problem) if problem.interface_of(name).boundary in first]


def front_window(problem: Problem, state: DrawnState, interface: str) -> Window:
    """Return a window around the strongest attraction on an interface, with a margin.

    In contact without adhesion it is around the largest pressure.
    """
    face = state.faces[interface]
    attraction = face.attraction if face.adheres else -face.attraction
    # where there is no attraction yet, a front will start at the end next to the drive
    from_drive = np.linalg.norm(face.position - state.driven[:, None, 1], axis=2).min(axis=0)
    body = problem.body_of(problem.interface_of(interface).boundary.body)
    pulls = attraction.max() > _NO_PULL * body.material.youngs_modulus
    # of several places with nearly the same attraction, such as the troughs of a wave, the one next to the
    # drive
    front = attraction > _ALIKE * attraction.max() if pulls else np.full(len(attraction), True)
    at = int(np.argmin(np.where(front, from_drive, np.inf)))
    if len(problem.bodies) > 1:
        return _window_of_bodies(problem, state, interface, at)
    through = face.opposite[at] - face.position[at]
    thickness = float(np.linalg.norm(through))
    # of a body that is thick for its adhering part, such as a cylinder, only the part next to the substrate
    size = min(thickness, face.length / 2)
    x, y = (face.position[at] + through * size / thickness / 2).tolist()
    half_width, half_height = 1.6 * size, 0.65 * size
    return Window((x - half_width, x + half_width), (y - half_height, y + half_height))


def _window_of_bodies(problem: Problem, state: DrawnState, interface: str, at: int) -> Window:
    """Return a window around a point of a face that has the thickness of the bodies on both sides of it."""
    face, joint = state.faces[interface], problem.interface_of(interface)
    group = tied_with(problem, joint.boundary.body)
    pairs = [
        {one.boundary.body, one.against.body}
        for one in problem.interfaces
        if isinstance(one.against, Boundary)
    ]
    beside = group.union(*(pair for pair in pairs if pair & group))
    thickness = max(
        sum(
            float(np.ptp(problem.body_of(name).shape.control_points.reshape(-1, 2), axis=0).min())
            for name in tied_with(problem, body)
        )
        for body in beside
    )
    size = min(thickness, face.length / 2)
    centre = face.position[at]
    if not isinstance(joint.against, Boundary):
        through = face.opposite[at] - centre
        centre = centre + 0.3 * size * through / np.linalg.norm(through)
    (x, y), half_width, half_height = centre.tolist(), 2.0 * size, 0.8 * size
    # little beside the bodies
    ends = np.concatenate([one.position.reshape(-1, 2)[:, 0] for one in state.bodies.values()])
    low, high = float(ends.min()) + 1.9 * size, float(ends.max()) - 1.9 * size
    x = min(max(x, low), high) if low < high else x
    return Window((x - half_width, x + half_width), (y - half_height, y + half_height))


def substrates(problem: Problem, interface: str = "") -> list[Substrate]:
    """Return the substrates of all interfaces, each once; or those of the body of one interface.

    A substrate of another body does not attract this body, and may be in the gap of this body. Bodies that
    adhere to each other only have none.
    """
    body = problem.interface_of(interface).boundary.body if interface else ""
    found: list[Substrate] = []
    for one in problem.interfaces:
        if isinstance(one.against, Boundary):
            continue
        if one.against not in found and body in ("", one.boundary.body):
            found.append(one.against)
    return found


def hatched(problem: Problem) -> str:
    """Return in words what pictures hatch; nothing where bodies adhere to each other only."""
    words = [
        "mirror plane" if isinstance(interface.law, Mirrored) else "substrate"
        for interface in problem.interfaces
        if not isinstance(interface.against, Boundary)
    ]
    return ", ".join(dict.fromkeys(words))


def common_view(
    problem: Problem, space: SpaceOfBodies, states: Sequence[StoredState]
) -> tuple[Window, float]:
    """Return a window for all states of a run, and their largest |I1|; one state at a time, to save memory.

    The window contains all bodies. If the only body is thicker than its adhering part is long, such as a
    cylinder, the window contains only the fronts, which would be too small to see otherwise.
    """
    windows, scale = [], 0.0
    for stored in states:
        state = drawn_state(problem, space, stored)
        window = whole_window([state])
        if problem.is_single:
            ((name, face),) = state.faces.items()
            thickness = float(np.linalg.norm(face.opposite - face.position, axis=1).max())
            window = window if thickness < face.length else front_window(problem, state, name)
        windows.append(window)
        scale = max(scale, stress_scale([state]))
    x, y = (
        (min(low for low, _ in ends), max(high for _, high in ends))
        for ends in ([window.x for window in windows], [window.y for window in windows])
    )
    return Window(x, y), scale
