"""The strip of the literature: peeled from a flat substrate by a pure moment."""

from isopeel.common.errors import InputError
from isopeel.physics.adhesion import AdhesionLaw, VanDerWaals
from isopeel.physics.materials import Material, NeoHooke
from isopeel.physics.substrates import Flat
from isopeel.problem.drives import RotatedSide
from isopeel.problem.interface import Interface, Traction
from isopeel.problem.problem import Body, Problem, Support
from isopeel.splines.nurbs import rectangle


def strip(
    *,
    length: float = 200.0,
    height: float = 10.0,
    adhering_length: float = 150.0,
    material: Material | None = None,
    law: AdhesionLaw | None = None,
    traction: Traction = "reference",
    irreversible: bool = False,
) -> Problem:
    """Strip on a flat rigid substrate at the equilibrium gap, whose right face is rotated by a pure moment.

    The lower face adheres for 0 <= x <= `adhering_length`; the left face has u_x = 0. By default it is the
    strip of Sauer (Int. J. Numer. Methods Eng. 87, 2011) and of Sadhana 46:3 (2021). Its units are the length
    L0 = 1 nm and the stress E0 = 2 GPa; so moments are in E0 L0^3 for a width L0. Raises InputError if a
    length is not positive, or if more than the whole length adheres.
    """
    for name, value in (("length", length), ("height", height)):
        if not 0 < value < float("inf"):
            raise InputError(f"body.{name}", value, "it must be positive")
    if not 0 < adhering_length <= length:
        raise InputError("adhesion.length", adhering_length, f"it must be positive and at most {length:g}")
    material = material or NeoHooke(youngs_modulus=1.0, poissons_ratio=0.2)
    law = law or VanDerWaals(hamaker_constant=0.05, equilibrium_distance=0.4)
    body = Body(rectangle(length, height), material)
    adhesion = Interface(
        body.side("bottom", end=adhering_length / length),
        law=law,
        against=Flat(height=-law.equilibrium_gap),
        traction=traction,
        irreversible=irreversible,
    )
    return Problem(
        name="strip",
        bodies=(body,),
        interfaces=(adhesion,),
        supports=(Support(body.side("left"), (0,)),),
        drive=RotatedSide("right"),
    )
