"""Pack arrays as short texts for a script: numbers of few bytes, in base64."""

from base64 import b64encode
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from isopeel.common.arrays import FloatArray

_LARGEST_DIFFERENCE = 32_767
_LARGEST_START = 2**31 - 1
#: The byte of an undefined stress; other stresses are 0 to 254, and 127 is zero.
_BLANK = 255


def packed(values: ArrayLike, dtype: str) -> str:
    """Return numbers in the order of their array, as little-endian numbers of a type such as "f4"."""
    return b64encode(np.asarray(values).astype(f"<{dtype}").tobytes()).decode("ascii")


def packed_positions(positions: FloatArray, resolution: float) -> dict[str, Any]:
    """Return points (m, k, 2) of m columns: the first column, and the differences between columns.

    They are whole multiples of a unit: the resolution, or more if the differences require it. Each point is
    exact to half of this unit, because differences of rounded numbers add up without an error.
    """
    differences = np.abs(np.diff(positions, axis=0)).max(initial=0.0)
    unit = max(
        resolution,
        # rounding may add one
        float(differences) / (_LARGEST_DIFFERENCE - 1),
        float(np.abs(positions[0]).max()) / _LARGEST_START,
    )
    rounded = np.rint(positions / unit).astype(np.int64)
    return {
        "unit": unit,
        "first": packed(rounded[0], "i4"),
        "differences": packed(np.diff(rounded, axis=0), "i2"),
    }


def packed_stress(values: FloatArray, scale: float) -> str:
    """Return values from -scale to scale as one byte each, the resolution of the colours."""
    levels = np.rint((np.clip(values / scale, -1, 1) + 1) * 127)
    return packed(np.where(np.isnan(values), _BLANK, levels), "u1")
