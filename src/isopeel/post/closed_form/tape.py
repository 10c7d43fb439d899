"""Tapes without bending stiffness: the force that peels, by the balance of energies. All per unit width.

`stiffness` is E' h of the tape, force per width and strain; `angle` is the one between the free part and the
substrate, in radians. Strains are small, angles are not.
"""

from math import pi, sin, sqrt

from isopeel.common.errors import InputError


def kendall_force(work: float, stiffness: float, angle: float, prestrain_force: float = 0.0) -> float:
    """Return the force F that peels a tape at an angle: (F - P_0)^2/(2 E' h) + F (1 - cos angle) = W.

    Kendall (J. Phys. D 8, 1975, 1449) for P_0 = 0. With P_0, the tension that the adhering tape bears
    without sliding, and lengths and the work W measured along that tape: what peels gains the strain
    e = (F - P_0)/(E' h), the load does F (1 + e - cos angle), and P_0 e + E' h e^2/2 is stored. The larger
    root is returned: where there are two, the tape rests on the substrate between them. Raises InputError
    unless the angle lies in [0, pi], and where no positive force holds that balance: a tape so tense, or so
    compressed, that it comes off by itself.
    """
    if not 0 <= angle <= pi:
        raise InputError("angle", angle, "it must lie in [0, pi]")
    # F^2 + 2 half F = free, with 1 - cos = 2 sin^2(angle/2), which keeps its digits at small angles
    half = 2 * stiffness * sin(angle / 2) ** 2 - prestrain_force
    free = 2 * stiffness * work - prestrain_force**2
    if half**2 + free < 0 or (half >= 0 >= free):
        raise InputError("prestrain_force", prestrain_force, "it must leave a positive force to peel with")
    root = sqrt(half**2 + free)
    # the form without cancellation
    return free / (half + root) if half > 0 else root - half


def sliding_tape_force(work: float, stiffness: float, angle: float) -> float:
    """Return the force F that peels a tape whose adhering part slides freely and is held at its far end.

    F (1 - cos angle) + F^2 sin^2(angle)/(2 E' h) = W: without friction the adhering part bears F cos(angle),
    so that what peels gains only the rest of the energy F^2/(2 E' h), and the front moves with it; derived
    from the potential energy of both parts (Begley, Collino, Israelachvili and McMeeking, J. Mech. Phys.
    Solids 61, 2013, treat such tapes). Raises InputError unless the angle lies in (0, pi]; at angle 0 no
    force peels.
    """
    if not 0 < angle <= pi:
        raise InputError("angle", angle, "it must lie in (0, pi]")
    lever = 2 * sin(angle / 2) ** 2
    return 2 * work / (lever + sqrt(lever**2 + 2 * work / stiffness * sin(angle) ** 2))


def t_peel_force(work: float, stiffness: float) -> float:
    """Return the force S on each of two equal tapes that are pulled off each other at 90 degrees.

    2 S + S^2/(E' h) = W: for each length that peels, both loads do the work S (1 + e) with e = S/(E' h), and
    each tape stores S e/2. By symmetry this is Kendall's tape with half of the work of adhesion. Sliding
    along the other tape changes nothing, as the forces have no component along the joint.
    """
    return kendall_force(work / 2, stiffness, pi / 2)
