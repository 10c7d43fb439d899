"""The displacement space of a body in run.h5, for programs that know HDF5 and splines, but not isopeel."""

import h5py
import numpy as np

from isopeel.results.schema import write_described
from isopeel.splines.nurbs import NurbsSurface
from isopeel.splines.rows import RowSpace


def write_space(file: h5py.File, name: str, space: RowSpace, shape: NurbsSurface) -> None:
    """Write the group `spaces/NAME`.

    The functions of row j, numbered from `first_function[j]` on, are B-splines of the knots `rows/j` along
    the body (attribute `degree`) times function j of the knots `across`. If there are `weights`
    (functions,), each function is multiplied by its weight and divided by the sum of all.
    `control_points` (functions, 2) describe the undeformed body.
    """
    group = file.create_group(f"spaces/{name}")
    group.attrs["name"] = space.name
    weighted = space.weighted(shape)
    across: dict[str, str | float] = {
        "unit": "1",
        "description": "knots across the body",
        "degree": space.across.degree,
    }
    write_described(group, "across", space.across.knot_vector, **across)
    first = {"unit": "1", "description": "number of the first function of each row, and of all functions"}
    write_described(group, "first_function", space.offsets, **first)
    for number, row in enumerate(space.rows):
        along: dict[str, str | float] = {
            "unit": "1",
            "description": "knots along the body",
            "degree": row.degree,
        }
        write_described(group, f"rows/{number}", row.knot_vector, **along)
    if weighted.weights is not None:
        weights = {"unit": "1", "description": "weights of the functions"}
        write_described(group, "weights", np.concatenate(weighted.weights), **weights)
    points = {"unit": "L0", "description": "control points of the body as it is"}
    write_described(group, "control_points", weighted.interpolate(shape.evaluate), **points)
