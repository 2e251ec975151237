# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of the pages of the six stages and of Mesh Validity, all of the dirty pipe junction: stage_pictures.py FOLDER
[STAGE ...] runs the stages at 5 mm and draws after each the wall, coloured by patch, and a section; for Octree Decompose the
octree and the geometry in it; for Boundary Refine five layers at 3 mm, with corners enlarged; for MeshValidity two measures. Run with pvpython and build/lib/python3/dist-packages on
PYTHONPATH; without a display, under xvfb-run."""
import os
import sys

import figures
import mesh_pictures as pictures
import numpy as np
from figures import Y, Panel
from projection_mesher import ProjectionMesherFilters as pm
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLookupTable
from vtkmodules.vtkFiltersCore import vtkCellCenters, vtkThreshold
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter

JUNCTION = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Testing", "Data", "pipe_junction_dirty.stl")
STAGES = ("OctreeDecompose", "PaintFront", "DummyLayer", "Project", "ResolveFeatures", "BoundaryRefine")
COLOURS = [pictures.COLOURS[i] for i in (2, 0, 1, 3, 4)]  # inlet, wall, outlet1 to 3
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


OTHERS = {"OctreeDecompose": octree, "BoundaryRefine": layers, "MeshValidity": validity}


def main(folder, names):
    for name in names or STAGES + ("MeshValidity",):
        rows = OTHERS[name]() if name in OTHERS else stage(name)
        figures.draw(rows, os.path.join(folder, name + ".png"))
        print(name, flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 2 or set(sys.argv[2:]) - set(STAGES) - set(OTHERS):
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
