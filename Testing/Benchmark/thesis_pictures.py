# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of the meshes of thesis_cases.py for Docs/ThesisCases.md, each of four views, like the thesis' Figs 5-7, 5-8,
5-12 to 5-14 and 5-20 to 5-22. Without a display, under xvfb-run:

    pvpython thesis_pictures.py OUT IMAGES
"""
import os
import sys

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLookupTable
from vtkmodules.vtkFiltersCore import vtkThreshold
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader
from vtkmodules.vtkRenderingCore import vtkRenderWindow

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "Docs", "Examples"))
import figures  # noqa: E402
import mesh_pictures as pictures  # noqa: E402

SIZE = (1280, 960)


def in_box(data, box):
    """The faces with their first point in a box (VTK's order), of the walls only; all for None."""
    shown = pictures.only_patches(data, pictures.shown_patches(data))
    if box is None:
        return shown
    points = vtk_to_numpy(shown.GetPoints().GetData())
    first = vtk_to_numpy(shown.GetPolys().GetConnectivityArray())[vtk_to_numpy(shown.GetPolys().GetOffsetsArray())[:-1]]
    low, high = np.reshape(box, (3, 2)).T
    keep = ((points[first] > low) & (points[first] < high)).all(axis=1)
    return threshold(shown, keep)


def threshold(data, keep):
    """The faces of a surface for which keep holds."""
    flags = numpy_to_vtk(keep.astype(np.uint8), deep=True)
    flags.SetName("Kept")
    data.GetCellData().AddArray(flags)
    kept, surface = vtkThreshold(), vtkGeometryFilter()
    kept.SetInputData(data)
    kept.SetInputArrayToProcess(0, 0, 0, 1, "Kept")
    kept.SetUpperThreshold(0.5)
    kept.SetThresholdFunction(vtkThreshold.THRESHOLD_UPPER)
    surface.SetInputConnection(kept.GetOutputPort())
    surface.Update()
    return surface.GetOutput()


class View:
    """Of the mesh in OUT/name: its wall seen along `direction`, or a cut square to the axis at a position."""

    def __init__(self, name, direction, up=(0, 0, 1), box=None, cut=None, title="", zoom=1.4):
        self.name, self.direction, self.up, self.box, self.cut = name, direction, up, box, cut
        self.title, self.zoom = title, zoom

    def renderer(self, folder):
        actors, bounds = (self.section if self.cut else self.wall)(os.path.join(folder, self.name))
        renderer = pictures.new_renderer(actors + [pictures.text_actor(self.title or self.name, 20, 15)])
        middle = np.reshape(self.box or bounds, (3, 2)).mean(axis=1)
        camera = renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetFocalPoint(*middle)
        camera.SetPosition(*(middle + np.array(self.direction, float)))
        camera.SetViewUp(*self.up)
        renderer.ResetCamera(self.box or bounds)
        camera.Zoom(self.zoom)
        return renderer

    def wall(self, folder):
        boundary = pictures.read(vtkXMLPolyDataReader(), os.path.join(folder, "boundary.vtp"))
        shown = in_box(boundary, self.box)
        actor = pictures.actor_of(shown)
        look = actor.GetProperty()
        look.SetColor(*pictures.COLOURS[0])
        look.EdgeVisibilityOn()
        look.SetEdgeColor(*pictures.LINES)
        look.SetInterpolationToFlat()
        return [actor], shown.GetBounds()

    def section(self, folder):
        grid = pictures.read(vtkXMLUnstructuredGridReader(), os.path.join(folder, "mesh.vtu"))
        cut = pictures.cut_grid(grid, *self.cut)
        return pictures.section_actors(cut), cut.GetBounds()


BELOW = (-0.5, -0.8, -0.7)
ACROSS, UP_Y = (0, 0.0, 1), (0, 1, 0)
SEAT = (-0.03, 0.03, 0.155, 0.2, -0.01, 0.01)
PICTURES = {
    "thesis_bowl.png": [
        View("bowl_0", BELOW, zoom=1.25), View("bowl_30_2mm", BELOW), View("bowl_60_2mm", BELOW),
        View("bowl_0_2mm", (1, 0, 0), cut=(0, 0.005), title="bowl_0_2mm, section")],
    "thesis_port.png": [
        View("port_coarse", (-0.6, 0.3, 0.8), UP_Y, zoom=1), View("port_half", (-0.5, 0.3, 0.9), UP_Y, zoom=1),
        View("port_half_coarse", ACROSS, UP_Y, SEAT, (2, -0.0015), "port_half_coarse, section"),
        View("port_half", ACROSS, UP_Y, SEAT, (2, -0.0015), "port_half, section")],
    "thesis_separating.png": [
        View("separating", (-0.7, -0.9, 0.6)),
        View("separating", (-0.5, -0.9, 0.6), box=(2.8, 7.4, -2.0, 0.3, -0.5, 1.7), title="separating, zoomed"),
        View("separating", (0, -1, 0), box=(-0.4, 7.4, -1, 1, -1, 2.2), cut=(1, 0.02), title="section y"),
        View("separating", (-1, 0, 0), box=(3.5, 5, -1.2, 1.2, -0.8, 1.6), cut=(0, 4.6), title="section x")]}


class Smoothness(View):
    """The wall faces that smoothness_cases.py has measured, grey to red at 10 degrees."""

    def wall(self, folder):
        boundary = pictures.read(vtkXMLPolyDataReader(), os.path.join(folder, "boundary.vtp"))
        every = vtk_to_numpy(boundary.GetCellData().GetArray("NormalDeviation"))
        shown = threshold(boundary, every >= 0)
        shown.GetCellData().SetActiveScalars("NormalDeviation")
        table = vtkLookupTable()
        table.SetHueRange(0.0, 0.0)
        table.SetSaturationRange(0.0, 1.0)
        table.SetValueRange(0.85, 0.9)
        table.SetTableRange(0, 10)
        table.Build()
        actor = pictures.actor_of(shown, table)
        actor.GetProperty().EdgeVisibilityOn()
        actor.GetProperty().SetEdgeColor(*pictures.LINES)
        actor.GetProperty().SetInterpolationToFlat()
        return [actor], shown.GetBounds()


SMOOTHNESS = [Smoothness("sphere_0.1", (-0.5, -0.8, 0.4)), Smoothness("cylinder_0.1", (-0.5, 0.4, 0.8), (0, 1, 0)),
              Smoothness("motorBike_fairing", (-0.5, -0.8, 0.3)), Smoothness("motorBike_fairing", (-1, 0, 0.2))]


def main(folder, images):
    if all(os.path.exists(os.path.join(folder, view.name)) for view in SMOOTHNESS):
        PICTURES["wall_smoothness.png"] = SMOOTHNESS
    for name, views in PICTURES.items():
        window = vtkRenderWindow()
        window.SetOffScreenRendering(1)
        window.SetMultiSamples(8)
        window.SetSize(*SIZE)
        for k, view in enumerate(views):
            renderer = view.renderer(folder)
            x, y = 0.5 * (k % 2), 0.5 * (1 - k // 2)
            renderer.SetViewport(x, y, x + 0.498, y + 0.498)
            window.AddRenderer(renderer)
        pictures.write_picture(window, os.path.join(images, name))
        figures.fewer_colours(os.path.join(images, name))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
