"""What theory says of a problem, where it says anything."""

from dataclasses import dataclass

import numpy as np

from isopeel.physics.batch import evaluate_material
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.post.closed_form.strip import beam_peeling, free_strip
from isopeel.post.closed_form.tape import kendall_force, sliding_tape_force
from isopeel.problem import Problem
from isopeel.splines.rows import RowSpace


@dataclass(frozen=True)
class Expected:
    """The steady reaction of a closed form, in the units of the drive's columns."""

    source: str
    reaction: float
    onset: float | None  # parameter at which peeling begins
    period: float | None  # in which the front passes one of equal elements; None where they are not


def expected(problem: Problem, space: RowSpace) -> Expected | None:
    """Find the closed form of a problem; None where there is none."""
    for theory in (_beam, _tape):
        found = theory(problem, _equal_elements(space))
        if found is not None:
            return found
    return None


def _equal_elements(space: RowSpace) -> int | None:
    sizes = np.diff(space.rows[0].breakpoints)
    # uniform breakpoints are rounded quotients
    return len(sizes) if np.ptp(sizes) < 1e-9 * sizes[0] else None


def _beam(problem: Problem, elements: int | None) -> Expected | None:
    beam = beam_peeling(problem)
    if beam is None:
        return None
    period = beam.period_deg(elements) if elements else None
    return Expected("beam theory", beam.moment, beam.onset_deg, period)


def _tape(problem: Problem, elements: int | None) -> Expected | None:
    """A strip that a dead force pulls off: Kendall's tape, or one that slides where nothing holds it."""
    strip, load = free_strip(problem), problem.drive.load
    if strip is None or load is None or load.follows or load.control == "force":
        return None
    material, work = problem.body.material, problem.adhesion.law.work_of_adhesion
    # from the adhering part to the free one
    angle = abs(np.angle(np.exp(1j * (load.angle if problem.drive.side == "right" else np.pi - load.angle))))
    stiffness = plane_strain_modulus(material) * strip.height
    tension = (
        strip.height * evaluate_material(material.kernel, material.parameters, np.eye(2)[None])[1][0, 0, 0]
    )
    if problem.adhesion.sliding_length is not None:
        force = kendall_force(work, stiffness, float(angle), float(tension))
    elif tension == 0 and angle > 0:
        force = sliding_tape_force(work, stiffness, float(angle))
    else:
        return None
    period = strip.length / elements * (1 - np.cos(angle)) if elements else None
    source = "Kendall's tape" if problem.adhesion.sliding_length is not None else "sliding tape"
    return Expected(source, force, None, period and float(period))
