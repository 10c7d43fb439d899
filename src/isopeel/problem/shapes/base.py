"""The interface of a shape, and functions for several shapes."""

from math import inf
from typing import ClassVar, Protocol

from isopeel.common.errors import InputError
from isopeel.common.units import length_text
from isopeel.splines.nurbs import NurbsCurve, NurbsSurface, Side

ROUND_OFF = 1e-12  # relative: a length that exceeds the whole by at most this share is the whole


class Shape(Protocol):
    """The shape of a body, as one patch over the unit square.

    xi runs along the lower side, "bottom", which faces the substrate; eta runs away from it. The lower side
    starts at the origin, unless the docstring of a shape states another place.
    """

    #: The name of the shape in a case file.
    name: ClassVar[str]
    #: The side that is held in x if a case has no key `held`.
    usual_hold: ClassVar[Side]

    def surface(self) -> NurbsSurface:
        """Return the exact shape, in the unit of its lengths."""
        ...

    def adhering_part(self, length: float) -> tuple[float, float]:
        """Return the parameters between which an arc length of the lower side adheres.

        For most shapes it begins at the left end.

        Raises InputError ("adhesion.length") for lengths that are not positive, or more than the whole side.
        """
        ...


def check_positive(**fields: float) -> None:
    """Raise InputError unless these fields of a body are positive and finite."""
    for name, value in fields.items():
        if not 0 < value < inf:
            raise InputError(f"body.{name}", value, "it must be positive")


def check_length(length: float, total: float) -> None:
    """Raise InputError unless this length of a lower side, whose total length is given, can adhere."""
    if not 0 < length <= total:
        raise InputError("adhesion.length", length, f"it must be positive and at most {length_text(total)}")


def parameter_at_length(curve: NurbsCurve, length: float) -> float:
    """Return the parameter of a curve at an arc length from its start, exact to round-off."""
    from scipy.optimize import brentq

    start, end = (float(place) for place in curve.space.breakpoints[[0, -1]])
    total = curve.length()
    check_length(length, total * (1 + ROUND_OFF))
    if length >= total:
        return end
    place = brentq(lambda parameter: curve.length(parameter) - length, start, end, xtol=1e-15, rtol=1e-15)
    return float(place)
