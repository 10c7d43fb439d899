"""Read HDF5 files that are not trusted.

Nothing outside of the file is read, and no data set takes more memory than it has bytes in the file.
"""

from math import prod
from typing import Any

import h5py
import numpy as np

from isopeel.common.arrays import FloatArray, IntArray

_MOST_IN_AN_ATTRIBUTE = 100_000  # values


class UntrustedError(ValueError):
    """The content of a file contradicts its format."""


def group(parent: h5py.Group, name: str) -> h5py.Group:
    """Return a group inside another one; raises UntrustedError if it is a link or not a group."""
    return _inside(parent, name, h5py.Group)


def text(parent: h5py.Group, name: str) -> str:
    """Return a text."""
    data = _inside(parent, name, h5py.Dataset)
    if h5py.check_string_dtype(data.dtype) is None or data.shape != ():
        raise UntrustedError(f"{data.name} is no text")
    return str(data.asstr()[()])


def floats(parent: h5py.Group, name: str, dimensions: int | None = None) -> FloatArray:
    """Return numbers of double precision, with so many dimensions, or with any number of them if None."""
    return np.asarray(_array(parent, name, dimensions, "<f8"), dtype=np.float64)


def whole_numbers(parent: h5py.Group, name: str, dimensions: int) -> IntArray:
    """Return whole numbers of 64 bits."""
    return np.asarray(_array(parent, name, dimensions, "<i8"), dtype=np.int64)


def attribute(of: h5py.Group | h5py.Dataset, name: str) -> Any:
    """Return a number, a text or an array of numbers."""
    if name not in of.attrs:
        raise UntrustedError(f"{of.name} has no {name}")
    stored = of.attrs.get_id(name)
    if prod(stored.shape or ()) > _MOST_IN_AN_ATTRIBUTE:
        raise UntrustedError(f"{name} of {of.name} is too large")
    value = of.attrs[name]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, np.ndarray) and value.dtype.kind not in "fi":
        raise UntrustedError(f"{name} of {of.name} is neither numbers nor a text")
    if not isinstance(value, str | bool | int | float | np.ndarray):
        raise UntrustedError(f"{name} of {of.name} is neither numbers nor a text")
    return value


def number(of: h5py.Group | h5py.Dataset, name: str) -> float:
    """Return an attribute that is one number."""
    value = attribute(of, name)
    if not isinstance(value, int | float):
        raise UntrustedError(f"{name} of {of.name} is no number")
    return value


def words(of: h5py.Group | h5py.Dataset, name: str) -> str:
    """Return an attribute that is a text."""
    value = attribute(of, name)
    if not isinstance(value, str):
        raise UntrustedError(f"{name} of {of.name} is no text")
    return value


def _inside(parent: h5py.Group, name: str, kind: type) -> Any:
    # links, for example to other files, are not followed, nor are paths through them
    if "/" in name or not isinstance(parent.get(name, getlink=True), h5py.HardLink):
        raise UntrustedError(f"it has no {parent.name.rstrip('/')}/{name}")
    found = parent[name]
    if not isinstance(found, kind):
        raise UntrustedError(f"{found.name} is no {kind.__name__.lower()}")
    return found


def _array(parent: h5py.Group, name: str, dimensions: int | None, dtype: str) -> Any:
    data = _inside(parent, name, h5py.Dataset)
    if data.dtype != np.dtype(dtype) or dimensions not in (None, data.ndim):
        expected = "" if dimensions is None else f" of {dimensions} dimensions"
        raise UntrustedError(f"{data.name} is no array{expected} of {np.dtype(dtype).name}")
    # the numbers must be contiguous in the file: packed ones could unpack to more than the memory
    plain = data.chunks is None and not data.is_virtual and not data.external
    if not plain or data.id.get_storage_size() != data.nbytes:
        raise UntrustedError(f"{data.name} does not hold its numbers")
    return data[()]
