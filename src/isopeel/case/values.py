"""The values that keys of a case file take, in L0 and E0, and what is said where they are wrong."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import radians
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationInfo

from isopeel.common.quantities import LENGTH, NUMBER, Dimension
from isopeel.common.units import Quantity, parse_quantity

#: Magnitudes, in L0 and E0 or degrees, between which products of a few powers of them stay finite.
SMALLEST, LARGEST = 1e-12, 1e12


@dataclass(frozen=True)
class Needed:
    """What is needed for a value, in the words of an error."""

    text: str


def means(meaning: str, example: Any = None, *, usual: str = "", see: str = "") -> Any:
    """Return the field of a key: what it means, with the other values of a `Meaning`."""
    extra: dict[str, Any] = {"usual": usual, "see": see}
    return Field(description=meaning, examples=[example], json_schema_extra=extra)


class Section(BaseModel):
    """A table of known keys."""

    model_config = ConfigDict(frozen=True, extra="forbid", protected_namespaces=())


def quantity_of(dimension: Dimension, written: object) -> Quantity:
    """Read a quantity of a dimension, however large. Raises ValueError that says what is needed."""
    try:
        quantity = parse_quantity(str(written))
    except ValueError as error:
        raise ValueError(f"{error}; {dimension.needed}") from error
    powers_agree = quantity.stress == dimension.stress and quantity.length == dimension.length
    if not powers_agree or quantity.angle != dimension.angle:
        raise ValueError(f"{dimension.needed}, and this is {_kind(quantity)}")
    return quantity


_KINDS: dict[tuple[Fraction | int, Fraction | int], str] = {
    (0, 1): "a length",
    (0, 2): "an area",
    (1, 0): "a stress",
    (1, 1): "a force per width or an energy per area",
    (1, 2): "a force",
    (1, 3): "an energy",
}


def _kind(quantity: Quantity) -> str:
    if quantity.angle:
        return "an angle"
    return _KINDS.get((quantity.stress, quantity.length), "something else")


def read_quantity(dimension: Dimension, written: object) -> float:
    """Read a quantity in E0^stress L0^length, or in degrees. Raises ValueError that says what is needed."""
    quantity = quantity_of(dimension, written)
    if quantity.value and not SMALLEST <= abs(quantity.value) <= LARGEST:
        unit = "degrees" if quantity.angle else "units of the case, or of 1 nm and 2 GPa"
        raise ValueError(f"it must lie between {SMALLEST:g} and {LARGEST:g} in {unit}")
    return quantity.value


def as_written(dimension: Dimension, value: object) -> str:
    """Return a value of a command line as a case file would have it, which takes no plain numbers.

    One rule for all commands: a plain number is in degrees where an angle is needed, as all curves over an
    angle are; of a length or a force it would mean another one in each case, and is left to be refused.
    """
    try:
        number = float(str(value))
    except ValueError:
        return str(value)
    return f"{number!r} deg" if dimension.angle else str(value)


def several(count: int, needed: str) -> str:
    """Say that a list is needed, of so many values that are each needed."""
    return f"a list of {count} is needed; for each value, {needed}"


class Key(NamedTuple):
    """How the value of a key is checked, and what is needed there."""

    annotation: Any
    needed: str | None


def key_of(hint: Any) -> Key:
    """Return the key for a type of a dataclass's field. Raises TypeError for types that no case can have.

    Floats have a dimension (`isopeel.common.quantities`), and texts may say in words what is needed; further
    there are true or false, whole numbers, texts to choose from, files, tuples of these, and constants by
    name.
    """
    if get_origin(hint) is Annotated:
        plain, *notes = get_args(hint)
        for note in notes:
            if isinstance(note, Dimension) and plain is float:
                return Key(_of(note), note.needed)
            if isinstance(note, str):
                return Key(key_of(plain).annotation, note)
        return key_of(plain)
    if get_origin(hint) in (Union, UnionType):
        kinds = [kind for kind in get_args(hint) if kind is not type(None)]
        if len(kinds) == 1:
            key = key_of(kinds[0])
            return Key(key.annotation | None, key.needed)
    if get_origin(hint) is Literal:
        first, last = ", ".join(map(repr, get_args(hint)[:-1])), repr(get_args(hint)[-1])
        return Key(hint, f"{first} or {last} is needed" if first else f"{last} is needed")
    if get_origin(hint) is tuple and Ellipsis not in get_args(hint):
        return _tuple_of([key_of(kind) for kind in get_args(hint)])
    if get_origin(hint) is Mapping and get_args(hint) == (str, float):
        return Key(dict[str, Annotated[float, BeforeValidator(_constant)]], None)
    try:
        return _PLAIN[hint]
    except (KeyError, TypeError) as error:
        allowed = "floats have a dimension, see isopeel.common.quantities"
        raise TypeError(f"a case file has no values of the type {hint}; {allowed}") from error


def _of(dimension: Dimension) -> Any:
    if dimension.is_number:
        return Annotated[float, dimension, Field(strict=True)]

    def read(written: object) -> float:
        value = read_quantity(dimension, written)
        return radians(value) if dimension.angle else value

    return Annotated[float, dimension, BeforeValidator(read)]


def _tuple_of(keys: list[Key]) -> Key:
    needed = several(len(keys), keys[0].needed or "a value is needed")
    tuple_type: Any = tuple
    annotation = tuple_type[tuple(key.annotation for key in keys)]
    return Key(Annotated[annotation, BeforeValidator(list_of(len(keys), needed))], needed)


def list_of(count: int, needed: str) -> Callable[[object], object]:
    """Return the check that something written is a list of so many values."""

    def check(written: object) -> object:
        if not isinstance(written, list) or len(written) != count:
            raise ValueError(needed)
        return written

    return check


def _constant(written: object) -> float:
    """Read a constant of a formula: a plain number, or a text with a unit made of stresses and lengths."""
    if isinstance(written, int | float) and not isinstance(written, bool):
        try:
            return float(written)
        except OverflowError as error:
            raise ValueError("it must be finite") from error
    quantity = parse_quantity(str(written))
    if quantity.angle:
        raise ValueError("write angles as plain numbers, in radians")
    return quantity.value


def constant_powers(written: object) -> tuple[Fraction, Fraction]:
    """Return the powers of stress and length that a constant is written in; a plain number has none."""
    if not isinstance(written, str):
        return Fraction(0), Fraction(0)
    quantity = parse_quantity(written)
    return quantity.stress, quantity.length


_A_FILE = "the path of a file is needed, as seen from the folder of the case"


def _file(written: object, info: ValidationInfo) -> Path:
    """Read the path of a file, as seen from the folder of the case."""
    if not isinstance(written, str):
        raise ValueError(_A_FILE)
    folder: Path = (info.context or {}).get("folder", Path())
    return (folder / written).absolute()


_PLAIN = {
    bool: Key(Annotated[bool, Field(strict=True)], "true or false is needed"),
    int: Key(Annotated[int, Field(strict=True)], "a whole number is needed"),
    str: Key(str, "a text is needed"),
    Path: Key(Annotated[Path, BeforeValidator(_file)], _A_FILE),
}

# The same for keys that no dataclass has.
LengthKey = Annotated[float, LENGTH, BeforeValidator(lambda written: read_quantity(LENGTH, written))]
NumberKey = Annotated[float, NUMBER, Field(strict=True), Needed(NUMBER.needed)]
FlagKey = Annotated[bool, Field(strict=True), Needed("true or false is needed")]
