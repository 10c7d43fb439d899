"""The bilinear joint law with damage, whose work depends on the mode ratio."""

from typing import Annotated

import numpy as np

from isopeel.common.arrays import BoolArray, FloatArray
from isopeel.common.quantities import Meaning, Number, Positive, Stress, SurfaceEnergy
from isopeel.physics.joints.base import HistoryVariable, JointLaw, joint_law

#: Mixity of a point that has not moved yet.
UNKNOWN = -1.0
#: Energies below this share of the one at which damage begins are round-off: they have no mixity.
_NO_ENERGY = 1e-20
#: Below this share a closed point is far from damage, and noise in its sliding would be a mixity of 1.
_SMALL = 1e-2
#: Damage that is reached again grows from here on: to the round-off of the mixity.
_REACHED = 1e-12


@joint_law
class MixedModeBilinear(JointLaw):
    """Attraction that rises linearly with the jump and falls linearly to zero, by damage D.

    With the stiffnesses K_n, K_t, w = (K_n <d_n>^2 + K_t d_t^2)/2 and the mixity B = K_t d_t^2/(2 w), the
    stored energy is (1 - D) w, and parting the faces takes (Benzeggagh and Kenane, Compos. Sci. Technol. 56,
    1996)

        G(B) = W + (shear_work - W) B^exponent.

    Damage begins at w = rise G(B) and is complete at w = G(B)/rise: between them D = (1 - 1/y)/(1 - rise),
    y = (w/(rise G))^(1/2), at the expense rise G (y - 1)/(1 - rise). K_n = strength^2/(2 rise W) and K_t =
    shear_strength^2/(2 rise shear_work) give both strengths in the pure modes, and the ratio of stiffnesses
    for which onset and separation are consistent (Turon et al., Eng. Fract. Mech. 77, 2010). The faces unload
    along the secant. In compression they repel each other with K_n, whatever the damage.

    G is that of the mixity in the last accepted step, a history variable: so each step has an energy, and a
    symmetric tangent. With the present mixity the law would have none. The error is of first order in the
    step, and vanishes at a fixed mode ratio. A point that has not moved in any step has no mixity, and is not
    damaged in the step in which it first moves. At a point that is pressed together and has slid little, w
    below a hundredth of its value at onset, the energy of compression counts as that of opening: this point
    is likely to open next.

    Energies are per area, and the strengths are stresses. `rise` is the share of the final jump at which
    damage begins; `initial_damage` is 1 for faces that are not joined but repel each other. Raises InputError
    where the constants are not positive, rise is not in (0, 1), or the initial damage is not in [0, 1].
    """

    strength: Annotated[Positive[Stress], Meaning("largest normal traction, in opening alone", "10 MPa")]
    shear_strength: Annotated[
        Positive[Stress], Meaning("largest tangential traction, in sliding alone", "10 MPa")
    ]
    work_of_adhesion: Annotated[
        Positive[SurfaceEnergy], Meaning("energy per area of separation by opening alone", "100 J/m^2")
    ]
    shear_work: Annotated[
        Positive[SurfaceEnergy], Meaning("energy per area of separation by sliding alone", "200 J/m^2")
    ]
    rise: Annotated[
        Number, Meaning("jump at which damage begins, divided by the final jump, between 0 and 1", 0.1)
    ]
    exponent: Annotated[
        Positive[Number], Meaning("exponent of the mode ratio in the work of Benzeggagh and Kenane", 2.0)
    ] = 2.0
    initial_damage: Annotated[
        Number, Meaning("damage at the start, from 0 to 1; 1 for the faces of a crack", 0.0)
    ] = 0.0

    history = (
        HistoryVariable("damage", "1", "damage from 0 to 1 at the Gauss points"),
        HistoryVariable("mixity", "1", "mixity from 0 (opening) to 1 at the Gauss points, -1 where unknown"),
        HistoryVariable("dissipated", "E0 L0", "dissipated energy per area at the Gauss points"),
    )

    def check(self) -> None:
        """Check the shares."""
        if not 0 < self.rise < 1:
            raise self.error("rise", "it must lie in (0, 1)")
        if not 0 <= self.initial_damage <= 1:
            raise self.error("initial_damage", "it must lie in [0, 1]")

    def initial_history(self) -> tuple[float, ...]:
        """Return damage, mixity and dissipated energy."""
        return self.initial_damage, UNKNOWN, 0.0

    def softens(self, _stiffness: FloatArray, history: FloatArray) -> BoolArray:
        """Return whether (n,) points are damaged."""
        damaged: BoolArray = history[0] > 0
        return damaged

    @property
    def stiffnesses(self) -> tuple[float, float]:
        """K_n and K_t, stresses per length."""
        double = 2 * self.rise
        return (
            self.strength**2 / (double * self.work_of_adhesion),
            self.shear_strength**2 / (double * self.shear_work),
        )

    def work_at(self, mixity: float) -> float:
        """Return the energy per area G(B) to part the faces at a fixed mixity in [0, 1]."""
        share: float = mixity**self.exponent
        return self.work_of_adhesion + (self.shear_work - self.work_of_adhesion) * share

    def constants(self) -> tuple[float, ...]:
        """Stiffnesses, works, and the shape of the law."""
        return *self.stiffnesses, self.work_of_adhesion, self.shear_work, self.rise, self.exponent

    @staticmethod
    def at_point(
        opening: float,
        sliding: float,
        damage: float,
        mixity: float,
        dissipated: float,
        K_n: float,
        K_t: float,
        W: float,
        shear_work: float,
        rise: float,
        exponent: float,
    ) -> tuple[float, ...]:
        """Return energies, derivatives and the new history."""
        pull, shear = K_n * max(opening, 0.0), K_t * sliding
        by_sliding = 0.5 * shear * sliding
        w = 0.5 * pull * opening + by_sliding
        rate = 0.0  # of damage, by w
        repelled = K_n * min(opening, 0.0)
        by_compression = 0.5 * repelled * opening
        later = mixity  # of parted faces it stays that with which they parted
        if damage < 1.0:
            if w > _SMALL * rise * W:
                later = by_sliding / w
            elif w + by_compression > _NO_ENERGY * rise * W:
                later = by_sliding / (w + by_compression)
        if mixity >= 0.0 and damage < 1.0:
            work = W + (shear_work - W) * mixity**exponent
            y = np.sqrt(w / (rise * work))
            before = 1.0 / (1.0 - (1.0 - rise) * damage)
            if y >= before * (1.0 - _REACHED):
                if y < 1.0 / rise:
                    damage = max(damage, (1.0 - 1.0 / y) / (1.0 - rise))
                    rate = 0.5 / (w * y * (1.0 - rise))
                else:
                    damage = 1.0
                end = min(y, 1.0 / rise)
                dissipated += rise * work * max(end - before, 0.0) / (1.0 - rise)
        kept = 1.0 - damage
        return (
            kept * w + by_compression,
            dissipated,
            kept * pull + repelled,
            kept * shear,
            (K_n if opening < 0.0 else kept * K_n - rate * pull * pull),
            -rate * pull * shear,
            kept * K_t - rate * shear * shear,
            damage,
            later,
            dissipated,
        )
