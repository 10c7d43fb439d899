"""A cylinder on an elastic half space, without adhesion and with that of a crack. All per unit length.

`reduced_modulus` is E* with 1/E* = (1 - nu^2)/E of one body plus the same of the other: E/(1 - nu^2) where
one is rigid. `load` presses where positive and pulls where negative.
"""

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np

from isopeel.common.arrays import FloatArray


@dataclass(frozen=True)
class HertzLine:
    """Line contact without adhesion."""

    half_width: float
    peak_pressure: float

    def pressure(self, place: FloatArray) -> FloatArray:
        """p_0 sqrt(1 - x^2/a^2) at places x (...), zero outside the contact."""
        inside = np.maximum(1 - np.square(place / self.half_width), 0.0)
        pressure: FloatArray = self.peak_pressure * np.sqrt(inside)
        return pressure


def hertz_line(load: float, reduced_modulus: float, radius: float) -> HertzLine:
    """Return the half-width a = sqrt(4 P R/(pi E*)) and peak pressure p_0 = 2 P/(pi a).

    Johnson, Contact Mechanics, Sec. 4.2(c).
    """
    half_width = sqrt(4 * load * radius / (pi * reduced_modulus))
    return HertzLine(half_width, 2 * load / (pi * half_width))


def jkr_line_load(half_width: float, work: float, reduced_modulus: float, radius: float) -> float:
    """Return the load F = pi E* a^2/(4 R) - sqrt(2 pi E* a W) at a contact half-width a.

    The cylinder of Johnson, Kendall and Roberts' theory: Hertz's load less that of a flat punch whose stress
    at the edge is that of a crack with G = W (Barquins, J. Adhesion 26, 1988; Chaudhury, Weaver, Hui and
    Kramer, J. Appl. Phys. 80, 1996).
    """
    pressed = pi * reduced_modulus * half_width**2 / (4 * radius)
    return pressed - sqrt(2 * pi * reduced_modulus * half_width * work)


def jkr_line_pull_off(work: float, reduced_modulus: float, radius: float) -> float:
    """Return the largest pull 3 (pi E* W^2 R/16)^(1/3) of `jkr_line_load`, at a^3 = 2 W R^2/(pi E*)."""
    return float(3 * (pi * reduced_modulus * work**2 * radius / 16) ** (1 / 3))
