# SPDX-License-Identifier: BSD-3-Clause
"""Cross-sections by Mesh Slice of the meshes that A. Shevelko's thesis shows in chapter 5, made from the shipped and the
generated geometry; layer cells in another colour. Writes a picture for each case into FOLDER:

    cross_sections.py FOLDER [CASE ...]

    MeshSlice          what VTK's cutter makes of a plane through the mesh's points, what Mesh Slice makes of it, crinkle
    section_junction   the dirty pipe junction at 1.3 mm with boundary layers, like Fig. 5-3
    section_bowl       the piston bowl turned by 0 and 30 degrees, like Figs 5-7 and 5-8
    section_port       half the inlet port and its valve, like Figs 5-11 to 5-14
    section_separating the separating models in three planes, like Figs 5-19 to 5-22

Run with pvpython and build/lib/python3/dist-packages on PYTHONPATH; without a display, under xvfb-run."""
import os
import sys

import mesh_pictures as pictures
import numpy as np
from projection_mesher import ProjectionMesherFilters as pm
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPlane
from vtkmodules.vtkFiltersCore import vtkCutter
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
from vtkmodules.vtkRenderingCore import vtkRenderWindow

TESTING = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Testing")
sys.path.append(os.path.join(TESTING, "Benchmark"))
import thesis_cases  # noqa: E402  only now can it be found

X, Y, Z = range(3)
LOOKS = (((-1, 0, 0), (0, 0, 1)), ((0, 1, 0), (0, 0, 1)), ((0, 0, -1), (0, 1, 0)))  # direction of the eye, upwards
PANEL = (900, 620)
ROOM = 1.06  # of what a panel shows over the box it is asked for


# ------------------------------------------------------------------------------------------------------- meshes
def thesis_mesh(name):
    """The mesh of a case of thesis_cases.py."""
    case = next(c for c in thesis_cases.CASES if c.name == name)
    mesh = thesis_cases.mesh_filter(case, case.geometry())
    mesh.Update()
    return mesh.GetOutput()


def junction_mesh():
    reader = pm.vtkSurfaceReader()
    reader.SetFileName(os.path.join(TESTING, "Data", "pipe_junction_dirty.stl"))
    mesh = pm.vtkProjectionMesh()
    mesh.SetInputConnection(reader.GetOutputPort())
    mesh.SetFeatureSize(0.0013)
    mesh.SetLayers(3)
    mesh.Update()
    return mesh.GetOutput()


def nearest_node_plane(grid, axis, position):
    """Where near a position most points of the mesh lie in a plane square to the axis."""
    at, count = np.unique(vtk_to_numpy(grid.GetPoints().GetData())[:, axis], return_counts=True)
    common = at[count > 0.5 * count.max()]
    return common[np.argmin(np.abs(common - position))]


# ------------------------------------------------------------------------------------------------------- panels
class Panel:
    """Part of a picture: actors seen square to an axis, or along `eye`; box (VTK's order): what is shown of them."""

    def __init__(self, title, actors, axis, box, eye=None):
        self.title, self.actors, self.axis, self.box, self.eye = title, actors, axis, np.array(box, float), eye

    def renderer(self):
        label = pictures.text_actor(f" {self.title} ", 16, 12)
        label.GetTextProperty().SetBackgroundColor(*pictures.BACKGROUND)
        label.GetTextProperty().SetBackgroundOpacity(0.8)
        renderer = pictures.new_renderer(self.actors + [label])
        corners = self.box.reshape(3, 2)
        middle, size = corners.mean(axis=1), corners[:, 1] - corners[:, 0]
        eye, up = LOOKS[self.axis]
        right = np.cross(eye, up)
        camera = renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetFocalPoint(*middle)
        camera.SetPosition(*(middle - np.multiply(self.eye or eye, np.linalg.norm(size))))
        camera.SetViewUp(*up)
        camera.SetParallelScale(ROOM / 2 * max(abs(size @ up), abs(size @ right) * PANEL[1] / PANEL[0]))
        renderer.ResetCameraClippingRange()
        return renderer


def section(title, grid, axis, position, box=None):
    """A panel of the mesh's section; the title says where."""
    cut = pictures.cut_grid(grid, axis, position)
    title = f"{title}, {'xyz'[axis]} = {1000 * position:.4g} mm"
    return Panel(title, pictures.section_actors(cut), axis, box or cut.GetBounds())


def draw(panels, columns, path):
    rows = (len(panels) + columns - 1) // columns
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(columns * PANEL[0], rows * PANEL[1])
    for k, panel in enumerate(panels):
        renderer = panel.renderer()
        x, y = k % columns, rows - 1 - k // columns
        renderer.SetViewport(x / columns, y / rows, (x + 0.998) / columns, (y + 0.998) / rows)
        window.AddRenderer(renderer)
    pictures.write_picture(window, path)


# -------------------------------------------------------------------------------------------------------- cases
def mesh_slice():
    """The same plane by VTK's cutter, by Mesh Slice, and the cells it cuts."""
    grid = junction_mesh()
    position = nearest_node_plane(grid, Y, -0.005)
    box = (0.03, 0.09, position, position, -0.02, 0.02)
    plane = vtkPlane()
    plane.SetNormal(0, 1, 0)
    plane.SetOrigin(0, position, 0)
    cutter, cells, surface = vtkCutter(), pm.vtkMeshSlice(), vtkGeometryFilter()
    cutter.SetCutFunction(plane)
    cutter.SetInputData(grid)
    cutter.GenerateTrianglesOff()
    cutter.Update()
    theirs = cutter.GetOutput()
    pictures.colour_cells(theirs, vtk_to_numpy(theirs.GetCellData().GetArray("Layer")) > 0)
    cells.SetPlane(plane)
    cells.SetInputData(grid)
    cells.CrinkleOn()
    surface.SetInputConnection(cells.GetOutputPort())
    surface.Update()
    whole = surface.GetOutput()
    pictures.colour_cells(whole, vtk_to_numpy(whole.GetCellData().GetArray("Layer")) > 0)
    face, lines = pictures.section_actors(whole)
    face.GetProperty().LightingOn()
    face.GetProperty().SetInterpolationToFlat()
    return [Panel("vtkCutter", pictures.section_actors(theirs), Y, box), section("Mesh Slice", grid, Y, position, box),
            Panel("Mesh Slice, crinkle", [face, lines], Y, (0.03, 0.07, position, position, -0.026, 0.002),
                  eye=(0.4, 1, -0.4))]


def section_junction():
    grid = junction_mesh()
    return [section("dirty pipe junction", grid, Y, 0), section("where the pipes meet", grid, Y, 0, (0.03, 0.06, 0, 0, 0.008, 0.028)),
            section("across the inlet", grid, X, 0.02), section("across the upper pipe", grid, Z, 0.03)]


def section_bowl():
    upright, turned = thesis_mesh("bowl_0_2mm"), thesis_mesh("bowl_30_2mm")
    return [section("bowl, 0 degrees, beside the plane of symmetry", upright, Y, 0.0005),
            section("bowl, 0 degrees", upright, X, 0.0), section("bowl, 30 degrees", turned, X, 0.0),
            section("bowl, 30 degrees", turned, Z, 0.008)]


def section_port():
    """Its plane of symmetry is a side of the mesh: sections show the faces there."""
    half = thesis_mesh("port_half")
    seat = (-0.036, 0.036, 0.15, 0.2, 0, 0)
    return [section("half the inlet port, plane of symmetry", half, Z, 0, seat),
            section("valve and seat", half, Z, 0, (0.004, 0.024, 0.162, 0.178, 0, 0)),
            section("inside", half, Z, -0.0015, seat),
            section("across the seat", half, Y, 0.177, (-0.022, 0.022, 0.177, 0.177, -0.022, 0.0))]


def section_separating():
    grid = thesis_mesh("separating")
    return [section("separating models", grid, X, 4.6), section("zoomed", grid, X, 4.6, (4.6, 4.6, -1.3, 1.3, -0.7, 1.7)),
            section("separating models", grid, Y, 0), section("zoomed", grid, Y, 0, (4.2, 7.4, 0, 0, -0.7, 1.6)),
            section("separating models", grid, Z, 0), section("zoomed", grid, Z, 0, (2.6, 7.4, -1.9, 0.2, 0, 0))]


CASES = {"MeshSlice": (mesh_slice, 3), "section_junction": (section_junction, 2), "section_bowl": (section_bowl, 2),
         "section_port": (section_port, 2), "section_separating": (section_separating, 2)}


def main(folder, names):
    unknown = sorted(set(names) - set(CASES))
    if unknown:
        raise SystemExit(f"There is no case {unknown[0]}; there are: {', '.join(CASES)}")
    os.makedirs(folder, exist_ok=True)
    for name in names or CASES:
        panels, columns = CASES[name][0](), CASES[name][1]
        draw(panels, columns, os.path.join(folder, name + ".png"))
        print(name, flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        raise SystemExit(__doc__)
    main(sys.argv[1], sys.argv[2:])
