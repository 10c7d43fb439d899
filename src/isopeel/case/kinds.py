"""Tables of a case file that choose one of several kinds, their keys made from the dataclasses themselves.

A new law, material, substrate, shape or drive is a new module of its package: `registry.discover` finds the
dataclass, its fields become the keys, and its `name` is what the case file calls it.
"""

import dataclasses
from collections.abc import Mapping
from difflib import get_close_matches
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self, get_args, get_type_hints

from pydantic import Field, ModelWrapValidatorHandler, ValidationInfo, create_model, model_validator

from isopeel.case import absent
from isopeel.case.values import Needed, Section, constant_powers, key_of, means
from isopeel.common.components import limits_of
from isopeel.common.errors import InputError
from isopeel.common.quantities import Meaning
from isopeel.common.registry import discover
from isopeel.physics.formula_dimensions import FormulaDimensions, check_dimensions


class KindSection(Section):
    """A table whose keys are the fields of a dataclass, and those that all of its family have."""

    #: The table, the packages of its dataclasses, the key that names one, and the name where it is left out.
    table: ClassVar[str]
    packages: ClassVar[tuple[str, ...]]
    chooser: ClassVar[str]
    usual: ClassVar[str | None] = None
    #: The name that the reference shows where there is no usual one.
    example_kind: ClassVar[str] = ""
    #: Fields of the dataclasses that the family gives them, from keys of its own.
    own: ClassVar[frozenset[str]] = frozenset()
    #: The dataclass; a family has none.
    maker: ClassVar[type[Any] | None] = None

    if TYPE_CHECKING:
        # the keys of the dataclass are known when it runs only
        def __getattr__(self, name: str) -> Any: ...

    @classmethod
    def chosen(cls, written: Mapping[str, Any]) -> type[Self]:
        """The section of the dataclass that a table names. Raises InputError that lists those there are."""
        name = written.get(cls.chooser, cls.usual)
        known = {name: kind for package in cls.packages for name, kind in discover(package).items()}
        if not isinstance(name, str) or name not in known:
            allowed = f"one of these {cls.chooser}s is needed: {', '.join(known)}"
            if isinstance(name, str):
                nearest = get_close_matches(name, known, 1)
                hint = f"did you mean {nearest[0]}? " if nearest else ""
                instead = absent.KINDS.get(name)
                allowed = f"{instead}; {allowed}" if instead else hint + allowed
            raise InputError(f"{cls.table}.{cls.chooser}", name, allowed)
        kind: Any = known[name]
        section: type[Self] = _section(cls, kind)
        return section

    @model_validator(mode="wrap")
    @classmethod
    def _choose(cls, written: object, handler: ModelWrapValidatorHandler[Self], info: ValidationInfo) -> Self:
        if cls.maker is not None or not isinstance(written, Mapping):
            return handler(written)
        section = cls.chosen(written).model_validate(written, context=info.context)
        dimensions = getattr(section.maker, "dimensions", None)
        if isinstance(dimensions, FormulaDimensions):
            constants = {
                name: (value, constant_powers(written["constants"][name]))
                for name, value in section.constants.items()
            }
            check_dimensions(cls.table, dimensions, getattr(section, dimensions.field), constants)
        return section

    def made(self, **own: Any) -> Any:
        """Make the object, with the fields that the family gives. Raises InputError of its class."""
        assert self.maker is not None
        fields = {field.name: getattr(self, field.name) for field in _given(type(self), self.maker)}
        return self.maker(**fields, **own)


def _given(family: type[KindSection], kind: type[Any]) -> list[dataclasses.Field[Any]]:
    """Return the fields of a dataclass that a table gives, each by its name."""
    return [field for field in dataclasses.fields(kind) if field.init and field.name not in family.own]


@cache
def _section(family: type[KindSection], kind: type[Any]) -> Any:
    """Make the section of a dataclass. Raises TypeError where no case could have one of its fields."""
    hints = get_type_hints(kind, include_extras=True)
    keys: dict[str, Any] = {}
    for field in _given(family, kind):
        if field.name in (family.chooser, *family.model_fields) or hasattr(family, field.name):
            raise TypeError(f"{kind.__qualname__}.{field.name} needs another name: a case has its own")
        try:
            annotation, needed = key_of(hints[field.name])
        except TypeError as error:
            raise TypeError(f"{kind.__qualname__}.{field.name}: {error}") from error
        default: Any = Field()
        if field.default is not dataclasses.MISSING:
            default = field.default
        elif field.default_factory is not dataclasses.MISSING:
            default = Field(default_factory=field.default_factory)
        given = get_args(hints[field.name])[1:]
        meaning = next((note for note in given if isinstance(note, Meaning)), Meaning(""))
        told = means(meaning.text, meaning.example, usual=meaning.usual, see=meaning.see)
        notes = (*limits_of(hints[field.name]), Needed(needed or ""), told)
        keys[field.name] = (Annotated[annotation, *notes], default)
    choice: Any = Literal[kind.name], ... if family.usual != kind.name else kind.name
    section = create_model(f"{kind.__name__}Section", __base__=family, **{family.chooser: choice}, **keys)
    section.maker = kind
    return section
