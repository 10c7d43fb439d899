"""What laws, materials and substrates have in common: a name for case files, and constants within limits."""

import re
from dataclasses import dataclass, fields
from types import UnionType
from typing import Annotated, Any, ClassVar, TypeVar, Union, get_args, get_origin, get_type_hints

from isopeel.common.errors import InputError
from isopeel.common.quantities import Limit

Kind = TypeVar("Kind", bound="type[Component]")


class Component:
    """The base of a frozen dataclass of constants, which `named_dataclass` makes of a class."""

    #: What a case file calls it.
    name: ClassVar[str]
    #: The table of a case file that has the constants as keys.
    table: ClassVar[str]
    #: What it must have, as a field or another member: of each group one.
    needed: ClassVar[tuple[tuple[str, ...], ...]] = ()
    #: What the values of fields must be.
    limits: ClassVar[tuple[tuple[str, Limit], ...]] = ()

    def __post_init__(self) -> None:
        """Raise InputError unless the constants are within their limits, and fit together."""
        for field, limit in self.limits:
            value = getattr(self, field)
            if value is not None and not limit.holds(value):
                raise self.error(field, limit.allowed)
        self.check()

    def check(self) -> None:
        """Raise InputError unless the constants, each within its limits, fit together."""

    def error(self, field: str, allowed: str) -> InputError:
        """Return the error of a constant that is not as `allowed`."""
        return InputError(f"{self.table}.{field}", getattr(self, field), allowed)


def named_dataclass(kind: Kind) -> Kind:
    """Make a class a frozen dataclass with limits and with a name: 'van-der-waals' of `VanDerWaals`.

    Raises TypeError where it lacks something.
    """
    if "name" not in vars(kind):
        kind.name = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "-", kind.__name__).lower()
    hints = get_type_hints(kind, include_extras=True)
    kind.limits = tuple((field, limit) for field, hint in hints.items() for limit in limits_of(hint))
    dataclass(frozen=True)(kind)
    members = {*dir(kind), *(field.name for field in fields(kind))}  # type: ignore[arg-type]
    for group in kind.needed:
        if members.isdisjoint(group):
            raise TypeError(f"{kind.__name__} needs {' or '.join(group)}")
    return kind


def limits_of(hint: Any) -> list[Limit]:
    """Return the limits that a type is annotated with, or one of the types of a union."""
    if get_origin(hint) is Annotated:
        plain, *notes = get_args(hint)
        return [note for note in notes if isinstance(note, Limit)] + limits_of(plain)
    if get_origin(hint) in (Union, UnionType):
        return [limit for kind in get_args(hint) for limit in limits_of(kind)]
    return []
