"""Draw a .vtu file, deformed and grey by its vertical displacement, off screen.

Without a file the picture is empty. A program of its own: VTK may end the process where it cannot draw.
"""

import sys

import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 (it draws)
from vtkmodules.vtkCommonCore import vtkLookupTable
from vtkmodules.vtkFiltersGeneral import vtkWarpVector
from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkDataSetMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkWindowToImageFilter,
)

SIZE = 400
NAME = "displacement [L0]"


def draw(source: str, picture: str, centre: tuple[float, float], half: float, reach: float) -> None:
    """Draw a square about a centre: grey from black at -reach to white at reach, blue elsewhere."""
    window, renderer = vtkRenderWindow(), vtkRenderer()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(SIZE, SIZE)
    window.AddRenderer(renderer)
    renderer.SetBackground(0, 0, 1)
    if source:
        reader, warp, surface = vtkXMLUnstructuredGridReader(), vtkWarpVector(), vtkDataSetSurfaceFilter()
        reader.SetFileName(source)
        warp.SetInputConnection(reader.GetOutputPort())
        warp.SetInputArrayToProcess(0, 0, 0, 0, NAME)
        surface.SetInputConnection(warp.GetOutputPort())
        surface.SetNonlinearSubdivisionLevel(3)
        greys = vtkLookupTable()
        greys.SetNumberOfTableValues(256)
        greys.SetRange(-reach, reach)
        greys.SetVectorModeToComponent()
        greys.SetVectorComponent(1)
        for level in range(256):
            greys.SetTableValue(level, level / 255, level / 255, level / 255, 1)
        mapper, actor = vtkDataSetMapper(), vtkActor()
        mapper.SetInputConnection(surface.GetOutputPort())
        mapper.SetScalarModeToUsePointFieldData()
        mapper.SelectColorArray(NAME)
        mapper.SetLookupTable(greys)
        mapper.UseLookupTableScalarRangeOn()
        mapper.InterpolateScalarsBeforeMappingOn()
        actor.SetMapper(mapper)
        actor.GetProperty().LightingOff()
        renderer.AddActor(actor)
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(*centre, 0)
    camera.SetPosition(*centre, 10 * half)
    camera.SetParallelScale(half)
    renderer.ResetCameraClippingRange()
    window.Render()
    image, writer = vtkWindowToImageFilter(), vtkPNGWriter()
    image.SetInput(window)
    image.ReadFrontBufferOff()
    writer.SetFileName(picture)
    writer.SetInputConnection(image.GetOutputPort())
    writer.Write()


if __name__ == "__main__":
    source, picture, *numbers = sys.argv[1:]
    x, y, half, reach = map(float, numbers)
    draw(source, picture, (x, y), half, reach)
