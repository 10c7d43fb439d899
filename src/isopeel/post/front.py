"""The peeling front: the adhesive stress there, its extent, and its decay in the part that still adheres."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from isopeel.assembly.interface import InterfacePoints, InterfaceState
from isopeel.assembly.spaces import SpaceOfBodies, spaces_by_name
from isopeel.assembly.tables import element_ends
from isopeel.common.arrays import FloatArray, frozen
from isopeel.common.errors import InputError
from isopeel.physics.batch import evaluate_law
from isopeel.physics.joints import JointLaw
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.post.closed_form import beam_peeling
from isopeel.post.fields import sample_side
from isopeel.problem import Problem
from isopeel.results.fields import StoredState

#: Points of an element, from its start (0) to its end (1): the ends of 20 equal cells.
POINTS = frozen(np.linspace(0.0, 1.0, 21))

_ALIKE = 0.95  # of the largest attraction

# root of sin 2z + 2z = 0, a layer on a rigid base without friction (Fadle, Ingenieur-Archiv 11, 1941)
_RIGID = 2.1061961 + 1.1253643j


@dataclass(frozen=True, eq=False)
class FrontProfile:
    """Tractions along the adhering part of a side: arrays (n, k) of the elements in order and their points.

    Tractions act per reference area, along the normal n_o of the substrate, and repulsion is positive. In
    equilibrium both tractions are equal; in a discrete solution their averages, weighted by its functions,
    are equal.
    """

    position: FloatArray  # distance along the reference side, from where the side begins
    deformed: FloatArray  # x (n, k, 2)
    normal: FloatArray  # n_o there (n, k, 2)
    gap: FloatArray
    adhesive_traction: FloatArray  # T, as in the assembly
    body_traction: FloatArray  # n_o . P N of the field in the elements next to the side
    softening: NDArray[np.bool_]  # does the attraction weaken as the gap grows beyond the largest one so far?
    shear: FloatArray | None = None  # of a joint law, along the joint

    @property
    def attraction(self) -> FloatArray:
        """What holds the faces together: the tension -T, and with a joint law the traction of both modes."""
        return attraction(self.adhesive_traction, self.shear)


@dataclass(frozen=True)
class ProcessZone:
    """The part where the attraction exceeds half its peak; positions along the reference side."""

    peak: float  # largest attraction
    position: float  # of the peak
    start: float
    end: float

    @property
    def length(self) -> float:
        """Full width at half maximum."""
        return self.end - self.start


@dataclass(frozen=True)
class Decay:
    """Stress that decays along a strip as exp(-s/length) cos(2 pi s/wavelength + phase)."""

    length: float
    wavelength: float


def front_profile(
    problem: Problem,
    space: SpaceOfBodies,
    displacement: FloatArray,
    points: FloatArray = POINTS,
    maximum_openings: FloatArray | None = None,
    interface: str = "",
) -> FrontProfile:
    """Return the tractions of a displacement (size, 2) at points (k,), 0 to 1, of every element.

    In an element that adheres in part, the points span that part. An irreversible joint needs the
    `maximum_openings` of a step, as for `InterfacePoints.state`. Of several interfaces one is chosen by its
    name (`Problem.interface_names`). Raises InputError for points that do not rise within
    [0, 1], for coefficients of another space, and for missing openings.
    """
    if points.size < 2 or not (points[0] >= 0 and points[-1] <= 1 and np.all(np.diff(points) > 0)):
        raise InputError("points", points.tolist(), "two or more that rise, from 0 to 1 at most")
    parameters = _adhering(problem, space, points, interface)
    found = InterfacePoints(problem, space, parameters, interface=interface)
    state = found.state(displacement, maximum_openings)
    boundary = problem.interface_of(interface).boundary
    fields = sample_side(problem, space, displacement, boundary.side, parameters, boundary.body)
    return FrontProfile(
        position=_distance(problem, space, parameters, interface),
        deformed=state.position,
        normal=state.normal,
        gap=state.gap,
        adhesive_traction=state.normal_traction,
        body_traction=np.einsum("...i,...iJ,...J->...", state.normal, fields.nominal_stress, fields.normal),
        softening=state.softening,
        shear=_shear(problem, state, interface),
    )


def attraction(traction: FloatArray, shear: FloatArray | None) -> FloatArray:
    """Return the tension -T; with a shear traction the size of both, where pressure is none."""
    return -traction if shear is None else np.hypot(np.maximum(-traction, 0.0), shear)


def attraction_of(problem: Problem, state: InterfaceState, interface: str) -> FloatArray:
    """Return the attraction at the points of a state of an interface, see `FrontProfile`."""
    return attraction(state.normal_traction, _shear(problem, state, interface))


def _shear(problem: Problem, state: InterfaceState, interface: str) -> FloatArray | None:
    joint = isinstance(problem.interface_of(interface).law, JointLaw)
    return state.tangential_traction if joint else None


def _adhering(problem: Problem, space: SpaceOfBodies, points: FloatArray, interface: str) -> FloatArray:
    """Return the parameters (n, k) of points (k,) of the elements, in their adhering parts."""
    boundary = problem.interface_of(interface).boundary
    ends = element_ends(spaces_by_name(problem, space)[boundary.body], boundary.side, boundary.part)
    return ends[:-1, None] + np.diff(ends)[:, None] * points


def process_zones(
    problem: Problem, space: SpaceOfBodies, states: Iterable[StoredState], interface: str = ""
) -> dict[int, ProcessZone]:
    """Return the zones of `process_zone` in states, by numbers of steps; without those that have no front.

    Of several interfaces one is chosen by its name.
    """
    parameters = _adhering(problem, space, POINTS, interface)
    position = _distance(problem, space, parameters, interface).ravel()
    points, found = InterfacePoints(problem, space, parameters, interface=interface), {}
    for state in states:
        at = points.state(state.displacement, state.maximum_openings)
        zone = _zone(position, attraction_of(problem, at, interface).ravel(), at.softening.ravel())
        if zone is not None:
            found[state.step] = zone
    return found


def process_zone(profile: FrontProfile) -> ProcessZone | None:
    """Return the stretch around the peak where the attraction exceeds half of it, by linear interpolation.

    Half the peak lies on the steep flanks; a tenth of it would depend on the long tail of the law. The peak
    is the largest value at the points. Where several stretches are pulled nearly alike, such as the troughs
    of a wave that a tape bridges, it is the strongest of those that are fronts. Returns None where there is
    no front: the attraction stays above half its peak up to an end of the adhering part, or the law softens
    on both sides of the peak, or on neither.
    """
    return _zone(profile.position.ravel(), profile.attraction.ravel(), profile.softening.ravel())


def _zone(position: FloatArray, attraction: FloatArray, softens: NDArray[np.bool_]) -> ProcessZone | None:
    largest = attraction.max()
    above = np.flatnonzero(attraction >= largest / 2) if largest > 0 else np.array([], dtype=np.int64)
    stretches = np.split(above, np.flatnonzero(np.diff(above) > 1) + 1)
    peaks = [int(one[np.argmax(attraction[one])]) for one in stretches if one.size]
    for peak in sorted(peaks, key=lambda k: -attraction[k]):
        if attraction[peak] < _ALIKE * largest:
            break
        zone = _zone_around(peak, position, attraction, softens)
        if zone is not None:
            return zone
    return None


def _zone_around(
    peak: int, position: FloatArray, attraction: FloatArray, softens: NDArray[np.bool_]
) -> ProcessZone | None:
    half = attraction[peak] / 2
    below = np.flatnonzero(attraction < half)
    before, after = below[below < peak], below[below > peak]
    if not before.size or not after.size:
        return None
    first, last = before[-1], after[0]
    softening = softens[[first, last]]
    if softening.all() or not softening.any():
        return None
    start = np.interp(half, attraction[first : first + 2], position[first : first + 2])
    end = np.interp(half, attraction[last : last - 2 : -1], position[last : last - 2 : -1])
    return ProcessZone(float(attraction[peak]), float(position[peak]), float(start), float(end))


def beam_decay(problem: Problem) -> Decay | None:
    """Return the decay behind the front of a strip as a beam on springs; None for other problems.

    E'I w'''' + k w = 0 with k = -T'(r_eq) gives exp(-s/l) cos(s/l + phase), l = (4 E'I/k)^(1/4) (Hetenyi,
    Beams on Elastic Foundation, 1946). It holds where l is well above the height of the strip.
    """
    strip = _held_strip(problem)
    if strip is None:
        return None
    height, modulus, stiffness = strip
    length = float((modulus * height**3 / 3 / stiffness) ** 0.25)
    return Decay(length, 2 * np.pi * length)


def layer_decay(problem: Problem) -> Decay | None:
    """Return the decay behind the front of a strip as an elastic layer on springs; None for other problems.

    A layer of height h, loaded along one face by a stress p sin(qx) without shear, deflects there by
    (2 p/(E' q)) (sinh qh cosh qh + qh) / (sinh^2 qh - (qh)^2) sin(qx) (plane strain, small strain). With a
    spring k = -T'(r_eq) in series, fields exp(-z s/h) exist for the roots of

        z + sin z cos z + E'/(2 k h) z (z^2 - sin^2 z) = 0,

    of which that with the least real part decays last. Soft springs give `beam_decay`, rigid ones
    1/z = 1/(2.106 + 1.125 i): then the height alone sets the decay.
    """
    from scipy.optimize import newton

    strip = _held_strip(problem)
    if strip is None:
        return None
    height, modulus, stiffness = strip
    softness = modulus / (2 * stiffness * height)

    def determinant(z: complex) -> complex:
        sine, cosine = np.sin(z), np.cos(z)
        value: complex = z + sine * cosine + softness * z * (z**2 - sine**2)
        return value

    root = complex(newton(determinant, _RIGID, tol=1e-13, maxiter=200))
    return Decay(height / root.real, 2 * np.pi * height / root.imag)


def _held_strip(problem: Problem) -> tuple[float, float, float] | None:
    """Return height, E' and the stiffness -T'(r_eq) of the adhesion; None where it is not a strip."""
    closed_form = beam_peeling(problem)
    if closed_form is None:
        return None
    law = problem.adhesion.law
    gap = np.array([law.equilibrium_gap])
    _, _, derivative = evaluate_law(law.kernel, law.parameters, gap, np.zeros(1))
    modulus = plane_strain_modulus(problem.body.material)
    bending = closed_form.moment * closed_form.radius  # E'I = E' h^3/12
    return float((12 * bending / modulus) ** (1 / 3)), modulus, -float(derivative[0])


def _distance(problem: Problem, space: SpaceOfBodies, parameters: FloatArray, interface: str) -> FloatArray:
    """Return the lengths (n, k) along the reference side, from its start to rising parameters."""
    boundary = problem.interface_of(interface).boundary
    curve = problem.body_of(boundary.body).shape.boundary(boundary.side)
    knots = element_ends(spaces_by_name(problem, space)[boundary.body], boundary.side, (0.0, 1.0))
    stops = np.concatenate([knots[knots < parameters[0, 0]], parameters.ravel()])
    nodes, weights = np.polynomial.legendre.leggauss(8)
    half = np.diff(stops)[:, None] / 2
    speed = np.linalg.norm(curve.derivatives(stops[:-1, None] + half * (nodes + 1), 1)[1], axis=-1)
    lengths = np.concatenate([[0.0], np.cumsum((speed * half) @ weights)])
    return lengths[-parameters.size :].reshape(parameters.shape)
