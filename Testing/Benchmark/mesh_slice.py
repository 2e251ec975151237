# SPDX-License-Identifier: BSD-3-Clause
"""Mesh Slice beside ParaView's Slice and VTK's cutter, on planes square to each axis through the middle of a mesh and through
the points nearest to it:

    pvpython mesh_slice.py MESH.vtu

with the build's lib/python3/dist-packages on PYTHONPATH. Seconds by the clock and, in brackets, of work (all processors
together), medians of five runs that take turns; the area each section has, and the ratio of ParaView's time to ours."""
import os
import statistics
import sys
import time

import numpy as np
from paraview.simple import Slice, TrivialProducer
from projection_mesher import ProjectionMesherFilters as pm
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPlane
from vtkmodules.vtkFiltersCore import vtkCutter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

RUNS = 5


class Cut:
    """One way to cut, with the times of its runs; algorithm(): a new filter, input connected and plane set."""

    def __init__(self, name, algorithm):
        self.name, self.algorithm, self.clock, self.work, self.output = name, algorithm, [], [], None

    def run(self):
        algorithm = self.algorithm()
        before, start = os.times(), time.perf_counter()
        algorithm.Update()
        self.clock.append(time.perf_counter() - start)
        after = os.times()
        self.work.append(after.user + after.system - before.user - before.system)
        self.output = algorithm.GetOutputDataObject(0)

    def row(self, where, normal, best):
        clock, work = statistics.median(self.clock), statistics.median(self.work)
        return (f"| {where} | {self.name} | {clock:.3f} ({work:.3f}) | {clock / best:.1f} | "
                f"{self.output.GetNumberOfCells():,} | {area(self.output, normal):.6g} |")


def area(cut, normal):
    if cut.GetNumberOfPolys() == 0:
        return 0.0
    points = vtk_to_numpy(cut.GetPoints().GetData()).astype(float)
    corners = vtk_to_numpy(cut.GetPolys().GetConnectivityArray())
    offsets = vtk_to_numpy(cut.GetPolys().GetOffsetsArray())
    after = np.arange(len(corners)) + 1
    after[offsets[1:] - 1] = offsets[:-1]
    turns = np.cross(points[corners], points[corners[after]]) @ normal
    return 0.5 * np.abs(np.add.reduceat(turns, offsets[:-1])).sum()  # VTK's polygons run either way


def cuts(grid, plane):
    producer = TrivialProducer()
    producer.GetClientSideObject().SetOutput(grid)

    def paraview():
        proxy = Slice(Input=producer, Triangulatetheslice=0)
        proxy.SliceType.Origin, proxy.SliceType.Normal = plane.GetOrigin(), plane.GetNormal()
        proxy.UpdateVTKObjects()
        return proxy.GetClientSideObject()

    def cutter():
        algorithm = vtkCutter()
        algorithm.SetCutFunction(plane)
        algorithm.SetInputData(grid)
        algorithm.GenerateTrianglesOff()
        return algorithm

    def ours():
        algorithm = pm.vtkMeshSlice()
        algorithm.SetPlane(plane)
        algorithm.SetInputData(grid)
        return algorithm

    return [Cut("Slice", paraview), Cut("vtkCutter", cutter), Cut("Mesh Slice", ours)]


def planes(grid):
    bounds, points = grid.GetBounds(), vtk_to_numpy(grid.GetPoints().GetData())
    for axis in range(3):
        middle = (bounds[2 * axis] + bounds[2 * axis + 1]) / 2
        at, count = np.unique(points[:, axis], return_counts=True)
        common = at[count > 0.1 * count.max()]
        node = common[np.argmin(np.abs(common - middle))]
        for position in (node, node + 1e-3 * (bounds[2 * axis + 1] - bounds[2 * axis])):
            plane, normal = vtkPlane(), np.eye(3)[axis]
            plane.SetNormal(*normal)
            plane.SetOrigin(*(position * normal))
            yield f"{'xyz'[axis]} = {position:.6g}" + (", through points" if position == node else ""), normal, plane


def main(path):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutput()
    kinds, counts = np.unique(vtk_to_numpy(grid.GetCellTypesArray()), return_counts=True)
    print(f"{grid.GetNumberOfCells():,} cells; VTK type: count {dict(zip(kinds.tolist(), counts.tolist()))}\n")
    print("| plane | by | seconds | of Mesh Slice's | polygons | area |\n|---|---|---|---|---|---|")
    for where, normal, plane in planes(grid):
        ways = cuts(grid, plane)
        for _ in range(RUNS):
            for way in ways:
                way.run()
        best = statistics.median(ways[-1].clock)
        for way in ways:
            print(way.row(where, normal, best), flush=True)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    main(sys.argv[1])
