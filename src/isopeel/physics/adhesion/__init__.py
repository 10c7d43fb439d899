"""Adhesion laws: normal traction between two surfaces as a function of their gap."""

from isopeel.physics.adhesion.base import AdhesionLaw
from isopeel.physics.adhesion.formula import FormulaAdhesion
from isopeel.physics.adhesion.van_der_waals import VanDerWaals

__all__ = ["AdhesionLaw", "FormulaAdhesion", "VanDerWaals"]
