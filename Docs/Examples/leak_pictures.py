# SPDX-License-Identifier: BSD-3-Clause
"""A picture of where a geometry leaks: as a whole, and the widest leak enlarged beside it.

    pvpython Docs/Examples/leak_pictures.py GEOMETRY FEATURE_SIZE PICTURE.png [--close coarse-to-fine|offset]
        [--inside x y z] [--outside x y z] [--punch x y z DIAMETER]

The geometry is transparent, open edges red, leak paths green, bottlenecks orange; membranes, or what closes the holes,
blue. GEOMETRY is any file that Surface Reader reads. --punch cuts a round hole first; it, --inside and --outside may be
repeated. Docs/Images/CloseHoles.png is the shipped pipe junction with two holes:

    Testing/Data/pipe_junction.stl 0.002 Docs/Images/CloseHoles.png --punch 0.03 -0.02 0 0.01 --punch 0.05 0 0.0575 0.008

Uses the suite in ./build, where mesh.sh and test.sh build it, unless it is on PYTHONPATH; without a display, run under
xvfb-run -a."""
import argparse
import os
import sys

import numpy
import vtkmodules.vtkRenderingFreeType  # noqa: F401  text
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  the renderer
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData, vtkSphere
from vtkmodules.vtkFiltersCore import (vtkCleanPolyData, vtkClipPolyData, vtkFeatureEdges, vtkGlyph3D,
                                       vtkTriangleFilter, vtkTubeFilter)
from vtkmodules.vtkFiltersModeling import vtkAdaptiveSubdivisionFilter
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow

BUILT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "build", "lib", "python3", "dist-packages")
sys.path.append(BUILT)
from projection_mesher import ProjectionMesherFilters as pm  # noqa: E402  only now can it be found

from mesh_pictures import write_picture  # noqa: E402  which needs it too

SIZE = (1800, 900)
METHODS = {None: 0, "coarse-to-fine": 1, "offset": 2}
VIEW = numpy.array((-0.5, -0.8, 0.45))


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("geometry")
    parser.add_argument("feature_size", type=float)
    parser.add_argument("picture")
    parser.add_argument("--close", choices=("coarse-to-fine", "offset"))
    for option, names in (("--inside", "xyz"), ("--outside", "xyz"), ("--punch", ("x", "y", "z", "DIAMETER"))):
        parser.add_argument(option, nargs=len(names), type=float, action="append", default=[], metavar=tuple(names))
    return parser.parse_args()


def read(path):
    reader = pm.vtkSurfaceReader()
    reader.SetFileName(path)
    triangles = vtkTriangleFilter()
    triangles.SetInputConnection(reader.GetOutputPort())
    triangles.Update()
    return triangles.GetOutput()


def punched(surface, centre, diameter):
    """Without what lies in the ball; edges are halved first, on both sides alike, until the hole is round."""
    merged, fine, ball, clip = vtkCleanPolyData(), vtkAdaptiveSubdivisionFilter(), vtkSphere(), vtkClipPolyData()
    merged.SetInputData(surface)
    merged.SetTolerance(0)
    fine.SetInputConnection(merged.GetOutputPort())
    fine.SetMaximumEdgeLength(diameter / 4)
    fine.SetMaximumTriangleArea(surface.GetLength() ** 2)  # edges alone decide, so that none hangs
    fine.SetMaximumNumberOfPasses(100)
    ball.SetCenter(*centre)
    ball.SetRadius(diameter / 2)
    clip.SetInputConnection(fine.GetOutputPort())
    clip.SetClipFunction(ball)
    triangles = vtkTriangleFilter()
    triangles.SetInputConnection(clip.GetOutputPort())
    triangles.Update()
    return triangles.GetOutput()


def triangle_surface(places, ids):
    surface, points, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    points.SetData(numpy_to_vtk(places, deep=True))
    cells.SetData(numpy_to_vtkIdTypeArray(numpy.arange(0, len(ids) + 1, 3), deep=True),
                  numpy_to_vtkIdTypeArray(ids.astype(numpy.int64), deep=True))
    surface.SetPoints(points)
    surface.SetPolys(cells)
    return surface


def search(surface, options):
    holes = pm.vtkCloseHoles()
    holes.SetInputDataObject(0, surface)
    holes.SetFeatureSize(options.feature_size)
    holes.SetSurfaceSize(options.feature_size)  # even cells: what larger ones happen to close is shown as well
    holes.SetMethod(METHODS[options.close])
    for point in options.inside:
        holes.AddInsidePoint(*point)
    for point in options.outside:
        holes.AddOutsidePoint(*point)
    holes.Update()
    if holes.GetOutputDataObject(0).GetFieldData().GetAbstractArray("PatchNames") is None:
        raise SystemExit("Close Holes gave no result; its error is above.")
    return holes


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
    merged.SetTolerance(0)
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
    points, places, ball, glyphs = vtkPolyData(), vtkPoints(), vtkSphereSource(), vtkGlyph3D()
    for row in range(table.GetNumberOfRows()):
        places.InsertNextPoint(table.GetColumnByName("Place").GetTuple3(row))
    points.SetPoints(places)
    ball.SetRadius(radius)
    ball.SetThetaResolution(24)
    ball.SetPhiResolution(24)
    glyphs.SetInputData(points)
    glyphs.SetSourceConnection(ball.GetOutputPort())
    glyphs.Update()
    return glyphs.GetOutput()


def closing_faces(holes):
    """What was added to the geometry; the membranes when nothing was."""
    closed = holes.GetOutputDataObject(0)
    names = closed.GetFieldData().GetAbstractArray("PatchNames")
    last = names.GetNumberOfValues() - 1
    if holes.GetMethod() == holes.SHOW_ONLY or names.GetValue(last) != "closed_holes":
        return holes.GetOutputDataObject(2)
    added = vtk_to_numpy(closed.GetCellData().GetArray("PatchId")) == last
    ids = vtk_to_numpy(closed.GetPolys().GetConnectivityArray()).reshape(-1, 3)[added]
    return triangle_surface(vtk_to_numpy(closed.GetPoints().GetData()), ids.reshape(-1))


def scene(surface, holes, scale, part):
    """Half a window; lines and marks are as large as the scale, a length, asks for."""
    renderer = vtkRenderer()
    renderer.SetViewport(0.5 * part, 0, 0.5 * (part + 1), 1)
    renderer.SetBackground(0.97, 0.97, 0.96)
    renderer.SetUseDepthPeeling(True)
    paths, table = holes.GetOutputDataObject(1), holes.GetOutputDataObject(3)
    for actor in (actor_of(surface, (0.72, 0.76, 0.80), 0.35), actor_of(open_edges(surface), (0.85, 0.1, 0.1), 1, 3),
                  actor_of(closing_faces(holes), (0.33, 0.53, 0.75), 0.7)):
        renderer.AddActor(actor)
    if table.GetNumberOfRows():
        renderer.AddActor(actor_of(tubes(paths, 0.004 * scale), (0.1, 0.65, 0.25)))
        renderer.AddActor(actor_of(marks(table, 0.012 * scale), (0.95, 0.6, 0.1)))
    return renderer


def look(renderer, focus, direction, radius):
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(*focus)
    camera.SetPosition(*(focus + direction))
    camera.SetViewUp(*((0, 1, 0) if abs(direction[2]) > 0.95 * numpy.linalg.norm(direction) else (0, 0, 1)))
    renderer.ResetCamera(*numpy.stack((focus - radius, focus + radius), axis=1).reshape(-1))
    camera.Zoom(1.5)
    renderer.ResetCameraClippingRange()


def picture(surface, holes, path):
    table, length = holes.GetOutputDataObject(3), surface.GetLength()
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetAlphaBitPlanes(1)
    window.SetMultiSamples(0)
    window.SetSize(*SIZE)
    centre = numpy.array(surface.GetCenter())
    views = [(centre, VIEW, 0.5 * length)]
    if table.GetNumberOfRows():
        place, width = numpy.array(table.GetColumnByName("Place").GetTuple3(0)), table.GetColumnByName("Width").GetValue(0)
        out = place - centre
        away = out / (numpy.linalg.norm(out) or 1) + 0.8 * VIEW  # from outside, a little from the side
        views.append((place, away, min(1.5 * width, 0.3 * length)))
    for part, (focus, direction, radius) in enumerate(views):
        renderer = scene(surface, holes, 2 * radius, part)
        window.AddRenderer(renderer)
        look(renderer, focus, direction, radius)
    write_picture(window, path)


def main():
    options = arguments()
    surface = read(options.geometry)
    for hole in options.punch:
        surface = punched(surface, numpy.array(hole[:3]), hole[3])
    holes = search(surface, options)
    table = holes.GetOutputDataObject(3)
    for row in range(table.GetNumberOfRows()):
        values = [table.GetColumnByName(name).GetValue(row) for name in ("Width", "SealingSize", "Area")]
        place = ", ".join(f"{x:.4g}" for x in table.GetColumnByName("Place").GetTuple3(row))
        print(f"leak {row}: {values[0]:.4g} wide at ({place}), sealed by {values[1]:.4g}, area {values[2]:.4g}")
    if not table.GetNumberOfRows():
        print("no leak")
    picture(surface, holes, options.picture)


if __name__ == "__main__":
    main()
