"""Rigid substrates: gap, normal and curvature as seen from a point."""

from isopeel.physics.substrates.base import Substrate
from isopeel.physics.substrates.flat import Flat

__all__ = ["Flat", "Substrate"]
