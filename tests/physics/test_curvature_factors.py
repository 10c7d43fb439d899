"""What the curvature factors f1, f2 of van der Waals adhesion are, by integrals over pairs of points.

Two points at a distance d have the energy e (r0/d)^12 - 2 e (r0/d)^6; with b points in a unit volume of both
solids, A_H = 2 pi^2 b^2 e r0^6. The traction on a body is the sum of the forces on all its points behind a
unit of its surface. f1 and f2 are exact for a body that fills the space beyond a sphere of radius R + r, each
point of which a half space at its own gap attracts. They are not those of a cylinder in plane strain, and
not those of the pair forces of a whole sphere or cylinder, which fall as its curvature grows.
"""

import math
from collections.abc import Callable
from typing import TypeAlias

import numpy as np
import pytest
from scipy.integrate import dblquad, quad

from isopeel import VanDerWaals
from isopeel.common.arrays import FloatArray
from isopeel.physics.batch import evaluate_law

LAW = VanDerWaals(hamaker_constant=0.05, equilibrium_distance=0.4)
GAPS = [0.27, 0.5, 2.0]  # beyond the equilibrium gap, where the law is not a straight line
#: Force between a point at gap u and a solid, for pairs of energy d^-m
PointForce: TypeAlias = Callable[[float, int], float]


def law_at(gap: float, curvature: float) -> tuple[float, float]:
    """T and dT/dr."""
    _, traction, derivative = evaluate_law(LAW.kernel, LAW.parameters, np.array([gap]), np.array([curvature]))
    return float(traction[0]), float(derivative[0])


def half_space(gap: float, power: int) -> float:
    """Pair forces m d^-(m+1) of a half space on a point, along its normal."""

    def axial(radius: float, depth: float) -> float:
        height = gap + depth
        return float(2 * np.pi * radius * power * height / (radius**2 + height**2) ** (power / 2 + 1))

    return float(dblquad(axial, 0, np.inf, 0, np.inf, epsabs=0, epsrel=1e-10)[0])


@pytest.mark.parametrize("gap", GAPS)
def test_a_half_space_attracts_each_point_with_the_law_s_slope(gap: float) -> None:
    """The flat law sums these forces over all points behind the surface: T(r) = int_r^inf b(u) du."""
    r0 = LAW.equilibrium_distance
    strength = LAW.hamaker_constant / (2 * np.pi**2 * r0**6)  # b^2 e
    pairs = strength * (r0**12 * half_space(gap, 12) - 2 * r0**6 * half_space(gap, 6))
    scale = strength * r0**12 * half_space(gap, 12)
    assert pairs == pytest.approx(-law_at(gap, 0.0)[1], abs=1e-9 * scale)  # the tolerance of the quadrature


@pytest.mark.parametrize("gap", GAPS)
@pytest.mark.parametrize("radius", [20.0, 1.5])
def test_the_factors_are_of_a_body_beyond_a_sphere(gap: float, radius: float) -> None:
    """Half-space forces on a body whose layers grow as (R + u)^2."""

    def layer(u: float, growth: int) -> float:
        return -law_at(u, 0.0)[1] * ((radius + u) / (radius + gap)) ** growth

    spherical, cylindrical = (
        quad(layer, gap, np.inf, args=(growth,), epsabs=0, epsrel=1e-11, limit=200)[0] for growth in (2, 1)
    )
    traction = law_at(gap, 1 / radius)[0]
    assert traction == pytest.approx(spherical, rel=1e-9)  # the tolerance of the quadrature
    # a cylinder's layers grow as R + u: the factors are then 1 + 9/8 z and 1 + 3/2 z over 1 + z, z = r/R
    z, x = gap / radius, LAW.equilibrium_distance / gap
    strength = LAW.hamaker_constant / (2 * np.pi * LAW.equilibrium_distance**3) / (1 + z)
    plane_strain = strength * ((1 + 9 / 8 * z) / 45 * x**9 - (1 + 3 / 2 * z) / 3 * x**3)
    assert cylindrical == pytest.approx(plane_strain, rel=1e-9)


def sphere(radius: float) -> PointForce:
    """Pair forces of a solid sphere: caps of points at a distance d, of half angle a, from the point."""

    def cap(distance: float, power: int, cosine: float) -> float:
        return float(np.pi * power * distance ** (1 - power)) * (1 - cosine**2)

    return lambda gap, power: _over_distances(cap, radius, gap, power)


def cylinder(radius: float) -> PointForce:
    """Pair forces of a long cylinder, whose lines int (d^2 + z^2)^(-m/2) dz sum up to c d^(1-m)."""
    lines = {6: 3 * np.pi / 8, 12: 63 * np.pi / 256}

    def arc(distance: float, power: int, cosine: float) -> float:
        width = 2 * math.sqrt(max(0.0, 1 - cosine**2))
        return float(lines[power] * (power - 1) * distance ** (1 - power)) * width

    return lambda gap, power: _over_distances(arc, radius, gap, power)


def _over_distances(
    part: Callable[[float, int, float], float], radius: float, gap: float, power: int
) -> float:
    centre = radius + gap

    def smooth(b: float) -> float:
        # d = u + 2 R sin^2 b takes away the square roots at both ends
        distance = gap + 2 * radius * math.sin(b) ** 2
        cosine = (centre**2 + distance**2 - radius**2) / (2 * centre * distance)
        return part(distance, power, cosine) * 2 * radius * math.sin(2 * b)

    return float(quad(smooth, 0, np.pi / 2, epsabs=0, epsrel=1e-10, limit=400)[0])


def test_distances_add_up_to_the_whole_solid() -> None:
    """The same pair forces by integrals over polar coordinates about the centre."""
    gap, radius = 0.3, 2.0

    def of_sphere(cosine: float, q: float) -> float:
        axial = radius + gap - q * cosine
        square = axial**2 + q**2 * (1 - cosine**2)
        return 2 * np.pi * q**2 * 6 * axial / square**4

    def of_cylinder(angle: float, q: float) -> float:
        axial, across = radius + gap - q * np.cos(angle), q * np.sin(angle)
        return float(2 * q * 3 * np.pi / 8 * 5 * axial / (axial**2 + across**2) ** 3.5)

    whole_sphere, _ = dblquad(of_sphere, 0, radius, -1, 1, epsabs=0, epsrel=1e-8)
    whole_cylinder, _ = dblquad(of_cylinder, 0, radius, 0, np.pi, epsabs=0, epsrel=1e-8)
    # the tolerance of the quadrature
    assert sphere(radius)(gap, 6) == pytest.approx(whole_sphere, rel=1e-7)
    assert cylinder(radius)(gap, 6) == pytest.approx(whole_cylinder, rel=1e-7)


@pytest.mark.parametrize(
    ("solid", "growth", "slopes"),
    [(cylinder, 1, (-7 / 16, -1 / 4)), (sphere, 2, (-7 / 8, -1 / 2))],
    ids=["cylinder", "sphere"],
)
def test_pair_forces_fall_where_the_factors_rise(
    solid: Callable[[float], PointForce], growth: int, slopes: tuple[float, float]
) -> None:
    """On a convex substrate and a body around it, repulsion and attraction change by slope r/R, not f - 1.

    A solid of curvature k in one direction takes the share k u/2 off the force at gap u, whatever the power;
    with layers that grow by k (u - r), int p u^-(p+1) du is 1 - k r + k r p/(2 (p - 1)) for p = 9, 3.
    """
    z = 1e-3
    force = solid(1 / z)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    inverse = 0.5 * (nodes + 1)  # 1/u for u from the gap 1 on, where the integrand is nearly a polynomial
    factors = (1 + 9 / 4 * z + 9 / 7 * z**2) / (1 + z) ** 2, (1 + 3 * z + 3 * z**2) / (1 + z) ** 2
    for power, slope, factor in zip((12, 6), slopes, factors, strict=True):
        layers: FloatArray = np.array(
            [force(1 / t, power) * ((1 / z + 1 / t) / (1 / z + 1)) ** growth / t**2 for t in inverse]
        )
        flat = {12: np.pi / 45, 6: np.pi / 6}[power]
        ratio = float(0.5 * weights @ layers) / flat
        assert (ratio - 1) / z == pytest.approx(slope, abs=5 * z)  # the next order in z
        assert factor > 1 > ratio
