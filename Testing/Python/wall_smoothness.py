# SPDX-License-Identifier: BSD-3-Clause
"""How smooth a mesh's wall is: the angle between each wall face and the geometry at the point closest to its centre.

    pvpython wall_smoothness.py BOUNDARY.vtp GEOMETRY L [PATTERN]

L is the feature size; PATTERN, a regular expression, picks patches by name. Faces within 2 L of a sharp edge of the
geometry are left out: there two normals are right. The geometry may be dirty: its triangles may be turned either way.
"""
import re
import sys

import numpy as np
import vtkmodules.vtkCommonCore  # noqa: F401  (VTK's core must load before modules built on it)
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import reference, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkGenericCell, vtkPolyData, vtkStaticCellLocator


def faces_of(boundary, pattern=""):
    """(ids, centres, unit normals) of the wall faces whose patches' names the pattern matches; the normal is that of
    the polygon, half the sum of the cross products around it."""
    names, kinds = (boundary.GetFieldData().GetAbstractArray(n) for n in ("PatchNames", "PatchTypes"))
    wanted = [kinds.GetValue(i) == "wall" and bool(re.search(pattern, names.GetValue(i)))
              for i in range(names.GetNumberOfValues())]
    patch = vtk_to_numpy(boundary.GetCellData().GetArray("PatchId"))
    points = vtk_to_numpy(boundary.GetPoints().GetData()).astype(float)
    ids = vtk_to_numpy(boundary.GetPolys().GetConnectivityArray())
    offsets = vtk_to_numpy(boundary.GetPolys().GetOffsetsArray())
    lengths = np.diff(offsets)
    following = np.arange(len(ids)) + 1
    following[offsets[1:] - 1] = offsets[:-1]
    centre = np.add.reduceat(points[ids], offsets[:-1]) / lengths[:, None]
    rim = points[ids] - np.repeat(centre, lengths, axis=0)
    normal = np.add.reduceat(np.cross(rim, rim[following]), offsets[:-1])
    keep = np.array(wanted)[patch]
    return np.flatnonzero(keep), centre[keep], normal[keep] / np.linalg.norm(normal[keep], axis=1)[:, None]


def sharp_edges(geometry, angle):
    """The geometry's sharp edges as lines, None when it has none. Points at the same place are one, repeated triangles
    too; whether two triangles are turned alike is seen from how they run along their edge."""
    points, index = np.unique(vtk_to_numpy(geometry.GetPoints().GetData()), axis=0, return_inverse=True)
    triangles = index.reshape(-1)[vtk_to_numpy(geometry.GetPolys().GetConnectivityArray()).reshape(-1, 3)]
    triangles = triangles[np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)[1]]
    normals = np.tile(normals_of(points.astype(float), triangles), (3, 1))
    ends = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    normals[ends[:, 0] > ends[:, 1]] *= -1
    rows, edge, count = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True, return_counts=True)
    edge = edge.reshape(-1)
    order = np.argsort(edge, kind="stable")
    first = order[np.concatenate([[0], np.cumsum(count)[:-1]])]
    cosine = -np.einsum("ij,ij->i", normals, normals[first][edge])  # neighbours run the other way
    cosine[first] = 1
    lowest = np.ones(len(rows))
    np.minimum.at(lowest, edge, cosine)
    rows = rows[lowest < np.cos(np.radians(angle))]
    if not len(rows):
        return None
    lines, place, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    place.SetData(numpy_to_vtk(points, deep=True))
    cells.SetData(numpy_to_vtkIdTypeArray(np.arange(0, 2 * len(rows) + 1, 2), deep=True),
                  numpy_to_vtkIdTypeArray(np.ascontiguousarray(rows).ravel(), deep=True))
    lines.SetPoints(place)
    lines.SetLines(cells)
    return lines


class Closest:
    """Closest points of a surface or of lines."""

    def __init__(self, data):
        self.locator = vtkStaticCellLocator()
        self.locator.SetDataSet(data)
        self.locator.BuildLocator()
        self.cell = vtkGenericCell()

    def find(self, place):
        """(distance, cell)"""
        at, sub, square, found = reference(0), reference(0), reference(0.0), [0.0] * 3
        self.locator.FindClosestPoint(place, found, self.cell, at, sub, square)
        return np.sqrt(square.get()), at.get()


def normals_of(points, triangles):
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    return normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]


def unit_normals(geometry):
    return normals_of(vtk_to_numpy(geometry.GetPoints().GetData()).astype(float),
                      vtk_to_numpy(geometry.GetPolys().GetConnectivityArray()).reshape(-1, 3))


def face_deviations(boundary, geometry, size, sharp=30.0, pattern=""):
    """Degrees for each face of the boundary; -1 where it is no wall, not of the pattern, or within 2 sizes of a sharp
    edge. geometry: triangles."""
    ids, centres, normals = faces_of(boundary, pattern)
    surface, of_triangle, edges = Closest(geometry), unit_normals(geometry), sharp_edges(geometry, sharp)
    if edges:
        sharps = Closest(edges)
        far = np.array([sharps.find(c)[0] > 2 * size for c in centres], dtype=bool)
        ids, centres, normals = ids[far], centres[far], normals[far]
    triangle = np.array([surface.find(c)[1] for c in centres], dtype=int)
    cosine = np.abs(np.einsum("ij,ij->i", normals, of_triangle[triangle]))
    every = np.full(boundary.GetNumberOfPolys(), -1.0)
    every[ids] = np.degrees(np.arccos(np.clip(cosine, 0, 1)))
    return every


def deviations(boundary, geometry, size, sharp=30.0, pattern=""):
    """The same without the faces that do not count."""
    every = face_deviations(boundary, geometry, size, sharp, pattern)
    return every[every >= 0]


def main(boundary_file, geometry_file, size, pattern=""):
    from projection_mesher import ProjectionMesherFilters as pm
    from vtkmodules.vtkFiltersCore import vtkTriangleFilter
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
    boundary, reader, triangles = vtkXMLPolyDataReader(), pm.vtkSurfaceReader(), vtkTriangleFilter()
    boundary.SetFileName(boundary_file)
    boundary.Update()
    reader.SetFileName(geometry_file)
    triangles.SetInputConnection(reader.GetOutputPort())
    triangles.Update()
    off = deviations(boundary.GetOutput(), triangles.GetOutput(), float(size), pattern=pattern)
    print(f"{len(off):,} faces: median {np.median(off):.2f} deg, 95% below {np.percentile(off, 95):.2f} deg")


if __name__ == "__main__":
    main(*sys.argv[1:])
