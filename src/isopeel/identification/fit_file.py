"""The file of a fit: a case, measured curves, parameters with bounds, and how they are searched."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError

from isopeel.case import Case
from isopeel.case.parameters import parameter_of as differentiable
from isopeel.case.text import document_of
from isopeel.case.values import Section
from isopeel.common.errors import InputError
from isopeel.common.units import unit_of
from isopeel.identification.data_set import DataSet, data_set_of
from isopeel.identification.measured import Measured, read_measured
from isopeel.identification.parameters import Noise, Parameter
from isopeel.identification.units import in_unit
from isopeel.study.tables import OfCase, case_of, first_error, text_of

#: Most starts of a fit.
MOST_STARTS = 1000
_QUANTITY = "a number, or a number and a unit, is needed"
NOISE = "a share of the largest measured value, such as '1 %', or a value with the unit of y, is needed"


class _MeasuredTable(Section):
    file: Annotated[str, Field(min_length=1, description="the path of a CSV file is needed")]
    x: Annotated[str, Field(description="the heading of a column is needed, such as 'displacement [mm]'")] = (
        ""
    )
    y: Annotated[str, Field(description="the heading of a column is needed, such as 'force [N/m]'")] = ""
    noise: Annotated[str | None, Field(description=NOISE)] = None
    deviation: Annotated[
        str, Field(description="the heading of a column of standard deviations is needed")
    ] = ""
    stage: Annotated[str, Field(description="the name of a stage of the case is needed")] = ""
    set: Annotated[
        dict[str, Any],
        Field(default_factory=dict, description="a table of keys of the case and their values is needed"),
    ]


class _ParameterTable(Section):
    key: Annotated[str, Field(min_length=1, description="a key of the case is needed, such as body.height")]
    start: Annotated[Any, Field(description=_QUANTITY)]
    lower: Annotated[Any, Field(description=_QUANTITY)] = None
    upper: Annotated[Any, Field(description=_QUANTITY)] = None
    scale: Annotated[
        Literal["linear", "logarithmic"] | None, Field(description="'linear' or 'logarithmic' is needed")
    ] = None


class _SearchTable(Section):
    starts: Annotated[
        int, Field(ge=1, le=MOST_STARTS, strict=True, description="a whole number from 1 on is needed")
    ] = 1
    seed: Annotated[int, Field(ge=0, strict=True, description="a whole number from 0 on is needed")] = 0
    profile: Annotated[str, Field(description="the key of a parameter is needed")] = ""


class _FitTable(OfCase):
    measured: Annotated[
        list[_MeasuredTable], Field(min_length=1, description="one table [[measured]] or more is needed")
    ]
    parameter: Annotated[
        list[_ParameterTable], Field(min_length=1, description="one table [[parameter]] or more is needed")
    ]
    search: Annotated[_SearchTable, Field(description="a table [search] is needed")] = _SearchTable()


_PARTS: Mapping[str, type[Section]] = {
    "measured": _MeasuredTable,
    "parameter": _ParameterTable,
    "search": _SearchTable,
}


@dataclass(frozen=True)
class Fit:
    """A case, the curves that are measured, and the parameters to find.

    Make one with `load_fit` or `fit_of`. The first start is that of the parameters; the `starts` - 1 others
    are points of a Latin hypercube between their bounds. `profile` is the key of a parameter, or empty.
    """

    name: str
    case: Case
    data: tuple[DataSet, ...]
    parameters: tuple[Parameter, ...]
    starts: int = 1
    seed: int = 0
    profile: str = ""

    def __post_init__(self) -> None:
        """Check that the parts fit together. Raises InputError."""
        _check_parameters(self)
        points = sum(len(one.y) for one in self.data)
        if points < len(self.parameters):
            allowed = f"{len(self.parameters)} parameters need at least as many measured points"
            raise InputError("measured", f"{points} points", allowed)
        stated = [one.deviations is not None for one in self.data]
        if any(stated) and not all(stated):
            number = stated.index(False) + 1
            allowed = "state the noise of all measured curves, or of none"
            raise InputError(f"measured.{number}.noise", None, allowed)
        if not any(stated) and points == len(self.parameters):
            allowed = "as many points as parameters leave no residual to estimate the noise from; state it"
            raise InputError("measured.1.noise", None, allowed)

    def start_values(self) -> tuple[float, ...]:
        """Return the start of each parameter in its unit."""
        return tuple(parameter.start for parameter in self.parameters)

    def written(self, values: Sequence[float]) -> dict[str, Any]:
        """Return values of the parameters as a case file has them, by their keys."""
        return {
            parameter.key: parameter.written(value)
            for parameter, value in zip(self.parameters, values, strict=True)
        }


def load_fit(path: Path) -> Fit:
    """Read the file of a fit, whose case and measured curves are seen from its folder.

    Raises InputError, whose field is the key, or FIT for the file itself.
    """
    return fit_of(document_of(text_of(path, "FIT", "fit"), str(path), "FIT", "fit"), path.parent)


def fit_of(document: Mapping[str, Any], folder: Path = Path()) -> Fit:
    """Check the tables of a fit, whose case and measured curves are seen from a folder. Raises InputError."""
    try:
        tables = _FitTable.model_validate(document)
    except ValidationError as error:
        raise first_error(error, _FitTable, _PARTS) from error
    base = case_of(tables.case, tables.set, folder)
    parameters = tuple(
        parameter_of(f"parameter.{number}", table.key, table.start, table.lower, table.upper, table.scale)
        for number, table in enumerate(tables.parameter, start=1)
    )
    data = []
    for number, table in enumerate(tables.measured, start=1):
        field = f"measured.{number}"
        measured = read_measured(folder / table.file, table.x, table.y, table.deviation)
        if table.noise is not None and table.deviation:
            raise InputError(f"{field}.noise", table.noise, "the key `deviation` states the noise, too")
        noise = None if table.noise is None else noise_of(f"{field}.noise", table.noise, measured)
        data.append(data_set_of(field, base, measured, table.set, table.stage, noise))
    search = tables.search
    return Fit(tables.name, base, tuple(data), parameters, search.starts, search.seed, search.profile)


def parameter_of(
    field: str,
    key: str,
    start: str | float,
    lower: str | float | None = None,
    upper: str | float | None = None,
    scale: str | None = None,
) -> Parameter:
    """Check a parameter, whose start and bounds are written as in a case file.

    A parameter is logarithmic by default if its start is positive, and a stated lower bound not negative.
    Raises InputError.
    """
    unit = ""
    if isinstance(start, str):
        try:
            unit = unit_of(start)
        except ValueError as error:
            raise InputError(f"{field}.start", start, f"{error}; {_QUANTITY}") from error
    first = _number(f"{field}.start", start, unit)
    low = -inf if lower is None else _number(f"{field}.lower", lower, unit)
    high = inf if upper is None else _number(f"{field}.upper", upper, unit)
    if not low < high:
        raise InputError(f"{field}.upper", upper, "it must be larger than `lower`")
    if not low <= first <= high:
        raise InputError(f"{field}.start", start, f"it must lie between the bounds {lower} and {upper}")
    positive = first > 0 and (lower is None or low >= 0)
    if scale == "logarithmic" and not positive:
        allowed = "a logarithmic parameter has a positive start, and no negative lower bound"
        raise InputError(f"{field}.scale", scale, allowed)
    return Parameter(key, first, unit, low, high, positive if scale is None else scale == "logarithmic")


def noise_of(field: str, text: str, measured: Measured) -> Noise:
    """Read noise: a share such as '1 %', or a value with a unit of the measured y. Raises InputError."""
    try:
        if text.strip().endswith("%"):
            noise = Noise(float(text.strip()[:-1]) / 100, True)
        else:
            noise = Noise(in_unit(text, measured.units[1]), False)
    except ValueError as error:
        raise InputError(field, text, f"{error}; {NOISE}") from error
    if not (noise.value > 0 and isfinite(noise.value)):
        raise InputError(field, text, f"it must be positive and finite; {NOISE}")
    return noise


def _number(field: str, written: str | float, unit: str) -> float:
    """Return a written value in a unit. Raises InputError."""
    try:
        if isinstance(written, bool) or not isinstance(written, str if unit else int | float):
            raise ValueError("it is of another kind")
        value = in_unit(str(written), unit)
        if not isfinite(value):
            raise ValueError("it is not finite")
    except ValueError as error:
        needed = f"a number and a unit such as {unit!r} is needed" if unit else "a plain number is needed"
        raise InputError(field, written, f"{error}; {needed}") from error
    return value


def _check_parameters(fit: Fit) -> None:
    keys = [parameter.key for parameter in fit.parameters]
    for number, parameter in enumerate(fit.parameters, start=1):
        field = f"parameter.{number}"
        if keys.index(parameter.key) != number - 1:
            raise InputError(f"{field}.key", parameter.key, "another parameter has this key")
        for one in fit.data:
            if parameter.key in one.values:
                allowed = f"the measured curve {one.name} sets this key, so that it cannot be fitted"
                raise InputError(f"{field}.key", parameter.key, allowed)
        if fit.starts > 1 and not (isfinite(parameter.lower) and isfinite(parameter.upper)):
            raise InputError(
                field, parameter.key, "several starts need a lower and an upper bound of each parameter"
            )
        if fit.starts > 1 and parameter.logarithmic and not parameter.lower > 0:
            raise InputError(
                f"{field}.lower",
                parameter.lower,
                "several starts of a logarithmic parameter need a positive lower bound",
            )
    if fit.profile and fit.profile not in keys:
        raise InputError("search.profile", fit.profile, f"it is one of the parameters: {', '.join(keys)}")
    for one in fit.data:
        for number, parameter in enumerate(fit.parameters, start=1):
            try:
                changed = one.case.with_values({parameter.key: parameter.written(parameter.start)})
                differentiable(changed, parameter.key)
            except InputError as error:
                raise InputError(f"parameter.{number}, {error.field}", error.value, error.allowed) from error
        try:
            one.case.with_values(fit.written(fit.start_values()))
        except InputError as error:
            raise InputError(f"parameter, {error.field}", error.value, error.allowed) from error
