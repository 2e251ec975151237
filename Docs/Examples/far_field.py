# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of Docs/FarField.md: far_field.py FOLDER meshes the outside of a sphere in a small box and extends it to a
half sphere and to a long box. Run with pvpython and build/lib/python3/dist-packages on PYTHONPATH; without a display,
under xvfb-run."""
import os
import sys

import mesh_pictures as pictures
import numpy
import vtkmodules.vtkCommonCore  # noqa: F401  (VTK's core must load before modules built on it)
from projection_mesher import ProjectionMesherFilters as pm
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersSources import vtkSphereSource

DOMAIN = (-1.5, 1.5, -1.5, 1.5, -1.5, 1.5)
FAR_COLOURS = ((0.55, 0.72, 0.88), (0.97, 0.93, 0.85))  # cells of the inner mesh, far cells


def inner_mesh():
    sphere = vtkSphereSource()
    sphere.SetThetaResolution(48)
    sphere.SetPhiResolution(48)
    mesh = pm.vtkProjectionMesh()
    mesh.SetInputConnection(sphere.GetOutputPort())
    mesh.SetFeatureSize(0.125)
    mesh.SetBaseSize(0.5)
    mesh.SetUseDomain(True)
    mesh.SetDomainBounds(*DOMAIN)
    mesh.SetRegion(1)
    mesh.Update()
    return mesh


def draw(far, inner_cells, path):
    """path.png, the boundary, and path_section.png, the plane y = 0."""
    boundary = far.GetOutputDataObject(1)
    names = [boundary.GetFieldData().GetAbstractArray("PatchNames").GetValue(i)
             for i in range(boundary.GetFieldData().GetAbstractArray("PatchNames").GetNumberOfValues())]
    present = [int(i) for i in numpy.unique(vtk_to_numpy(boundary.GetCellData().GetArray("PatchId")))]
    outside = [i for i in present if names[i] != "wall"]
    pictures.surface(pictures.only_patches(boundary, outside), names, outside, path + ".png")

    cut = pictures.cut_grid(far.GetOutput(), 1, 0)
    pictures.colour_cells(cut, vtk_to_numpy(cut.GetCellData().GetArray("vtkOriginalCellIds")) >= inner_cells)
    renderer = pictures.new_renderer(pictures.section_actors(cut, FAR_COLOURS))
    renderer.GetActiveCamera().ParallelProjectionOn()
    pictures.save(renderer, vtk_to_numpy(cut.GetPoints().GetData()), (0, -1, 0), (0, 0, 1), path + "_section.png")


def main(folder):
    mesh = inner_mesh()
    far = pm.vtkFarField()
    far.SetInputConnection(mesh.GetOutputPort())
    far.SetExtendZmin(False)
    for name, shape in (("FarField", 1), ("FarField_box", 0)):
        far.SetShape(shape)
        far.SetRadius(8)
        far.SetUseBounds(True)
        far.SetFarBounds(-6, 14, -5, 5, -1.5, 6)
        far.Update()
        inner_cells = mesh.GetOutput().GetNumberOfCells()
        print(f"{name}: {inner_cells} cells and {far.GetFarCells()} far cells in {far.GetFarLayers()} layers")
        draw(far, inner_cells, os.path.join(folder, name))


if __name__ == "__main__":
    main(sys.argv[1])
