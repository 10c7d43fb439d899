"""Patches from files that splinepy writes, from a hand-written one, and from broken ones."""

import base64
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import splinepy

from isopeel.common.errors import InputError
from isopeel.problem.shapes import HalfCylinder, Patch, Shape
from isopeel.splines.nurbs import annulus_sector
from isopeel.splines.rows import row_space

# A quarter ring of radii 1 and 2, clockwise from the y axis, and a polynomial patch of the same points.
RING = [[0, 1], [1, 1], [1, 0], [0, 2], [2, 2], [2, 0]]
WEIGHTS = [1, np.sqrt(0.5), 1] * 2


def bspline() -> splinepy.BSpline:
    """A wavy strip, cubic along xi with an uneven and a double knot, quadratic along eta."""
    knots = [[0, 0, 0, 0, 1, 2.5, 2.5, 4, 4, 4, 4], [-1, -1, -1, 1, 1, 1]]
    x, y = np.meshgrid(np.linspace(0, 10, 7), [0, 1, 3])
    return splinepy.BSpline([3, 2], knots, np.stack([x, y + 0.2 * np.sin(x)], axis=-1).reshape(-1, 2))


def nurbs() -> splinepy.NURBS:
    plain = bspline()
    weights = np.random.default_rng(5).uniform(0.7, 1.4, (21, 1))
    return splinepy.NURBS(plain.degrees, plain.knot_vectors, plain.control_points, weights)


SPLINES: dict[str, Callable[[], splinepy.Spline]] = {
    "BSpline": bspline,
    "NURBS": nurbs,
    "Bezier": lambda: splinepy.Bezier([2, 1], RING),
    "RationalBezier": lambda: splinepy.RationalBezier([2, 1], RING, WEIGHTS),
}


@pytest.mark.parametrize("encoded", [False, True])
@pytest.mark.parametrize("kind", SPLINES)
def test_files_of_splinepy_evaluate_as_splinepy_does(kind: str, encoded: bool, tmp_path: Path) -> None:
    drawn = SPLINES[kind]()
    splinepy.io.json.export(str(tmp_path / "drawn.json"), drawn, base64encoding=encoded)
    shape: Shape = Patch(tmp_path / "drawn.json", unit_length=2.5)
    surface = shape.surface()
    places = np.random.default_rng(1).uniform(size=(60, 2))
    bounds = drawn.parametric_bounds
    expected = 2.5 * drawn.evaluate(bounds[0] + places * (bounds[1] - bounds[0]))
    # coordinates up to 25, and parameters that go through one more rounding
    assert np.abs(surface.evaluate(*places.T) - expected).max() < 1e-14 * 25 * 3
    start, end = shape.adhering_part(1.0)
    assert start == 0
    assert surface.boundary("bottom").length(end) == pytest.approx(1.0, rel=1e-13)


def test_a_shape_comes_back_from_its_file(tmp_path: Path) -> None:
    sector = annulus_sector(1.0, 2.0, np.pi / 2)
    peer = splinepy.NURBS(
        [2, 1],
        [space.knot_vector for space in sector.spaces],
        sector.control_points.swapaxes(0, 1).reshape(-1, 2),
        sector.weights.T.reshape(-1, 1),
    )
    for encoded in (False, True):
        splinepy.io.json.export(str(tmp_path / "sector.json"), peer, base64encoding=encoded)
        surface = Patch(tmp_path / "sector.json").surface()
        # splinepy keeps products with the weights: one rounding there, one back
        assert np.abs(surface.control_points - sector.control_points).max() < 1e-15
        assert np.array_equal(surface.weights, sector.weights)
        assert surface.area() == pytest.approx(np.pi / 4 * 3, rel=1e-13)


def document(**changes: Any) -> dict[str, Any]:
    """A strip of 10 x 3 whose right half rises, written by hand; None removes a key."""
    spline = {
        "SplineType": "NURBS",
        "para_dim": 2,
        "dim": 2,
        "degrees": [2, 1],
        "knot_vectors": [[0, 0, 0, 1, 1, 1], [0, 0, 1, 1]],
        "control_points": [[0, 0], [5, 0], [10, 2], [0, 3], [5, 3], [10, 5]],
        "weights": [1, 1, 1, 1, 1, 1],
    }
    spline.update(changes)
    return {"SplineList": [{key: value for key, value in spline.items() if value is not None}]}


def write(path: Path, content: object) -> Path:
    file = path / "patch.json"
    file.write_text(content if isinstance(content, str) else json.dumps(content))
    return file


def test_a_hand_written_file(tmp_path: Path) -> None:
    file = write(tmp_path, document())
    surface = Patch(file).surface()
    # x = 10 xi, y = 2 xi^2 + 3 eta
    xi, eta = np.linspace(0, 1, 7)[:, None], np.linspace(0, 1, 4)
    x, y = np.moveaxis(surface.evaluate(xi, eta), -1, 0)
    assert np.abs(x - 10 * xi).max() < 1e-14
    assert np.abs(y - 2 * xi**2 - 3 * eta).max() < 1e-14
    assert surface.area() == pytest.approx(30, rel=1e-13)
    # a text of a path does as well, and the file is not needed any more
    shape = Patch(str(file))  # type: ignore[arg-type]
    file.unlink()
    assert shape.surface().area() == pytest.approx(30, rel=1e-13)
    assert shape.file == file


def test_weights_of_any_size_make_the_same_shape(tmp_path: Path) -> None:
    for size in (1e-150, 1e300):
        surface = Patch(write(tmp_path, document(weights=[size] * 6)), unit_length=1e12).surface()
        assert surface.area() == pytest.approx(30e24, rel=1e-13)


def test_rotations_are_exact_on_meshes_that_hold_the_knots_of_the_file(tmp_path: Path) -> None:
    drawn = nurbs()
    knots = [[0] * 4 + [1, 2, 3] + [4] * 4, [0, 0, 0, 1, 1, 1]]
    drawn = splinepy.NURBS([3, 2], knots, drawn.control_points, drawn.weights)
    splinepy.io.json.export(str(tmp_path / "drawn.json"), drawn)
    surface = Patch(tmp_path / "drawn.json").surface()
    xi = np.random.default_rng(2).uniform(size=50)

    def error(elements: int) -> float:
        space = row_space("N3", (elements, 2), across_degree=2).weighted(surface)
        turned = space.interpolate(lambda xi, eta: surface.evaluate(xi, eta) @ [[-1.0, 1.0], [-1.0, -1.0]])
        basis = space.basis(xi, np.full(50, 0.3), 0)
        field = np.einsum("nm,nmc->nc", basis.values, turned[basis.functions])
        return float(np.abs(field - surface.evaluate(xi, 0.3) @ [[-1.0, 1.0], [-1.0, -1.0]]).max())

    # coordinates of 10, through the interpolation of numerator and weight; other meshes miss the knots
    assert error(4) < 1e-12
    assert error(8) < 1e-12
    assert error(6) > 1e-4


BROKEN: dict[str, tuple[object, str]] = {
    "empty": ("", "not a JSON file"),
    "text": ("solid patch", "not a JSON file"),
    "cut off": (json.dumps(document())[:-9], "not a JSON file"),
    "nested": ("[" * 100_000, "not a JSON file"),
    "a list": ([1, 2], "not a JSON file of splines"),
    "no list": ({"Name": "SplineGroup"}, "SplineList is missing: a list with exactly one spline"),
    "no spline": ({"SplineList": []}, "SplineList: a list with exactly one spline"),
    "two": ({"SplineList": document()["SplineList"] * 2}, "SplineList: a list with exactly one spline"),
    "type": (document(SplineType="TSpline"), "SplineType: it must be one of NURBS, BSpline"),
    "volume": (document(para_dim=3, degrees=[1, 1, 1]), "para_dim: it must be 2, for a surface"),
    "in space": (document(dim=3), "dim: it must be 2, for a shape in the plane"),
    "no degrees": (document(degrees=None), "degrees is missing: two whole numbers"),
    "degrees": (document(degrees=[2, "1"]), "degrees: two whole numbers from 1 to 30"),
    "a true degree": (document(degrees=[2, True]), "degrees: two whole numbers from 1 to 30"),
    "high degree": (document(SplineType="Bezier", degrees=[10**12, 1]), "degrees: two whole numbers"),
    "no knots": (document(knot_vectors=None), "a NURBS needs knot_vectors"),
    "no weights": (document(weights=None), "a NURBS needs weights"),
    "more weights": (document(SplineType="BSpline"), "a BSpline has no weights"),
    "knots fall": (
        document(knot_vectors=[[0, 0, 0, 1, 1, 1], [1, 1, 0, 0]]),
        "in the file, knot_vector [1.0, 0.0]: knots must",
    ),
    "knots equal": (document(knot_vectors=[[0, 0, 0, 1, 1, 1], [1, 1, 1, 1]]), "first and last knot"),
    "no knot": (document(knot_vectors=[[], [0, 0, 1, 1]]), "at least 6 knots"),
    "open knots": (document(knot_vectors=[[0, 0, 0.1, 1, 1, 1], [0, 0, 1, 1]]), "occur 3 times"),
    "huge knots": (document(knot_vectors=[[-1e308] * 3 + [1e308] * 3, [0, 0, 1, 1]]), "knot"),
    "nan": (json.dumps(document()).replace("[0, 3]", "[NaN, 3]"), "control_points: pairs of finite numbers"),
    "inf": (document(weights=[1, 1, 1, 1, 1, "1e999"]), "weights: finite numbers"),
    "too big": (json.dumps(document()).replace("10,", "1e999,"), "control_points: pairs of finite numbers"),
    "long number": (
        json.dumps(document()).replace("10,", f"1{'0' * 400},"),
        "control_points: pairs of finite",
    ),
    "overflow": (
        document(control_points=[[-1e308, 0], [0, 0], [1e308, 0], [-1e308, 3], [0, 3], [1e308, 5]]),
        "",
    ),
    "triples": (document(control_points=[[0, 0, 0]] * 6), "control_points: pairs of finite numbers"),
    "fewer points": (document(control_points=[[0, 0]] * 5), "need 3 x 2 control points, not 5"),
    "fewer weights": (document(weights=[1] * 5), "5 weights for 6 control points"),
    "negative": (document(weights=[1, 1, 1, 1, 1, -1]), "weights must be positive"),
    "not base64": (document(control_points="no!"), "control_points: pairs of finite numbers are needed"),
    "half a number": (document(weights=base64.b64encode(b"1234").decode()), "weights: finite numbers"),
    "odd": (document(control_points=base64.b64encode(bytes(24)).decode()), "control_points: pairs of finite"),
    "folded": (document(control_points=[[0, 0], [5, 9], [10, 2], [0, 3], [5, 3], [10, 5]]), "must not fold"),
    "far away": (
        document(control_points=[[0, 0], [1e300, 0], [0, 1], [1e300, 1], [0, 2], [1e300, 2]]),
        "control_points: pairs of finite numbers are needed, of magnitude 1e+12 at most",
    ),
    "a point": (document(control_points=[[1, 1]] * 6), "must not fold"),
}


@pytest.mark.parametrize("kind", BROKEN)
def test_broken_files_are_refused_in_one_line(kind: str, tmp_path: Path) -> None:
    content, reason = BROKEN[kind]
    file = write(tmp_path, content)
    with pytest.raises(InputError) as caught:
        Patch(file)
    assert (caught.value.field, caught.value.value) == ("body.file", str(file))
    assert reason in str(caught.value)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 400


def test_mirrored_patches_are_distinguished_from_folded_ones(tmp_path: Path) -> None:
    swapped = splinepy.Bezier([1, 1], [[0, 0], [0, 1], [5, 0], [5, 1]])
    splinepy.io.json.export(str(tmp_path / "swapped.json"), swapped)
    with pytest.raises(
        InputError, match=r"negative everywhere: swap or reverse .* xi runs along the lower side"
    ):
        Patch(tmp_path / "swapped.json")


def test_corners_without_an_angle_may_be_read(tmp_path: Path) -> None:
    half = HalfCylinder(1.0).surface()
    drawn = splinepy.RationalBezier(
        [2, 2], half.control_points.swapaxes(0, 1).reshape(-1, 2), half.weights.T.reshape(-1, 1)
    )
    splinepy.io.json.export(str(tmp_path / "half.json"), drawn)
    assert Patch(tmp_path / "half.json").surface().area() == pytest.approx(np.pi / 2, rel=1e-13)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "none.json", tmp_path / "nu\0ll"):
        with pytest.raises(InputError, match=r"^body\.file: .* there is no such file"):
            Patch(path)
    with (tmp_path / "huge.json").open("wb") as file:
        file.truncate(20_000_001)
    with pytest.raises(InputError, match=r"^body\.file: .* more than 20 MB"):
        Patch(tmp_path / "huge.json")
    (tmp_path / "binary.json").write_bytes(bytes(range(256)))
    with pytest.raises(InputError, match="not a JSON file"):
        Patch(tmp_path / "binary.json")
    many = document(
        SplineType="Bezier",
        knot_vectors=None,
        weights=None,
        degrees=[1, 1],
        control_points=[[0, 0]] * 100_001,
    )
    with pytest.raises(InputError, match="at most 100000 can be read"):
        Patch(write(tmp_path, many))
    for unit in (0.0, -1.0, np.inf, np.nan):
        with pytest.raises(InputError, match=r"^body\.unit_length: .* it must be positive"):
            Patch(write(tmp_path, document()), unit_length=unit)
    with pytest.raises(InputError, match=r"^body\.file: .* finite"):
        Patch(write(tmp_path, document()), unit_length=1e308)
