"""Patches whose map is singular, or nearly: one line with the reason, before the first step."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from isopeel.common.errors import InputError
from isopeel.problem.shapes.half_cylinder import HalfCylinder
from isopeel.problem.shapes.patch import Patch

SQUARE = [[0, 0], [10, 0], [0, 1], [10, 1]]


def patch_of(folder: Path, points: list[Any], **keys: object) -> Patch:
    """The patch of a file; bilinear and without weights where nothing else is said."""
    weights = "weights" in keys
    spline = {
        "SplineType": "RationalBezier" if weights else "Bezier",
        "para_dim": 2,
        "dim": 2,
        "degrees": [1, 1],
        "control_points": points,
        **keys,
    }
    file = folder / "patch.json"
    file.write_text(json.dumps({"SplineList": [spline]}))
    return Patch(file, 1.0)


@pytest.mark.parametrize("weight", [1e-300, 1e-30, 1e-7, 1e9, 5e-324])
def test_weights_are_of_one_size(weight: float, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"body\.file: .*weights differ by a factor of .* 1e\+06 is allowed"):
        patch_of(tmp_path, SQUARE, weights=[1, weight, 1, 1])


@pytest.mark.parametrize("weight", [0, -1, -1e-300])
def test_weights_are_positive(weight: float, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"body\.file: .*weights must be positive and finite"):
        patch_of(tmp_path, SQUARE, weights=[1, weight, 1, 1])


@pytest.mark.parametrize(
    ("points", "side"),
    [
        ([[0, 0], [10, 0], [0, 0], [10, 1]], "left"),
        ([[0, 0], [10, 0], [0, 1], [10, 0]], "right"),
        ([[5, 0], [5, 0], [0, 1], [10, 1]], "bottom"),
        ([[0, 0], [10, 0], [5, 1], [5, 1]], "top"),
        ([[0, 0], [10, 0], [0, 1], [10, 1e-12]], "right"),
    ],
)
def test_no_side_is_a_point(points: list[Any], side: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=rf"body\.file: .*the side {side} has no length"):
        patch_of(tmp_path, points)


BIQUADRATIC = [[x, y] for y in (0, 0.5, 1) for x in (0, 5, 10)]


@pytest.mark.parametrize(
    "moved",
    [
        {3: [0, 0], 4: [5, 0], 5: [10, 0]},  # two rows of control points coincide
        {1: [0, 0], 4: [0, 0.5], 7: [0, 1]},  # two columns
        {4: [5, 0], 3: [0, 0], 5: [10, 1e-12]},  # nearly
    ],
)
def test_control_points_that_coincide_make_no_map(moved: dict[int, list[float]], tmp_path: Path) -> None:
    points = [moved.get(k, point) for k, point in enumerate(BIQUADRATIC)]
    with pytest.raises(InputError, match=r"body\.file: .*(is singular|must not fold|has no length)"):
        patch_of(tmp_path, points, degrees=[2, 2])


@pytest.mark.parametrize(
    "points",
    [
        [[0, 0], [10, 0], [10, 1], [0, 1]],  # a bow tie
        [[0, 0], [10, 0], [0, 1], [3, -1]],  # a corner inside out
        [[10, 0], [0, 0], [10, 1], [0, 1]],  # the wrong way round
    ],
)
def test_a_patch_does_not_fold(points: list[Any], tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"body\.file: .*(must not fold|Jacobian is negative)"):
        patch_of(tmp_path, points)


def test_a_fold_that_is_small_is_found(tmp_path: Path) -> None:
    """Where dx/dxi = (1 - xi)^2 - 2.002 xi (1 - xi) + xi^2 is negative: 0.5 -/+ 0.011, between all points."""
    points = [[x, y] for y in (0, 1) for x in (0, 1, -0.001, 0.999)]
    with pytest.raises(InputError, match=r"body\.file: .*must not fold, as it does at xi = 0\.5"):
        patch_of(tmp_path, points, degrees=[3, 1])


@pytest.mark.parametrize("size", [1e-250, 1e-26])
def test_a_patch_is_of_the_size_of_a_body(size: float, tmp_path: Path) -> None:
    points = (np.array(SQUARE) * size).tolist()
    with pytest.raises(InputError, match=r"body\.file: .*it must lie between"):
        patch_of(tmp_path, points)


def test_what_is_only_unusual_is_a_patch(tmp_path: Path) -> None:
    """Weights of an arc of nearly a half turn, a corner without an angle, and a graded map."""
    assert patch_of(tmp_path, SQUARE, weights=[1, 0.01, 1, 1]).surface().area() > 0
    disc = HalfCylinder(10.0).surface()
    points = disc.control_points.swapaxes(0, 1).reshape(-1, 2).tolist()
    weights = disc.weights.T.ravel().tolist()
    half = patch_of(tmp_path, points, degrees=[2, 2], weights=weights)
    assert half.surface().area() == pytest.approx(disc.area(), rel=1e-12)
    graded = [[x, y] for y in (0, 1) for x in (0, 1e-3, 10)]
    assert patch_of(tmp_path, graded, degrees=[2, 1]).surface().area() == pytest.approx(10, rel=1e-12)
