# SPDX-License-Identifier: BSD-3-Clause
"""The picture of Docs/PlanarMesh.md: planar_mesh.py FOLDER meshes the air around an aerofoil (NACA 0012, at 8 degrees) that
stands through its domain, and draws the section of the mesh. Run with pvpython and build/lib/python3/dist-packages on
PYTHONPATH; without a display, under xvfb-run."""
import os
import sys

import mesh_pictures as pictures
import numpy
import vtkmodules.vtkCommonCore  # noqa: F401  (VTK's core must load before modules built on it)
from projection_mesher import ProjectionMesherFilters as pm
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

STATIONS = 60  # on each of the aerofoil's sides
ANGLE = 8.0  # degrees
SIZE = 0.0025  # of the smallest cells, at the trailing edge; the chord is 1
SHOWN = numpy.array(((-0.1, -0.25, 0), (1.1, 0.25, 0)))


def aerofoil():
    """Points around a NACA 0012 of chord 1, from the trailing edge over the upper side."""
    x = 0.5 * (1 + numpy.cos(numpy.linspace(0, numpy.pi, STATIONS)))
    half = 0.6 * (0.2969 * numpy.sqrt(x) - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    around = numpy.concatenate([numpy.column_stack([x, half]), numpy.column_stack([x, -half])[::-1][1:-1]])
    turn = numpy.radians(-ANGLE)
    return around @ numpy.array([[numpy.cos(turn), numpy.sin(turn)], [-numpy.sin(turn), numpy.cos(turn)]])


def thickened(outline, low, high):
    """The outline's prism between two heights, with its ends."""
    count = len(outline)
    points, cells = vtkPoints(), vtkCellArray()
    for height in (low, high):
        for x, y in outline:
            points.InsertNextPoint(x, y, height)
    for i in range(count):
        j = (i + 1) % count
        cells.InsertNextCell(4, (i, j, j + count, i + count))
    cells.InsertNextCell(count, tuple(reversed(range(count))))
    cells.InsertNextCell(count, tuple(range(count, 2 * count)))
    surface = vtkPolyData()
    surface.SetPoints(points)
    surface.SetPolys(cells)
    return surface


def section_of_mesh():
    """The planar mesh of the air around the aerofoil."""
    mesh = pm.vtkProjectionMesh()
    mesh.SetInputData(thickened(aerofoil(), -1, 1))
    mesh.SetFeatureSize(SIZE)
    mesh.SetBaseSize(0.16)
    mesh.SetUseDomain(True)
    mesh.SetDomainBounds(-1, 3, -1.28, 1.28, -0.08, 0.08)
    mesh.SetRegion(1)
    mesh.SetLayers(4)
    section = pm.vtkPlanarMesh()
    section.SetInputConnection(mesh.GetOutputPort())
    section.Update()
    return section


def front_faces(section, layers):
    """The faces of the patch front, coloured by whether their cells are layer cells; they are in the order of the cells."""
    boundary = section.GetOutputDataObject(1)
    names = boundary.GetFieldData().GetAbstractArray("PatchNames")
    front = pictures.only_patches(boundary, [names.GetNumberOfValues() - 1])
    pictures.colour_cells(front, layers)
    return front


def draw(front, path):
    faces, lines = pictures.section_actors(front)
    lines.SetPosition(0, 0, SIZE)
    renderer = pictures.new_renderer([faces, lines])
    renderer.GetActiveCamera().ParallelProjectionOn()
    pictures.save(renderer, SHOWN, (0, 0, 1), (0, 1, 0), path)


def main(folder):
    section = section_of_mesh()
    layers = vtk_to_numpy(section.GetOutput().GetCellData().GetArray("Layer")) > 0
    draw(front_faces(section, layers), os.path.join(folder, "PlanarMesh.png"))
    print(f"{section.GetOutput().GetNumberOfCells()} cells, of those {int(layers.sum())} in layers")


if __name__ == "__main__":
    main(sys.argv[1])
