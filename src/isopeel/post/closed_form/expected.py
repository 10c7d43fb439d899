"""What theory says of a problem, where it says anything."""

from dataclasses import dataclass
from math import cos, pi, remainder

import numpy as np

from isopeel.errors import InputError
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.batch import evaluate_material, evaluate_substrate
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.post.closed_form.strip import FreeStrip, beam_peeling, free_strip
from isopeel.post.closed_form.tape import kendall_force, sliding_tape_force
from isopeel.problem import Problem
from isopeel.splines.rows import RowSpace

_ROUND_OFF = 1e-9
_SLENDER = 8.0  # lengths over heights from which a strip is a beam


@dataclass(frozen=True)
class Expected:
    """The steady reaction of a closed form, in the units of the drive's columns."""

    source: str
    reaction: float
    onset: float | None  # parameter at which peeling begins
    period: float | None  # in which the front passes one of equal elements; None where they are not


def expected(problem: Problem, space: RowSpace) -> Expected | None:
    """Find the closed form of a problem whose body begins at rest; None where there is none.

    It takes a slender strip that lies on a flat substrate at the equilibrium gap, adheres up to the end that
    is not driven, and is held nowhere but there.
    """
    strip = free_strip(problem)
    if strip is None or not _lies_free(problem, strip):
        return None
    sizes = np.diff(space.rows[0].breakpoints)
    # uniform breakpoints are rounded quotients
    element = strip.length / len(sizes) if np.ptp(sizes) < _ROUND_OFF * sizes[0] else None
    for theory in (_beam, _tape):
        found = theory(problem, strip, element)
        if found is not None:
            return found
    return None


def _lies_free(problem: Problem, strip: FreeStrip) -> bool:
    adhesion, substrate, driven = problem.adhesion, problem.adhesion.substrate, problem.drive.side
    place = problem.body.shape.boundary(adhesion.side).evaluate([adhesion.start])
    gap, _, _ = evaluate_substrate(substrate.kernel, substrate.parameters, place)
    at_rest = abs(float(gap[0]) - adhesion.law.equilibrium_gap) < _ROUND_OFF * strip.length
    up_to_the_end = (adhesion.start if driven == "right" else 1 - adhesion.end) == 0
    far = {"left": "right", "right": "left"}.get(driven)
    held_there = all(fixed.side == far for fixed in problem.fixed)
    slender = strip.length > _SLENDER * strip.height
    return at_rest and up_to_the_end and held_there and slender


def _tension(problem: Problem, strip: FreeStrip) -> float:
    """Force per width along the strip that it is laid with."""
    material = problem.body.material
    stress = evaluate_material(material.kernel, material.parameters, np.eye(2)[None])[1]
    tension = strip.height * float(stress[0, 0, 0])
    return tension if abs(tension) > _ROUND_OFF * material.youngs_modulus * strip.height else 0.0


def _beam(problem: Problem, strip: FreeStrip, element: float | None) -> Expected | None:
    beam = beam_peeling(problem)
    if beam is None or _tension(problem, strip):
        return None
    period = None if element is None else float(np.degrees(element / beam.radius))
    return Expected("beam theory", beam.moment, beam.onset_deg, period)


def _tape(problem: Problem, strip: FreeStrip, element: float | None) -> Expected | None:
    """A strip that a dead force pulls off: Kendall's tape, or one that slides where nothing holds it."""
    adhesion, drive, load = problem.adhesion, problem.drive, problem.drive.load
    if load is None or load.follows or load.control == "force" or (load.start, load.end) != (0.0, 1.0):
        return None
    # of two halves, one of which is modelled, each bends the other: a cantilever, whose force is not steady
    if adhesion.side != "bottom" or isinstance(adhesion.law, Mirrored):
        return None
    angle = remainder(load.angle if drive.side == "right" else pi - load.angle, 2 * pi)
    tension = _tension(problem, strip)
    held = adhesion.sliding_length is not None
    if angle <= 0 or (tension and not held):
        return None
    work, stiffness = (
        adhesion.law.work_of_adhesion,
        plane_strain_modulus(problem.body.material) * strip.height,
    )
    period = None if element is None else element * (1 - cos(angle))
    if not held:
        return Expected("sliding tape", sliding_tape_force(work, stiffness, angle), None, period)
    try:
        return Expected("Kendall's tape", kendall_force(work, stiffness, angle, tension), None, period)
    except InputError:
        return None  # a tape so tense that it comes off by itself
