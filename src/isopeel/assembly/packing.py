"""The data of a term as one array of integers and one of floats: so loops of all terms have one signature.

A `NamedTuple` declares the data of loops once: arrays of given dimensions, and single numbers. `packed`
returns the two arrays; `reader` returns the function by which compiled loops restore the tuple, with views as
arrays.
"""

from typing import Annotated, Any, NamedTuple, TypeAlias, get_args, get_type_hints

import numpy as np

from isopeel.common.arrays import BoolArray, FloatArray, IntArray
from isopeel.common.compilation import inner_of_text

Integers1: TypeAlias = Annotated[IntArray, 1]
Integers2: TypeAlias = Annotated[IntArray, 2]
Integers3: TypeAlias = Annotated[IntArray, 3]
Integers4: TypeAlias = Annotated[IntArray, 4]
Floats1: TypeAlias = Annotated[FloatArray, 1]
Floats2: TypeAlias = Annotated[FloatArray, 2]
Floats3: TypeAlias = Annotated[FloatArray, 3]
Floats4: TypeAlias = Annotated[FloatArray, 4]
Floats5: TypeAlias = Annotated[FloatArray, 5]
#: Yes or no; in loops an integer.
Flags2: TypeAlias = Annotated[BoolArray, 2]

#: Arrays begin at multiples of this number of items, so that they share no cache line.
_LINE = 8


class Packed(NamedTuple):
    """Data of a term; the first integers are the place of each field and the shapes of arrays."""

    integers: IntArray
    floats: FloatArray


def packed(data: Any) -> Packed:
    """Return the packed data of a `NamedTuple` of arrays and numbers."""
    fields = _fields(type(data))
    header: list[int] = []
    parts: dict[bool, list[Any]] = {False: [], True: []}
    ends = {False: _rounded(sum(1 + dimensions for _, dimensions in fields.values())), True: 0}
    start = ends[False]
    for (is_float, dimensions), value in zip(fields.values(), data, strict=True):
        array = np.asarray(value, dtype=np.float64 if is_float else np.int64)
        if array.ndim != dimensions:
            raise TypeError(f"{type(data).__name__}: an array of {array.ndim} dimensions, not {dimensions}")
        header += [ends[is_float], *array.shape]
        parts[is_float].append((ends[is_float], array.ravel()))
        ends[is_float] += _rounded(array.size)
    integers, floats = np.zeros(ends[False], dtype=np.int64), np.zeros(ends[True])
    integers[: len(header)] = header
    assert len(header) <= start
    for whole, filled in ((integers, parts[False]), (floats, parts[True])):
        for begin, flat in filled:
            whole[begin : begin + flat.size] = flat
    integers.setflags(write=False)
    return Packed(integers, floats)


def reader(kind: type) -> Any:
    """Return a compiled function that returns the `NamedTuple` of given integers and floats.

    Numba cannot compile a loop over fields of several types. So its source is written here, with one
    expression for each field.

    Each kind has a name of its own. Cached loops contain the readers that they call, as symbols of a name, a
    number that counts the functions of a process, and the types of the arguments. With one name for all, two
    processes could compile different readers with the same symbol, and a third one, which loaded the loops of
    both, called one reader for both.
    """
    views, place = [], 0
    for is_float, dimensions in _fields(kind).values():
        whole = "floats" if is_float else "integers"
        begin = f"integers[{place}]"
        shape = [f"integers[{place + 1 + d}]" for d in range(dimensions)]
        if dimensions:
            flat = f"{whole}[{begin} : {begin} + {' * '.join(shape)}]"
            views.append(flat if dimensions == 1 else f"{flat}.reshape(({', '.join(shape)}))")
        else:
            views.append(f"{whole}[{begin}]")
        place += 1 + dimensions
    name = f"read_{kind.__name__}"
    source = f"def {name}(integers, floats):\n    return Kind({', '.join(views)})\n"
    names: dict[str, Any] = {"Kind": kind, "__name__": kind.__module__}
    exec(source, names)
    return inner_of_text(names[name])


def _fields(kind: type) -> dict[str, tuple[bool, int]]:
    """Return whether a field has floats, and the number of dimensions of its array, zero for a number."""
    found = {}
    for name, hint in get_type_hints(kind, include_extras=True).items():
        if hint in (int, bool, float):
            found[name] = hint is float, 0
        else:
            array, dimensions = get_args(hint)
            found[name] = array == FloatArray, dimensions
    return found


def _rounded(size: int) -> int:
    return -(-size // _LINE) * _LINE
