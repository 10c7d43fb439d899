"""Files that ParaView and other readers of VTK open: unstructured grids (.vtu) and series of them (.pvd).

Data are appended raw, each array as one block packed by zlib (VTK File Formats, docs.vtk.org). The points
of Bezier quadrilaterals come as corners, then the inside of the edges bottom, right, top and left, along
their parameter, then the rows inside; those of curves as both ends, then the inside.
"""

import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from struct import pack
from typing import Any, NamedTuple
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from isopeel.common.arrays import FloatArray, IntArray
from isopeel.results.files import replacing

#: Numbers of VTK's kinds of cells (vtkCellType.h).
LINE, QUAD, BEZIER_CURVE, BEZIER_QUADRILATERAL = 3, 9, 75, 77

_TYPES = {"<f8": "Float64", "<i8": "Int64", "|u1": "UInt8", "|i1": "Int8"}
# the fastest level: a higher one takes three times as long and saves a tenth of the size
_PACKING = 1


@dataclass(frozen=True, eq=False)
class Grid:
    """Cells of one kind and of c points each in the plane z = 0, with data at points and in cells.

    Data are (points or cells, components): 1, 3 of a vector, 6 of a symmetric tensor (xx, yy, zz, xy, yz,
    xz) or 9 of a tensor, row by row. The data at points of a Bezier cell are control values: the rational
    functions of the cell apply to them as to its points.
    """

    kind: int
    points: FloatArray  # (n, 3)
    cells: IntArray  # (m, c) numbers of points
    point_data: Mapping[str, FloatArray]
    cell_data: Mapping[str, FloatArray]
    degrees: tuple[int, int] | None = None  # of Bezier cells
    weights: FloatArray | None = field(default=None, repr=False)  # (n,) of rational Bezier cells


def quadrilateral_order(p: int, q: int) -> IntArray:
    """Return the numbers (q + 1) i + j of the points (i, j) of a Bezier quadrilateral, in VTK's order."""
    inner_i, inner_j = range(1, p), range(1, q)
    order = [(0, 0), (p, 0), (p, q), (0, q)]
    order += [(i, 0) for i in inner_i] + [(p, j) for j in inner_j]
    order += [(i, q) for i in inner_i] + [(0, j) for j in inner_j]
    order += [(i, j) for j in inner_j for i in inner_i]
    return np.array([(q + 1) * i + j for i, j in order])


def curve_order(p: int) -> IntArray:
    """Return the numbers (p + 1,) of the points of a Bezier curve, in VTK's order."""
    return np.array([0, p, *range(1, p)])


def write_grid(path: Path, grid: Grid, time: float, notes: Mapping[str, str]) -> None:
    """Write a grid as a .vtu file, with its time and notes as field data. Raises OSError."""
    file = _File()
    count = len(grid.cells)
    attributes = "" if grid.degrees is None else ' HigherOrderDegrees="HigherOrderDegrees"'
    weighted = "" if grid.weights is None else ' RationalWeights="RationalWeights"'
    file.line("<FieldData>")
    file.array("TimeValue", np.array([time]), tuples=1)
    for name, text in notes.items():
        file.text(name, text)
    file.line("</FieldData>")
    file.line(f'<Piece NumberOfPoints="{len(grid.points)}" NumberOfCells="{count}">')
    file.line(f"<PointData{weighted}>")
    for name, values in grid.point_data.items():
        file.array(name, values)
    if grid.weights is not None:
        file.array("RationalWeights", grid.weights)
    file.line("</PointData>")
    file.line(f"<CellData{attributes}>")
    for name, values in grid.cell_data.items():
        file.array(name, values)
    if grid.degrees is not None:
        file.array("HigherOrderDegrees", np.tile(np.array([*grid.degrees, 1.0]), (count, 1)))
    file.line("</CellData>")
    file.line("<Points>")
    file.array("Points", grid.points)
    file.line("</Points>")
    file.line("<Cells>")
    file.array("connectivity", grid.cells.reshape(-1))
    file.array("offsets", grid.cells.shape[1] * np.arange(1, count + 1))
    file.array("types", np.full(count, grid.kind, dtype=np.uint8))
    file.line("</Cells>")
    file.line("</Piece>")
    with replacing(path) as part:
        part.write_bytes(file.content())


class Part(NamedTuple):
    """A file of a series: its time, and the number of the part that it is at that time."""

    file: str
    time: float
    number: int = 0


def write_series(path: Path, parts: Sequence[Part]) -> None:
    """Write a .pvd file that lists other files, relative to its folder, in their order. Raises OSError."""
    sets = "".join(
        f"<DataSet timestep={quoteattr(repr(part.time))} part={quoteattr(str(part.number))}"
        f" file={quoteattr(part.file)}/>\n"
        for part in parts
    )
    with replacing(path) as part:
        part.write_text(
            '<?xml version="1.0"?>\n<!-- isopeel -->\n'
            '<VTKFile type="Collection" version="1.0" byte_order="LittleEndian">\n'
            f"<Collection>\n{sets}</Collection>\n</VTKFile>\n",
            encoding="utf-8",
        )


class _File:
    """The text of a .vtu file and the data that are appended to it."""

    def __init__(self) -> None:
        self._lines: list[str] = []
        self._data = bytearray()

    def line(self, text: str) -> None:
        self._lines.append(text)

    def array(self, name: str, values: NDArray[Any], tuples: int | None = None) -> None:
        little = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))
        components = 1 if little.ndim == 1 else little.shape[1]
        size = f' NumberOfComponents="{components}"' if tuples is None else f' NumberOfTuples="{tuples}"'
        offset = len(self._data)
        self.line(
            f"<DataArray type={quoteattr(_TYPES[little.dtype.str])} Name={quoteattr(name)}{size}"
            f' format="appended" offset="{offset}"/>'
        )
        packed = zlib.compress(little.tobytes(), _PACKING)
        # blocks, bytes in a block, bytes in a last one that is not full, packed bytes of each
        header = (1, little.nbytes, 0, len(packed)) if little.nbytes else (0, 0, 0)
        self._data += pack(f"<{len(header)}Q", *header) + (packed if little.nbytes else b"")

    def text(self, name: str, text: str) -> None:
        codes = " ".join(str(byte) for byte in (*text.encode(), 0))
        self.line(
            f'<Array type="String" Name={quoteattr(name)} NumberOfTuples="1" format="ascii">{codes}</Array>'
        )

    def content(self) -> bytes:
        head = (
            '<?xml version="1.0"?>\n<!-- isopeel -->\n'
            '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian"'
            ' header_type="UInt64" compressor="vtkZLibDataCompressor">\n<UnstructuredGrid>\n'
        )
        lines = "\n".join(self._lines)
        tail = b"\n</AppendedData>\n</VTKFile>\n"
        start = f'{head}{lines}\n</UnstructuredGrid>\n<AppendedData encoding="raw">\n_'
        return start.encode() + bytes(self._data) + tail
