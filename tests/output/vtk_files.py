"""The files as VTK's own readers and cells see them."""

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import reference, vtkOutputWindow, vtkStringOutputWindow
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

from isopeel.common.arrays import FloatArray, IntArray


class ReadGrid:
    """A .vtu file; whatever VTK complains about is an error."""

    def __init__(self, path: Path) -> None:
        usual, complaints = vtkOutputWindow.GetInstance(), vtkStringOutputWindow()
        vtkOutputWindow.SetInstance(complaints)
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(path))
        reader.Update()
        vtkOutputWindow.SetInstance(usual)
        assert complaints.GetOutput() == ""
        self.grid: Any = reader.GetOutput()
        self.point_data, self.cell_data, self.field_data = (
            {data.GetArrayName(n): data.GetAbstractArray(n) for n in range(data.GetNumberOfArrays())}
            for data in (self.grid.GetPointData(), self.grid.GetCellData(), self.grid.GetFieldData())
        )

    @property
    def points(self) -> FloatArray:
        """(n, 3)."""
        return np.array(vtk_to_numpy(self.grid.GetPoints().GetData()))

    @property
    def cells(self) -> IntArray:
        """Numbers of the points of one cell after the other."""
        return np.array(vtk_to_numpy(self.grid.GetCells().GetConnectivityArray()))

    def at_points(self, name: str) -> FloatArray:
        """Data at points, (n, ...)."""
        return np.array(vtk_to_numpy(self.point_data[name]))

    def in_cells(self, name: str) -> FloatArray:
        """Data in cells, (m, ...)."""
        return np.array(vtk_to_numpy(self.cell_data[name]))

    def evaluate(self, cell: int, place: tuple[float, float], *names: str) -> list[FloatArray]:
        """Position (3,) and fields at a place in [0, 1] x [0, 1] of a cell, by the cell's own functions."""
        found = self.grid.GetCell(cell)
        numbers = [found.GetPointId(n) for n in range(found.GetNumberOfPoints())]
        position, functions = [0.0] * 3, [0.0] * len(numbers)
        found.EvaluateLocation(reference(0), [*place, 0.0], position, functions)
        fields = (np.array([self.point_data[name].GetTuple(n) for n in numbers]) for name in names)
        return [np.array(position), *(np.array(functions) @ field for field in fields)]


def series(path: Path) -> list[tuple[float, Path]]:
    """Times and files of a .pvd file."""
    sets = ElementTree.parse(path).getroot().findall("Collection/DataSet")
    return [(float(found.attrib["timestep"]), path.parent / found.attrib["file"]) for found in sets]
