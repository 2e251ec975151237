# SPDX-License-Identifier: BSD-3-Clause
"""How much of the sharp edges of simple shapes in any position Projection Mesh resolves; see Docs/ResolveFeatures.md.

    pvpython rotated_shapes.py [--rotations 10] [--divisions 25] [--shapes cube ...]

Meshes each shape in that many random rotations (the same at every run) inside, with one layer and a feature size of its
unit length over `divisions`, for both values of FeatureDepth. Prints a table row for each: the least and the mean share
of the length of sharp edges that mesh edges lie on, corners with a mesh node, and cells on the average.
projection_mesher must be on PYTHONPATH.
"""
import argparse
import math
import random

from projection_mesher import ProjectionMesherFilters as pm
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPlane, vtkPlaneCollection, vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkFiltersCore import vtkCleanPolyData, vtkTriangleFilter
from vtkmodules.vtkFiltersGeneral import vtkClipClosedSurface, vtkTransformPolyDataFilter
from vtkmodules.vtkFiltersModeling import vtkLinearExtrusionFilter
from vtkmodules.vtkFiltersSources import vtkConeSource, vtkCubeSource, vtkCylinderSource, vtkSphereSource

DEPTHS = {"As Needed": 0, "Full": 1}
FACETS = 64


def triangles(source):
    filter_, clean = vtkTriangleFilter(), vtkCleanPolyData()
    clean.SetInputConnection(source.GetOutputPort())
    filter_.SetInputConnection(clean.GetOutputPort())
    filter_.Update()
    return filter_.GetOutput()


def cube():
    return triangles(vtkCubeSource())


def block():
    """An L of unit sides, one high."""
    corners = ((0.5, 0.4), (0.5, 1), (0, 1), (0, 0), (1, 0), (1, 0.4))
    points, polygon, flat = vtkPoints(), vtkCellArray(), vtkPolyData()
    polygon.InsertNextCell(len(corners), [points.InsertNextPoint(x, y, 0) for x, y in corners])
    flat.SetPoints(points)
    flat.SetPolys(polygon)
    prism = vtkLinearExtrusionFilter()
    prism.SetInputData(flat)
    return triangles(prism)


def cylinder():
    source = vtkCylinderSource()
    source.SetResolution(FACETS)
    return triangles(source)


def cone():
    """As high as its base is wide: 63 degrees at the rim."""
    source = vtkConeSource()
    source.SetResolution(FACETS)
    return triangles(source)


def cut_sphere():
    """Cut by three planes: a corner where they meet, and three on the sphere."""
    source, clip, planes = vtkSphereSource(), vtkClipClosedSurface(), vtkPlaneCollection()
    source.SetThetaResolution(FACETS)
    source.SetPhiResolution(FACETS // 2)
    source.SetOutputPointsPrecision(vtkAlgorithm.DOUBLE_PRECISION)
    for axis, place in enumerate((0.151, 0.103, 0.052)):
        plane = vtkPlane()
        plane.SetOrigin([place if a == axis else 0 for a in range(3)])
        plane.SetNormal([-1 if a == axis else 0 for a in range(3)])
        planes.AddItem(plane)
    clip.SetInputConnection(source.GetOutputPort())
    clip.SetClippingPlanes(planes)
    return triangles(clip)


SHAPES = {shape.__name__: shape for shape in (cube, block, cylinder, cone, cut_sphere)}


def turned(surface, seed):
    """By a rotation that is as likely as any other."""
    numbers = random.Random(seed)
    w, *axis = (numbers.gauss(0, 1) for _ in range(4))
    turn, filter_ = vtkTransform(), vtkTransformPolyDataFilter()
    turn.RotateWXYZ(math.degrees(2 * math.atan2(math.hypot(*axis), w)), axis)
    filter_.SetTransform(turn)
    filter_.SetInputData(surface)
    filter_.Update()
    return filter_.GetOutput()


def resolved(surface, size, depth):
    """Share of the length, corners hit, corners, cells."""
    mesh = pm.vtkProjectionMesh()
    mesh.SetInputDataObject(0, surface)
    mesh.SetFeatureSize(size)
    mesh.SetFeatureDepth(depth)
    mesh.SetLayers(1)
    mesh.Update()
    return (mesh.GetResolvedLength() / mesh.GetFeatureLength(), mesh.GetResolvedCorners(), mesh.GetCorners(),
            mesh.GetOutputDataObject(0).GetNumberOfCells())


def table_row(name, depth, options):
    surface = SHAPES[name]()
    runs = [resolved(turned(surface, seed), 1 / options.divisions, DEPTHS[depth]) for seed in range(options.rotations)]
    shares, hit, corners, cells = zip(*runs)
    print(f"| {name.replace('_', ' ')} | {depth} | {100 * min(shares):.1f}% | {100 * sum(shares) / len(shares):.1f}% "
          f"| {sum(hit)} of {sum(corners)} | {sum(cells) // len(cells):,} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rotations", type=int, default=10)
    parser.add_argument("--divisions", type=float, default=25)
    parser.add_argument("--shapes", nargs="+", choices=SHAPES, default=list(SHAPES))
    options = parser.parse_args()
    print("| shape | `FeatureDepth` | least | mean | corners | cells |\n|" + "---|" * 6)
    for name in options.shapes:
        for depth in DEPTHS:
            table_row(name, depth, options)


if __name__ == "__main__":
    main()
