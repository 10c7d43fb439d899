"""The energy release rates of opening and sliding at a front, by the loads of two equal arms."""

from dataclasses import dataclass

import numpy as np

from isopeel.assembly.spaces import SpaceOfBodies
from isopeel.common.arrays import FloatArray
from isopeel.physics.joints import JointLaw
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.post.contour import Arm, Contour, Contours
from isopeel.post.fields import side_positions
from isopeel.post.sections import section_means
from isopeel.post.straight_side import OPPOSITE, straight_side
from isopeel.problem import Boundary, Interface, Problem
from isopeel.results.fields import StoredState

#: Difference of two equal thicknesses, over the thickness.
_ROUND_OFF = 1e-9


@dataclass(frozen=True)
class ModeRates:
    """Energy release rates of opening, G_I, and of sliding, G_II, per area."""

    opening: float
    sliding: float

    @property
    def ratio(self) -> float:
        """Return G_II/(G_I + G_II); nan where both vanish."""
        total = self.opening + self.sliding
        return self.sliding / total if total > 0 else np.nan


@dataclass(frozen=True, eq=False)
class ArmLoads:
    """The loads of the free part of an arm on its section at the front."""

    tension: float  # along the joint, towards the open part
    moment: float  # anticlockwise, about the middle of the section


def equal_arm_rates(upper: ArmLoads, lower: ArmLoads, height: float, bending_stiffness: float) -> ModeRates:
    """Return the rates of two equal arms of a height, with E'I of one of them per width.

    The joint points to its open part along e, and the upper arm lies on the side of e turned anticlockwise.
    With M_I = (M_1 - M_2)/2, M_II = (M_1 + M_2)/2 and N = (N_1 - N_2)/2,

        G_I = M_I^2/(E'I),  G_II = 3 (M_II + N h/6)^2/(4 E'I).

    This is the energy of beams before and behind the front (Hutchinson and Suo, Adv. Appl. Mech. 29,
    1992), divided by symmetry: loads that are mirror images only open, and the others only slide. Arms
    that are pressed together, M_I < 0, do not open. Shear forces are not included.
    """
    opening = max(upper.moment - lower.moment, 0.0) / 2
    sliding = (upper.moment + lower.moment) / 2 + (upper.tension - lower.tension) / 2 * height / 6
    return ModeRates(opening**2 / bending_stiffness, 3 * sliding**2 / (4 * bending_stiffness))


def mode_rates(
    problem: Problem, space: SpaceOfBodies, state: StoredState, interface: str = ""
) -> ModeRates | str:
    """Return the energy release rates at the front of a joint of two equal arms, or why they are not given.

    The loads on the sections at the front are those on sections in the free parts (`section_means`), carried
    to the front in the present state, see `equal_arm_rates`. The rates are per width, in the units of the
    problem. Of several interfaces one is chosen by its name.
    """
    reason = _unfit(problem.interface_of(interface))
    found = reason or Contours(problem, space, interface).around(state)
    if isinstance(found, str):
        return found
    return rates_at(problem, space, state.displacement, found, interface)


def rates_at(
    problem: Problem, space: SpaceOfBodies, displacement: FloatArray, found: Contour, interface: str
) -> ModeRates | str:
    """Return the rates by the sections of a contour, at coefficients (size, 2): see `mode_rates`."""
    joint = problem.interface_of(interface)
    reason = _unfit(joint)
    if reason:
        return reason
    first, second = found.arms
    if found.layers:
        return "the arms have layers, and moments do not divide the energy into opening and sliding"
    bodies = [problem.body_of(arm.behind.body) for arm in found.arms]
    alike = abs(first.height / second.height - 1) <= _ROUND_OFF
    if not alike or bodies[0].material != bodies[1].material:
        return "the arms differ, and moments do not divide the energy into opening and sliding"
    # the tangent with the body of the interface on its left is the normal turned clockwise
    side = straight_side(problem, joint.boundary)
    assert side is not None
    anticlockwise = joint.side in ("bottom", "right")
    on_left = (float(found.along @ side.direction) > 0) == anticlockwise
    along = (1 if on_left else -1) * np.array([found.normal[1], -found.normal[0]])
    loads = [_loads(problem, space, displacement, arm, found.along, along) for arm in found.arms]
    upper, lower = loads if on_left else loads[::-1]
    stiffness = plane_strain_modulus(bodies[0].material) * first.height**3 / 12
    return equal_arm_rates(upper, lower, first.height, stiffness)


def _unfit(joint: Interface) -> str:
    """Return why an interface has no mode ratio; nothing where it may have one."""
    if isinstance(joint.law, JointLaw) and isinstance(joint.against, Boundary):
        return ""
    return "faces that slide without friction have no mode ratio: it needs a joint law"


def _loads(
    problem: Problem,
    space: SpaceOfBodies,
    displacement: FloatArray,
    arm: Arm,
    at_rest: FloatArray,
    along: FloatArray,
) -> ArmLoads:
    """Return the loads of the free part of an arm on its section at the front."""
    body, side, front = arm.behind.body, arm.behind.side, np.array([arm.front])
    faces = [
        side_positions(problem, space, displacement, one, front, body)[0] for one in (side, OPPOSITE[side])
    ]
    middle = (faces[0] + faces[1]) / 2
    means = section_means(problem, space, displacement, arm.behind, at_rest, middle)
    return ArmLoads(float(means.force @ along), means.moment)
