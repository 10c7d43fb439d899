"""Rigid substrates: gap, normal and curvature as seen from a point.

Substrates from a formula are in `substrates.formula`, which loads SymPy when one is made: a second.
"""

from isopeel.physics.substrates.base import Substrate
from isopeel.physics.substrates.circle import Circle
from isopeel.physics.substrates.flat import Flat
from isopeel.physics.substrates.rigid import RigidSubstrate, substrate
from isopeel.physics.substrates.wavy import Wavy

__all__ = ["Circle", "Flat", "RigidSubstrate", "Substrate", "Wavy", "substrate"]
