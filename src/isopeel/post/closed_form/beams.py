"""Beams that peel: moments and forces for a given energy release rate. All per unit width.

`bending_stiffness` is E' I of one beam per width, E' h^3/12 of a strip in plane strain. A length dl that
peels releases what the load does less what it stores in the beam.
"""

from collections.abc import Sequence
from math import sqrt

import numpy as np


def composite_stiffness(layers: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Return EA and EI of a beam of layers, each of a modulus E and a height h, per width and upwards.

    EA = sum E h, and EI = sum E (h^3/12 + h d^2) with the distances d of the layers' centres from the neutral
    axis, at the mean height of the centres weighted by E h (Gere and Timoshenko, Mechanics of Materials,
    composite beams). In plane strain the moduli are E/(1 - nu^2).
    """
    moduli, heights = np.array(layers, dtype=np.float64).T
    centres = np.cumsum(heights) - heights / 2
    stretching = moduli * heights
    neutral = (stretching * centres).sum() / stretching.sum()
    bending = moduli * heights**3 / 12 + stretching * (centres - neutral) ** 2
    return float(stretching.sum()), float(bending.sum())


def beam_moment(work: float, bending_stiffness: float) -> float:
    """Return the moment M = sqrt(2 E' I W) that peels a beam off a flat substrate of work of adhesion W.

    M turns the end by dl M/(E' I), half of whose work is stored: M^2/(2 E' I) = W.
    """
    return sqrt(2 * bending_stiffness * work)


def double_cantilever_moment(energy_release_rate: float, bending_stiffness: float) -> float:
    """Return the moment M = sqrt(G E' I) on each arm of a double cantilever: each releases M^2/(2 E' I)."""
    return sqrt(energy_release_rate * bending_stiffness)


def double_cantilever_force(energy_release_rate: float, bending_stiffness: float, opening: float) -> float:
    """Return the force P = sqrt(2/3) G^(3/4) (E' I)^(1/4) D^(-1/2) on each arm, for the total opening D.

    The crack's length a drops out of the bending of both arms, D = 2 P a^3/(3 E' I), and of the moment
    P a = sqrt(G E' I) at its tip. Arms are slender, clamped at the tip, and turn little.
    """
    return sqrt(2 / (3 * opening) * sqrt(energy_release_rate**3 * bending_stiffness))
