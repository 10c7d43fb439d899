"""The parameters of a case: keys whose values are numbers, by which the results can be differentiated."""

from dataclasses import dataclass

from isopeel.case.case import Case
from isopeel.common.errors import InputError
from isopeel.common.units import measured_as, parse_quantity, unit_of

#: Tables of keys that are no parameters of the problem.
_TABLES = ("name", "about", "units", "discretization", "reading", "output")
#: Keys that say where a path goes, or on which mesh, or which only scale what is shown.
_KEYS = ("to", "step", "mesh", "grading", "space", "across_degree", "width")
#: Shift of a parameter, as a share of it. The round-off of the forces is divided by it: with 1e-6 it is seen
#: in the sixth digit. With the difference of fourth order the truncation error of the steepest law, whose
#: force goes with the ninth power of the gap, is 1e-13.
SHARE = 1e-4


@dataclass(frozen=True)
class Parameter:
    """A key of a case, its value as a number of a unit, and the size of its shifts in this unit.

    The unit is that in which the case has the value; a plain number has none, and its unit is empty.
    """

    key: str
    value: float
    unit: str
    shift: float

    def written(self, shift: float) -> str | float:
        """Return another value, as a case has it."""
        value = self.value + shift
        return f"{value!r} {self.unit}" if self.unit else value


def parameter_of(case: Case, key: str) -> Parameter:
    """Return a parameter of a case by its key. Raises InputError, whose field is the key, if it is none."""
    first, *_, last = [*key.split("."), ""] if "." not in key else key.split(".")
    if first in _TABLES or last in _KEYS:
        raise InputError(key or "key", None, "the equilibrium at a value of the drive does not depend on it")
    written = case.value(key)
    if isinstance(written, bool) or not isinstance(written, int | float | str):
        raise InputError(key, written, "a key whose value is one number is needed")
    if not isinstance(written, str):
        value, unit, is_angle = float(written), "", False
    else:
        try:
            unit = unit_of(written)
            value, is_angle = measured_as(written, unit), parse_quantity(written).angle
        except ValueError as error:
            raise InputError(key, written, f"a key whose value is one number is needed: {error}") from error
    # an angle has a scale of its own, and so has a plain number
    size = 1.0 / measured_as(f"1 {unit}", "rad") if is_angle else abs(value) or float(not unit)
    if not size:
        raise InputError(key, written, "zero has no size for a difference; give a value near it")
    return Parameter(key, value, unit, SHARE * size)
