"""Beams that are clamped at the left and bent at the right, far from any substrate.

Answers: P = 3 E'I d/(L^3 (1 + s)) of a small deflection d, with the share s = 3 E'I/(k G A L^2) of shear, k
= 5/6 (Timoshenko); the elastica for a dead force and a large one; M = E'I theta/L for a moment. Range:
slenderness L/h from 25 to 100, and from 60 where nu is above 0.4: the clamp holds the end from widening,
which shortens the beam by 0.15 heights at nu = 1/2 and by less than 0.05 up to nu = 0.4 (fine runs), and P
by three times the share of that; small deflections up to 0.02 L, which change P by 3e-4; large ones to 0.6
L; bending strains below 0.03.
"""

from math import pi, radians, sin

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipeinc, ellipkinc

from trials.case import Answer, Drawn, Value
from trials.dice import Dice
from trials.quantities import rounded
from trials.sheets import DEFAULT_MESH, HEIGHTS, MODULI, SPACES, law, material, path, poissons_ratio, units

SLENDERNESS, SLENDER = (25.0, 100.0), 60.0
SMALL, LARGE = (0.002, 0.02), (0.1, 0.6)  # deflections over lengths
ANGLES = (5.0, 100.0)  # degrees
LARGEST_STRAIN = 0.03
SHEAR = 5 / 6


def draw(dice: Dice) -> Drawn:
    """Draw a beam and how it is bent."""
    while True:
        drawn = _beam(dice)
        if drawn:
            return drawn


def elastica_load(deflection: float) -> float:
    """P L^2/(E'I) of a dead transverse force that moves the end of a clamped beam by a share of its length.

    Bisshopp and Drucker (Q. Appl. Math. 3, 1945): with the end turned by phi, k^2 = (1 + sin phi)/2 and
    sin psi = 1/(k sqrt(2)), a = sqrt(P L^2/(E'I)) = K(k) - F(psi, k), and d/L = 1 - 2 (E(k) - E(psi, k))/a.
    """

    def root(turned: float) -> tuple[float, float]:
        square = (1 + sin(turned)) / 2
        psi = np.arcsin(1 / np.sqrt(2 * square))
        a = float(ellipkinc(pi / 2, square) - ellipkinc(psi, square))
        return a, 1 - 2 * float(ellipeinc(pi / 2, square) - ellipeinc(psi, square)) / a

    turned = brentq(lambda phi: root(phi)[1] - deflection, 1e-6, pi / 2 - 1e-6, xtol=1e-13)
    return root(turned)[0] ** 2


def _beam(dice: Dice) -> Drawn | None:
    sort = dice.pick(("small", "small", "large", "moment"))
    height, ratio = dice.decades(*HEIGHTS), poissons_ratio(dice)
    modulus = dice.decades(*MODULI)
    slenderness = dice.decades(*SLENDERNESS)
    if ratio > 0.4 and slenderness < SLENDER:
        return None
    length = rounded(slenderness * height)
    bending = modulus / (1 - ratio**2) * height**3 / 12
    if sort == "moment":
        angle, step = path(dice.decades(*ANGLES), dice.pick((10, 20, 40)))
        value = bending * radians(angle) / length
        drive: dict[str, Value] = {"kind": "rotation", "to": f"{angle:.10g} deg", "step": f"{step:g} deg"}
        strain = value / bending * height / 2
    else:
        share = dice.decades(*(SMALL if sort == "small" else LARGE))
        end, step = path(share * length, dice.pick((10, 20, 40)))
        shear_modulus = modulus / (2 * (1 + ratio))
        if sort == "small":
            sheared = 3 * bending / (SHEAR * shear_modulus * height * length**2)
            value = 3 * bending * end / length**3 / (1 + sheared)
        else:
            value = elastica_load(end / length) * bending / length**2
        strain = value * length / bending * height / 2
        drive = {"kind": "force", "angle": "90 deg", "to": dice.length(end), "step": dice.length(step)}
    if strain > LARGEST_STRAIN:
        return None
    # a joint that plays no part: the substrate is far beyond what little it reaches
    work, strength = rounded(1e-6 * modulus * height), rounded(1e-3 * modulus)
    table: dict[str, Value] = {}
    if not dice.chance(0.6):
        table["space"] = dice.pick(SPACES)
    if not dice.chance(DEFAULT_MESH):
        table["mesh"] = f"{round(dice.decades(4, 200))}x{dice.pick((1, 2, 2, 3, 4))}"
    return Drawn(
        f"{sort}",
        {
            **units(dice, height),
            "body": {"length": dice.length(length), "height": dice.length(height)},
            "material": material(dice, modulus, ratio),
            "adhesion": law(dice, work, strength, small=False).table,
            "substrate": {"gap": dice.length(rounded(height))},
            "held": {"left": "xy"},
            "discretization": table,
            "drive": {"side": "right", **drive},
        },
        Answer("largest", value),
    )
