# SPDX-License-Identifier: BSD-3-Clause
"""How smooth the walls of meshed spheres and cylinders are, and of OpenFOAM's motorBike where the environment variable
PROJECTIONMESHER_MOTORBIKE names its file; see Docs/ThesisCases.md.

    pvpython smoothness_cases.py OUT

writes OUT/smoothness.md and OUT/NAME/boundary.vtp, with the degrees of each wall face in the cell array NormalDeviation
(-1: near a sharp edge).
"""
import os
import sys

import numpy as np
from projection_mesher import ProjectionMesherFilters as pm
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkFiltersSources import vtkCylinderSource, vtkSphereSource
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "Python"))
import wall_smoothness  # noqa: E402

FAIRING = r"^frt-fairing%|^frt-fairing:001%"
BIKE_SIZE = 1 / 64


def triangles(source):
    filter_ = vtkTriangleFilter()
    filter_.SetInputConnection(source.GetOutputPort())
    filter_.Update()
    return filter_.GetOutput()


def sphere():
    """Of radius 1, with facets of 1 degree."""
    source = vtkSphereSource()
    source.SetRadius(1)
    source.SetThetaResolution(360)
    source.SetPhiResolution(180)
    return triangles(source)


def cylinder():
    source = vtkCylinderSource()
    source.SetRadius(1)
    source.SetHeight(4)
    source.SetResolution(360)
    return triangles(source)


def bike():
    reader = pm.vtkSurfaceReader()
    reader.SetFileName(os.environ["PROJECTIONMESHER_MOTORBIKE"])
    return triangles(reader)


def mesh(geometry, size):
    filter_ = pm.vtkProjectionMesh()
    filter_.SetInputDataObject(0, geometry)
    filter_.SetFeatureSize(size)
    filter_.SetLayers(1)
    return filter_


def even_mesh(geometry, size):
    """Cells of one size, so that the wall's smoothness, not where the octree saves cells, is seen."""
    filter_ = mesh(geometry, size)
    filter_.SetBaseSize(size)
    return filter_


def bike_mesh(geometry, size):
    """As OpenFOAM's own case has it."""
    filter_ = mesh(geometry, size)
    filter_.SetPatchArray("PatchId")
    filter_.SetUseDomain(True)
    filter_.SetDomainBounds(-5, 15, -4, 4, 0, 8)
    filter_.AddRefineBox(-1, 8, -0.7, 0.7, 0, 2.5, 1 / 16)
    filter_.SetRegion(1)  # outside
    return filter_


def main(folder):
    cases = [(f"{shape.__name__}_{size}", shape, size, even_mesh, "") for shape in (sphere, cylinder)
             for size in (0.2, 0.1, 0.05)]
    if "PROJECTIONMESHER_MOTORBIKE" in os.environ:
        cases.append(("motorBike_fairing", bike, BIKE_SIZE, bike_mesh, FAIRING))
    lines = ["| case | faces | median | 95% | 99% | largest |\n|---|---|---|---|---|---|"]
    for name, shape, size, make, pattern in cases:
        geometry = shape()
        filter_ = make(geometry, size)
        filter_.Update()
        boundary = filter_.GetOutputDataObject(1)
        every = wall_smoothness.face_deviations(boundary, geometry, size, pattern=pattern)
        off = every[every >= 0]
        lines.append(f"| {name} | {len(off):,} | " + " | ".join(f"{np.percentile(off, q):.2f}" for q in (50, 95, 99, 100)) + " |")
        print(lines[-1], flush=True)
        array = numpy_to_vtk(every, deep=True)
        array.SetName("NormalDeviation")
        boundary.GetCellData().AddArray(array)
        os.makedirs(os.path.join(folder, name), exist_ok=True)
        writer = vtkXMLPolyDataWriter()
        writer.SetFileName(os.path.join(folder, name, "boundary.vtp"))
        writer.SetInputDataObject(boundary)
        writer.SetDataModeToBinary()
        writer.Write()
    with open(os.path.join(folder, "smoothness.md"), "w", encoding="utf-8") as table:
        table.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(sys.argv[1])
