# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of a mesh: mesh_pictures.py FOLDER reads mesh.vtu and boundary.vtp there and writes section.png, a plane cut
with mesh lines, and surface.png, the boundary coloured by patch. Run with pvpython and build/lib/python3/dist-packages on
PYTHONPATH; without a display, under xvfb-run."""
import itertools
import math
import os
import sys

import numpy
import vtkmodules.vtkRenderingFreeType  # noqa: F401  text
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  the renderer
from projection_mesher import ProjectionMesherFilters as pm
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLookupTable
from vtkmodules.vtkFiltersCore import vtkExtractEdges, vtkThreshold
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader
from vtkmodules.vtkRenderingCore import (vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkTextActor,
                                         vtkWindowToImageFilter)

SIZE = (1400, 1000)
BACKGROUND = (0.96, 0.96, 0.95)
LINES = (0.16, 0.18, 0.21)
TEXT = (0.1, 0.1, 0.1)
# For patches: even in lightness, told apart by the colour-blind.
COLOURS = ((0.72, 0.76, 0.80), (0.88, 0.48, 0.37), (0.41, 0.64, 0.48), (0.33, 0.53, 0.75), (0.91, 0.76, 0.42),
           (0.63, 0.49, 0.72), (0.45, 0.73, 0.75), (0.85, 0.60, 0.72), (0.65, 0.55, 0.43), (0.60, 0.72, 0.33))
CELL_COLOURS = ((0.80, 0.86, 0.91), (0.97, 0.84, 0.67))  # inner cells, layer cells


def read(reader, path):
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def lookup(colours, count):
    table = vtkLookupTable()
    table.SetNumberOfTableValues(count)
    for i in range(count):
        table.SetTableValue(i, *colours[i % len(colours)])
    table.SetTableRange(-0.5, count - 0.5)
    return table


def actor_of(data, table=None):
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    if table:
        mapper.SetScalarModeToUseCellData()
        mapper.SetLookupTable(table)
        mapper.UseLookupTableScalarRangeOn()
    else:
        mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    return actor


# --------------------------------------------------------------------------------------------------- the section
def cut_grid(grid, axis, position):
    """The cells' polygons in a plane square to an axis, coloured by whether they are layer cells."""
    slicer = pm.vtkMeshSlice()
    slicer.SetInputData(grid)
    slicer.GetPlane().SetNormal(*(1.0 if a == axis else 0.0 for a in range(3)))
    slicer.GetPlane().SetOrigin(*(position if a == axis else 0.0 for a in range(3)))
    slicer.Update()
    cut = slicer.GetOutput()
    if cut.GetNumberOfCells() == 0:
        raise RuntimeError("the section is empty")
    layer = cut.GetCellData().GetArray("Layer")
    colour_cells(cut, vtk_to_numpy(layer) > 0 if layer else numpy.zeros(cut.GetNumberOfCells(), bool))
    return cut


def colour_cells(cut, values):
    colours = numpy_to_vtk(values.astype(numpy.float32), deep=True)
    colours.SetName("Colour")
    cut.GetCellData().SetScalars(colours)


def section_actors(cut, colours=CELL_COLOURS):
    """The polygons of a cut in their colours, and the mesh lines."""
    edges = vtkExtractEdges()
    edges.SetInputData(cut)
    edges.Update()
    face, lines = actor_of(cut, lookup(colours, len(colours))), actor_of(edges.GetOutput())
    lines.GetProperty().SetColor(*LINES)
    lines.GetProperty().SetLineWidth(1.2)
    for actor in (face, lines):
        actor.GetProperty().LightingOff()
    return [face, lines]


def section(grid, focus, path):
    """A plane through the middle of focus, square to its shortest side, at a round number."""
    sides = [focus[2 * a + 1] - focus[2 * a] for a in range(3)]
    axis = sides.index(min(sides))
    position = round(focus[2 * axis] + 0.5 * sides[axis], 3 - math.floor(math.log10(sides[axis])))
    actors = section_actors(cut_grid(grid, axis, position))
    renderer = new_renderer(actors + [text_actor(f"{'xyz'[axis]} = {position:.4g}", 24, 20)])
    renderer.GetActiveCamera().ParallelProjectionOn()
    direction, up = (((1, 0, 0), (0, 0, 1)), ((0, -1, 0), (0, 0, 1)), ((0, 0, 1), (0, 1, 0)))[axis]
    save(renderer, numpy.array(list(itertools.product(*numpy.reshape(focus, (3, 2))))), direction, up, path)


# ---------------------------------------------------------------------------------------------------- the surface
def shown_patches(boundary):
    """Ids of the patches worth a look: the walls, where sides of a domain would hide them; else all."""
    types = boundary.GetFieldData().GetAbstractArray("PatchTypes")
    present = numpy.unique(vtk_to_numpy(boundary.GetCellData().GetArray("PatchId")))
    walls = [int(i) for i in present if types.GetValue(int(i)) == "wall"]
    return walls or [int(i) for i in present]


def only_patches(boundary, patches):
    keep = numpy.isin(vtk_to_numpy(boundary.GetCellData().GetArray("PatchId")), patches)
    flags = numpy_to_vtk(keep.astype(numpy.uint8), deep=True)
    flags.SetName("Shown")
    boundary.GetCellData().AddArray(flags)
    threshold = vtkThreshold()
    threshold.SetInputData(boundary)
    threshold.SetInputArrayToProcess(0, 0, 0, 1, "Shown")
    threshold.SetUpperThreshold(0.5)
    threshold.SetThresholdFunction(vtkThreshold.THRESHOLD_UPPER)
    surface = vtkGeometryFilter()
    surface.SetInputConnection(threshold.GetOutputPort())
    surface.Update()
    shown = surface.GetOutput()
    shown.GetCellData().SetActiveScalars("PatchId")
    return shown


def patch_colours(boundary, count):
    """Plain grey for the patch of most faces, the other colours in order of size."""
    sizes = numpy.bincount(vtk_to_numpy(boundary.GetCellData().GetArray("PatchId")), minlength=count)
    rank = numpy.argsort(numpy.argsort(-sizes, kind="stable"))
    return [COLOURS[r % len(COLOURS)] for r in rank]


def surface(shown, names, patches, path):
    table = lookup(patch_colours(shown, len(names)), len(names))
    actor = actor_of(shown, table)
    actor.GetProperty().EdgeVisibilityOn()
    actor.GetProperty().SetEdgeColor(*LINES)
    actor.GetProperty().SetInterpolationToFlat()
    actor.GetProperty().SetAmbient(0.4)
    actor.GetProperty().SetDiffuse(0.6)
    labels = legend(names, patches, table) if len(patches) <= 20 else []
    renderer = new_renderer([actor] + labels)
    points = vtk_to_numpy(shown.GetPoints().GetData())
    save(renderer, points, (-0.45, -0.8, 0.4), (0, 0, 1), path)


def legend(names, patches, table):
    """Patch names on their colours, from the lower left corner upwards."""
    labels = []
    for row, patch in enumerate(reversed(patches)):
        label = text_actor(f" {names[patch]} ", 24, 20 + 34 * row)
        label.GetTextProperty().SetBackgroundColor(*table.GetTableValue(patch)[:3])
        label.GetTextProperty().SetBackgroundOpacity(1.0)
        labels.append(label)
    return labels


# -------------------------------------------------------------------------------------------------------- drawing
def text_actor(text, x, y):
    actor = vtkTextActor()
    actor.SetInput(text)
    actor.SetPosition(x, y)
    actor.GetTextProperty().SetColor(*TEXT)
    actor.GetTextProperty().SetFontSize(22)
    return actor


def new_renderer(actors):
    renderer = vtkRenderer()
    renderer.SetBackground(*BACKGROUND)
    for actor in actors:
        renderer.AddActor(actor)
    return renderer


def aim(renderer, points, direction, up):
    """Points the camera along the direction at the points, as near as the picture's frame allows."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(*middle)
    camera.SetPosition(*(middle + direction))
    camera.SetViewUp(*up)
    renderer.ResetCamera([side for sides in zip(low, high) for side in sides])
    homogeneous = numpy.column_stack([points, numpy.ones(len(points))])
    for _ in range(3):  # centring and zooming change each other a little
        matrix = camera.GetCompositeProjectionTransformMatrix(SIZE[0] / SIZE[1], -1, 1)
        view = homogeneous @ numpy.array([[matrix.GetElement(i, j) for j in range(4)] for i in (0, 1, 3)]).T
        view = view[:, :2] / view[:, 2:]
        low, high = view.min(axis=0), view.max(axis=0)
        centre = numpy.array(camera.GetWindowCenter()) + (low + high) / 2
        camera.SetWindowCenter(*centre)
        camera.Zoom(0.93 / ((high - low) / 2).max())
    renderer.ResetCameraClippingRange()


def write_picture(window, path):
    """Renders a window and writes what it shows as PNG."""
    window.Render()
    image = vtkWindowToImageFilter()
    image.SetInput(window)
    image.ReadFrontBufferOff()
    writer = vtkPNGWriter()
    writer.SetInputConnection(image.GetOutputPort())
    writer.SetFileName(path)
    writer.Write()


def save(renderer, points, direction, up, path):
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(*SIZE)
    window.AddRenderer(renderer)
    aim(renderer, points, direction, up)
    write_picture(window, path)


def grown(bounds, part):
    middle = [(bounds[2 * a] + bounds[2 * a + 1]) / 2 for a in range(3)]
    half = [(1 + part) * (bounds[2 * a + 1] - bounds[2 * a]) / 2 for a in range(3)]
    return [m + s * h for m, h in zip(middle, half) for s in (-1, 1)]


def surface_picture(folder, boundary):
    """Draws the boundary; returns the box that is worth a section."""
    field = boundary.GetFieldData().GetAbstractArray("PatchNames")
    names = [field.GetValue(i) for i in range(field.GetNumberOfValues())]
    patches = shown_patches(boundary)
    shown = only_patches(boundary, patches)
    surface(shown, names, patches, os.path.join(folder, "surface.png"))
    whole = shown.GetNumberOfCells() == boundary.GetNumberOfCells()
    return shown.GetBounds() if whole else grown(shown.GetBounds(), 0.25)


def main(folder):
    boundary_file, focus = os.path.join(folder, "boundary.vtp"), None
    if os.path.exists(boundary_file):
        focus = surface_picture(folder, read(vtkXMLPolyDataReader(), boundary_file))
    grid = read(vtkXMLUnstructuredGridReader(), os.path.join(folder, "mesh.vtu"))
    section(grid, focus or grid.GetBounds(), os.path.join(folder, "section.png"))


if __name__ == "__main__":
    main(sys.argv[1])
