"""Damage of an adhesive joint: unloading along the secant of any law's envelope.

A law T(x) of the opening x = gap - equilibrium gap is taken as the envelope of first opening. Where a point
has reached the opening h and closes again, it follows the straight line from the envelope at h to the
envelope at x = 0, reopens along that line, and meets the envelope at h (Ortiz and Pandolfi, Int. J. Numer.
Methods Eng. 44, 1999); in compression, x < 0, it follows the envelope. With the envelope's potential Phi the
energies per area, both zero at the equilibrium gap of a joint never opened, are

    stored = area under the line from 0 to x, or Phi(x) - Phi(0) in compression,
    dissipated = Phi(h) - Phi(0) less the area under the line from 0 to h,

the latter with x for h where x > h; the traction is less the slope of their sum at fixed h.

The history h is a state of the last equilibrium: it is read here and never written. Whoever accepts an
equilibrium takes max(h, x) for the next one.

A joint is made where its faces meet: the gap that a point starts at is no opening of the joint. Until a point
has closed, x <= 0, its history is `NOT_CLOSED`, and it follows the envelope both ways, as a reversible law,
with nothing dissipated. Once it has closed, its history is the maximum opening, which starts at zero.

The attraction divided by the opening must not grow with the opening, or closing would return more than
opening took: `check_envelope`. All laws of this package satisfy it; a formula whose attraction is convex at
first does not. There is no other threshold of damage: where an envelope rises in a straight line, the secant
is that line and nothing is lost; where it rises in a curve, as the exponential law, a little is lost before
the peak.
"""

from typing import NamedTuple

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.compilation import compiled
from isopeel.common.errors import InputError
from isopeel.physics.adhesion.base import AdhesionLaw
from isopeel.physics.batch import evaluate_law

#: Openings below this share of the equilibrium gap count as none: the gap's round-off would show in the slope
#: of so short a secant, and the envelope differs from it by less than can be seen.
_NO_OPENING = 1e-10

#: History of a point that has not closed yet; any other negative number says the same.
NOT_CLOSED = -1.0
#: Openings at which an envelope is checked, in units of (W/stiffness)^(1/2). Its values there have more than
#: the digits of the tolerance, unless the equilibrium gap is far larger.
_OPENINGS = np.geomspace(1e-4, 1e4, 1601)
_TOLERANCE = 1e-6


class SecantUnloading(NamedTuple):
    """Energies per area, traction (repulsion positive) and its derivative by the gap, all of one shape."""

    stored: FloatArray
    traction: FloatArray
    derivative: FloatArray
    dissipated: FloatArray


def secant_unloading(
    law: AdhesionLaw, gap: FloatArray, history: FloatArray, curvature: float = 0.0
) -> SecantUnloading:
    """State of a joint at gaps (...) after maximum openings `history` (...), which broadcast together.

    Raises InputError unless every history is finite and at least zero.
    """
    gaps, openings = np.broadcast_arrays(
        np.asarray(gap, dtype=np.float64), np.asarray(history, dtype=np.float64)
    )
    refused = openings[~((openings >= 0) & (openings < np.inf))]
    if refused.size:
        raise InputError("history", float(refused[0]), "maximum openings are finite and at least zero")
    rest = law.equilibrium_gap
    here, closed, reached = (
        np.stack(evaluate_law(law.kernel, law.parameters, at, np.full(at.shape, curvature)), axis=-1)
        for at in (gaps, np.full(gaps.shape, rest), rest + openings)
    )
    outputs = np.empty((*gaps.shape, 4))
    for n in np.ndindex(gaps.shape):
        envelope = tuple(here[n]), tuple(closed[n][:2]), tuple(reached[n][:2])
        outputs[n] = damaged(float(gaps[n]), rest, float(openings[n]), *envelope)
    return SecantUnloading(*np.moveaxis(outputs, -1, 0))


def check_envelope(law: AdhesionLaw) -> None:
    """Raise InputError where the attraction divided by the opening grows with the opening, A < A' x."""
    rest = np.array([law.equilibrium_gap])
    stiffness = -evaluate_law(law.kernel, law.parameters, rest, np.zeros(1))[2][0]
    if stiffness > 0:
        openings = np.sqrt(law.work_of_adhesion / stiffness) * _OPENINGS
        gaps = rest + openings
        _, traction, derivative = evaluate_law(law.kernel, law.parameters, gaps, np.zeros(gaps.size))
        slope = derivative * openings
        if not (slope < traction - _TOLERANCE * (np.abs(slope) + np.abs(traction))).any():
            return
    allowed = "the attraction of its law must not grow faster than the opening, or closing would give energy"
    raise InputError("adhesion.irreversible", True, allowed)


@compiled
def damaged(
    gap: float,
    equilibrium_gap: float,
    history: float,
    law: tuple[float, float, float],
    closed: tuple[float, float],
    reached: tuple[float, float],
) -> tuple[float, float, float, float]:
    """Return stored energy, traction, its derivative and dissipated energy at a gap, after a maximum opening.

    `law` is Phi, T and T' of the envelope at the gap; `closed` and `reached` are Phi and T at the equilibrium
    gap and at the maximum opening `history`. Where that is negative the joint has not closed yet, and follows
    its envelope. At x = h, where a path goes on from an equilibrium, the derivative is that of further
    opening.
    """
    potential, traction, derivative = law
    Phi_closed, T_closed = closed  # T is zero, but for a law that pulls or pushes there on a curved substrate
    if history < 0.0:
        return potential - Phi_closed, traction, derivative, 0.0
    x = gap - equilibrium_gap
    h = history if history > _NO_OPENING * equilibrium_gap else 0.0
    opens = x >= h
    end = x if opens else h
    Phi_end = potential if opens else reached[0]
    T_end = traction if opens else reached[1]
    dissipated = Phi_end - Phi_closed + 0.5 * (T_closed + T_end) * end if end > 0.0 else 0.0
    if x < 0.0:
        return potential - Phi_closed, traction, derivative, dissipated
    if opens:
        return -0.5 * (T_closed + T_end) * x, traction, derivative, dissipated
    slope = (T_end - T_closed) / h
    return -(T_closed + 0.5 * slope * x) * x, T_closed + slope * x, slope, dissipated
