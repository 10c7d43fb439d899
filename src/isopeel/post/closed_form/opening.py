"""An arm that is lifted off at its end, as in double cantilever beams and wedge tests: force and crack."""

from dataclasses import dataclass
from math import pi, remainder, sqrt

from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.post.closed_form.expected import decay_length, lies_free
from isopeel.post.closed_form.strip import free_strip
from isopeel.problem import Problem, PulledSide

# Each of the limits keeps the error of the force at a given lift within 1 %. The compliance of the arm's root
# lengthens the crack; its effect on the force vanishes to first order: for an arm on springs the relative
# error is exactly (decay length/crack)^3/4 (from the compliance of a beam on springs, that of
# `front.beam_decay`).
_SLENDER = 8.0  # crack over height: shear adds about (3/4)(height/crack)^2 to the compliance
_DECAYS = 4.0  # crack over decay length
_GROWN = 1.0  # decay lengths that the crack has grown by
_LEFT = 2.0  # decay lengths of the joint that are left
#: Lift over crack up to which the small rotations of beam theory give a crack's length within 1.4 %.
_SLOPE = 0.25


@dataclass(frozen=True)
class LiftedArm:
    """One arm of bending stiffness E'I per width, lifted by d at its end; the joint takes W for this arm."""

    bending_stiffness: float
    work: float

    def crack_length(self, lift: float) -> float:
        """Return the length a = (9 E'I d^2/(2 W))^(1/4), for a strip (3 E'h^3 d^2/(8 W))^(1/4).

        It is valid at small rotations, and follows from the moment P a = sqrt(2 E'I W) at the front and d = P
        a^3/(3 E'I). It is the length of an arm clamped at the front: the compliance of the root is part of
        it.
        """
        return float((9 * self.bending_stiffness * lift**2 / (2 * self.work)) ** 0.25)

    def crack_by_compliance(self, lift: float, force: float) -> float:
        """Return the length a = (3 E'I d/P)^(1/3) of an arm clamped at its front with the same compliance."""
        return float((3 * self.bending_stiffness * lift / force) ** (1 / 3))

    def force(self, lift: float) -> float:
        """Return the force P of the elastica at any rotation; for small ones it is `double_cantilever_force`.

        A dead force P across the joint rotates the end by phi. Along the arm E'I theta'^2/2 =
        P (sin phi - sin theta), and the joint takes W = M^2/(2 E'I) = P sin phi at the front. So
        d = sqrt(E'I/(2 P)) int_0^phi sin(theta)/sqrt(sin(phi) - sin(theta)) dtheta, which is solved for phi.
        Lifts much larger than sqrt(E'I/W) rotate the arm by 90 degrees: then P = W, as for a tape.
        """
        from scipy.integrate import quad
        from scipy.optimize import brentq

        # with c = sin(phi), sin(theta) = c (1 - u^2) takes the root out of the integral
        longest = sqrt(self.bending_stiffness / self.work)

        def lifted(c: float) -> float:
            integral = quad(lambda u: (1 - u**2) / sqrt(1 - (c * (1 - u**2)) ** 2), 0, 1)[0]
            return float(longest * sqrt(2) * c**2 * integral)

        if lift >= lifted(1 - 1e-9):
            return self.work
        return self.work / float(brentq(lambda c: lifted(c) - lift, 0.0, 1 - 1e-9, xtol=1e-14))


@dataclass(frozen=True)
class Opening:
    """The closed form of an opening test at its end: lengths are None where rotations are not small."""

    force: float
    crack_length: float | None
    by_compliance: float | None  # of the run


def opening(problem: Problem, lift: float, force: float) -> Opening | str | None:
    """Return the closed form for the lift of an arm's end, a text on why it is not valid, or None.

    `force` is that of the run. None is returned for other problems: the form is that of a slender strip on a
    flat substrate, or on its mirror image, lifted across at one end and held at the other.
    """
    strip, load = free_strip(problem), problem.drive
    if strip is None or not isinstance(load, PulledSide) or load.follows or problem.adhesion.side != "bottom":
        return None
    across = abs(remainder(load.angle - pi / 2, 2 * pi)) < 1e-6
    if not across or not lies_free(problem, strip) or lift <= 0 or force <= 0:
        return None
    reach = decay_length(problem, strip.height)
    if reach is None:
        return None
    work = problem.adhesion.law.work_of_adhesion
    arm = LiftedArm(plane_strain_modulus(problem.body.material) * strip.height**3 / 12, work)
    crack = arm.crack_length(lift)
    for wrong, text in (
        (crack < strip.free_length + _GROWN * reach, "the crack has not grown by the reach of its front"),
        (crack < _SLENDER * strip.height, f"the open arm is shorter than {_SLENDER:g} heights"),
        (crack < _DECAYS * reach, f"the front is {reach / crack:.2g} times as long as the crack"),
        (crack > strip.length - _LEFT * reach, "the end of the joint is near"),
    ):
        if wrong:
            return text
    small = lift <= _SLOPE * crack
    by_compliance = arm.crack_by_compliance(lift, force)
    return Opening(arm.force(lift), crack if small else None, by_compliance if small else None)
