"""Values of factors, and the points of designs."""

import numpy as np
import pytest
from scipy.stats import qmc

from isopeel.study.design import points_of
from isopeel.study.factors import Factor, Listed, Range, Scale

ANGLE = Factor("drive.angle", Listed(("60 deg", "1.5 rad")))
HEIGHT = Factor("body.height", Range(1.0, 100.0, "nm", 3, logarithmic=True))
RATIO = Factor("material.poissons_ratio", Range(0.1, 0.4, "", 4, logarithmic=False))
SPACE = Factor("discretization.space", Listed(("L1", "N2.1")))


def test_values_are_those_that_a_case_file_would_have() -> None:
    assert HEIGHT.values.values == ("1.0 nm", "10.0 nm", "100.0 nm")
    assert RATIO.values.values == (0.1, 0.2, 0.3, 0.4)
    assert ANGLE.heading == "drive.angle [deg]"
    assert ANGLE.scale.number("1.5 rad") == pytest.approx(np.degrees(1.5), rel=1e-15)
    assert SPACE.scale == Scale(None)
    assert SPACE.heading == "discretization.space"
    assert RATIO.scale.number(0.25) == 0.25
    # quantities of two dimensions are names
    assert Scale.of(("1 nm", "2 Pa")) == Scale(None)
    assert Scale.of((True, False)) == Scale(None)


def test_a_grid_has_all_combinations_and_zipped_factors_one_row() -> None:
    points = points_of([ANGLE, HEIGHT], "grid", 0, 0)
    assert len(points) == 6
    assert points[1] == {"drive.angle": "60 deg", "body.height": "10.0 nm"}
    together = [Factor("a", Listed((1, 2)), "pair"), HEIGHT, Factor("b", Listed((3, 4)), "pair")]
    points = points_of(together, "grid", 0, 0)
    assert len(points) == 6
    assert all(point["b"] == point["a"] + 2 for point in points)  # type: ignore[operator]


def test_samples_are_those_of_scipy() -> None:
    cube = qmc.LatinHypercube(2, rng=7).random(5)
    points = points_of([HEIGHT, RATIO], "latin-hypercube", 5, 7)
    heights = [HEIGHT.scale.number(point["body.height"]) for point in points]
    np.testing.assert_allclose(np.array(heights, np.float64), 100.0 ** cube[:, 0], rtol=1e-11)
    ratios = [RATIO.scale.number(point["material.poissons_ratio"]) for point in points]
    np.testing.assert_allclose(np.array(ratios, np.float64), 0.1 + 0.3 * cube[:, 1], rtol=1e-11)
    # each value of a list has its part of the sample
    names = [point["discretization.space"] for point in points_of([SPACE], "sobol", 8, 1)]
    assert names.count("L1") == 4


def test_saltellis_points_change_one_coordinate() -> None:
    points = points_of([HEIGHT, RATIO], "saltelli", 4, 3)
    assert len(points) == 4 * (2 + 2)
    one, other, height, ratio = (points[4 * k : 4 * k + 4] for k in range(4))
    for a, b, h, r in zip(one, other, height, ratio, strict=True):
        assert h == {**a, "body.height": b["body.height"]}
        assert r == {**a, "material.poissons_ratio": b["material.poissons_ratio"]}
