"""The result of a fit: values with standard errors, curves with bands, and what may be wrong, in words."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from isopeel.case import Case
from isopeel.common.arrays import FloatArray
from isopeel.common.dataframes import dataframe
from isopeel.identification.data_set import DataSet
from isopeel.identification.fit_file import Fit
from isopeel.identification.least_squares import Minimum
from isopeel.identification.parameters import Parameter
from isopeel.identification.profile import Profile
from isopeel.identification.statistics import RunsTest


@dataclass(frozen=True)
class FittedParameter:
    """A value in the unit of its parameter, with its standard error.

    `alone` is the standard error if all other parameters were known, and `bound` the bound that the value is
    at, "lower" or "upper": then it has no standard error (nan). `effect` is the largest change of a curve for
    a change of the value by 1 %, in percent of the largest measured value.
    """

    parameter: Parameter
    value: float
    standard_error: float
    alone: float
    effect: float
    bound: str = ""

    @property
    def key(self) -> str:
        """The key of the case."""
        return self.parameter.key

    @property
    def relative_error(self) -> float:
        """The standard error as a part of the value."""
        return self.standard_error / abs(self.value) if self.value else np.inf

    @property
    def text(self) -> str:
        """The value and its standard error with the unit."""
        unit = self.parameter.unit
        if np.isnan(self.standard_error):
            return f"{self.value:.6g} {unit}".rstrip() + f" (at its {self.bound} bound)"
        return f"{self.value:.6g} ± {self.standard_error:.2g} {unit}".rstrip()


@dataclass(frozen=True, eq=False)
class FittedCurve:
    """A measured curve and the fitted one, at the measured points, in the units of the measured columns.

    `band` (points,) is half the width of the 95 % confidence band of the fitted curve, and `deviations`
    (points,) are the standard deviations of the noise, stated or estimated. `runs` is None for few points.
    """

    data: DataSet
    fitted: FloatArray
    band: FloatArray
    deviations: FloatArray
    runs: RunsTest | None

    @property
    def x(self) -> FloatArray:
        """The measured abscissae (points,)."""
        return self.data.measured.x

    @property
    def residuals(self) -> FloatArray:
        """Measured minus fitted values (points,)."""
        return self.data.measured.y - self.fitted


@dataclass(frozen=True, eq=False)
class FitResult:
    """What a fit found.

    `covariance` and `correlation` (k, k) are those of the values; rows of parameters at a bound are nan.
    `condition` is the condition number of the relative sensitivities. `chi_square` is the sum of squared
    residuals in units of the noise: where none is stated, the noise is estimated so that it is `freedom`, the
    number of points without that of free parameters. `case` has the fitted values.
    """

    fit: Fit
    parameters: tuple[FittedParameter, ...]
    covariance: FloatArray
    correlation: FloatArray
    condition: float
    chi_square: float
    freedom: int
    noise_is_stated: bool
    probability: float
    curves: tuple[FittedCurve, ...]
    starts: tuple[Minimum, ...]
    profile: Profile | None
    notes: tuple[str, ...]
    runs: int
    case: Case

    @property
    def values(self) -> dict[str, float]:
        """The values by their keys, in the units of the parameters."""
        return {one.key: one.value for one in self.parameters}

    def to_dataframe(self) -> Any:
        """Return the table of parameters as a DataFrame of pandas, by their keys.

        Raises ImportError if pandas is not installed.
        """
        return dataframe(self.table()).set_index("key")

    def table(self) -> dict[str, list[Any]]:
        """Return the columns of the table of parameters."""
        found = self.parameters
        return {
            "key": [one.key for one in found],
            "unit": [one.parameter.unit for one in found],
            "value": [one.value for one in found],
            "standard error": [_or_none(one.standard_error) for one in found],
            "standard error alone": [_or_none(one.alone) for one in found],
            "effect of 1 % [%]": [one.effect for one in found],
            "bound": [one.bound for one in found],
        }


def _or_none(value: float) -> float | None:
    return None if np.isnan(value) else value
