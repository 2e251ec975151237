# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of the filters' pages: stage_pictures.py FOLDER [NAME ...] runs the stages on the dirty pipe junction at 5 mm and draws
after each the wall, coloured by patch, and a section; for OctreeDecompose the octree and the geometry in it, for OctreeReasons
what made its cells small; for BoundaryRefine five layers at 3 mm, with corners enlarged; for MeshValidity two measures; for
DetectFeatures the feature lines of two pipes pushed into each other; for Regions a body with three chambers; for ThinPlaces a
shell 2.4 cells thick. Run with pvpython and build/lib/python3/dist-packages on PYTHONPATH; without a display, under xvfb-run."""
import os
import sys

import figures
import mesh_pictures as pictures
import numpy as np
from figures import X, Y, Z, Panel
from projection_mesher import ProjectionMesherFilters as pm
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLookupTable, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkFiltersCore import vtkAppendPolyData, vtkCellCenters, vtkThreshold, vtkTriangleFilter
from vtkmodules.vtkFiltersGeneral import vtkTransformPolyDataFilter
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
from vtkmodules.vtkFiltersSources import vtkCylinderSource, vtkSphereSource

JUNCTION = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Testing", "Data", "pipe_junction_dirty.stl")
STAGES = ("OctreeDecompose", "PaintFront", "DummyLayer", "Project", "ResolveFeatures", "BoundaryRefine")
COLOURS = [pictures.COLOURS[i] for i in (2, 0, 1, 3, 4)]  # inlet, wall, outlet1 to 3
REASON_COLOURS = ((0.87, 0.87, 0.87),) + pictures.COLOURS[1:]
FROM = (-0.45, -0.8, 0.4)  # where walls are looked at from
PLANE = 0.001  # of the sections: through the middle of cells
SIZE = 0.005
FINE = 0.003  # where five layers are shown


def mesh_after(stage, size=SIZE, layers=3):
    mesh = pm.vtkProjectionMesh()
    mesh.SetInputDataObject(0, figures.read_geometry(JUNCTION))
    mesh.SetFeatureSize(size)
    mesh.SetLayers(layers)
    mesh.SetStopAfter(STAGES.index(stage) + 1)
    mesh.Update()
    return mesh.GetOutputDataObject(0), mesh.GetOutputDataObject(1)


def touched_cells(tree):
    """The skin of the leaves behind the plane y = 0 that a triangle touches."""
    centres, chosen, skin = vtkCellCenters(), vtkThreshold(), vtkGeometryFilter()
    centres.SetInputData(tree)
    centres.Update()
    behind = vtk_to_numpy(centres.GetOutput().GetPoints().GetData())[:, Y] > 0
    flags = numpy_to_vtk((behind & (vtk_to_numpy(tree.GetCellData().GetArray("Cut")) == 1)).astype(np.uint8), deep=True)
    flags.SetName("Shown")
    tree.GetCellData().AddArray(flags)
    chosen.SetInputData(tree)
    chosen.SetInputArrayToProcess(0, 0, 0, 1, "Shown")
    chosen.SetUpperThreshold(0.5)
    chosen.SetThresholdFunction(vtkThreshold.THRESHOLD_UPPER)
    skin.SetInputConnection(chosen.GetOutputPort())
    skin.Update()
    return figures.meshed(pictures.actor_of(skin.GetOutput(), pictures.lookup([figures.WALL], 1)))


def octree():
    tree = pm.vtkOctreeDecompose()
    geometry = figures.read_geometry(JUNCTION)
    tree.SetInputDataObject(0, geometry)
    tree.SetFeatureSize(SIZE)
    tree.Update()
    section = figures.section(tree.GetOutput(), Y, PLANE)[:2]
    line = figures.cut_line(geometry, Y, PLANE)
    line.SetPosition(0, -0.001, 0)  # before the cells
    eye, up = figures.SQUARE[Y]
    return [(470, [Panel("octree and geometry, y = 1 mm", section + [line], eye, up, depth=0),
                   Panel("half of the cells on the geometry", [touched_cells(tree.GetOutput())], (-0.35, -0.8, 0.35))], (1, 1))]


def reasons():
    """A section of the octree, coloured by the criterion that made each cell as small as it is."""
    tree = pm.vtkOctreeDecompose()
    tree.SetInputDataObject(0, figures.read_geometry(JUNCTION))
    tree.SetFeatureSize(0.0025)
    tree.SetCellsPerCircle(32)
    tree.Update()
    cut = pictures.cut_grid(tree.GetOutput(), Y, PLANE)
    names = tree.GetOutput().GetFieldData().GetAbstractArray("RefinedByNames")
    why = vtk_to_numpy(cut.GetCellData().GetArray("RefinedBy"))
    present = np.unique(why)
    pictures.colour_cells(cut, np.searchsorted(present, why))
    eye, up = figures.SQUARE[Y]
    section = Panel("y = 1 mm, coloured by RefinedBy", pictures.section_actors(cut, REASON_COLOURS), eye, up, depth=0)
    key = figures.Key([(names.GetValue(int(k)), REASON_COLOURS[i]) for i, k in enumerate(present)])
    return [(640, [section, key], (3, 1))]


def pipe(radius, low, high, axis):
    """An open pipe of triangles along an axis."""
    source, turn, triangles = vtkCylinderSource(), vtkTransformPolyDataFilter(), vtkTriangleFilter()
    source.SetRadius(radius)
    source.SetHeight(high - low)
    source.SetCenter(0, 0.5 * (low + high), 0)
    source.SetResolution(60)
    source.CappingOff()
    move = vtkTransform()
    if axis == X:
        move.RotateZ(-90)
    elif axis == Z:
        move.RotateX(90)
    turn.SetTransform(move)
    turn.SetInputConnection(source.GetOutputPort())
    triangles.SetInputConnection(turn.GetOutputPort())
    triangles.Update()
    return triangles.GetOutput()


def feature_lines():
    """Rims blue, the line along which the pipes cut each other red."""
    both, detect = vtkAppendPolyData(), pm.vtkDetectFeatures()
    both.AddInputData(pipe(1.0, -3, 3, X))
    both.AddInputData(pipe(0.6, 0.0, 2.2, Z))
    both.Update()
    detect.SetInputData(both.GetOutput())
    detect.OpenEdgesOn()
    detect.Update()
    found = detect.GetOutputDataObject(0)
    pictures.colour_cells(found, vtk_to_numpy(found.GetCellData().GetArray("Kind")) & 16 > 0)
    lines = pictures.actor_of(found, pictures.lookup([(0.15, 0.30, 0.75), (0.80, 0.15, 0.10)], 2))
    lines.GetProperty().SetLineWidth(7)
    lines.GetProperty().LightingOff()
    body = pictures.actor_of(both.GetOutput())
    body.GetProperty().SetColor(*figures.WALL)
    body.GetProperty().SetOpacity(0.25)
    return [(560, [Panel("two pipes pushed into each other", [body, lines], (-0.5, -0.8, 0.4), depth=0)], (1,))]


def rooms(axes, inside):
    """The faces between the bricks of a grid of planes that are inside and those that are not; inside: of a brick's middle."""
    middles = [0.5 * (a[1:] + a[:-1]) for a in axes]
    full = np.pad(np.array([[[inside(x, y, z) for z in middles[Z]] for y in middles[Y]] for x in middles[X]]), 1)
    surface, points, quads = vtkPolyData(), vtkPoints(), vtkCellArray()
    for axis in range(3):
        for at in np.argwhere(np.diff(full.astype(int), axis=axis)):
            low = at - 1  # of the padding, but along the axis the face is at the brick's upper end
            low[axis] += 1
            corners = np.repeat(low[None], 4, axis=0)
            others = [a for a in range(3) if a != axis]
            corners[1:3, others[0]] += 1
            corners[2:4, others[1]] += 1
            if min(low[a] for a in others) >= 0:
                quads.InsertNextCell(4, [points.InsertNextPoint(*(axes[a][c[a]] for a in range(3))) for c in corners])
    surface.SetPoints(points)
    surface.SetPolys(quads)
    return surface


def regions():
    """Three chambers, each a zone; the slot between two of them is too low for the cells."""
    size, slot, plane = 0.1, (0.97, 1.03), 0.93
    axes = [np.array(a) for a in ((0.01, 2.01, 2.71, 3.91, 4.31, 5.11), (0, 0.6, 1.4, 2.0), (0, slot[0], slot[1], 2.0))]
    body = rooms(axes, lambda x, y, z: x < 2.01 or 2.71 < x < 3.91 or x > 4.31 or
                 (2.01 < x < 2.71 and 0.6 < y < 1.4 and slot[0] < z < slot[1]))
    mesh = pm.vtkProjectionMesh()
    mesh.SetInputData(body)
    mesh.SetFeatureSize(size)
    mesh.SetSurfaceSize(size)
    mesh.SetRegion(3)  # all enclosed ones
    mesh.Update()
    cut = pictures.cut_grid(mesh.GetOutputDataObject(0), Y, plane)
    pictures.colour_cells(cut, vtk_to_numpy(cut.GetCellData().GetArray("Zone")))
    narrow = pictures.actor_of(mesh.GetOutputDataObject(3))
    narrow.GetProperty().SetColor(0.80, 0.15, 0.10)
    narrow.GetProperty().SetPointSize(12)
    line = figures.cut_line(body, Y, plane, pictures.LINES)
    for actor in (narrow, line):
        actor.AddPosition(0, -1, 0)
    names = mesh.GetOutputDataObject(0).GetFieldData().GetAbstractArray("ZoneNames")
    colours = [pictures.COLOURS[i] for i in (3, 4, 2)]
    eye, up = figures.SQUARE[Y]
    shown = pictures.section_actors(cut, colours) + [line, narrow]
    key = figures.Key([(names.GetValue(i), colours[i]) for i in range(3)] + [("too narrow", (0.80, 0.15, 0.10))])
    return [(430, [Panel("section, coloured by Zone", shown, eye, up, depth=0), key], (5, 1))]


def ball(radius):
    source = vtkSphereSource()
    source.SetRadius(radius)
    source.SetPhiResolution(90)
    source.SetThetaResolution(90)
    source.Update()
    return source.GetOutput()


def thin_places():
    """A shell 2.4 cells thick: few leaves are whole in it, and the mesh is whole all the same."""
    size, plane = 0.06, 0.31
    shell, tree, mesh = vtkAppendPolyData(), pm.vtkOctreeDecompose(), pm.vtkProjectionMesh()
    for radius in (1, 1 - 2.4 * size):
        shell.AddInputData(ball(radius))
    shell.Update()
    for stage in (tree, mesh):
        stage.SetInputData(shell.GetOutput())
        stage.SetFeatureSize(size)
        stage.SetSurfaceSize(size)
    tree.Update()
    middles = vtkCellCenters()
    middles.SetInputConnection(tree.GetOutputPort())
    middles.Update()
    centres = vtk_to_numpy(middles.GetOutput().GetPoints().GetData())
    away = np.linalg.norm(centres, axis=1)
    whole = (vtk_to_numpy(tree.GetOutput().GetCellData().GetArray("Cut")) == 0) & (away < 1) & (away > 1 - 2.4 * size)
    flags = numpy_to_vtk(whole.astype(np.uint8), deep=True)
    flags.SetName("Whole")
    tree.GetOutput().GetCellData().AddArray(flags)
    mesh.SetRegion(2)  # of the points
    mesh.AddSeedPoint(*centres[whole][0])
    mesh.Update()
    cut = pictures.cut_grid(tree.GetOutput(), Y, plane)
    pictures.colour_cells(cut, vtk_to_numpy(cut.GetCellData().GetArray("Whole")))
    line = figures.cut_line(shell.GetOutput(), Y, plane)
    line.SetPosition(0, -1, 0)
    eye, up = figures.SQUARE[Y]
    quarter = (0, 1, 0, 0, 0, 1)
    return [(430, [Panel("leaves wholly inside, in a section", pictures.section_actors(cut, [(1, 1, 1), pictures.COLOURS[3]]) + [line],
                         eye, up, box=quarter, depth=0),
                   figures.square("the mesh there", mesh.GetOutputDataObject(0), Y, plane, quarter),
                   Panel("from outside", [figures.walls(mesh.GetOutputDataObject(1))], FROM)], (1, 1, 1))]


def stage(name):
    grid, boundary = mesh_after(name)
    return [(430, [Panel("wall and patches", [figures.walls(boundary, colours=COLOURS)], FROM),
                   figures.square("section y = 1 mm", grid, Y, PLANE)], (1, 1))]


def layers():
    """Whole, a rim, and the concave edge where two pipes meet."""
    grid, boundary = mesh_after("BoundaryRefine", FINE, 5)
    rim, concave = (-0.001, 0.016, 0, 0, 0.0085, 0.0208), (0.03, 0.046, 0, 0, 0.0115, 0.0232)
    return [(430, [figures.square("section y = 1 mm", grid, Y, PLANE),
                   Panel("wall and patches", [figures.walls(boundary, colours=COLOURS)], FROM)], (1, 1)),
            (440, [figures.square("at the inlet's rim", grid, Y, PLANE, rim),
                   figures.square("where the pipes meet", grid, Y, PLANE, concave)], (1, 1))]


def measured(cut, name, limit):
    """The polygons of a section from white, 0, to red, the limit."""
    table = vtkLookupTable()
    table.SetHueRange(0, 0)
    table.SetSaturationRange(0, 1)
    table.SetValueRange(0.97, 0.8)
    table.SetTableRange(0, limit)
    table.Build()
    lines = pictures.section_actors(cut)[1]
    shown = pictures.actor_of(cut, table)
    shown.GetMapper().SetScalarModeToUseCellFieldData()
    shown.GetMapper().SelectColorArray(name)
    shown.GetProperty().LightingOff()
    lines.GetProperty().SetLineWidth(1)
    return [shown, lines]


def validity():
    check = pm.vtkMeshValidity()
    check.SetInputDataObject(mesh_after("ResolveFeatures", FINE)[0])
    check.Update()
    cut, (eye, up) = pictures.cut_grid(check.GetOutput(), Y, PLANE), figures.SQUARE[Y]
    return [(430, [Panel(f"{name}: white 0, red {limit}{unit}", measured(cut, name, limit), eye, up, depth=0)
                   for name, limit, unit in (("Angle", 70, " degrees"), ("Skewness", 3.8, ""))], (1, 1))]


OTHERS = {"OctreeDecompose": octree, "OctreeReasons": reasons, "BoundaryRefine": layers, "MeshValidity": validity,
          "DetectFeatures": feature_lines, "Regions": regions, "ThinPlaces": thin_places}


def main(folder, names):
    for name in names or sorted(set(STAGES) | set(OTHERS)):
        rows = OTHERS[name]() if name in OTHERS else stage(name)
        figures.draw(rows, os.path.join(folder, name + ".png"))
        print(name, flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 2 or set(sys.argv[2:]) - set(STAGES) - set(OTHERS):
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
