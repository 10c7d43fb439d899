"""Flat blocks on a flat substrate, pulled off by their top: stress is uniform.

Answer: strength times width, whatever the elasticity: block and joint are springs in a row, and the stress
stays uniform up to the strength. Exact for all sizes, as the block slides freely on the substrate and at
its top.
"""

from trials.case import Answer, Drawn, Value
from trials.dice import Dice
from trials.quantities import rounded
from trials.sheets import (
    DEFAULT_MESH,
    HEIGHTS,
    MODULI,
    SPACES,
    WORKS,
    law,
    material,
    path,
    poissons_ratio,
    units,
)

WIDTHS = (0.5, 8.0)  # over heights
#: Strains of the block under the strength: stiff blocks hardly strain, soft ones snap off.
STRAINS = (1e-5, 0.05)


def draw(dice: Dice) -> Drawn:
    """Draw a block and how far it is pulled."""
    while True:
        drawn = _block(dice)
        if drawn:
            return drawn


def _block(dice: Dice) -> Drawn | None:
    height, work, ratio = dice.decades(*HEIGHTS), dice.decades(*WORKS), poissons_ratio(dice)
    width = rounded(dice.between(*WIDTHS) * height)
    modulus, strain = dice.decades(*MODULI), dice.decades(*STRAINS)
    stiffness = modulus / (1 - ratio**2)
    strength = rounded(strain * stiffness)
    opening = work / strength
    if not 1e-5 * height <= opening <= height:
        return None
    chosen = law(dice, work, strength, small=False)
    # the peak comes before the block is strained and the joint opened by what the law takes at most
    end, step = path(1.02 * strain * height + 1.3 * opening, dice.pick((60, 100, 150)))
    table: dict[str, Value] = {}
    if not dice.chance(0.6):
        table["space"] = dice.pick(SPACES)
    if not dice.chance(DEFAULT_MESH):
        table["mesh"] = f"{round(dice.decades(1, 60))}x{round(dice.decades(1, 12))}"
    adhesion = {**chosen.table, "irreversible": True} if dice.chance(0.3) else chosen.table
    return Drawn(
        f"block, {chosen.table['law']}",
        {
            **units(dice, height),
            "body": {"length": dice.length(width), "height": dice.length(height)},
            "material": material(dice, modulus, ratio),
            "adhesion": adhesion,
            "discretization": table,
            "drive": {
                "kind": "displacement",
                "side": "top",
                "angle": "90 deg",
                "to": dice.length(end),
                "step": dice.length(step),
            },
        },
        Answer("pull-off", strength * width),
    )
