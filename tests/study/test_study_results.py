"""What is read from all runs of a study: effects and shares of the variance, against known functions."""

import numpy as np
import pytest
from scipy.stats import sobol_indices

from isopeel.case import load_case
from isopeel.study.factors import Factor, Listed, Range
from isopeel.study.figures import curves_figure, main_effect, output_figure
from isopeel.study.outcome import Amount, Line, Outcome
from isopeel.study.sobol import variance_shares
from isopeel.study.study import Study
from isopeel.study.table import StudyResults, output_of

CASE = load_case("strip")


def _results(factors: tuple[Factor, ...], method: str, count: int, values: object) -> StudyResults:
    """The results of a study whose runs have one reading, a function of the numbers of the factors."""
    study = Study("known", CASE, factors, method, count)  # type: ignore[arg-type]
    line = Line("peel", np.arange(3.0), np.arange(3.0), ("rotation", "moment"), ("deg", "N m/m"))
    outcomes = []
    for point in study.points:
        numbers = [factor.scale.number(point[factor.key]) for factor in factors]
        value = float(values(*numbers))  # type: ignore[operator]
        outcomes.append(Outcome("completed", readings={"y": Amount(value, "N")}, lines=(line,)))
    return StudyResults(study, tuple(outcomes))


def test_shares_of_the_variance_are_those_of_ishigamis_function() -> None:
    """sin a + 7 sin^2 b + 0.1 c^4 sin a over [-pi, pi]^3 (Ishigami and Homma 1990)."""
    names = ("a", "b", "c")
    factors = tuple(Factor(name, Range(-np.pi, np.pi, "", 2, logarithmic=False)) for name in names)
    results = _results(
        factors,
        "saltelli",
        4096,
        lambda a, b, c: np.sin(a) + 7 * np.sin(b) ** 2 + 0.1 * c**4 * np.sin(a),
    )
    first = 0.5 * (1 + 0.1 * np.pi**4 / 5) ** 2
    second, joint = 7**2 / 8, 0.1**2 * np.pi**8 * 8 / 225
    whole = first + second + joint
    found = variance_shares(results, results.outputs[0])
    assert found is not None
    assert found == variance_shares(results, "y")
    # the error of the sample, some count^-1/2
    known = [first / whole, second / whole, 0]
    assert [share.first_order.value for share in found.shares] == pytest.approx(known, abs=0.02)
    total = [(first + joint) / whole, second / whole, joint / whole]
    assert [share.total_order.value for share in found.shares] == pytest.approx(total, abs=0.02)
    assert [share.name for share in found.shares] == list(names)
    for share, *true in zip(found.shares, known, total, strict=True):
        for index, value in zip((share.first_order, share.total_order), true, strict=True):
            # an interval of 95 % has a width of four standard errors: at most three of them
            assert abs(index.value - value) < 0.75 * (index.high - index.low)
            assert index.low < index.value < index.high
    # a grid has no such points
    grid = _results(factors[:1], "grid", 0, np.sin)
    assert variance_shares(grid, grid.outputs[0]) is None


def _product(a: float, b: float) -> float:
    return a * (2 + b)


def test_shares_and_their_intervals_agree_with_scipy() -> None:
    factors = tuple(Factor(name, Range(0.0, 1.0, "", 2, logarithmic=False)) for name in ("a", "b"))
    results = _results(factors, "saltelli", 256, _product)
    output = results.outputs[0]
    found = variance_shares(results, output)
    assert found is not None
    one, other, *mixed = np.split(output.values - output.values[:512].mean(), 4)
    given = {"f_A": one[None], "f_B": other[None], "f_AB": np.stack(mixed)[:, None]}
    theirs = sobol_indices(func=given, n=256)
    intervals = theirs.bootstrap()
    for order in ("first_order", "total_order"):
        indices = [getattr(share, order) for share in found.shares]
        np.testing.assert_allclose(
            [index.value for index in indices], np.ravel(getattr(theirs, order)), rtol=1e-12
        )
        interval = getattr(intervals, order).confidence_interval
        # another method, and other resamples: the widths agree to some 10 %
        widths = [index.high - index.low for index in indices]
        np.testing.assert_allclose(widths, np.ravel(interval.high - interval.low), rtol=0.25)


def test_points_with_a_failed_run_are_left_out_of_the_shares() -> None:
    factors = tuple(Factor(name, Range(0.0, 1.0, "", 2, logarithmic=False)) for name in ("a", "b"))
    results = _results(factors, "saltelli", 64, _product)
    whole = variance_shares(results, results.outputs[0])
    fewer = StudyResults(results.study, (*results.outcomes[:-1], Outcome("refused")))
    found = variance_shares(fewer, fewer.outputs[0])
    assert whole is not None
    assert found is not None
    assert (whole.used_points, found.used_points, found.all_points) == (64, 63, 64)
    # one point of 64 has a share of the order of 1/64
    assert found.shares[0].first_order.value == pytest.approx(whole.shares[0].first_order.value, abs=0.05)
    none = StudyResults(results.study, tuple(Outcome("refused") for _ in results.outcomes))
    assert variance_shares(none, output_of("y", none.outcomes)) is None


def test_the_main_effect_is_the_mean_over_the_other_factors() -> None:
    x, y = (one.ravel() for one in np.meshgrid([1.0, 2.0, 3.0], [0.0, 5.0]))
    places, means = main_effect(x, x**2 + y)
    np.testing.assert_allclose(places, [1, 2, 3])
    np.testing.assert_allclose(means, np.array([1, 4, 9]) + 2.5)
    # of many values, means of eight parts: of a line, its values at their centres, to the spacing
    fine = np.geomspace(1.0, 256.0, 8001)
    places, means = main_effect(fine, np.log2(fine), logarithmic=True)
    np.testing.assert_allclose(places, 2.0 ** np.arange(0.5, 8.0), rtol=1e-12)
    np.testing.assert_allclose(means, np.arange(0.5, 8.0), atol=1e-3)
    # a run without a value is left out
    assert main_effect(np.array([1.0, 1.0]), np.array([4.0, np.nan]))[1].tolist() == [4.0]


def test_readings_of_runs_are_in_one_unit() -> None:
    outcomes = [Outcome("completed", readings={"zone": Amount(*one)}) for one in ((2.0, "um"), (500.0, "nm"))]
    found = output_of("zone", [*outcomes, Outcome("refused")])
    assert found.heading == "zone [um]"
    np.testing.assert_array_equal(found.values, [2.0, 0.5, np.nan])


@pytest.mark.parametrize("count", [1, 2, 3])
def test_an_output_is_drawn_over_one_factor_two_or_more(count: int) -> None:
    factors = (
        Factor("a", Range(1.0, 100.0, "nm", 3, logarithmic=True)),
        Factor("b", Range(0.0, 1.0, "", 3, logarithmic=False)),
        Factor("c", Listed(("L1", "N2.1"))),
    )[:count]
    results = _results(factors, "grid", 0, lambda a, *_: a)
    figure = output_figure(results, results.outputs[0])
    axes = figure.axes[0]
    assert axes.get_xlabel() == "a [nm]"
    assert axes.get_xscale() == "log"
    assert axes.get_ylabel() == ("b" if count == 2 else "y [N]")
    if count == 3:
        assert [label.get_text() for label in figure.axes[2].get_xticklabels()] == ["L1", "N2.1"]
    assert len(curves_figure(results).axes[0].lines) == len(results.outcomes)


def test_runs_without_a_value_are_marked() -> None:
    factors = (
        Factor("a", Listed((1.0, 2.0, 3.0))),
        Factor("b", Listed((1.0, 1000.0))),
        Factor("c", Listed(("L1", "N2.1"))),
    )
    for count in (1, 2, 3):
        whole = _results(factors[:count], "grid", 0, lambda a, *_: a)
        results = StudyResults(whole.study, (Outcome("refused"), *whole.outcomes[1:]))
        figure = output_figure(results, results.outputs[0])
        for axes in figure.axes[:count] if count == 3 else figure.axes[:1]:
            marks = [line for line in axes.lines if line.get_label() == "no value"]
            assert [len(line.get_xdata()) for line in marks] == [1]  # type: ignore[arg-type]
        if count == 2:
            assert axes.get_yscale() == "log"
            cells = axes.collections[0].get_array()
            assert cells is not None
            assert np.ma.count_masked(cells) == 1  # type: ignore[no-untyped-call]


def test_factors_that_change_together_share_an_axis() -> None:
    factors = (Factor("a", Listed((1, 2)), "pair"), Factor("b", Listed((3, 4)), "pair"))
    results = _results(factors, "grid", 0, lambda a, _: a)
    assert output_figure(results, results.outputs[0]).axes[0].get_xlabel() == "a (with b)"
