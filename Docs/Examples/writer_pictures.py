# SPDX-License-Identifier: BSD-3-Clause
"""A mesh written and read back, for the page of the writers:

    writer_pictures.py PLUGIN GEOMETRY FEATURE_SIZE PICTURE

Meshes the geometry with two boundary layers. Left: the boundary as an STL file, each solid in its colour. Right: half of the
cells of the Fluent mesh file, as ParaView's reader knows them. Run with pvpython; without a display, under xvfb-run."""
import os
import sys
import tempfile

from paraview.simple import (Clip, ColorBy, CreateLayout, CreateView, FluentCaseReader, GetLookupTableForArray, LoadPlugin,
                             OutputPort, SaveData, SaveScreenshot, Show)

SIZE = (700, 560)
COLOURS = ((0.88, 0.48, 0.37), (0.72, 0.76, 0.80), (0.41, 0.64, 0.48), (0.33, 0.53, 0.75), (0.91, 0.76, 0.42))


def new_view():
    view = CreateView("RenderView")
    view.OrientationAxesVisibility = 0
    view.UseColorPaletteForBackground = 0
    view.Background = [0.96, 0.96, 0.95]
    return view


def show(data, view):
    shown = Show(data, view)
    shown.Representation = "Surface With Edges"
    shown.EdgeColor = [0.16, 0.18, 0.21]
    shown.Ambient, shown.Diffuse = 0.35, 0.7
    shown.AmbientColor = shown.DiffuseColor = [0.80, 0.86, 0.91]
    return shown


def look_at(view, data):
    x0, x1, y0, y1, z0, z1 = data.GetDataInformation().GetBounds()
    centre = [(x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2]
    size = max(x1 - x0, y1 - y0, z1 - z0)
    view.CameraFocalPoint = centre
    view.CameraPosition = [centre[0] - 1.1 * size, centre[1] - 1.45 * size, centre[2] + 0.75 * size]
    view.CameraViewUp = [0, 0, 1]
    view.CameraViewAngle = 30


def colour_patches(shown):
    ColorBy(shown, ("CELLS", "PatchId"))
    table = GetLookupTableForArray("PatchId", 1)
    table.InterpretValuesAsCategories = 1
    table.Annotations = [text for i in range(len(COLOURS)) for text in (str(i), str(i))]
    table.IndexedColors = [value for colour in COLOURS for value in colour]


def main(plugin, geometry, size, picture):
    filters = {"": None}  # paraview.simple fills only a namespace that is not empty
    LoadPlugin(plugin, remote=False, ns=filters)
    mesh = filters["ProjectionMesh"](Geometry=filters["SurfaceReader"](FileName=geometry), FeatureSize=float(size), Layers=2)
    with tempfile.TemporaryDirectory() as folder:
        stl, msh = os.path.join(folder, "boundary.stl"), os.path.join(folder, "mesh.msh")
        filters["SurfaceWriter"](Input=OutputPort(mesh, 1), FileName=stl).UpdatePipeline()
        SaveData(msh, proxy=OutputPort(mesh, 0))
        surface, cells = filters["SurfaceReader"](FileName=stl), FluentCaseReader(FileName=msh)
        half = Clip(Input=cells, Crinkleclip=1)
        half.ClipType.Normal = [0, -1, 0]
        half.ClipType.Origin = [0, 0, 0]
        half.Invert = 1
        layout = CreateLayout("files")
        left, right = new_view(), new_view()
        layout.AssignView(layout.SplitHorizontal(0, 0.5), left)
        layout.AssignView(2, right)
        colour_patches(show(surface, left))
        show(half, right)
        for view in (left, right):
            look_at(view, surface)
        SaveScreenshot(picture, layout, ImageResolution=[2 * SIZE[0], SIZE[1]])


if __name__ == "__main__":
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    main(*sys.argv[1:])
