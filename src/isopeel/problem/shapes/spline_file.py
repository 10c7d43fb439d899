"""Reads one surface from a file in splinepy's JSON format; the content of the file is not trusted."""

import base64
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from isopeel.splines.nurbs import NurbsSurface
from isopeel.splines.space import HIGHEST_DEGREE, SplineSpace

LARGEST_FILE = 20_000_000  # bytes
MOST_POINTS = 100_000
LARGEST_COORDINATE = 1e12  # products of several coordinates stay finite

#: The keys that each type of spline has besides degrees and control points.
PARTS = {
    "NURBS": {"knot_vectors", "weights"},
    "BSpline": {"knot_vectors"},
    "RationalBezier": {"weights"},
    "Bezier": set(),
}


def _numbers(encoded: str) -> list[float]:
    """Decode numbers of double precision from base64."""
    numbers: list[float] = np.frombuffer(base64.b64decode(encoded, validate=True), dtype="<f8").tolist()
    return numbers


def _decoded_points(written: object) -> object:
    """Make encoded coordinates a list of points."""
    if not isinstance(written, str):
        return written
    numbers = _numbers(written)
    return [list(pair) for pair in zip(numbers[::2], numbers[1::2], strict=True)]


def _decoded_weights(written: object) -> object:
    """Return weights as one list, from their encoded form or from a list of lists of one weight each."""
    if isinstance(written, str):
        return _numbers(written)
    if isinstance(written, list) and all(isinstance(row, list) and len(row) == 1 for row in written):
        return [row[0] for row in written]
    return written


_Degree = Annotated[int, Field(ge=1, le=HIGHEST_DEGREE)]
_Coordinate = Annotated[float, Field(ge=-LARGEST_COORDINATE, le=LARGEST_COORDINATE)]
_Point = Annotated[list[_Coordinate], Field(min_length=2, max_length=2)]


class _Part(BaseModel):
    model_config = ConfigDict(strict=True, allow_inf_nan=False)


class _Spline(_Part):
    """The keys of a spline, with their names in the file; each description states the allowed values."""

    SplineType: Literal["NURBS", "BSpline", "RationalBezier", "Bezier"] = Field(
        description=f"it must be one of {', '.join(PARTS)}"
    )
    para_dim: Literal[2] = Field(description="it must be 2, for a surface")
    dim: Literal[2] = Field(description="it must be 2, for a shape in the plane")
    degrees: tuple[_Degree, _Degree] = Field(
        description=f"two whole numbers from 1 to {HIGHEST_DEGREE} are needed"
    )
    knot_vectors: tuple[list[float], list[float]] | None = Field(
        default=None, description="two lists of finite numbers are needed"
    )
    control_points: Annotated[list[_Point], BeforeValidator(_decoded_points)] = Field(
        description=f"pairs of finite numbers are needed, of magnitude {LARGEST_COORDINATE:g} at most, as "
        "lists or as base64 of 8 bytes each"
    )
    weights: Annotated[list[float], BeforeValidator(_decoded_weights)] | None = Field(
        default=None, description="finite numbers are needed, as a list or as base64 of 8 bytes each"
    )


class _File(_Part):
    SplineList: list[_Spline] = Field(
        description="a list with exactly one spline is needed", min_length=1, max_length=1
    )


def read_surface(path: Path) -> NurbsSurface:
    """Return the one surface of a file, over the unit square. Raises ValueError with the reason."""
    spline = _read(path)
    for part in ("knot_vectors", "weights"):
        needed = part in PARTS[spline.SplineType]
        if needed != (getattr(spline, part) is not None):
            raise ValueError(f"in the file, a {spline.SplineType} {'needs' if needed else 'has no'} {part}")
    knots = spline.knot_vectors or tuple([0.0] * (p + 1) + [1.0] * (p + 1) for p in spline.degrees)
    along, across = map(_on_unit_interval, spline.degrees, knots)
    sizes, count = (along.size, across.size), len(spline.control_points)
    if count != sizes[0] * sizes[1] or count > MOST_POINTS:
        limit = f"; at most {MOST_POINTS} can be read" if count > MOST_POINTS else ""
        raise ValueError(
            f"its degrees and knots need {sizes[0]} x {sizes[1]} control points, not {count}{limit}"
        )
    weights = [1.0] * count if spline.weights is None else spline.weights
    if len(weights) != count:
        raise ValueError(f"it has {len(weights)} weights for {count} control points")
    points = np.array(spline.control_points).reshape(*sizes[::-1], 2).swapaxes(0, 1)
    return NurbsSurface((along, across), points, np.array(weights).reshape(sizes[::-1]).T)


def _read(path: Path) -> _Spline:
    """Return the one spline of a file, after a check of each key."""
    try:
        if not path.is_file():
            raise ValueError("there is no such file")
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except OSError as error:
        raise ValueError(f"it cannot be read: {error.strerror}") from error
    if len(content) > LARGEST_FILE:
        raise ValueError(f"it has more than {LARGEST_FILE // 10**6} MB")
    try:
        return _File.model_validate_json(content).SplineList[0]
    except ValidationError as error:
        raise ValueError(_first(error)) from error


def _first(error: ValidationError) -> str:
    """Return the place of pydantic's first error in the file, and what is needed there."""
    details = error.errors(include_url=False, include_input=False)[0]
    match details["loc"]:
        case ():
            return f"it is not a JSON file of splines: {details['msg']}"
        case ("SplineList", int(), str(key), *_):
            needed = _Spline.model_fields[key].description
        case _:
            key, needed = "SplineList", _File.model_fields["SplineList"].description
    return f"in the file, {key}{' is missing' if details['type'] == 'missing' else ''}: {needed}"


def _on_unit_interval(degree: int, knots: list[float]) -> SplineSpace:
    written = SplineSpace(degree, np.array(knots)).knot_vector
    with np.errstate(all="ignore"):  # numbers that become infinite are refused below
        return SplineSpace(degree, (written - written[0]) / (written[-1] - written[0]))
