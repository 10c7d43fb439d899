"""Strips peeled by a moment, alone or as one half of a double cantilever beam.

Answer: M = sqrt(2 E'I W) of a strip on a substrate, sqrt(G E'I) of each arm of a double cantilever beam.
Range: bending strain h/(2 rho) from 0.003 to 0.05, where `isopeel validate` finds at most 0.06 % between
runs and closed form (the deviation grows with the square of the strain). The process zone takes no part: a
steady state moves along without change, whatever the law. It is shorter than a third of the radius, so that
rotations of less than 150 degrees will do, and the joint is read where the law is spent at its end.
"""

from dataclasses import dataclass
from math import degrees, sqrt

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

BENDING_STRAINS = (0.003, 0.05)
#: Process zones over heights.
ZONES = (0.5, 6.0)
LARGEST_ROTATION = 150.0  # degrees


@dataclass(frozen=True)
class Strip:
    """A thin strip and its joint in SI units; the work is that of the modelled side alone."""

    small: bool
    height: float
    work: float
    modulus: float
    ratio: float
    strength: float
    zone: float

    @property
    def bending(self) -> float:
        """E'I per width."""
        return self.modulus / (1 - self.ratio**2) * self.height**3 / 12

    @property
    def radius(self) -> float:
        """Of the part that has peeled."""
        return sqrt(self.bending / (2 * self.work))


def draw(dice: Dice) -> Drawn:
    """Draw a strip, how far it is turned, and a mesh."""
    while True:
        strip = _strip(dice)
        drawn = strip and _turned(dice, strip)
        if drawn:
            return drawn


def _strip(dice: Dice) -> Strip | None:
    small = dice.chance(0.2)
    height = dice.decades(*(SMALL_HEIGHTS if small else HEIGHTS))
    work = dice.decades(*(SMALL_WORKS if small else WORKS))
    ratio, strain = poissons_ratio(dice), dice.decades(*BENDING_STRAINS)
    stiffness = 6 * work / (height * strain**2)
    modulus = rounded(stiffness * (1 - ratio**2))
    if not MODULI[0] <= modulus <= MODULI[1]:
        return None
    bending = stiffness * height**3 / 12
    strength = rounded(sqrt(bending * work) / (dice.decades(*ZONES) * height) ** 2)
    zone = process_zone(stiffness, bending, work, strength)
    return Strip(small, height, work, modulus, ratio, strength, zone)


def _turned(dice: Dice, strip: Strip) -> Drawn | None:
    mirrored = dice.chance(0.35)
    work = rounded(2 * strip.work) if mirrored else strip.work
    chosen = law(dice, work, strip.strength, small=strip.small)
    spent = chosen.spent / 2 if mirrored else chosen.spent
    size = element_size(dice, strip.zone)
    free = dice.between(2.0, 8.0) * strip.height
    # the arc has opened by what the law takes at the end of the joint
    start = sqrt(2 * strip.radius * spent) + 3 * strip.zone
    behind = 4 * strip.zone + 4 * strip.height
    window = max(0.25 * start, 2.5 * size if size else 0.02 * (free + start + behind))
    end = degrees((free + start + window) / strip.radius)
    if strip.zone > strip.radius / 3 or end > LARGEST_ROTATION:
        return None
    adhering = start + window + behind + (2 * size if size else 0.0)
    meshed = mesh(dice, free + adhering, size, strip.zone)
    last, step = path(end, dice.pick((60, 100, 150)))
    begins = last * (1 - window / (free + start + window))
    adhesion = {**chosen.table, "length": dice.length(rounded(adhering, 6))}
    if mirrored:
        adhesion["symmetric"] = True
    if dice.chance(0.3):
        adhesion["irreversible"] = True
    return Drawn(
        f"{'double cantilever' if mirrored else 'strip'}, {chosen.table['law']}",
        {
            **units(dice, strip.height),
            "body": {
                "shape": "strip",
                "length": dice.length(rounded(free + adhering, 6)),
                "height": dice.length(strip.height),
            },
            "material": material(dice, strip.modulus, strip.ratio),
            "adhesion": adhesion,
            "discretization": meshed.table,
            "drive": {"kind": "rotation", "side": "right", "to": f"{last:.10g} deg", "step": f"{step:g} deg"},
            "reading": {"window": [f"{begins:.6g} deg", f"{last:.10g} deg"]},
        },
        Answer("plateau", sqrt(2 * strip.bending * (work / 2 if mirrored else work))),
        meshed.element,
    )
