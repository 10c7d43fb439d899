"""Tapes and beams of any elastic material at finite strain: the balances of energy without small strains.

All per unit width, in plane strain (F_33 = 1). What peels in steady motion changes from one uniform state to
another, so that the balance of energies per reference length holds for any material and any law of adhesion:

    work of the load per length - change of the stored energy per length = W.

The small-strain forms of `tape` and `beams` are their limits, and are valid where both agree.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import cos

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.physics.batch import evaluate_material
from isopeel.physics.materials import Material

_FURTHEST = 100.0  # largest stretch: no tape of a laboratory is stretched by more
_STEP = 1.05  # factor from one tried stretch to the next
# of the polynomial across a bent section, and its Gauss points: round-off at strain 0.3
_ORDER, _POINTS = 8, 10
_NEWTON = 30  # iterations: the first guess is a beam's, from which a few are enough at moderate strain
# where a formula is nan at large strains, `brentq` and `numpy.linalg` raise kinds of ValueError
_NONE = (ArithmeticError, ValueError)


def energy_at_rest(material: Material) -> float:
    """Return the energy density of the reference shape, which that of a formula need not set to zero."""
    energy, _, _ = evaluate_material(material.kernel, material.parameters, np.eye(2)[None])
    return float(energy[0])


@dataclass(frozen=True)
class Membrane:
    """A tape of layers without bending stiffness, each free of stress across its height."""

    layers: tuple[tuple[Material, float], ...]  # material and height of each

    def state(self, stretch: float) -> tuple[float, float]:
        """Return the energy above that of the reference shape, and S = h dpsi/dlambda, per reference length.

        Both are sums over the layers, which have one stretch. Raises ArithmeticError where no transverse
        stretch leaves a layer free of stress across.
        """
        total, force = 0.0, 0.0
        for (material, height), at_rest in zip(self.layers, self._at_rest, strict=True):
            energy, stress = _without_stress_across(material, stretch)
            total += height * (energy - at_rest)
            force += height * float(stress[0, 0])
        return total, force

    def stretch(self, force: float) -> float:
        """Return the stretch under a force. Raises ArithmeticError where there is none."""
        return _root_around(lambda stretch: self.state(stretch)[1] - force, 1.0)

    @cached_property
    def _at_rest(self) -> tuple[float, ...]:
        return tuple(energy_at_rest(material) for material, _ in self.layers)


def _without_stress_across(material: Material, stretch: float) -> tuple[float, FloatArray]:
    """Return energy density and stress (2, 2) at a stretch along, without stress across."""
    across = _root_around(lambda s: float(_stretched(material, stretch, s)[1][1, 1]), 1.0)
    return _stretched(material, stretch, across)


def _stretched(material: Material, stretch: float, across: float) -> tuple[float, FloatArray]:
    """Return the energy density and the stress (2, 2) of a material stretched along and across."""
    F = np.diag([stretch, across])[None]
    energy, stress, _ = evaluate_material(material.kernel, material.parameters, F)
    return float(energy[0]), stress[0]


@dataclass(frozen=True)
class PeeledTape:
    """Steady peeling of a tape: force per width, stretch of what is peeled, and how the load moves.

    `rate` is the displacement of the load along itself by the reference length that peels.
    """

    force: float
    stretch: float
    rate: float


def peeled_tape(
    material: Material, height: float, work: float, angle: float, *, held: bool = True
) -> PeeledTape | None:
    """Return the force S that peels a tape of one material at an angle, see `peeled_layers`."""
    return peeled_layers(((material, height),), work, angle, held=held)


def peeled_layers(
    layers: tuple[tuple[Material, float], ...], work: float, angle: float, *, held: bool = True
) -> PeeledTape | None:
    """Return the force S that peels a tape at an angle (radians), at any stretch; None where none does.

    The tape has layers, each of a material and a height; h psi below is the sum over them.

    The membrane form for soft tapes (He et al. 2018), with the energy of the material itself, per reference
    length. If the joint holds along the substrate, the adhering part has its undeformed shape:

        S (lambda - cos a) - h [psi(lambda) - psi(1)] = W,  S = h dpsi/dlambda.

    If it slides without friction and its far end is held, it bears S cos a = h dpsi/dlambda(lambda_a) and
    moves with the front, which follows from the potential energy of both parts:

        S (lambda - lambda_a cos a) - h [psi(lambda) - psi(lambda_a)] = W.

    At small strain they are `kendall_force`, of tapes laid under tension too, and `sliding_tape_force`.
    """
    from scipy.optimize import brentq

    tape, cosine = Membrane(layers), cos(angle)

    def released(stretch: float) -> float:
        energy, force = tape.state(stretch)
        if held:
            return force * (stretch - cosine) - energy - work
        behind = tape.stretch(force * cosine)
        return force * (stretch - behind * cosine) - energy + tape.state(behind)[0] - work

    try:
        slack = tape.stretch(0.0)
        # a tape that stores more energy than the joint takes comes off by itself
        if released(slack) >= 0:
            return None
        low, high = slack, slack
        while released(high) < 0:
            low, high = high, 1 + _STEP * (high - 1) + 1e-3
            if high > _FURTHEST:
                return None
        stretch = float(brentq(released, low, high, xtol=1e-15, rtol=1e-14))
        force = tape.state(stretch)[1]
        behind = 1.0 if held else tape.stretch(force * cosine)
    except _NONE:
        return None
    return PeeledTape(force, stretch, stretch - behind * cosine)


def _root_around(function: Callable[[float], float], start: float) -> float:
    """Return the root next to a positive start of a function that rises through it.

    Raises ArithmeticError.
    """
    from scipy.optimize import brentq

    value = function(start)
    if value == 0:
        return start
    step = _STEP if value < 0 else 1 / _STEP
    one, other = start, start * step
    while value * function(other) > 0:
        one, other = other, other * step
        if not 1 / _FURTHEST < other < _FURTHEST:
            raise ArithmeticError("no root")
    if not np.isfinite(function(other)):
        raise ArithmeticError("no root")
    return float(brentq(function, *sorted((one, other)), xtol=1e-15, rtol=1e-14))


@dataclass(frozen=True)
class BentStrip:
    """Steady peeling of a strip by a pure moment: moment per width, and the curvature of what is peeled."""

    moment: float
    curvature: float


def bent_strip(material: Material, height: float, work: float, curvature: float) -> BentStrip | None:
    """Return the moment that peels a strip at any bending strain: M kappa - U(kappa) = W; None without one.

    U is the energy per reference length of a strip bent to a uniform curvature kappa (turn per reference
    length), M = dU/dkappa, and `curvature` a first guess, that of beam theory. In plane strain the section
    becomes a sector of circles r(Y) with F = diag(kappa r, r'), and r follows from the equilibrium
    d(P_22)/dY = kappa P_11 with free faces: the least energy, found here among polynomials.
    """
    from scipy.optimize import brentq

    section = _Section(material, height)

    def excess(kappa: float) -> float:
        energy, moment = section.bent(kappa)
        return moment * kappa - energy - work

    try:
        low, high = 0.9 * curvature, 1.1 * curvature
        while excess(low) > 0:
            low, high = 0.8 * low, low
        while excess(high) < 0:
            low, high = high, 1.2 * high
        kappa = float(brentq(excess, low, high, rtol=1e-10))
        return BentStrip(section.bent(kappa)[1], kappa)
    except _NONE:
        return None


@dataclass(frozen=True)
class _Section:
    """A section of a strip, whose radii r(Y) are a polynomial across its height."""

    material: Material
    height: float

    def bent(self, curvature: float) -> tuple[float, float]:
        """Return the energy per reference length above that of the reference shape, and the moment.

        Raises ArithmeticError where there is no equilibrium.
        """
        h = self.height
        nodes, weights = np.polynomial.legendre.leggauss(_POINTS)
        # Legendre polynomials over [-1, 1], the place Y = h/2 xi
        values = np.polynomial.legendre.legvander(nodes, _ORDER)
        derivatives = np.stack(
            [
                np.polynomial.legendre.legval(nodes, np.polynomial.legendre.legder(unit))
                for unit in np.eye(_ORDER + 1)
            ],
            axis=1,
        ) * (2 / h)
        weights = weights * h / 2
        c = np.zeros(_ORDER + 1)
        c[:2] = 1 / curvature, h / 2
        material = self.material
        F = np.zeros((_POINTS, 2, 2))
        for _ in range(_NEWTON):
            r = values @ c
            F[:, 0, 0], F[:, 1, 1] = curvature * r, derivatives @ c
            if not (F[:, 0, 0] > 0).all() or not (F[:, 1, 1] > 0).all():
                break
            energy, P, A = evaluate_material(material.kernel, material.parameters, F)
            first, second = curvature * values, derivatives
            residual = first.T @ (weights * P[:, 0, 0]) + second.T @ (weights * P[:, 1, 1])
            tangent = sum(
                (one.T * (weights * A[:, i, i, k, k])) @ other
                for i, one in enumerate((first, second))
                for k, other in enumerate((first, second))
            )
            change = np.linalg.solve(np.asarray(tangent), residual)
            c -= change
            if np.abs(change).max() < 1e-13 / curvature:
                energy, P, _ = evaluate_material(material.kernel, material.parameters, F)
                energy = energy - energy_at_rest(material)
                return float(weights @ energy), float(weights @ (P[:, 0, 0] * r))
        raise ArithmeticError("no equilibrium of the bent section")
