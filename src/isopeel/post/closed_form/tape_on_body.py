"""The closed form of a tape that is peeled off a deformable body at a right angle."""

from math import cos, pi, sin, sqrt

from isopeel.assembly.spaces import SpaceOfBodies, spaces_by_name
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.post.closed_form.expected import (
    ARM,
    DECAY,
    ROUND_OFF,
    SMALL_STRAIN,
    Expected,
    Theory,
    decay_of,
    equal_element,
    tension_of,
)
from isopeel.post.closed_form.finite_strain import peeled_tape
from isopeel.post.closed_form.strip import FreeStrip, strip_of
from isopeel.post.closed_form.t_peel import level, middle, peeled_strip, pulled_joint
from isopeel.post.closed_form.tape import kendall_force
from isopeel.problem import Problem


def tape_on_body(problem: Problem, space: SpaceOfBodies) -> Theory:
    """Return the closed form of a tape peeled off a body at 90 degrees, or why there is none.

    The force is Kendall's, whatever the stiffness of the body: in steady peeling, the deformation of the body
    moves with the front and takes no energy. It is valid for a slender strip that begins at rest at the
    equilibrium gap on a rectangle, adheres up to the end that is not driven, and is held only there.
    """
    found = _tape(problem)
    if found is None:
        return Theory()
    interface, (tape, base, name) = problem.adhesion, found
    if not interface.has_potential:
        return Theory(reason="two half-passes have no energy, and the closed form is a balance of energies")
    body = problem.body_of(name)
    (other,) = (one for one in problem.bodies if one.name != name)
    work, material = interface.law.work_of_adhesion, body.material
    exact = peeled_tape(material, tape.height, work, pi / 2)
    if exact is None:
        return Theory()
    stiffness = plane_strain_modulus(material) * tape.height
    force, source = kendall_force(work, stiffness, pi / 2), "Kendall's tape"
    if abs(force / exact.force - 1) > SMALL_STRAIN:
        force, source = exact.force, f"{source}, finite strain"
    element = equal_element(tape, spaces_by_name(problem, space)[name])
    period = element and exact.rate * element
    # of a layer; stresses decay in it over its height
    compliance = base.height / plane_strain_modulus(other.material)
    reach = max(decay_of(interface.law, material, tape.height, compliance) or tape.height, base.height)
    arm = max(ARM * sqrt(stiffness * tape.height**2 / 12 / force), tape.free_length + DECAY * reach)
    return Theory(Expected(source, force, None, period, arm, DECAY * reach))


def _tape(problem: Problem) -> tuple[FreeStrip, FreeStrip, str] | None:
    """Measure a tape and the body below or above it, and name the tape; None for other problems."""
    found = pulled_joint(problem)
    if found is None:
        return None
    interface, pair, drive = found
    pulled, *others = problem.driven
    if others or abs(cos(drive.angle)) > ROUND_OFF:
        return None
    own, against = sorted(pair, key=lambda one: one.body != pulled.boundary.body)
    tape = peeled_strip(problem, own, pulled.boundary)
    # the side of the rectangle that is called right here does not matter
    base = strip_of(problem.body_of(against.body).shape, against, "right")
    if own.body != pulled.boundary.body or tape is None or base is None:
        return None
    above = 1.0 if middle(problem, own)[1] > middle(problem, against)[1] else -1.0
    gap = above * (level(problem, own) - level(problem, against))
    at_rest = abs(gap - interface.law.equilibrium_gap) < ROUND_OFF * tape.length
    away = abs(above * pulled.factor * sin(drive.angle) - 1) < ROUND_OFF
    tense = tension_of(problem.body_of(own.body).material, tape)
    return (tape, base, own.body) if at_rest and away and not tense else None
