"""Double cantilever beams pulled open by forces, one half modelled.

Answer: P = sqrt(2/3) G^(3/4) (E'I)^(1/4) D^(-1/2) on each arm at the opening D, of which the modelled half
moves by D/2. The crack's length drops out, and with it the rotation of the arm's root to first order of
process zone over crack, wherever that root lies. Range: cracks of 15 to 40 heights (the shear of the arm
changes P by less than 0.3 %), a process zone shorter than a tenth of the crack, rotations of the end below
0.1 (the square of which counts). Read over the last 6 % of the path, along which P of the closed form is
averaged.
"""

from math import sqrt

from trials.case import Answer, Drawn
from trials.dice import Dice
from trials.quantities import rounded
from trials.sheets import (
    HEIGHTS,
    MODULI,
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

CRACKS = (15.0, 40.0)  # heights, at the end
ROTATIONS = (0.003, 0.1)  # of the end, at the end
ZONES = (0.4, 3.0)  # heights
LONGEST_ZONE = 0.1  # cracks
READ = 0.94  # of the path


def draw(dice: Dice) -> Drawn:
    """Draw a beam, how far it is opened, and a mesh."""
    while True:
        drawn = _beam(dice)
        if drawn:
            return drawn


def mean_force(energy: float, bending: float, start: float, end: float) -> float:
    """Mean force per width over displacements of one arm, D/2, from start to end."""
    # the mean of d^(-1/2) is 2/(sqrt(start) + sqrt(end))
    return sqrt(sqrt(energy**3 * bending) / 3) * 2 / (sqrt(start) + sqrt(end))


def _beam(dice: Dice) -> Drawn | None:
    height, energy = dice.decades(*HEIGHTS), dice.decades(*WORKS)
    ratio = poissons_ratio(dice)
    crack, rotation = dice.between(*CRACKS) * height, dice.decades(*ROTATIONS)
    # the arm's curvature at the tip is sqrt(G/(E'I)), its rotation half of that times the crack
    bending = energy / (2 * rotation / crack) ** 2
    modulus = rounded(12 * bending / height**3 * (1 - ratio**2))
    if not MODULI[0] <= modulus <= MODULI[1]:
        return None
    stiffness = modulus / (1 - ratio**2)
    bending = stiffness * height**3 / 12
    zone = dice.decades(*ZONES) * height
    strength = rounded(sqrt(bending * energy) / zone**2)
    zone = process_zone(stiffness, bending, energy, strength)
    if zone > LONGEST_ZONE * crack:
        return None
    chosen = law(dice, energy, strength, small=False)
    size = element_size(dice, zone)
    before = crack * dice.between(0.5, 0.75)
    behind = crack - before + 6 * zone + 4 * height + (2 * size if size else 0.0)
    # the crack of the model is longer by about 0.6 heights and a process zone than that of the beam's formula
    end, step = path(sqrt(energy / bending) * crack**2 / 3, dice.pick((60, 100, 150)))
    begins = rounded(READ * end)
    meshed = mesh(dice, before + behind, size, zone)
    adhesion = {**chosen.table, "length": dice.length(rounded(behind, 6)), "symmetric": True}
    if dice.chance(0.5):
        adhesion["irreversible"] = True
    held = {"held": {"left": "xy"}} if dice.chance(0.4) else {}
    return Drawn(
        f"force, {chosen.table['law']}",
        {
            **units(dice, height),
            "body": {"length": dice.length(rounded(before + behind, 6)), "height": dice.length(height)},
            "material": material(dice, modulus, ratio),
            "adhesion": adhesion,
            **held,
            "discretization": meshed.table,
            "drive": {
                "kind": "force",
                "side": "right",
                "angle": "90 deg",
                "to": dice.length(end),
                "step": dice.length(step),
            },
            "reading": {"window": [dice.length(begins), dice.length(end)]},
        },
        Answer("plateau", mean_force(energy, bending, begins, end)),
        meshed.element,
    )
