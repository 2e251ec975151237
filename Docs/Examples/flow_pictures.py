# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of the flows that junction_flow.sh and motorbike_potential.sh compute, into their folder OUT:

    flow_pictures.py junction OUT     velocity.png, the plane y = 0, and pressure.png, the boundary
    flow_pictures.py motorbike OUT    flow.png, speed in the plane y = 0, pressure coefficient on the surface

Run with pvpython and build/lib/python3/dist-packages on PYTHONPATH; without a display, under xvfb-run."""
import os
import sys

import mesh_pictures as pictures
import numpy as np
from projection_mesher import ProjectionMesherFilters as pm
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkStaticCellLocator
from vtkmodules.vtkFiltersCore import vtkAppendPolyData, vtkFeatureEdges, vtkGlyph2D
from vtkmodules.vtkFiltersSources import vtkGlyphSource2D
from vtkmodules.vtkIOGeometry import vtkOpenFOAMReader
from vtkmodules.vtkRenderingAnnotation import vtkScalarBarActor
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction

DENSITY = 1.2  # of air, kg/m3
FREE_SPEED = 20.0  # m/s, of the air before the motorcycle
DOMAIN_SIDES = ("xmin", "xmax", "ymin", "ymax", "zmin", "zmax")
SEQUENTIAL = ((0.27, 0.00, 0.33), (0.23, 0.32, 0.55), (0.13, 0.57, 0.55), (0.37, 0.79, 0.38), (0.99, 0.91, 0.14))
DIVERGING = ((0.02, 0.19, 0.38), (0.26, 0.58, 0.76), (0.97, 0.97, 0.97), (0.84, 0.38, 0.30), (0.40, 0.00, 0.12))


# ------------------------------------------------------------------------------------------------- the solution
def read_case(case):
    """The cells and the boundary's patches by name, at the last time, each with its arrays at points too."""
    handle = os.path.join(case, "case.foam")
    with open(handle, "w", encoding="ascii"):
        pass
    reader = vtkOpenFOAMReader()
    reader.SetFileName(handle)
    reader.SkipZeroTimeOff()
    reader.DecomposePolyhedraOff()
    reader.UpdateInformation()
    reader.EnableAllPatchArrays()
    reader.EnableAllCellArrays()
    times = reader.GetTimeValues()
    reader.UpdateTimeStep(times.GetValue(times.GetNumberOfValues() - 1))
    cells, boundary = reader.GetOutput().GetBlock(0), reader.GetOutput().GetBlock(1)
    names = [boundary.GetMetaData(i).Get(boundary.NAME()) for i in range(boundary.GetNumberOfBlocks())]
    return cells, {name: boundary.GetBlock(i) for i, name in enumerate(names)}


def joined(pieces):
    append = vtkAppendPolyData()
    for piece in pieces:
        append.AddInputData(piece)
    append.Update()
    return append.GetOutput()


def body_patches(patches):
    """Those that are no side of the domain."""
    return [patch for name, patch in patches.items() if name not in DOMAIN_SIDES]


def at_points(data, name):
    return vtk_to_numpy(data.GetPointData().GetArray(name))


def plane_cut(grid, y=0.0):
    slicer = pm.vtkMeshSlice()
    slicer.SetInputData(grid)
    slicer.GetPlane().SetOrigin(0, y, 0)
    slicer.GetPlane().SetNormal(0, 1, 0)
    slicer.Update()
    return slicer.GetOutput()


# ------------------------------------------------------------------------------------------------------ drawing
def colours(stops, low, high):
    table = vtkColorTransferFunction()
    for at, colour in zip(np.linspace(low, high, len(stops)), stops):
        table.AddRGBPoint(at, *colour)
    return table


def coloured(data, values, table):
    """The data with colours for values at its points."""
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName("Colour")
    data.GetPointData().SetScalars(array)
    actor = pictures.actor_of(data)
    actor.GetMapper().ScalarVisibilityOn()
    actor.GetMapper().SetScalarModeToUsePointData()
    actor.GetMapper().InterpolateScalarsBeforeMappingOn()
    actor.GetMapper().SetLookupTable(table)
    actor.GetMapper().UseLookupTableScalarRangeOn()
    return actor


def wall(data, values, table):
    actor = coloured(data, values, table)
    actor.GetProperty().SetAmbient(0.45)
    actor.GetProperty().SetDiffuse(0.55)
    return actor


def plain(data, colour, width=2.0):
    actor = pictures.actor_of(data)
    actor.GetProperty().SetColor(*colour)
    actor.GetProperty().SetLineWidth(width)
    actor.GetProperty().LightingOff()
    return actor


def outline(cut):
    edges = vtkFeatureEdges()
    edges.SetInputData(cut)
    edges.FeatureEdgesOff()
    edges.ManifoldEdgesOff()
    edges.NonManifoldEdgesOff()
    edges.ColoringOff()
    edges.Update()
    return edges.GetOutput()


def scale_bar(table, title, x, y):
    """The colours with their values, and what they are above them; x and y in parts of the picture."""
    bar = vtkScalarBarActor()
    bar.SetLookupTable(table)
    bar.SetOrientationToHorizontal()
    bar.SetPosition(x, y)
    bar.SetPosition2(0.36, 0.06)
    bar.SetNumberOfLabels(5)
    bar.SetLabelFormat("%.3g")
    bar.UnconstrainedFontSizeOn()
    text = bar.GetLabelTextProperty()
    text.SetColor(*pictures.TEXT)
    text.SetFontSize(20)
    text.BoldOff()
    text.ItalicOff()
    text.ShadowOff()
    return [bar, pictures.text_actor(title, x * pictures.SIZE[0], (y + 0.07) * pictures.SIZE[1])]


def arrows(cut, name, spacing, longest):
    """Arrows at the corners of a square grid in the plane y = 0, each with its cell's velocity."""
    bounds = cut.GetBounds()
    locator = vtkStaticCellLocator()
    locator.SetDataSet(cut)
    locator.BuildLocator()
    velocity = vtk_to_numpy(cut.GetCellData().GetArray(name))
    points, vectors = vtkPoints(), []
    for x in np.arange(bounds[0] + spacing / 2, bounds[1], spacing):
        for z in np.arange(bounds[4] + spacing / 2, bounds[5], spacing):
            cell = locator.FindCell((x, 0.0, z))
            if cell >= 0:
                points.InsertNextPoint(x, z, 0.0)
                vectors.append((velocity[cell][0], velocity[cell][2], 0.0))
    seeds = vtkPolyData()
    seeds.SetPoints(points)
    array = numpy_to_vtk(np.array(vectors), deep=True)
    array.SetName("V")
    seeds.GetPointData().SetVectors(array)
    shape = vtkGlyphSource2D()
    shape.SetGlyphTypeToArrow()
    shape.FilledOff()
    shape.SetCenter(0.5, 0, 0)
    glyphs = vtkGlyph2D()
    glyphs.SetInputData(seeds)
    glyphs.SetSourceConnection(shape.GetOutputPort())
    glyphs.SetScaleModeToScaleByVector()
    glyphs.SetScaleFactor(longest / np.linalg.norm(velocity, axis=1).max())
    glyphs.Update()
    actor = plain(glyphs.GetOutput(), (0.05, 0.05, 0.05), 1.3)
    actor.RotateX(90)  # the plane of the glyphs into y = 0
    actor.AddPosition(0, -1e-4, 0)
    return actor


# --------------------------------------------------------------------------------------------------------- cases
def junction(out):
    cells, patches = read_case(os.path.join(out, "case"))
    cut = plane_cut(cells)
    speed = np.linalg.norm(at_points(cut, "U"), axis=1)
    table = colours(SEQUENTIAL, 0, speed.max())
    face = coloured(cut, speed, table)
    face.GetProperty().LightingOff()
    face.GetProperty().SetOpacity(0.75)
    lines = [plain(outline(cut), pictures.LINES), arrows(cut, "U", 0.0034, 0.0038)]
    renderer = pictures.new_renderer([face] + lines + scale_bar(table, "speed, m/s", 0.03, 0.04))
    renderer.GetActiveCamera().ParallelProjectionOn()
    pictures.save(renderer, vtk_to_numpy(cut.GetPoints().GetData()), (0, -1, 0), (0, 0, 1), os.path.join(out, "velocity.png"))

    surface = joined(patches.values())
    pressure = DENSITY * at_points(surface, "p")
    table = colours(SEQUENTIAL, *np.percentile(pressure, (5, 95)))
    renderer = pictures.new_renderer([wall(surface, pressure, table)] +
                                     scale_bar(table, "pressure less that at the outlets, Pa", 0.03, 0.04))
    pictures.save(renderer, vtk_to_numpy(surface.GetPoints().GetData()), (-0.45, -0.8, 0.4), (0, 0, 1),
                  os.path.join(out, "pressure.png"))


def motorbike(out):
    cells, patches = read_case(os.path.join(out, "case"))
    cut = plane_cut(cells)
    speed = np.linalg.norm(at_points(cut, "grad(Phi)"), axis=1)
    speeds = colours(SEQUENTIAL, 0, 1.6 * FREE_SPEED)
    plane = coloured(cut, speed, speeds)
    plane.GetProperty().LightingOff()
    body = joined(body_patches(patches))
    coefficient = 1 - np.sum((at_points(body, "grad(Phi)") / FREE_SPEED)**2, axis=1)
    coefficients = colours(DIVERGING, -1, 1)
    surface = wall(body, coefficient, coefficients)
    surface.GetProperty().FrontfaceCullingOn()  # faces look away from the flow; a thin sheet has two in one place
    renderer = pictures.new_renderer([plane, surface] + scale_bar(speeds, "speed in the plane, m/s", 0.03, 0.04) +
                                     scale_bar(coefficients, "pressure coefficient on the surface", 0.6, 0.04))
    corners = np.array([(x, y, z) for x in (-0.7, 2.1) for y in (-0.3, 0.0) for z in (-0.3, 1.5)])
    pictures.save(renderer, corners, (-0.35, -1, 0.22), (0, 0, 1), os.path.join(out, "flow.png"))


CASES = {"junction": junction, "motorbike": motorbike}

if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[1] not in CASES:
        sys.exit(__doc__)
    CASES[sys.argv[1]](sys.argv[2])
