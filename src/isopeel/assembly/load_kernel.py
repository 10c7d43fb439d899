"""Compiled: forces of a load on the coefficients, and how they turn with the body."""

from typing import NamedTuple

import numpy as np

from isopeel.assembly.loops import Energies
from isopeel.assembly.packing import Floats2, Floats5, Integers1, Integers2, Integers3, reader
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import inner
from isopeel.matrix.band import entry_place


class LoadData(NamedTuple):
    """The data of the loops over a load; the arrays are those of `LoadTerm`."""

    size: float  # of a load that is held; of a load of the drive, its factor on the size of that
    of_drive: bool
    functions: Integers1  # (n,)
    pattern: Floats2  # (n, 2)
    elements: Integers2  # (E, m)
    blocks: Floats5  # (E, m, 2, m, 2)
    unknowns: Integers3  # (E, m, 2)


read_load = reader(LoadData)


def add_load(
    integers: IntArray,
    floats: FloatArray,
    _history: FloatArray,
    scalars: FloatArray,
    u: FloatArray,
    forces: FloatArray,
    band: FloatArray,
    diagonal: int,
    with_tangent: bool,
) -> Energies:
    """Subtract the forces of a load from those on the coefficients, see `isopeel.assembly.loops`."""
    load: LoadData = read_load(integers, floats)
    size = load.size * scalars[0] if load.of_drive else load.size
    _subtract(load, size, u, forces)
    if with_tangent:
        _subtract_stiffness(load, size, band, diagonal)
    return 0.0, 0.0, 0.0, np.inf


# products are rounded before they are subtracted: so a load that has been balanced leaves nothing
@inner
def _subtract(load: LoadData, size: float, u: FloatArray, forces: FloatArray) -> None:
    for n in range(len(load.functions)):
        for i in range(2):
            forces[load.functions[n], i] -= size * load.pattern[n, i]
    for e in range(len(load.elements)):
        count = load.elements.shape[1]
        for a in range(count):
            for i in range(2):
                total = 0.0
                for b in range(count):
                    for k in range(2):
                        total += load.blocks[e, a, i, b, k] * u[load.elements[e, b], k]
                forces[load.elements[e, a], i] -= size * total


@inner
def _subtract_stiffness(load: LoadData, size: float, band: FloatArray, diagonal: int) -> None:
    flat, stride = band.ravel(), band.shape[1] - 1
    for e in range(len(load.elements)):
        count = load.elements.shape[1]
        for a in range(count):
            for i in range(2):
                row = load.unknowns[e, a, i]
                for b in range(count):
                    for k in range(2):
                        column = load.unknowns[e, b, k]
                        # entries above the diagonal have no place in a symmetric matrix
                        if row >= 0 and column >= 0 and (diagonal > 0 or row >= column):
                            place = entry_place(stride, diagonal, row, column)
                            flat[place] -= size * load.blocks[e, a, i, b, k]
