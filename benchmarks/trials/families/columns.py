"""Straight films under compression, which buckle.

Answers: Euler's loads 4 pi^2 E'I/L^2 of a film that is clamped at both ends and shortened, and pi^2 E'I/(4
L^2) of one that a dead force compresses at its free end. Both are corrected for shear and shortening, P =
P_E (1 - P_E/(k G A) + P_E/(E'h)) to first order with k = 5/6 (Timoshenko and Gere, Theory of Elastic
Stability, Sec. 2.17, and P as of the deformed column). Range: L/h from 40 to 200 and 25 to 100, so that
each correction is below 0.8 %; from twice as much where nu is above 0.4, where a clamp shortens the film by
up to 0.15 heights (see `cantilevers`).
"""

from math import pi

from trials.case import Answer, Drawn, Value
from trials.dice import Dice
from trials.quantities import rounded
from trials.sheets import DEFAULT_MESH, HEIGHTS, MODULI, SPACES, law, material, path, poissons_ratio, units

CLAMPED, FREE = (40.0, 200.0), (25.0, 100.0)  # lengths over heights
SHEAR = 5 / 6
#: How far the path goes, in what shortens the film, or loads it, at the bifurcation.
FAR = (1.5, 4.0)


def draw(dice: Dice) -> Drawn:
    """Draw a film and how it is compressed."""
    clamped = dice.chance(0.6)
    height, ratio, modulus = dice.decades(*HEIGHTS), poissons_ratio(dice), dice.decades(*MODULI)
    stubborn = 2.0 if ratio > 0.4 else 1.0
    length = rounded(stubborn * dice.decades(*(CLAMPED if clamped else FREE)) * height)
    value = buckling_load(modulus, ratio, height, length, clamped=clamped)
    stiffness = modulus / (1 - ratio**2) * height
    far, steps = dice.between(*FAR), dice.pick((10, 20, 40))
    drive: dict[str, Value]
    if clamped:
        end, step = path(far * value / stiffness * length, steps)
        drive = {"kind": "displacement", "angle": "180 deg", "transverse": "held"}
        drive |= {"to": dice.length(end), "step": dice.length(step)}
    else:
        end, step = path(min(far, 1.5) * value, steps)
        drive = {"kind": "force", "angle": "180 deg", "control": "force"}
        drive |= {"to": dice.force(end), "step": dice.force(step)}
    work, strength = rounded(1e-6 * modulus * height), rounded(1e-3 * modulus)
    table: dict[str, Value] = {}
    if not dice.chance(0.6):
        table["space"] = dice.pick(SPACES)
    if not dice.chance(DEFAULT_MESH):
        table["mesh"] = f"{round(dice.decades(6, 200))}x{dice.pick((1, 2, 2, 3, 4))}"
    return Drawn(
        "clamped at both ends" if clamped else "free end",
        {
            **units(dice, height),
            "body": {"length": dice.length(length), "height": dice.length(height)},
            "material": material(dice, modulus, ratio),
            "adhesion": law(dice, work, strength, small=False).table,
            # it bends away from the substrate or towards it, which is far
            "substrate": {"gap": dice.length(rounded(2 * length))},
            "held": {"left": "xy"},
            "discretization": table,
            "drive": {"side": "right", **drive},
        },
        Answer("buckling", value),
    )


def buckling_load(modulus: float, ratio: float, height: float, length: float, *, clamped: bool) -> float:
    """Load per width at which a film buckles."""
    stiffness = modulus / (1 - ratio**2) * height
    euler = (4 if clamped else 0.25) * pi**2 * stiffness * height**2 / 12 / length**2
    sheared = euler / (SHEAR * modulus / (2 * (1 + ratio)) * height)
    return euler * (1 - sheared + euler / stiffness)
