"""The script gets the numbers that were packed, to the requested resolution."""

from base64 import b64decode

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isopeel.common.arrays import FloatArray
from isopeel.html_report.packing import packed, packed_positions, packed_stress


def unpacked(text: str, dtype: str) -> FloatArray:
    return np.frombuffer(b64decode(text), f"<{dtype}").astype(np.float64)


@given(
    st.integers(1, 6),
    st.integers(1, 4),
    st.floats(1e-6, 1e6),
    st.floats(1e-9, 1e3),
    st.integers(0, 2**32 - 1),
)
def test_positions_are_kept_to_half_their_unit(
    columns: int, rows: int, extent: float, resolution: float, seed: int
) -> None:
    positions = extent * np.random.default_rng(seed).uniform(-1, 1, (columns, rows, 2))
    found = packed_positions(positions, resolution)
    differences = unpacked(found["differences"], "i2").reshape(columns - 1, rows, 2)
    first = unpacked(found["first"], "i4").reshape(1, rows, 2)
    again = found["unit"] * np.cumsum(np.concatenate([first, differences]), axis=0)
    # half a unit, and the round-off of the products
    assert np.abs(again - positions).max() <= 0.5 * found["unit"] + 1e-12 * extent
    # the largest difference takes at most 32766 units, the largest start 2^31
    assert found["unit"] <= max(resolution, 2 * extent / 32766, extent / (2**31 - 1))


def test_a_stress_is_one_of_255_levels_or_blank() -> None:
    values = np.array([-0.2, -0.1, 0.0, 0.05, 0.1, np.nan])
    assert list(b64decode(packed_stress(values, 0.1))) == [0, 0, 127, 190, 254, 255]


@pytest.mark.parametrize(("dtype", "size"), [("f8", 8), ("f4", 4), ("i4", 4), ("u1", 1)])
def test_numbers_take_the_bytes_of_their_type(dtype: str, size: int) -> None:
    text = packed(np.arange(5), dtype)
    assert len(b64decode(text)) == 5 * size
    assert unpacked(text, dtype).tolist() == [0, 1, 2, 3, 4]
