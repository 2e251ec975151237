# SPDX-License-Identifier: BSD-3-Clause
"""The pipeline that Docs/Images/paraview.png shows in ParaView's window: the six stages on the dirty pipe junction, the wall of
the mesh, and a section of it. To see it, in the project's folder:

    paraview --plugin-search-paths=build/lib/paraview/plugins/ProjectionMesher --plugins=ProjectionMesher \\
        --script=Docs/Examples/paraview_window.py

The picture is a photograph of that window, with the menu Filters > Projection Mesher open."""
from paraview import simple
from paraview.simple import (BoundaryRefine, ColorBy, DummyLayer, GetActiveViewOrCreate, MeshSlice, OctreeDecompose, OutputPort,
                             PaintFront, Project, Render, ResolveFeatures, SetActiveSource, Show, SurfaceReader)

GEOMETRY = "Testing/Data/pipe_junction_dirty.stl"
FROM = (-0.45, -0.8, 0.4)
PATCHES = ((0.41, 0.64, 0.48), (0.72, 0.76, 0.80), (0.88, 0.48, 0.37), (0.33, 0.53, 0.75), (0.91, 0.76, 0.42))


def stages():
    """The six filters, each on the one before."""
    geometry = SurfaceReader(registrationName="pipe_junction_dirty.stl", FileName=GEOMETRY)
    octree = OctreeDecompose(registrationName="OctreeDecompose", Geometry=geometry, FeatureSize=0.003)
    front = PaintFront(registrationName="PaintFront", Input=octree, Geometry=geometry)
    layer = DummyLayer(registrationName="DummyLayer", Input=OutputPort(front, 0))
    projected = Project(registrationName="Project", Input=OutputPort(layer, 0), Geometry=geometry)
    features = ResolveFeatures(registrationName="ResolveFeatures", Input=OutputPort(projected, 0), Geometry=geometry)
    return BoundaryRefine(registrationName="BoundaryRefine", Input=OutputPort(features, 0), Layers=5)


def show(data, view, array, colours, ambient):
    shown = Show(data, view)
    shown.Ambient, shown.Diffuse = ambient, 1 - ambient
    shown.Representation = "Surface With Edges"
    shown.EdgeColor = [0.16, 0.18, 0.21]
    ColorBy(shown, ("CELLS", array))
    table = simple.GetColorTransferFunction(array)
    table.InterpretValuesAsCategories = 1
    table.Annotations = [text for i in range(len(colours)) for text in (str(i), str(i))]
    table.IndexedColors = [part for colour in colours for part in colour]
    shown.SetScalarBarVisibility(view, False)
    return shown


def main():
    mesh = stages()
    section = MeshSlice(registrationName="MeshSlice", Input=OutputPort(mesh, 0))
    section.Plane.Origin, section.Plane.Normal = [0.0, 0.001, 0.0], [0.0, 1.0, 0.0]
    view = GetActiveViewOrCreate("RenderView")
    view.UseColorPaletteForBackground = 0
    view.Background = [0.96, 0.96, 0.95]
    show(OutputPort(mesh, 1), view, "PatchId", PATCHES, 0.4)
    cut = show(section, view, "Layer", ((0.80, 0.86, 0.91),) + 5 * ((0.97, 0.84, 0.67),), 1.0)
    cut.Position = [0.0, 0.0, -0.125]  # below the wall
    SetActiveSource(mesh)
    view.CameraParallelProjection = 1
    view.CameraFocalPoint = [0.075, 0.0, -0.062]
    view.CameraPosition = [0.075 + FROM[0], FROM[1], -0.062 + FROM[2]]
    view.CameraViewUp = [0.0, 0.0, 1.0]
    view.CameraParallelScale = 0.125
    Render(view)


main()
