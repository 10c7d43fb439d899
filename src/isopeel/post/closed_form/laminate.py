"""The closed form of a tape of several tied layers that is peeled off a plane at a right angle."""

from math import cos, pi, sin, sqrt

import numpy as np

from isopeel.assembly.spaces import SpaceOfBodies, spaces_by_name
from isopeel.common.errors import InputError
from isopeel.physics.adhesion import Contact
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.batch import evaluate_substrate
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.physics.substrates import Flat
from isopeel.post.closed_form.beams import composite_stiffness
from isopeel.post.closed_form.expected import (
    ARM,
    DECAY,
    ROUND_OFF,
    SLENDER,
    SMALL_STRAIN,
    Expected,
    Theory,
    equal_element,
    tension_of,
)
from isopeel.post.closed_form.finite_strain import peeled_layers
from isopeel.post.closed_form.strip import FreeStrip, strip_of
from isopeel.post.closed_form.tape import kendall_force
from isopeel.post.law import law_character
from isopeel.problem import Boundary, Interface, Problem, PulledSide
from isopeel.splines.nurbs import Side


def laminate(problem: Problem, space: SpaceOfBodies) -> Theory:
    """Return the closed form of a tape of tied layers peeled off a plane at 90 degrees, or why there is none.

    It is Kendall's force with the sum of E' h of the layers: in steady peeling the layers have one stretch
    beyond the bend, and what bends moves with the front. It is valid for rectangles of one length, tied one
    upon another. The lowest one begins at rest at the equilibrium gap, adheres up to the end that is not
    pulled, and all are held only there.
    """
    found = _layers(problem)
    if found is None:
        return Theory()
    interface, names, strips = found
    bodies = [problem.body_of(name) for name in names]
    work = interface.law.work_of_adhesion
    layers = tuple((body.material, strip.height) for body, strip in zip(bodies, strips, strict=True))
    exact = peeled_layers(layers, work, pi / 2)
    if exact is None:
        return Theory()
    stretching, bending = composite_stiffness(
        [(plane_strain_modulus(material), height) for material, height in layers]
    )
    force, source = kendall_force(work, stretching, pi / 2), "Kendall's tape of layers"
    if abs(force / exact.force - 1) > SMALL_STRAIN:
        force, source = exact.force, f"{source}, finite strain"
    element = equal_element(strips[0], spaces_by_name(problem, space)[names[0]])
    reach = _reach(interface, bending, layers)
    arm = max(ARM * sqrt(bending / force), strips[0].free_length + DECAY * reach)
    return Theory(Expected(source, force, None, element and exact.rate * element, arm, DECAY * reach))


def _reach(interface: Interface, bending: float, layers: tuple[tuple[object, float], ...]) -> float:
    """Return how far a front reaches into the joint: of a beam on springs, or the height of all layers."""
    height = sum(height for _, height in layers)
    try:
        strength = law_character(interface.law).strength
    except InputError:
        return height
    stiffness = strength**2 / (2 * interface.law.work_of_adhesion)
    return max(float((4 * bending / stiffness) ** 0.25), height)


def _layers(problem: Problem) -> tuple[Interface, list[str], list[FreeStrip]] | None:
    """Return the interface, and names and measures of the layers from it upwards; None for other problems."""
    drive = problem.drive
    if len(problem.ties) != len(problem.bodies) - 1 or len(problem.interfaces) != 1 or problem.loads:
        return None
    if not problem.ties or not isinstance(drive, PulledSide) or drive.follows or drive.control == "force":
        return None
    (interface,), (pulled, *others) = problem.interfaces, problem.driven
    side, upwards = pulled.boundary.side, pulled.factor * sin(drive.angle)
    turned = abs(cos(drive.angle)) > ROUND_OFF or abs(upwards - 1) > ROUND_OFF
    if others or turned or side not in ("left", "right") or not pulled.boundary.is_whole:
        return None
    if not _at_rest(problem, interface, side == "right"):
        return None
    faces = _stack(problem, interface.boundary)
    if faces is None or pulled.boundary.body not in [face.body for face in faces]:
        return None
    strips = [strip_of(problem.body_of(face.body).shape, face, side) for face in faces]
    measured = [strip for strip in strips if strip is not None]
    held_there = all(
        one.side not in (side, "bottom", "top") and one.boundary.is_whole for one in problem.supports
    )
    tense = any(
        tension_of(problem.body_of(face.body).material, strip)
        for face, strip in zip(faces, measured, strict=False)
    )
    height = sum(strip.height for strip in measured)
    if len(measured) != len(faces) or not held_there or tense or measured[0].length <= SLENDER * height:
        return None
    return interface, [face.body for face in faces], measured


def _stack(problem: Problem, lowest: Boundary) -> list[Boundary] | None:
    """Return the lower faces of bodies that are tied one upon another over their whole length."""
    faces, ties = [lowest], list(problem.ties)
    while ties:
        upper: Side = "top" if faces[-1].side == "bottom" else "bottom"
        face = Boundary(faces[-1].body, upper)
        found = [tie for tie in ties if face in (tie.boundary, tie.to)]
        if len(found) != 1:
            return None
        (tie,) = found
        ties.remove(tie)
        above = tie.to if tie.boundary == face else tie.boundary
        own, other = (
            problem.body_of(one.body).shape.boundary(one.side).evaluate([0.0, 1.0]) for one in (face, above)
        )
        apart = float(np.abs(own - other).max())
        if above.side not in ("bottom", "top") or apart > ROUND_OFF * float(np.ptp(own)):
            return None
        faces.append(above)
    return faces


def _at_rest(problem: Problem, interface: Interface, to_the_left: bool) -> bool:
    """Return whether an interface with a plane begins at its gap, without a hold along it, at the far end."""
    law, plane, boundary = interface.law, interface.against, interface.boundary
    if not isinstance(plane, Flat) or plane.angle != Flat().angle or isinstance(law, Contact | Mirrored):
        return False
    if boundary.side not in ("bottom", "top") or interface.traction != "reference":
        return False
    place = problem.body_of(boundary.body).shape.boundary(boundary.side).evaluate([boundary.start])
    gap, _, _ = evaluate_substrate(plane.kernel, plane.parameters, place)
    up_to_the_end = boundary.start == 0 if to_the_left else boundary.end == 1
    return up_to_the_end and abs(float(gap[0]) - law.equilibrium_gap) < ROUND_OFF * max(
        1.0, float(abs(place).max())
    )
