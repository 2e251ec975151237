# SPDX-License-Identifier: BSD-3-Clause
"""A picture of leaks: leak_pictures.py GEOMETRY FEATURE_SIZE PICTURE.png [METHOD] draws the geometry transparent, its
open edges red, the leak paths green with their narrowest places marked, and the membranes blue. GEOMETRY is any
surface file that VTK reads as .stl, .obj, .vtp or .ply. Run with pvpython; without a display, under xvfb-run."""
import os
import sys

import vtkmodules.vtkRenderingFreeType  # noqa: F401  text
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  the renderer
from projection_mesher import ProjectionMesherFilters as pm
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkFiltersCore import vtkCleanPolyData, vtkFeatureEdges, vtkGlyph3D, vtkTubeFilter
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOGeometry import vtkOBJReader, vtkSTLReader
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOPLY import vtkPLYReader
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkRenderingCore import (vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow,
                                         vtkWindowToImageFilter)

READERS = {".obj": vtkOBJReader, ".stl": vtkSTLReader, ".ply": vtkPLYReader, ".vtp": vtkXMLPolyDataReader}
SIZE = (1400, 1000)


def read(path):
    reader = READERS[os.path.splitext(path)[1].lower()]()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def actor_of(data, colour, opacity=1.0, width=1.0):
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*colour)
    actor.GetProperty().SetOpacity(opacity)
    actor.GetProperty().SetLineWidth(width)
    return actor


def open_edges(surface):
    merged = vtkCleanPolyData()
    merged.SetInputData(surface)
    edges = vtkFeatureEdges()
    edges.SetInputConnection(merged.GetOutputPort())
    edges.FeatureEdgesOff()
    edges.NonManifoldEdgesOff()
    edges.Update()
    return edges.GetOutput()


def tubes(paths, radius):
    lines = vtkPolyData()
    lines.SetPoints(paths.GetPoints())
    lines.SetLines(paths.GetLines())
    tube = vtkTubeFilter()
    tube.SetInputData(lines)
    tube.SetRadius(radius)
    tube.SetNumberOfSides(12)
    tube.Update()
    return tube.GetOutput()


def marks(table, radius):
    points = vtkPolyData()
    places = vtkPoints()
    for row in range(table.GetNumberOfRows()):
        places.InsertNextPoint(table.GetColumnByName("Place").GetTuple3(row))
    points.SetPoints(places)
    ball = vtkSphereSource()
    ball.SetRadius(radius)
    glyphs = vtkGlyph3D()
    glyphs.SetInputData(points)
    glyphs.SetSourceConnection(ball.GetOutputPort())
    glyphs.Update()
    return glyphs.GetOutput()


def picture(surface, holes, path):
    length = surface.GetLength()
    renderer = vtkRenderer()
    renderer.SetBackground(0.97, 0.97, 0.96)
    renderer.SetUseDepthPeeling(True)
    for actor in (actor_of(surface, (0.72, 0.76, 0.80), 0.35), actor_of(open_edges(surface), (0.85, 0.1, 0.1), 1, 3),
                  actor_of(holes.GetOutputDataObject(2), (0.33, 0.53, 0.75), 0.8),
                  actor_of(tubes(holes.GetOutputDataObject(1), 0.003 * length), (0.1, 0.65, 0.25)),
                  actor_of(marks(holes.GetOutputDataObject(3), 0.009 * length), (0.95, 0.6, 0.1))):
        renderer.AddActor(actor)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetAlphaBitPlanes(1)
    window.SetMultiSamples(0)
    window.SetSize(*SIZE)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(surface.GetCenter())
    camera.SetPosition([c + d for c, d in zip(surface.GetCenter(), (-0.5, -0.8, 0.45))])
    camera.SetViewUp(0, 0, 1)
    renderer.ResetCamera(surface.GetBounds())
    camera.Zoom(1.3)
    window.Render()
    image = vtkWindowToImageFilter()
    image.SetInput(window)
    image.ReadFrontBufferOff()
    writer = vtkPNGWriter()
    writer.SetInputConnection(image.GetOutputPort())
    writer.SetFileName(path)
    writer.Write()


def main(geometry, size, path, method="0"):
    surface = read(geometry)
    holes = pm.vtkCloseHoles()
    holes.SetInputDataObject(0, surface)
    holes.SetFeatureSize(float(size))
    holes.SetSurfaceSize(float(size))  # even cells: what larger ones happen to close is shown as well
    holes.SetMethod(int(method))
    holes.Update()
    table = holes.GetOutputDataObject(3)
    for row in range(table.GetNumberOfRows()):
        values = [table.GetColumnByName(name).GetValue(row) for name in ("Width", "SealingSize", "Area")]
        place = ", ".join(f"{x:.4g}" for x in table.GetColumnByName("Place").GetTuple3(row))
        print(f"leak {row}: {values[0]:.4g} wide at ({place}), sealed by {values[1]:.4g}, area {values[2]:.4g}")
    picture(surface, holes, path)


if __name__ == "__main__":
    main(*sys.argv[1:])
