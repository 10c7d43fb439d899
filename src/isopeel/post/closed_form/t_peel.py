"""The closed form of two equal strips that adhere to each other and are pulled apart: a T-peel test."""

from math import cos, pi, sin, sqrt

import numpy as np

from isopeel.assembly.spaces import SpaceOfBodies, spaces_by_name
from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion import Contact
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.post.closed_form.expected import (
    ARM,
    DECAY,
    ROUND_OFF,
    SLENDER,
    SMALL_STRAIN,
    Expected,
    Theory,
    decay_of,
    equal_element,
    tension_of,
)
from isopeel.post.closed_form.finite_strain import peeled_tape
from isopeel.post.closed_form.strip import FreeStrip, strip_of
from isopeel.post.closed_form.tape import t_peel_force
from isopeel.problem import Boundary, Interface, Problem, PulledSide
from isopeel.splines.nurbs import Side


def t_peel(problem: Problem, space: SpaceOfBodies) -> Theory:
    """Return the closed form of a T-peel test of bodies that begin at rest, or why there is none.

    It is valid for two slender strips of one material and height that lie at the equilibrium gap, adhere up
    to the ends that are not driven, are held only there, and are pulled apart at 90 degrees by dead forces.
    The arms of strips that differ bend the joint ahead of the front, so that no state of them is steady.
    """
    strips = _arms(problem)
    if strips is None:
        return Theory()
    interface, material = problem.adhesion, problem.bodies[0].material
    if not interface.has_potential:
        return Theory(reason="two half-passes have no energy, and the closed form is a balance of energies")
    work, (strip, other) = interface.law.work_of_adhesion, strips
    exact = peeled_tape(material, strip.height, work / 2, pi / 2)
    if exact is None:
        return Theory()
    stiffness = plane_strain_modulus(material) * strip.height
    force, name = t_peel_force(work, stiffness), "T-peel"
    if abs(force / exact.force - 1) > SMALL_STRAIN:
        force, name = exact.force, "T-peel, finite strain"
    spaces = spaces_by_name(problem, space)
    sizes = [equal_element(strip, spaces[body.name]) for body in problem.bodies]
    # while the front passes an element, both arms move
    period = 2 * exact.rate * sizes[0] if sizes[0] and sizes[0] == sizes[1] else None
    # by symmetry, each strip is one on a plane that mirrors it
    reach = decay_of(Mirrored(interface.law), material, strip.height) or strip.height
    turn = ARM * sqrt(stiffness * strip.height**2 / 12 / force)
    arm = max(turn, max(strip.free_length, other.free_length) + DECAY * reach)
    return Theory(Expected(name, force, None, period, arm, DECAY * reach))


def _arms(problem: Problem) -> tuple[FreeStrip, FreeStrip] | None:
    """Measure the upper and the lower strip; None for other problems."""
    found = pulled_joint(problem)
    if found is None:
        return None
    interface, pair, drive = found
    pulled = {one.boundary.body: one for one in problem.driven}
    if len(pulled) != len(problem.driven) or len(pulled) != 2 or abs(cos(drive.angle)) > ROUND_OFF:
        return None
    upper, lower = sorted(pair, key=lambda one: -middle(problem, one)[1])
    # of a parameter above zero
    forces = [pulled[one.body].factor * sin(drive.angle) for one in (upper, lower)]
    above, below = (peeled_strip(problem, one, pulled[one.body].boundary) for one in (upper, lower))
    if above is None or below is None or not np.allclose(forces, (1, -1), rtol=0, atol=ROUND_OFF):
        return None
    top, base = (problem.body_of(one.body) for one in (upper, lower))
    if top.material != base.material or abs(above.height / below.height - 1) > ROUND_OFF:
        return None
    ends = [_points_right(problem, one.boundary) for one in pulled.values()]
    gap = level(problem, upper) - level(problem, lower)
    at_rest = abs(gap - interface.law.equilibrium_gap) < ROUND_OFF * above.length
    if ends[0] != ends[1] or not at_rest or tension_of(top.material, above):
        return None
    return above, below


def pulled_joint(problem: Problem) -> tuple[Interface, tuple[Boundary, Boundary], PulledSide] | None:
    """Return the joint of two bodies that an unknown dead force pulls, its sides, and the drive, or None."""
    drive, interfaces = problem.drive, problem.interfaces
    if len(problem.bodies) != 2 or len(interfaces) != 1 or problem.loads:
        return None
    (interface,) = interfaces
    if not isinstance(interface.against, Boundary) or isinstance(interface.law, Contact):
        return None
    if not isinstance(drive, PulledSide) or drive.follows or drive.control == "force":
        return None
    return interface, (interface.boundary, interface.against), drive


def peeled_strip(problem: Problem, boundary: Boundary, driven: Boundary) -> FreeStrip | None:
    """Measure a slender strip that adheres up to the end that is not driven, and is held only there."""
    far: dict[Side, Side] = {"left": "right", "right": "left"}
    if driven.side not in far or boundary.side not in ("bottom", "top") or not driven.is_whole:
        return None
    strip = strip_of(problem.body_of(boundary.body).shape, boundary, driven.side)
    up_to_the_end = (boundary.start if driven.side == "right" else 1 - boundary.end) == 0
    held_there = all(
        support.side == far[driven.side] and support.boundary.is_whole
        for support in problem.supports
        if support.boundary.body == boundary.body
    )
    slender = strip is not None and strip.length > SLENDER * strip.height
    return strip if up_to_the_end and held_there and slender else None


def level(problem: Problem, boundary: Boundary) -> float:
    """Return the height of the start of a boundary."""
    side = problem.body_of(boundary.body).shape.boundary(boundary.side)
    return float(side.evaluate([boundary.start])[0, 1])


def _points_right(problem: Problem, end: Boundary) -> bool:
    """Return whether an end of a strip along the x axis is the one at larger x."""
    side = problem.body_of(end.body).shape.boundary(end.side)
    return bool(side.control_points[0, 0] > middle(problem, end)[0])


def middle(problem: Problem, boundary: Boundary) -> FloatArray:
    """Return the mean of the control points of the body of a boundary."""
    mean: FloatArray = problem.body_of(boundary.body).shape.control_points.reshape(-1, 2).mean(axis=0)
    return mean
