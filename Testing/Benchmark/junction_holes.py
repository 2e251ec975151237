# SPDX-License-Identifier: BSD-3-Clause
"""Holes of several widths at several places of the pipe junction: are they found, and sealed when closed?

    pvpython junction_holes.py [--feature-size 0.0013] [--widths 0.5 1 1.5 2 2.5 3] [--models clean dirty] [--stage 2]

Prints a table row for each hole (widths in even cells of the feature size) as Docs/CloseHoles.md has them: whether the
punched geometry's inside leaks, where and how wide Close Holes finds the leak, and the volume of the mesh of the closed
geometry against that of the whole one, for Coarse To Fine and Offset. --stage 2 measures the front, 4 the projected mesh.
projection_mesher must be on PYTHONPATH.
"""
import argparse
import os
import sys

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkTriangleFilter

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.append(os.path.join(HERE, "..", "..", "Docs", "Examples"))
from leak_pictures import pm, read, triangle_surface  # noqa: E402  only now can it be found

MODELS = {"clean": "pipe_junction.stl", "dirty": "pipe_junction_dirty.stl"}
METHODS = {"Coarse To Fine": 1, "Offset": 2}


def places(size):
    """Centres of the balls: on the main pipe's side, in the middle of a flat end, on a branch one cell from its end."""
    return {"pipe wall": (0.075, 0.02, 0.0), "flat end": (0.05, 0.0, 0.0575), "near an edge": (0.05, -0.015, 0.0575 - size)}


def punched(surface, centre, diameter):
    """Without what lies in the ball; triangles at its border are quartered first, until the hole is round."""
    points = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)
    left, kept = points[vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)], []
    while len(left):
        middle = left.mean(axis=1)
        size = numpy.linalg.norm(left - middle[:, None], axis=2).sum(axis=1)
        distance = numpy.linalg.norm(middle - centre, axis=1)
        fine = (size < 0.1 * diameter) | (abs(distance - diameter / 2) > size)
        kept.append(left[fine & (distance > diameter / 2)])
        a, b, c = left[~fine].transpose(1, 0, 2)
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        left = numpy.concatenate([numpy.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    places = numpy.concatenate(kept).reshape(-1, 3)
    return triangle_surface(places, numpy.arange(len(places)))


def quietly(filter_):
    errors = []
    filter_.AddObserver("ErrorEvent", lambda *_: errors.append(1))
    filter_.AddObserver("WarningEvent", lambda *_: None)
    filter_.Update()
    return not errors


def volume(surface, size, stage):
    """Of the mesh of the inside; None when it leaks."""
    mesh = pm.vtkProjectionMesh()
    mesh.SetInputDataObject(0, surface)
    mesh.SetFeatureSize(size)
    mesh.SetSurfaceSize(size)
    mesh.SetStopAfter(stage)
    if not quietly(mesh):
        return None
    triangles = vtkTriangleFilter()
    triangles.SetInputData(mesh.GetOutputDataObject(1))
    triangles.Update()
    flat = triangles.GetOutput()
    points = vtk_to_numpy(flat.GetPoints().GetData()).astype(float)
    a, b, c = points[vtk_to_numpy(flat.GetPolys().GetConnectivityArray()).reshape(-1, 3)].transpose(1, 0, 2)
    return abs(numpy.einsum("ij,ij->i", a, numpy.cross(b, c)).sum()) / 6


def close(surface, size, method):
    holes = pm.vtkCloseHoles()
    holes.SetInputDataObject(0, surface)
    holes.SetFeatureSize(size)
    holes.SetSurfaceSize(size)
    holes.SetMethod(method)
    quietly(holes)
    return holes


def leaks(holes, centre, size):
    """Distance from the ball's centre and width of each leak, in cells."""
    table = holes.GetOutputDataObject(3)
    rows = []
    for row in range(table.GetNumberOfRows()):
        place = [table.GetColumnByName("Place").GetComponent(row, k) for k in range(3)]
        rows.append((numpy.linalg.norm(numpy.subtract(place, centre)) / size,
                     table.GetValueByName(row, "Width").ToDouble() / size))
    return rows


def table_row(model, name, width, surface, centre, options, whole):
    size = options.feature_size
    leaky = volume(surface, size, 2) is None
    found = leaks(close(surface, size, 0), centre, size)
    verdict = "found" if found else "no leak"
    if leaky != bool(found):
        verdict += ", WRONGLY" if not found else " but no cell passes"
    seen = "; ".join(f"{width:.2f} cells wide, {off:.1f} off" for off, width in found)
    closed = []
    for method in METHODS.values():
        sealed = volume(close(surface, size, method).GetOutputDataObject(0), size, options.stage) if found else None
        closed.append("" if not found else "leaks" if sealed is None else f"{100 * (sealed / whole - 1):+.2f}%")
    print(f"| {model} | {name} | {width:g} | {verdict} | {seen} | {' | '.join(closed)} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--feature-size", type=float, default=0.0013)
    parser.add_argument("--widths", type=float, nargs="+", default=[0.5, 1, 1.5, 2, 2.5, 3])
    parser.add_argument("--models", nargs="+", choices=MODELS, default=list(MODELS))
    parser.add_argument("--stage", type=int, default=2)
    options = parser.parse_args()
    print("| model | place | width | leak | " + " | ".join(["seen", *METHODS]) + " |\n|" + "---|" * 7)
    for model in options.models:
        surface = read(os.path.join(HERE, "..", "Data", MODELS[model]))
        whole = volume(surface, options.feature_size, options.stage)
        for name, centre in places(options.feature_size).items():
            for width in options.widths:
                table_row(model, name, width, punched(surface, centre, width * options.feature_size), centre, options,
                          whole)


if __name__ == "__main__":
    main()
