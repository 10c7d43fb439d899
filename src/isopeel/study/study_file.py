"""The file of a study: a base case, factors, the design, and the outputs that are read."""

from collections.abc import Mapping, Sequence
from itertools import islice, product
from math import isfinite
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError

from isopeel.case import Case
from isopeel.case.text import document_of
from isopeel.case.values import Section
from isopeel.common.errors import InputError
from isopeel.common.units import measured_as, unit_of
from isopeel.study.design import Method, Point, groups_of
from isopeel.study.factors import Factor, Listed, Range
from isopeel.study.study import Study
from isopeel.study.tables import OfCase, case_of, first_error, text_of, with_set_values

#: Most runs of a study: each takes a second or more.
MOST_RUNS = 100_000
#: Combinations with other factors that are tried for a value that the base case cannot have.
_MOST_TRIED = 32
_RANGE = "a factor has `values`, a list, or a range: `from`, `to` and, in a grid, `count`"


class _FactorTable(Section):
    key: Annotated[str, Field(min_length=1, description="a key of the case is needed, such as body.height")]
    values: Annotated[
        list[Any] | None, Field(min_length=1, description="a list of one value or more is needed")
    ] = None
    start: Annotated[Any, Field(alias="from", description="the first value of the range is needed")] = None
    to: Annotated[Any, Field(description="the last value of the range is needed")] = None
    count: Annotated[
        int | None, Field(ge=2, le=MOST_RUNS, strict=True, description="a whole number from 2 on is needed")
    ] = None
    scale: Annotated[
        Literal["linear", "logarithmic"], Field(description="'linear' or 'logarithmic' is needed")
    ] = "linear"
    zip: Annotated[str, Field(description="a name is needed; factors of one name change together")] = ""


class _DesignTable(Section):
    method: Annotated[
        Method, Field(description="'grid', 'latin-hypercube', 'sobol' or 'saltelli' is needed")
    ] = "grid"
    count: Annotated[
        int | None, Field(ge=1, le=MOST_RUNS, strict=True, description="a whole number from 1 on is needed")
    ] = None
    seed: Annotated[int, Field(ge=0, strict=True, description="a whole number from 0 on is needed")] = 0


class _StudyTable(OfCase):
    factor: Annotated[
        list[_FactorTable], Field(min_length=1, description="one table [[factor]] or more is needed")
    ]
    design: Annotated[_DesignTable, Field(description="a table [design] is needed")] = _DesignTable()
    outputs: Annotated[
        tuple[str, ...], Field(description='a list of readings is needed, such as ["largest moment"]')
    ] = ()


def read_study(path: Path) -> Study:
    """Read the file of a study, whose case is a shipped one or is seen from its folder.

    Raises InputError, whose field is the key, or STUDY for the file itself.
    """
    return study_of(document_of(text_of(path, "STUDY", "study"), str(path), "STUDY", "study"), path.parent)


def study_of(document: Mapping[str, Any], folder: Path = Path()) -> Study:
    """Check the tables of a study, whose case is a shipped one or is seen from a folder.

    Raises InputError, whose field is the key.
    """
    tables = _checked(document)
    return _of_case(tables, case_of(tables.case, tables.set, folder))


def study_of_case(document: Mapping[str, Any], base: Case) -> Study:
    """Check the tables of a study of a case that is loaded already; they have no key `case`.

    Raises InputError, whose field is the key.
    """
    tables = _checked({**document, "case": base.name})
    return _of_case(tables, with_set_values(base, tables.set))


def _checked(document: Mapping[str, Any]) -> _StudyTable:
    try:
        return _StudyTable.model_validate(document)
    except ValidationError as error:
        raise first_error(error, _StudyTable, {"factor": _FactorTable, "design": _DesignTable}) from error


def _of_case(tables: _StudyTable, base: Case) -> Study:
    design = tables.design
    factors = tuple(
        _factor(table, f"factor.{number}", design.method)
        for number, table in enumerate(tables.factor, start=1)
    )
    if twice := {factor.key for factor in factors} & set(tables.set):
        raise InputError(f"set.{min(twice)}", tables.set[min(twice)], "a factor has this key; leave one out")
    _check_keys_differ(factors)
    if design.method == "grid":
        _check_lists(factors)
    _check_keys(base, factors)
    return Study(
        tables.name,
        base,
        factors,
        design.method,
        _count(design, factors),
        design.seed,
        tuple(dict.fromkeys(tables.outputs)),
    )


def _factor(table: _FactorTable, field: str, method: Method) -> Factor:
    """Return the factor of a table. Raises InputError."""
    given = [
        name
        for name, value in (("from", table.start), ("to", table.to), ("count", table.count))
        if value is not None
    ]
    if table.values is not None:
        if given:
            raise InputError(f"{field}.{given[0]}", None, f"{_RANGE}; not both")
        return Factor(table.key, Listed(tuple(table.values)), table.zip)
    # samples take any values of a range
    count = 2 if method != "grid" else table.count
    if table.start is None or table.to is None or count is None:
        raise InputError(field, table.key, _RANGE)
    unit = _unit(table.start, f"{field}.from")
    lower, upper = (
        _number(value, unit, f"{field}.{name}") for name, value in (("from", table.start), ("to", table.to))
    )
    logarithmic = table.scale == "logarithmic"
    if logarithmic and not (lower > 0 and upper > 0):
        raise InputError(f"{field}.scale", table.scale, "both ends of a logarithmic range must be positive")
    if lower == upper:
        raise InputError(f"{field}.to", table.to, "it must differ from `from`")
    return Factor(table.key, Range(lower, upper, unit, count, logarithmic), table.zip)


def _unit(value: object, field: str) -> str:
    if isinstance(value, int | float) and not isinstance(value, bool):
        return ""
    try:
        return unit_of(str(value))
    except ValueError as error:
        raise InputError(
            field, value, f"{error}; a range begins at a number, or at a number and a unit"
        ) from error


def _number(value: object, unit: str, field: str) -> float:
    """Return an end of a range in the unit of its first end."""
    plain = isinstance(value, int | float) and not isinstance(value, bool)
    if plain and not unit:
        number = float(str(value))
        if not isfinite(number):
            raise InputError(field, value, "it must be finite")
        return number
    needed = (
        f"a number and a unit such as {unit!r} is needed"
        if unit
        else "a plain number is needed, as in `from`"
    )
    if plain or not unit:
        raise InputError(field, value, needed)
    try:
        return measured_as(str(value), unit)
    except ValueError as error:
        raise InputError(field, value, f"{error}; {needed}") from error


def _check_keys_differ(factors: tuple[Factor, ...]) -> None:
    seen = set()
    for number, factor in enumerate(factors, start=1):
        if factor.key in seen:
            raise InputError(f"factor.{number}.key", factor.key, "another factor has this key")
        seen.add(factor.key)


def _check_keys(base: Case, factors: tuple[Factor, ...]) -> None:
    """Check the keys of factors, and their listed values or the ends of their ranges. Raises InputError.

    Factors that change together are checked together. Values that the base case cannot have are right if
    they fit to values of other factors; other combinations may fail as runs.
    """
    numbers = {factor.key: number for number, factor in enumerate(factors, start=1)}
    rows = [_ends(group) for group in groups_of(factors)]
    for place, points in enumerate(rows):
        for point in points:
            try:
                base.with_values(point)
            except InputError as error:
                others = product(*rows[:place], *rows[place + 1 :])
                if any(_is_valid(base, [point, *other]) for other in islice(others, _MOST_TRIED)):
                    continue
                field = f"factor.{numbers[next(iter(point))]}, {error.field}"
                raise InputError(field, error.value, error.allowed) from error


def _ends(group: Sequence[Factor]) -> list[Point]:
    """Return the values of factors that change together, or the ends of their ranges."""
    return [
        {factor.key: value for factor, value in zip(group, values, strict=True)}
        for values in zip(*(factor.ends for factor in group), strict=False)
    ]


def _is_valid(base: Case, parts: Sequence[Point]) -> bool:
    try:
        base.with_values({key: value for part in parts for key, value in part.items()})
    except InputError:
        return False
    return True


def _check_lists(factors: tuple[Factor, ...]) -> None:
    """Check that no run is there twice, and that factors that change together fit. Raises InputError."""
    for group in groups_of(factors):
        lengths = {factor.key: len(factor.values.values) for factor in group}
        if len(set(lengths.values())) > 1:
            listed = ", ".join(f"{key} has {length}" for key, length in lengths.items())
            raise InputError(
                "zip", group[0].zip, f"factors that change together have as many values: {listed}"
            )
        seen = set()
        for row in zip(*(factor.values.values for factor in group), strict=True):
            if repr(row) in seen:
                field = f"factor.{factors.index(group[0]) + 1}.values"
                raise InputError(field, row[0] if len(row) == 1 else row, "it is there twice")
            seen.add(repr(row))


def _count(design: _DesignTable, factors: tuple[Factor, ...]) -> int:
    """Return the number of points of a sample. Raises InputError, also where a study has too many runs."""
    groups = groups_of(factors)
    if design.method == "grid":
        if design.count is not None:
            raise InputError("design.count", design.count, "a grid has all combinations; leave the key out")
        runs = 1
        for group in groups:
            runs *= len(group[0].values.values)
    elif design.count is None:
        raise InputError("design.count", None, "the key is missing; a sample needs a number of points")
    else:
        if design.method != "latin-hypercube" and design.count & (design.count - 1):
            allowed = "Sobol's sequence is balanced for powers of two only, such as 64 or 128"
            raise InputError("design.count", design.count, allowed)
        runs = design.count * (len(groups) + 2 if design.method == "saltelli" else 1)
    if runs > MOST_RUNS:
        raise InputError("factor", f"{runs} runs", f"a study has at most {MOST_RUNS} runs")
    return design.count or 0
