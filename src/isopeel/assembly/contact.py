"""The stiffness of contact without adhesion, chosen from the bodies and their elements."""

from dataclasses import replace

from isopeel.assembly.spaces import Spaces
from isopeel.assembly.tables import side_of
from isopeel.physics.adhesion import AdhesionLaw, Contact
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.problem import Boundary, Interface

#: Stiffness of contact over that of an element, E'/h.
_STIFFER = 10.0


def with_contact_stiffness(spaces: Spaces) -> Spaces:
    """Return spaces whose problem has a stiffness for each contact, chosen where none is given.

    It is 10 E'/h with E' = E/(1 - nu^2) and the length h of the shortest element of the boundary; the smaller
    one of two bodies. An element under a pressure p is shortened by p h/E' at most, so that the surfaces
    overlap by a tenth of this, and less on a finer mesh.
    """
    problem = spaces.problem
    interfaces = tuple(replace(one, law=_stiff(one.law, spaces, one)) for one in problem.interfaces)
    if all(one.law is before.law for one, before in zip(interfaces, problem.interfaces, strict=True)):
        return spaces
    return replace(spaces, problem=replace(problem, interfaces=interfaces))


def _stiff(law: AdhesionLaw, spaces: Spaces, interface: Interface) -> AdhesionLaw:
    if isinstance(law, Mirrored):
        inner = _stiff(law.law, spaces, interface)
        return law if inner is law.law else Mirrored(inner)
    if not isinstance(law, Contact) or law.stiffness is not None:
        return law
    against = interface.against
    boundaries = [interface.boundary, *([against] if isinstance(against, Boundary) else [])]
    return replace(law, stiffness=_STIFFER * min(_of_an_element(spaces, one) for one in boundaries))


def _of_an_element(spaces: Spaces, boundary: Boundary) -> float:
    """Return E'/h of the shortest element of a boundary."""
    shortest = float(side_of(spaces, boundary).weights.sum(axis=1).min())
    return plane_strain_modulus(spaces.problem.body_of(boundary.body).material) / shortest
