"""The two forms of a case, and which of them a document has."""

from collections.abc import Mapping
from typing import Any

from isopeel.case.case import Case
from isopeel.case.one_body import OneBody
from isopeel.case.several_bodies import SeveralBodies
from isopeel.common.errors import InputError

#: Tables of the form for one body, and what says the same of several.
_SHORT = {
    "material": "the material of each body is a table in its [[body]]",
    "adhesion": "each adhesion is an [[interface]], whose boundary is BODY.SIDE",
    "substrate": "each substrate is a table in its [[interface]]",
    "held": "what is held is a [[support]], whose boundary is BODY.SIDE",
}


def form_of(document: Mapping[str, Any]) -> type[Case]:
    """Return the form of a case. Raises InputError where tables of both forms are mixed."""
    several = [key for key in ("interface", "tie", "support") if key in document]
    if not several and not isinstance(document.get("body"), list):
        return OneBody
    if not isinstance(document.get("body", []), list):
        raise InputError("body", "[body]", f"with [[{several[0]}]] each body is a [[body]] with a name")
    if not document.get("body"):
        raise InputError("body", document.get("body"), "a table [[body]] is needed for each body")
    for key, allowed in _SHORT.items():
        if key in document:
            raise InputError(key, f"[{key}]", f"with [[body]], {allowed}")
    return SeveralBodies
