"""Least squares and their statistics, against a linear model, published numbers and enumeration."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations, groupby

import numpy as np
import pytest
import scipy.optimize

from isopeel.case import load_case
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.identification.data_set import data_set_of
from isopeel.identification.fit_file import Fit
from isopeel.identification.least_squares import starts_of
from isopeel.identification.measured import Measured
from isopeel.identification.model import CurveModel, Evaluation
from isopeel.identification.parameters import Noise, Parameter
from isopeel.identification.report import make_document
from isopeel.identification.solve import solve
from isopeel.identification.statistics import runs_test, uncertainty
from isopeel.report.document import Picture, to_markdown
from isopeel.results.provenance import Provenance

X = np.linspace(0.5, 10.0, 40)
CASE = load_case("tape-angle").with_values({"drive.to": "10 nm", "reading": None})
RATIO, FACTOR, HEIGHT = (
    Parameter("material.poissons_ratio", 0.2, lower=-0.5, upper=0.45),
    Parameter("material.youngs_modulus", 1.0, "GPa", logarithmic=True),
    Parameter("body.height", 4.0, "nm", 1.0, 9.0, logarithmic=True),
)


class Known(CurveModel):
    """A function of the parameters in place of the curves of a case."""

    def __init__(self, fit: Fit, function: object) -> None:
        super().__init__(fit, None, lambda _: None)
        self._function = function

    def _evaluated(self, values: tuple[float, ...]) -> Evaluation:
        def at(values: Sequence[float]) -> FloatArray:
            return np.asarray(self._function(*values), np.float64)  # type: ignore[operator]

        found = at(values)
        columns = []
        for number, one in enumerate(self._fit.parameters):
            here = one.coordinate(values[number])
            far = [list(values), list(values)]
            for other, sign in zip(far, (1, -1), strict=True):
                other[number] = one.value(here + sign * 1e-6)
            columns.append((at(far[0]) - at(far[1])) / 2e-6)
        if not np.isfinite(found).all():
            return Evaluation(found, np.empty((0, 0)), found, "no curve")
        return Evaluation(found, np.column_stack(columns), np.zeros(len(found)))


def _fit(
    y: FloatArray, parameters: Sequence[Parameter], noise: float | None = None, profile: str = ""
) -> Fit:
    """A fit of values y in N/m, with parameters that need not be those of the case."""
    measured = Measured("known.csv", ("displacement", "force"), ("nm", "N/m"), X, y)
    stated = None if noise is None else Noise(noise, False)
    data = data_set_of("measured.1", CASE, measured, {}, noise=stated)
    keys = ("material.poissons_ratio", "material.youngs_modulus", "body.height")
    assert {one.key for one in parameters} <= set(keys)
    return Fit("known", CASE, (data,), tuple(parameters), profile=profile)


def test_a_line_has_the_errors_of_linear_regression() -> None:
    """Against scipy.stats.linregress, which estimates the noise from the residuals, too."""
    rng = np.random.default_rng(3)
    y = 2.0 - 0.3 * X + 0.1 * rng.standard_normal(len(X))
    fit = _fit(y, [RATIO, FACTOR])
    line = scipy.stats.linregress(X, y)
    ratio, factor = (found := solve(fit, Known(fit, lambda a, b: b + a * X))).parameters
    # the search ends one thousandth of an error from the minimum
    assert ratio.value == pytest.approx(line.slope, abs=1e-3 * line.stderr)
    assert factor.value == pytest.approx(line.intercept, abs=1e-3 * line.intercept_stderr)
    assert ratio.standard_error == pytest.approx(line.stderr, rel=1e-3)
    assert factor.standard_error == pytest.approx(line.intercept_stderr, rel=1e-3)
    assert found.chi_square == pytest.approx(38)
    assert found.freedom == 38
    # of a line, the band is narrowest at the mean of x, where it is t s / sqrt(n)
    (curve,) = found.curves
    narrowest = scipy.stats.t.ppf(0.975, 38) * curve.deviations[0] / np.sqrt(40)
    assert curve.band.min() == pytest.approx(narrowest, rel=2e-3)
    assert found.notes == ()


def test_errors_with_stated_noise_are_those_of_curve_fit() -> None:
    def model(x: FloatArray, a: float, b: float) -> FloatArray:
        return b * np.exp(-a * x)

    rng = np.random.default_rng(5)
    y = model(X, 0.3, 2.0) + 0.01 * rng.standard_normal(len(X))
    fit = _fit(y, [RATIO, FACTOR], 0.01, RATIO.key)
    values, covariance = scipy.optimize.curve_fit(
        model, X, y, (0.2, 1.0), np.full(len(X), 0.01), absolute_sigma=True
    )
    found = solve(fit, Known(fit, lambda a, b: model(X, a, b)))
    errors = np.sqrt(np.diag(covariance))
    for one, value, error in zip(found.parameters, values, errors, strict=True):
        assert one.value == pytest.approx(value, abs=0.01 * error)
        assert one.standard_error == pytest.approx(error, rel=1e-3)
    correlation = covariance[0, 1] / errors.prod()
    assert found.correlation[0, 1] == pytest.approx(correlation, abs=1e-3)
    assert found.chi_square == pytest.approx(np.sum(((y - model(X, *values)) / 0.01) ** 2), rel=1e-4)
    # with so little noise the model is linear: the profile is that of linear theory
    assert found.profile is not None
    lower, upper = found.profile.interval
    assert [lower, upper] == pytest.approx(
        [values[0] - 1.96 * errors[0], values[0] + 1.96 * errors[0]], rel=5e-4
    )
    text = to_markdown(make_document(found, Provenance.of_this_process(), "isopeel fit known.toml"))
    assert "Profile of material.poissons_ratio" in text


def test_what_cannot_be_identified_is_said() -> None:
    y = 2.0 + 2e-5 * X
    fit = _fit(y, [RATIO, FACTOR], 0.02)
    weak = solve(fit, Known(fit, lambda a, b: b + 1e-4 * a * X))
    (note,) = weak.notes
    assert note.startswith("`material.poissons_ratio` cannot be identified from these curves")
    assert "hardly depend on it" in note
    # many points have a small standard error, but an error of 1 % of the sensor is as large as the value
    fit = _fit(2.0 + 2e-3 * X, [RATIO], 1e-3)
    small = solve(fit, Known(fit, lambda a: 2.0 + 1e-2 * a * X))
    assert small.parameters[0].relative_error < 0.1
    (note,) = small.notes
    # 0.2 changes the curve by 0.02 of 2.02
    assert small.parameters[0].effect == pytest.approx(0.02 / 2.02, rel=1e-3)
    assert "an error of 1 % of the sensor or of the model changes it by 101 % or more" in note
    # a product is known, and its factors are not
    fit = _fit(2.0 + 0.01 * np.sin(5 * X), [HEIGHT, FACTOR], 0.02)
    product = solve(fit, Known(fit, lambda h, b: b * h + 0 * X))
    assert sum("only a combination of parameters" in note for note in product.notes) == 2
    assert product.condition > 1e6
    assert product.values[HEIGHT.key] * product.values[FACTOR.key] == pytest.approx(2.0, abs=0.01)


def test_a_bound_is_active_and_residuals_are_tested() -> None:
    rng = np.random.default_rng(2)
    y = 3.0 + 0.8 * X + 0.01 * rng.standard_normal(len(X))
    fit = _fit(y, [RATIO, FACTOR], 0.01)
    found = solve(fit, Known(fit, lambda a, b: b + a * X))
    ratio, factor = found.parameters
    assert ratio.bound == "upper"
    assert ratio.value == pytest.approx(0.45, rel=1e-4)
    assert np.isnan(ratio.standard_error)
    # the other is the mean of what is left
    assert factor.value == pytest.approx(np.mean(y - 0.45 * X), rel=1e-4)
    assert factor.standard_error == pytest.approx(0.01 / np.sqrt(40), rel=1e-3)
    notes = " ".join(found.notes)
    assert "`material.poissons_ratio` is at its upper bound, 0.45." in notes
    assert "larger than the stated noise" in notes
    assert "do not look like noise: they have 2 runs" in notes
    assert found.freedom == 39


def test_of_several_starts_the_best_is_taken_and_others_are_named() -> None:
    y = np.cos(0.9 * X)

    def wave(height: float) -> FloatArray:
        # beyond 3 there is no curve
        return np.cos(0.2 * height * X) if height < 8 else np.full(len(X), np.nan)

    fit = replace(_fit(y, [HEIGHT], 0.01), starts=12, seed=4)
    starts = starts_of(fit)
    assert starts[0] == (4.0,)
    # one in each of equal parts of the logarithmic range
    shares = np.log(np.array(starts[1:]).ravel()) / np.log(9.0)
    assert sorted((shares * 11).astype(int)) == list(range(11))
    found = solve(fit, Known(fit, wave))
    assert found.values[HEIGHT.key] == pytest.approx(4.5, rel=1e-4)
    notes = " ".join(found.notes)
    assert "starts have no curve: no curve" in notes
    assert "starts ended at a larger sum of squares" in notes
    with pytest.raises(InputError, match=r"body.height = 4 nm' cannot be used; .*: no curve"):
        solve(replace(fit, starts=1), Known(fit, lambda _: np.full(len(X), np.nan)))


def test_runs_of_signs_are_those_of_all_orders() -> None:
    """Mean and variance of the number of runs over all orders of 10 and 11 signs, by enumeration."""
    rng = np.random.default_rng(0)
    counts = []
    for chosen in combinations(range(21), 10):
        if rng.random() < 0.05:
            signs = np.full(21, -1)
            signs[list(chosen)] = 1
            counts.append(len(list(groupby(signs.tolist()))))
    found = runs_test(np.where(np.arange(21) % 2, 1.0, -1.0))
    assert found is not None
    assert found.runs == 21
    # the error of the mean of 17,000 of them
    assert found.expected == pytest.approx(np.mean(counts), abs=0.06)
    blocks = runs_test(np.where(np.arange(40) < 20, 1.0, -1.0))
    assert blocks is not None
    assert blocks.probability < 1e-8
    few = runs_test(np.where(np.isin(np.arange(21) * 8 % 21, range(10)), 1.0, -1.0))
    assert few is not None
    share = np.mean(np.array(counts) <= few.runs)
    # the normal approximation with the correction for whole numbers
    assert few.probability == pytest.approx(share, abs=0.02)
    assert runs_test(np.ones(30)) is None


def test_a_combination_without_effect_has_a_large_error() -> None:
    jacobian = np.column_stack([X, 2 * X])
    found = uncertainty(jacobian, 0.25)
    assert found.condition > 1e10
    assert found.alone == pytest.approx(0.5 / np.linalg.norm(jacobian, axis=0))
    assert found.errors.min() > 1e6 * found.alone.max()
    # numpy's inverse where there is one
    regular = np.column_stack([X, X**2])
    expected = 0.25 * np.linalg.inv(regular.T @ regular)
    np.testing.assert_allclose(uncertainty(regular, 0.25).covariance, expected, rtol=1e-10)
    assert uncertainty(regular).condition == pytest.approx(np.linalg.cond(regular))


def test_figures_have_the_headings_of_the_measured_columns() -> None:
    y = 2.0 + 0.3 * X
    fit = _fit(y, [RATIO, FACTOR], 0.1)
    found = solve(fit, Known(fit, lambda a, b: b + a * X))
    document = make_document(found, Provenance.of_this_process(), "isopeel fit known.toml")
    pictures = [block for block in document.blocks if isinstance(block, Picture)]
    assert [block.name for block in pictures] == ["curve-1", "correlation"]
    axes = pictures[0].draw().axes
    assert axes[0].get_ylabel() == "force [N/m]"
    assert axes[1].get_xlabel() == "displacement [nm]"
