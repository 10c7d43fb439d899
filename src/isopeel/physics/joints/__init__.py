"""Joint laws: the energy of two faces as a function of their opening and sliding, with damage."""

from isopeel.physics.joints.base import HistoryVariable, JointLaw, joint_law
from isopeel.physics.joints.mixed_mode_bilinear import MixedModeBilinear
from isopeel.physics.joints.xu_needleman import XuNeedleman

__all__ = ["HistoryVariable", "JointLaw", "MixedModeBilinear", "XuNeedleman", "joint_law"]
