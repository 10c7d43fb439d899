"""Tapes pulled by a force at 10 to 180 degrees: bonded to the substrate (Kendall), or sliding.

Answer: F (1 - cos a) + F^2/(2 E'h) = W of a bonded tape, with sin^2(a) in the second term of a sliding one.
Range: strain F/(E'h) of the free arm from 0.0002 to 0.01, so that what the material does at finite strain
(a share of the order of the strain of the second term) is below 1 %. The bending at the front takes no
part, as it moves along without change. The arm is longer than 5 elastica lengths l = sqrt(E'I/F): bent by
the front it deviates from the force by 8 tan(a/4) exp(-s/l) at its end at most, which changes the force by
half the square of that over 1 - cos a, and so by less than 0.1 %.
"""

from math import cos, radians, sin, sqrt

from trials.case import Answer, Drawn
from trials.dice import Dice
from trials.quantities import rounded
from trials.sheets import (
    HEIGHTS,
    MODULI,
    SMALL_HEIGHTS,
    SMALL_WORKS,
    WORKS,
    element_size,
    law,
    material,
    mesh,
    path,
    poissons_ratio,
    process_zone,
    units,
)

STRAINS = (2e-4, 0.01)
#: Process zones over elastica lengths.
ZONES = (0.15, 1.5)
#: Least length of the arm at the end, in elastica lengths.
ARM = 5.0


def draw(dice: Dice) -> Drawn:
    """Draw a tape, the angle it is pulled at, and a mesh."""
    while True:
        drawn = _tape(dice)
        if drawn:
            return drawn


def steady_force(work: float, stiffness: float, angle: float, *, bonded: bool) -> float:
    """The force per width of the closed form."""
    lever = 1 - cos(angle)
    stretched = (1.0 if bonded else sin(angle) ** 2) / (2 * stiffness)
    return 2 * work / (lever + sqrt(lever**2 + 4 * stretched * work))


def _angle(dice: Dice) -> float:
    sort = dice.random.random()
    if sort < 0.12:
        return 180.0
    if sort < 0.6:
        return dice.pick((10.0, 15.0, 20.0, 30.0, 45.0, 60.0, 75.0, 90.0, 90.0, 120.0, 135.0, 150.0, 165.0))
    return round(dice.between(10.0, 178.0), 1)


def _tape(dice: Dice) -> Drawn | None:
    small, bonded, degrees = dice.chance(0.2), dice.chance(0.65), _angle(dice)
    angle = radians(degrees)
    height = dice.decades(*(SMALL_HEIGHTS if small else HEIGHTS))
    work = dice.decades(*(SMALL_WORKS if small else WORKS))
    ratio, strain = poissons_ratio(dice), dice.decades(*STRAINS)
    part = 1.0 if bonded else sin(angle) ** 2
    stiffness = work / (strain * (1 - cos(angle)) + part * strain**2 / 2)
    modulus = rounded(stiffness / height * (1 - ratio**2))
    if not MODULI[0] <= modulus <= MODULI[1]:
        return None
    stiffness = modulus / (1 - ratio**2) * height
    force = steady_force(work, stiffness, angle, bonded=bonded)
    elastica = height / sqrt(12 * force / stiffness)
    bending = stiffness * height**2 / 12
    # near the front the tape bends by at most 2 force (1 - cos) over its stiffness, whatever the angle
    strength = rounded(sqrt(bending * work) / (dice.decades(*ZONES) * elastica) ** 2)
    zone = process_zone(stiffness / height, bending, work, strength)
    chosen = law(dice, work, strength, small=small)
    free = dice.between(1.0, 3.0) * elastica
    # the arm stands at its angle, and the law has let go at the end of the joint; steep arms lift at once
    risen = chosen.spent / sin(min(angle, radians(90.0)) / 2)
    arm = ARM * elastica + max(risen, 3 * zone)
    behind = 5 * zone + 3 * elastica
    # a bonded tape hands its tension to the substrate over d sqrt(E'h/(2 W)), d the sliding length
    shear_lag = sqrt(stiffness / (2 * work))
    sliding_length = rounded(min(chosen.spent / dice.between(1.0, 5.0), behind / 4 / shear_lag))
    if bonded:
        zone = min(zone, sliding_length * shear_lag)
    size = element_size(dice, zone)
    window = max(0.2 * arm, 2.5 * size if size else 0.02 * (arm + 10 * zone))
    peeled = arm + window - free
    adhering = peeled + behind + (2 * size if size else 0.0)
    if free + adhering > 300 * elastica or chosen.spent > 10 * elastica:
        return None
    meshed = mesh(dice, free + adhering, size, zone)
    rate = 1 - cos(angle) + force / stiffness * (1.0 if bonded else sin(angle) ** 2)
    # the free arm turns up, and of a sliding tape all that adheres is stretched first
    first = free * (1 - cos(angle)) + (arm + window) * force / stiffness
    if not bonded:
        first += (adhering - peeled) * force / stiffness * cos(angle) ** 2
    end, step = path(peeled * rate + first, dice.pick((60, 100, 150)))
    begins = end - min(window * rate, 0.5 * end)
    adhesion = {**chosen.table, "length": dice.length(rounded(adhering, 6))}
    if bonded:
        adhesion["sliding_length"] = dice.length(sliding_length)
    if dice.chance(0.2) and not bonded:
        adhesion["irreversible"] = True
    return Drawn(
        f"{'bonded' if bonded else 'sliding'}, {degrees:g} degrees, {chosen.table['law']}",
        {
            **units(dice, height),
            "body": {
                "shape": "strip",
                "length": dice.length(rounded(free + adhering, 6)),
                "height": dice.length(height),
            },
            "material": material(dice, modulus, ratio),
            "adhesion": adhesion,
            "discretization": meshed.table,
            "drive": {
                "kind": "force",
                "side": "right",
                "angle": f"{degrees:g} deg",
                "to": dice.length(end),
                "step": dice.length(step),
            },
            "reading": {"window": [dice.length(rounded(begins)), dice.length(end)]},
        },
        Answer("plateau", force),
        meshed.element,
    )
