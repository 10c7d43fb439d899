"""What the laws of an opening have in common: a strength, a work and a gap without traction."""

import numpy as np

from isopeel.common.errors import InputError


def check_cohesive(strength: float, work_of_adhesion: float, equilibrium_gap: float) -> None:
    """Raise InputError unless strength and work are positive and finite, and the gap is not negative."""
    for name, value in (("strength", strength), ("work_of_adhesion", work_of_adhesion)):
        if not 0 < value < np.inf:
            raise InputError(f"adhesion.{name}", value, "it must be positive")
    if not 0 <= equilibrium_gap < np.inf:
        raise InputError("adhesion.equilibrium_gap", equilibrium_gap, "it must be zero or positive")
