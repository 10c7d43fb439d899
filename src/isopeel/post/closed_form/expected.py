"""The closed form of a problem, if there is one, and the range in which it is valid."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import cos, pi, remainder, sqrt

import numpy as np

from isopeel.common.errors import InputError
from isopeel.physics.adhesion import AdhesionLaw
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.batch import evaluate_material, evaluate_substrate
from isopeel.physics.materials import Material
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.post.closed_form.finite_strain import bent_strip, peeled_tape
from isopeel.post.closed_form.strip import FreeStrip, beam_peeling, free_strip
from isopeel.post.closed_form.tape import kendall_force, sliding_tape_force
from isopeel.post.law import law_character
from isopeel.problem import Problem, PulledSide
from isopeel.splines.rows import RowSpace

ROUND_OFF = 1e-9  # relative
SLENDER = 8.0  # lengths over heights from which a strip is a beam
#: A small-strain form is valid where it is within this share of the finite-strain one: half of the 1 % that a
#: closed form is to be right within.
SMALL_STRAIN = 0.005
#: Lengths sqrt(E'I/S) of elastica from which the free arm of a tape points along its force: what is left of
#: its turn changes the balance of energies by exp(-2 x 3) = 0.25 % (`tests/validation`, tapes).
ARM = 3.0
#: Decay lengths (4 E'I/k)^(1/4) of a beam on springs that the joint must have opened by, and be closed beyond
#: the front. With the mean stiffness k of the law during separation they are the longest decay lengths: the
#: moment of the published strip, whose law has a long range, is 0.1 % below its plateau there.
DECAY = 2.0


@dataclass(frozen=True)
class Expected:
    """The steady reaction of a closed form, in the units of the drive's columns.

    It is valid from the length `arm` of the free part on, between the front and the driven end, and as long
    as the length `behind` adheres beyond the front (in L0).
    """

    source: str
    reaction: float
    onset: float | None  # parameter at which peeling begins
    period: float | None  # in which the front passes one of equal elements; None where they are not
    arm: float = 0.0
    behind: float = 0.0


@dataclass(frozen=True)
class Theory:
    """The closed form of a problem, if one is valid, or the reason why there is none that is."""

    form: Expected | None = None
    reason: str = ""


def expected(problem: Problem, space: RowSpace) -> Expected | None:
    """Find the closed form of a problem whose body begins at rest; None where none is valid."""
    return theory(problem, space).form


def theory(problem: Problem, space: RowSpace) -> Theory:
    """Return the closed form of a problem whose body begins at rest, or why there is none.

    It is valid for a slender strip on a flat substrate at the equilibrium gap that adheres up to the end that
    is not driven, and is held only there. The small-strain form is returned where it is within SMALL_STRAIN
    of the one at finite strain, and otherwise the form at finite strain.
    """
    strip = free_strip(problem)
    if strip is None or not lies_free(problem, strip):
        return Theory()
    element = equal_element(strip, space)
    for find in (_beam, _tape):
        found = find(problem, strip, element)
        if found is not None:
            return found
    return Theory()


def invalid(
    form: Expected,
    crack_lengths: Sequence[float | None],
    adhering_end: float,
    shown: Callable[[float], str] = "{:.4g} L0".format,
) -> str | None:
    """Return why a closed form is not valid where a curve is read, or None where it is.

    `crack_lengths` are those from the driven end to the front (L0) where the reading begins and where it
    ends, None without a front; `adhering_end` is where the joint ends, from the same end, and `shown` writes
    a length.
    """
    first, last = crack_lengths[0], crack_lengths[-1]
    if first is None or last is None:
        return "no front was found along the joint"
    if first < form.arm:
        return (
            f"the free part must be {shown(form.arm)} long; at the start of the reading it is {shown(first)}"
        )
    left = adhering_end - last
    if left < form.behind:
        rest = shown(max(left, 0.0))
        return (
            f"the rest of the joint must be {shown(form.behind)} long; at the end of the reading it is {rest}"
        )
    return None


def equal_element(strip: FreeStrip, space: RowSpace) -> float | None:
    """Return the length of the elements along a strip; None where they are not equal."""
    sizes = np.diff(space.rows[0].breakpoints)
    # uniform breakpoints are rounded quotients
    return strip.length / len(sizes) if np.ptp(sizes) < ROUND_OFF * sizes[0] else None


def decay_length(problem: Problem, height: float) -> float | None:
    """Return the length (4 E'I/k)^(1/4) that a front reaches into a joint; None without attraction.

    Of a beam on springs (Hetenyi, Beams on Elastic Foundation, 1946) with the mean stiffness
    k = strength^2/(2 W) of the law during separation; at least the height of the strip, as for a layer.
    """
    return decay_of(problem.adhesion.law, problem.body.material, height)


def decay_of(law: AdhesionLaw, material: Material, height: float, compliance: float = 0.0) -> float | None:
    """Return the `decay_length` of a strip of a material that adheres by a law.

    `compliance` is that of what it adheres to: the displacement by the stress.
    """
    try:
        strength = law_character(law).strength
    except InputError:
        return None
    bending = plane_strain_modulus(material) * height**3 / 12
    stiffness = strength**2 / (2 * law.work_of_adhesion)
    if compliance:
        stiffness = 1 / (1 / stiffness + compliance)
    return max(float((4 * bending / stiffness) ** 0.25), height)


def lies_free(problem: Problem, strip: FreeStrip) -> bool:
    """Return whether a slender strip lies at the equilibrium gap, adheres to its far end, and is held."""
    adhesion, substrate, driven = problem.adhesion, problem.adhesion.substrate, problem.driven_side
    place = problem.body.shape.boundary(adhesion.side).evaluate([adhesion.start])
    gap, _, _ = evaluate_substrate(substrate.kernel, substrate.parameters, place)
    at_rest = abs(float(gap[0]) - adhesion.law.equilibrium_gap) < ROUND_OFF * strip.length
    up_to_the_end = (adhesion.start if driven == "right" else 1 - adhesion.end) == 0
    far = {"left": "right", "right": "left"}.get(driven or "")
    held_there = all(support.side == far and support.boundary.is_whole for support in problem.supports)
    slender = strip.length > SLENDER * strip.height
    return at_rest and up_to_the_end and held_there and slender


def tension_of(material: Material, strip: FreeStrip) -> float:
    """Return the tension per width with which a strip was laid."""
    stress = evaluate_material(material.kernel, material.parameters, np.eye(2)[None])[1]
    tension = strip.height * float(stress[0, 0, 0])
    return tension if abs(tension) > ROUND_OFF * material.youngs_modulus * strip.height else 0.0


def _beam(problem: Problem, strip: FreeStrip, element: float | None) -> Theory | None:
    beam = beam_peeling(problem)
    if beam is None or tension_of(problem.body.material, strip):
        return None
    work, material = problem.adhesion.law.work_of_adhesion, problem.body.material
    exact = bent_strip(material, strip.height, work, 1 / beam.radius)
    if exact is None:
        return Theory(reason="no bending moment releases the work of adhesion with this material")
    reach = decay_length(problem, strip.height) or strip.height
    small = abs(beam.moment / exact.moment - 1) <= SMALL_STRAIN
    curvature = 1 / beam.radius if small else exact.curvature
    # the published strip, at a bending strain of 0.09, is 0.9 % below beam theory with projected areas
    if problem.adhesion.traction == "projected" and strip.height * curvature / 2 > 0.1:
        return Theory(reason="the traction acts on projected areas, which the bending strain changes")
    period = None if element is None else float(np.degrees(element * curvature))
    return Theory(
        Expected(
            "beam theory" if small else "bending at finite strain",
            beam.moment if small else exact.moment,
            beam.onset_deg if small else float(np.degrees(strip.free_length * curvature)),
            period,
            strip.free_length + DECAY * reach,
            DECAY * reach,
        )
    )


def _tape(problem: Problem, strip: FreeStrip, element: float | None) -> Theory | None:
    """Return the theory of a strip peeled by a dead force: Kendall's tape, or a tape that slides."""
    adhesion, load = problem.adhesion, problem.drive
    whole = problem.driven[0].boundary.is_whole
    if not isinstance(load, PulledSide) or load.follows or load.control == "force" or not whole:
        return None
    # of two halves, one of which is modelled, each bends the other: a cantilever, whose force is not steady
    if adhesion.side != "bottom" or isinstance(adhesion.law, Mirrored):
        return None
    angle = remainder(load.angle if problem.driven_side == "right" else pi - load.angle, 2 * pi)
    tension = tension_of(problem.body.material, strip)
    held = adhesion.sliding_length is not None
    if angle <= 0 or (tension and not held):
        return None
    work, material = adhesion.law.work_of_adhesion, problem.body.material
    exact = peeled_tape(material, strip.height, work, angle, held=held)
    if exact is None:
        return None  # a tape so tense that it comes off by itself
    modulus = plane_strain_modulus(material)
    try:
        force = (
            kendall_force(work, modulus * strip.height, angle, tension)
            if held
            else sliding_tape_force(work, modulus * strip.height, angle)
        )
    except InputError:
        return None
    name = "Kendall's tape" if held else "sliding tape"
    small = abs(force / exact.force - 1) <= SMALL_STRAIN
    if not small:
        force, name = exact.force, f"{name}, finite strain"
    # the work per projected area grows with the stretch
    if problem.adhesion.traction == "projected" and abs(exact.stretch - 1) > SMALL_STRAIN:
        return Theory(reason="the traction acts on projected areas, which the stretch of the tape changes")
    period = None if element is None else element * (1 - cos(angle) if small else exact.rate)
    reach = decay_length(problem, strip.height) or strip.height
    arm = max(ARM * sqrt(modulus * strip.height**3 / 12 / force), strip.free_length + DECAY * reach)
    behind = reach_behind(problem, strip.height)
    return Theory(Expected(name, force, None, period, arm, behind))


def reach_behind(problem: Problem, height: float) -> float:
    """Return the reach of a front into a joint by bending and shear; with a shorter rest it is not steady."""
    return DECAY * max(decay_length(problem, height) or height, _shear_lag(problem, height))


def _shear_lag(problem: Problem, height: float) -> float:
    """Return the length sqrt(E'h/k) over which a joint takes up a tension, k = 2 W/d^2; 0 where it slides."""
    sliding, work = problem.adhesion.sliding_length, problem.adhesion.law.work_of_adhesion
    stiffness = plane_strain_modulus(problem.body.material) * height
    return 0.0 if sliding is None else sliding * sqrt(stiffness / (2 * work))
