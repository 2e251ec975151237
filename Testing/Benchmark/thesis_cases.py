# SPDX-License-Identifier: BSD-3-Clause
"""Meshes the thesis' test cases 2, 3 and 4 by Projection Mesh and writes a table of the meshes beside the thesis' own
numbers; see Docs/ThesisCases.md.

    pvpython thesis_cases.py OUT [NAME ...]

with the build's lib/python3/dist-packages on PYTHONPATH. OUT/NAME then holds geometry.stl, mesh.vtu, boundary.vtp and
polyMesh, OUT/table.md the rows of this run. Meshes have the one prism a wall face, as the thesis' have.
"""
import os
import sys

import numpy as np
from projection_mesher import ProjectionMesherFilters as pm
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import reference
from vtkmodules.vtkCommonDataModel import vtkGenericCell, vtkStaticCellLocator
from vtkmodules.vtkIOGeometry import vtkSTLWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "Python"))
import thesis_geometry as cases  # noqa: E402
import wall_smoothness  # noqa: E402


class Case:
    """thesis: (cells, boundary faces, largest angle), None for what it does not give."""

    def __init__(self, name, geometry, size, thesis=(None, None, None), domain=None, sharp=None):
        self.name, self.geometry, self.size, self.thesis = name, geometry, size, thesis
        self.domain, self.sharp = domain, sharp


BOWLS = ((0, 7007, 2923, 44.31), (15, 7756, 3432, 70.96), (30, 8052, 3670, 62.88), (45, 8190, 3782, 60.96),
         (60, 8207, 3905, 64.12))
CASES = [Case(f"bowl_{turn}", lambda turn=turn: cases.piston_bowl(turn), 0.003, numbers) for turn, *numbers in BOWLS]
CASES += [Case(f"bowl_{turn}_2mm", lambda turn=turn: cases.piston_bowl(turn), 0.002, numbers) for turn, *numbers in BOWLS]
CASES += [Case("port_coarse", cases.inlet_port, 0.0025),
          Case("port", cases.inlet_port, 0.001, (27404, 12357, None)),
          Case("port_half_coarse", lambda: cases.inlet_port(half=True), 0.0025),
          Case("port_half", lambda: cases.inlet_port(half=True), 0.001),
          Case("separating", cases.separating_models, 0.05, domain=cases.SEPARATING_DOMAIN, sharp=5)]
HEAD = ("| case | cells (thesis) | boundary faces (thesis) | largest angle internal / boundary (thesis) | worst eta internal "
        "/ boundary | wall within 0.05 l | sharp edges captured | normals off, median / 95% |\n|" + 8 * "---|")


def mesh_filter(case, geometry):
    mesh = pm.vtkProjectionMesh()
    mesh.SetInputDataObject(0, geometry)
    mesh.SetPatchArray("PatchId")
    mesh.SetFeatureSize(case.size)
    mesh.SetLayers(1)
    if case.sharp:
        mesh.SetSharpAngle(case.sharp)
    if case.domain:
        mesh.SetUseDomain(True)
        mesh.SetDomainBounds(*case.domain)
        mesh.SetRegion(1)  # outside
    return mesh


def share_near(boundary, geometry, distance):
    """Of the points, face centres and edge middles of the walls, the share within a distance of the geometry."""
    locator, cell = vtkStaticCellLocator(), vtkGenericCell()
    locator.SetDataSet(geometry)
    locator.BuildLocator()
    kinds = boundary.GetFieldData().GetAbstractArray("PatchTypes")
    patch = vtk_to_numpy(boundary.GetCellData().GetArray("PatchId"))
    points = vtk_to_numpy(boundary.GetPoints().GetData())
    ids, offsets = (vtk_to_numpy(a) for a in (boundary.GetPolys().GetConnectivityArray(),
                                              boundary.GetPolys().GetOffsetsArray()))
    places = []
    for face in np.flatnonzero([kinds.GetValue(int(p)) == "wall" for p in patch]):
        row = points[ids[offsets[face]:offsets[face + 1]]]
        places += [row, row.mean(axis=0)[None], 0.5 * (row + np.roll(row, -1, axis=0))]
    found, at, sub, square = [0.0] * 3, reference(0), reference(0), reference(0.0)
    places = np.unique(np.concatenate(places), axis=0)
    near = 0
    for place in places:
        locator.FindClosestPoint(place, found, cell, at, sub, square)
        near += square.get() <= distance ** 2
    return near / len(places)


def write(folder, geometry, mesh):
    os.makedirs(folder, exist_ok=True)
    stl = vtkSTLWriter()
    for writer, data, name in ((stl, geometry, "geometry.stl"),
                               (vtkXMLUnstructuredGridWriter(), mesh.GetOutputDataObject(0), "mesh.vtu"),
                               (vtkXMLPolyDataWriter(), mesh.GetOutputDataObject(1), "boundary.vtp")):
        writer.SetFileName(os.path.join(folder, name))
        writer.SetInputDataObject(data)
        (writer.SetFileTypeToBinary if writer is stl else writer.SetDataModeToBinary)()
        writer.Write()
    foam = pm.vtkPolyMeshWriter()
    foam.SetInputDataObject(mesh.GetOutputDataObject(0))
    foam.SetDirectory(os.path.join(folder, "polyMesh"))
    foam.Write()


def beside(value, thesis, form):
    return f"{value:{form}}" + (f" ({thesis:{form}})" if thesis else "")


def row(case, geometry, mesh):
    """One line of the table."""
    v = pm.vtkMeshValidity()
    v.SetInputDataObject(mesh.GetOutputDataObject(0))
    v.Update()
    if v.GetViolations():
        raise RuntimeError(f"{case.name}: {v.GetDescription()}")
    boundary = mesh.GetOutputDataObject(1)
    off = wall_smoothness.deviations(boundary, geometry, case.size, case.sharp or 30)
    captured = mesh.GetResolvedLength() / mesh.GetFeatureLength() if mesh.GetFeatureLength() else 1
    angles = f"{v.GetWorstAngleInternal():.1f} / {v.GetWorstAngleBoundary():.1f}"
    return " | ".join([
        f"| {case.name}", beside(mesh.GetOutputDataObject(0).GetNumberOfCells(), case.thesis[0], ","),
        beside(v.GetBoundaryFaces(), case.thesis[1], ","), angles + (f" ({case.thesis[2]:.1f})" if case.thesis[2] else ""),
        f"{v.GetWorstEtaInternal():.3f} / {v.GetWorstEtaBoundary():.3f}",
        f"{100 * share_near(boundary, geometry, 0.05 * case.size):.1f}%", f"{100 * captured:.1f}%",
        f"{np.median(off):.2f} / {np.percentile(off, 95):.2f} |"])


def main(folder, names):
    os.makedirs(folder, exist_ok=True)
    lines = [HEAD]
    for case in CASES:
        if names and case.name not in names:
            continue
        geometry = case.geometry()
        mesh = mesh_filter(case, geometry)
        mesh.Update()
        write(os.path.join(folder, case.name), geometry, mesh)
        lines.append(row(case, geometry, mesh))
        print(lines[-1], flush=True)
    with open(os.path.join(folder, "table.md"), "w", encoding="utf-8") as table:
        table.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
