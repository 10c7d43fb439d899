"""The grammar of space names, such as L4, N2.1 or L1+N2@2: which splines the rows of control points use."""

import re
from dataclasses import dataclass

from isopeel.common.errors import InputError

HIGHEST_DEGREE = 20
ALLOWED = (
    "what a name may be: Lp (Lagrange, C0), Np (NURBS, C^(p-1)), Np.q (Np elevated q times) or Hp (Hermite, "
    f"p odd), with degrees from 1 to {HIGHEST_DEGREE}, such as L2, N4, N2.1, H3; BULK+CONTACT@ROWS for other "
    "splines in the ROWS rows at the contact, such as L1+N2.1 (one row) or N2+N4@2; or a published scheme: "
    "Q1N2, Q1N2.1, Q1C4, Q1CH"
)


@dataclass(frozen=True)
class SplineFamily:
    """The spline spaces of one degree and one continuity at inner knots, 0 to degree - 1, on any mesh.

    Raises InputError for a degree that is not 1 to 20, or another continuity.
    """

    degree: int
    continuity: int

    def __post_init__(self) -> None:
        if not 1 <= self.degree <= HIGHEST_DEGREE:
            raise InputError("degree", self.degree, f"it must be 1 to {HIGHEST_DEGREE}")
        if not 0 <= self.continuity < self.degree:
            raise InputError(
                "continuity", self.continuity, f"for degree {self.degree} it must be 0 to {self.degree - 1}"
            )

    def __str__(self) -> str:
        """Return the canonical name: L4, N4, N2.1 (which is also H3)."""
        if self.continuity == 0:
            return f"L{self.degree}"
        smooth, elevations = self.continuity + 1, self.degree - self.continuity - 1
        return f"N{smooth}.{elevations}" if elevations else f"N{smooth}"


@dataclass(frozen=True)
class SpaceName:
    """The family of the rows of control points in the bulk, and that of the first rows, at the contact.

    `contact_rows` is the number of the first rows: 0 if both families are the same, and at least 1 otherwise.
    Raises InputError for other numbers.
    """

    bulk: SplineFamily
    contact: SplineFamily
    contact_rows: int

    def __post_init__(self) -> None:
        if self.contact == self.bulk and self.contact_rows != 0:
            raise InputError("contact_rows", self.contact_rows, "with one family for all rows it must be 0")
        if self.contact != self.bulk and self.contact_rows < 1:
            raise InputError("contact_rows", self.contact_rows, "with a contact family it must be 1 or more")

    def __str__(self) -> str:
        """Return the canonical name, which gives an equal object again: L2, L1+N2.1, N2+N4@2."""
        if self.contact_rows == 0:
            return str(self.bulk)
        return f"{self.bulk}+{self.contact}" + (f"@{self.contact_rows}" if self.contact_rows > 1 else "")


NUMBER = "[1-9][0-9]{0,3}"
NURBS = rf"N{NUMBER}(?:\.{NUMBER})?"
FAMILY = rf"L{NUMBER}|{NURBS}|H{NUMBER}"
NAME = re.compile(rf"(?P<bulk>{FAMILY})(?:\+(?P<contact>{FAMILY})(?:@(?P<rows>{NUMBER}))?)?")
# Enriched contact elements: NURBS (Corbett and Sauer, 2014), Lagrange and cubic Hermite (Sauer, 2011).
SCHEME = re.compile(rf"Q1(?P<contact>{NURBS}|C{NUMBER}|CH)")


def parse_space_name(name: str) -> SpaceName:
    """Return the families of a space name. Raises InputError, which lists the possible names."""
    scheme = SCHEME.fullmatch(name)
    written = "L1+" + scheme["contact"].replace("CH", "H3").replace("C", "L") if scheme else name
    parts = NAME.fullmatch(written)
    if not parts:
        raise InputError("space", name, ALLOWED)
    try:
        bulk = _family(parts["bulk"])
        contact = _family(parts["contact"] or parts["bulk"])
    except InputError as error:
        raise InputError("space", name, ALLOWED) from error
    return SpaceName(bulk, contact, 0 if contact == bulk else int(parts["rows"] or 1))


def _family(name: str) -> SplineFamily:
    letter, (base, *elevations) = name[0], map(int, name[1:].split("."))
    if letter == "L":
        return SplineFamily(base, 0)
    if letter == "N":
        return SplineFamily(base + sum(elevations), base - 1)
    if base % 2 == 0:
        raise InputError("degree", base, "the degree of Hermite splines must be odd")
    return SplineFamily(base, (base - 1) // 2)
