"""Adhesion laws: normal traction between two surfaces as a function of their gap.

Laws from a formula are in `adhesion.formula`, which loads SymPy when one is made: a second.
"""

from isopeel.physics.adhesion.base import AdhesionLaw
from isopeel.physics.adhesion.bilinear import Bilinear
from isopeel.physics.adhesion.contact import Contact
from isopeel.physics.adhesion.dugdale import Dugdale
from isopeel.physics.adhesion.exponential import Exponential
from isopeel.physics.adhesion.lennard_jones import LennardJones
from isopeel.physics.adhesion.normal import NormalLaw, normal_law
from isopeel.physics.adhesion.trapezoidal import Trapezoidal
from isopeel.physics.adhesion.van_der_waals import VanDerWaals

__all__ = [
    "AdhesionLaw",
    "Bilinear",
    "Contact",
    "Dugdale",
    "Exponential",
    "LennardJones",
    "NormalLaw",
    "Trapezoidal",
    "VanDerWaals",
    "normal_law",
]
