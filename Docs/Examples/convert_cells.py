# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of Docs/ConvertCells.md: convert_cells.py GEOMETRY FOLDER meshes a geometry with three layers and draws the
whole cells behind a plane as they are, as tetrahedra and as a hybrid. Run with pvpython and
build/lib/python3/dist-packages on PYTHONPATH; without a display, under xvfb-run."""
import os
import sys

import figures
import mesh_pictures as pictures
import numpy
import vtkmodules.vtkCommonCore  # noqa: F401  (VTK's core must load before modules built on it)
from projection_mesher import ProjectionMesherFilters as pm
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkCellCenters, vtkThreshold
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter

KINDS = {10: "tetrahedra", 14: "pyramids", 13: "wedges", 12: "hexahedra", 42: "polyhedra"}
COLOURS = ((0.88, 0.48, 0.37), (0.91, 0.76, 0.42), (0.41, 0.64, 0.48), (0.55, 0.72, 0.88), (0.63, 0.49, 0.72))
SIZE_OF_CELLS = 1 / 45  # of the geometry's longest edge
WINDOW = 0.2  # half width of what is shown, of that edge
NORMAL = (0.12, 1.0, -0.3)  # of the plane: askew to the octree, so that cells stand out of it


def cells_behind(grid):
    """Whole cells of the middle part whose centres lie behind a plane, with their kind as a cell array."""
    bounds = numpy.array(grid.GetBounds()).reshape(3, 2)
    middle, longest = bounds.mean(axis=1), (bounds[:, 1] - bounds[:, 0]).max()
    centres = vtkCellCenters()
    centres.SetInputData(grid)
    centres.Update()
    away = vtk_to_numpy(centres.GetOutput().GetPoints().GetData()) - middle
    shown = (away @ NORMAL > 0) & (numpy.abs(away[:, [0, 2]]) < WINDOW * longest).all(axis=1)
    place = {kind: i for i, kind in enumerate(KINDS)}
    kinds = numpy.array([place[t] for t in vtk_to_numpy(grid.GetCellTypesArray())], dtype=numpy.float32)
    marked = grid.NewInstance()
    marked.ShallowCopy(grid)
    for name, values in (("Shown", shown.astype(numpy.uint8)), ("Kind", kinds)):
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        marked.GetCellData().AddArray(array)
    threshold = vtkThreshold()
    threshold.SetInputData(marked)
    threshold.SetInputArrayToProcess(0, 0, 0, 1, "Shown")
    threshold.SetUpperThreshold(1)
    threshold.SetThresholdFunction(vtkThreshold.THRESHOLD_UPPER)
    skin = vtkGeometryFilter()
    skin.SetInputConnection(threshold.GetOutputPort())
    skin.Update()
    skin.GetOutput().GetCellData().SetActiveScalars("Kind")
    return skin.GetOutput()


def draw(grid, path):
    skin = cells_behind(grid)
    table = pictures.lookup(COLOURS, len(KINDS))
    cells = pictures.actor_of(skin, table)
    cells.GetProperty().EdgeVisibilityOn()
    cells.GetProperty().SetEdgeColor(*pictures.LINES)
    cells.GetProperty().SetAmbient(0.35)
    cells.GetProperty().SetDiffuse(0.7)
    names = list(KINDS.values())
    present = [int(i) for i in numpy.unique(vtk_to_numpy(skin.GetCellData().GetArray("Kind")))]
    renderer = pictures.new_renderer([cells] + pictures.legend(names, present, table))
    renderer.GetActiveCamera().ParallelProjectionOn()
    pictures.save(renderer, vtk_to_numpy(skin.GetPoints().GetData()), (-0.25, -1, 0.2), (0, 0, 1), path)
    figures.fewer_colours(path)


def main(geometry, folder):
    reader = pm.vtkSurfaceReader()
    reader.SetFileName(geometry)
    reader.Update()
    bounds = numpy.array(reader.GetOutputDataObject(0).GetBounds()).reshape(3, 2)
    mesh = pm.vtkProjectionMesh()
    mesh.SetInputConnection(reader.GetOutputPort())
    mesh.SetFeatureSize(SIZE_OF_CELLS * (bounds[:, 1] - bounds[:, 0]).max())
    mesh.SetLayers(3)
    cells = pm.vtkConvertCells()
    cells.SetInputConnection(mesh.GetOutputPort())
    for shapes, name in ((cells.TETRAHEDRA, "ConvertCells"), (cells.HYBRID, "ConvertCells_hybrid")):
        cells.SetCellShapes(shapes)
        cells.Update()
        print(f"{name}: {cells.GetOutput().GetNumberOfCells()} cells from {mesh.GetOutput().GetNumberOfCells()}, "
              f"skewness {cells.GetMaxSkewness():.2f}")
        draw(cells.GetOutput(), os.path.join(folder, name + ".png"))
    draw(mesh.GetOutput(), os.path.join(folder, "ConvertCells_input.png"))


if __name__ == "__main__":
    main(*sys.argv[1:])
