# SPDX-License-Identifier: BSD-3-Clause
"""How quickly Octree Decompose and Paint Front follow a change of the feature size, measured as in ParaView:

    preview.py PLUGIN GEOMETRY [--domain xmin xmax ymin ymax zmin zmax] [--sizes L ...] [--picture FILE]

Run with pvpython; for the picture, without a display, under xvfb-run. The table gives seconds by the clock and seconds of
work (all processors together) of each filter, for each size; the first row includes preparing the geometry."""
import argparse
import os
import time

from paraview.simple import ColorBy, CreateView, GetColorTransferFunction, LoadPlugin, OutputPort, SaveScreenshot, Show


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("plugin")
    parser.add_argument("geometry")
    parser.add_argument("--domain", nargs=6, type=float)
    parser.add_argument("--base", type=float, default=0, help="base size")
    parser.add_argument("--sizes", nargs="+", type=float, default=[1 / 8, 1 / 16, 1 / 32, 1 / 64, 1 / 32])
    parser.add_argument("--invisible", action="store_true", help="let Paint Front look for invisible passages too")
    parser.add_argument("--picture")
    return parser.parse_args()


def timed(proxy):
    """(seconds by the clock, seconds of work) of an update."""
    before, start = os.times(), time.perf_counter()
    proxy.UpdatePipeline()
    after = os.times()
    return time.perf_counter() - start, after.user + after.system - before.user - before.system


def pipeline(options, filters):
    geometry = filters["SurfaceReader"](FileName=options.geometry)
    octree = filters["OctreeDecompose"](Geometry=geometry)
    front = filters["PaintFront"](Input=octree, Geometry=geometry)
    octree.BaseSize = options.base
    front.ReportInvisible = options.invisible
    if options.domain:
        octree.UseDomain = 1
        octree.DomainBounds = options.domain
        front.Region = "Outside"
    geometry.UpdatePipeline()
    return octree, front


def measure(octree, front, sizes):
    print("    size     leaves      cells   octree s (work)    front s (work)     both s")
    for size in sizes:
        octree.FeatureSize = size
        (clock, work), (front_clock, front_work) = timed(octree), timed(front)
        leaves, cells = (p.GetDataInformation().GetNumberOfCells() for p in (octree, front))
        print(f"{size:8.5f} {leaves:10d} {cells:10d} {clock:9.2f} ({work:.2f}) {front_clock:10.2f} ({front_work:.2f}) "
              f"{clock + front_clock:10.2f}", flush=True)


def draw(front, cut, path):
    """cut: a Mesh Slice of the front."""
    view = CreateView("RenderView")
    view.ViewSize = [1400, 900]
    view.OrientationAxesVisibility = 0
    view.UseColorPaletteForBackground = 0
    view.Background = [0.96, 0.96, 0.95]
    bounds = front.GetDataInformation().GetBounds()
    middle = [(bounds[2 * a] + bounds[2 * a + 1]) / 2 for a in range(3)]
    cut.Plane.Origin, cut.Plane.Normal = middle, [0, 1, 0]
    shown = Show(cut, view)
    ColorBy(shown, ("CELLS", "Level"))
    shown.Ambient, shown.Diffuse = 1, 0  # the colours as they are
    shown.EdgeColor = [0.16, 0.18, 0.21]
    shown.RescaleTransferFunctionToDataRange(False, True)
    GetColorTransferFunction("Level").ApplyPreset("Cool to Warm", True)
    view.CameraPosition = [middle[0], bounds[2] - 10 * (bounds[3] - bounds[2]), middle[2]]
    view.CameraFocalPoint = middle
    view.CameraViewUp = [0, 0, 1]
    view.CameraParallelProjection = 1
    view.CameraParallelScale = 0.55 * max(bounds[5] - bounds[4], (bounds[1] - bounds[0]) * 9 / 14)
    SaveScreenshot(path, view)


def main():
    options = arguments()
    filters = {"": None}  # paraview.simple fills only a namespace that is not empty
    LoadPlugin(options.plugin, remote=False, ns=filters)
    octree, front = pipeline(options, filters)
    measure(octree, front, options.sizes)
    if options.picture:
        mesh = OutputPort(front, 0)
        draw(mesh, filters["MeshSlice"](Input=mesh), options.picture)


if __name__ == "__main__":
    main()
