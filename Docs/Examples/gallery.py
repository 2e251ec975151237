# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of Docs/Gallery.md: gallery.py MESHES PICTURES [NAME ...]. MESHES/NAME holds mesh.vtu and boundary.vtp as mesh.sh
and thesis_cases.py leave them; the page has the commands. Writes PICTURES/gallery_NAME.png. Run with pvpython and
build/lib/python3/dist-packages on PYTHONPATH; without a display, under xvfb-run."""
import os
import sys

import figures
import mesh_pictures as pictures
from convert_cells import COLOURS as KIND_COLOURS, KINDS
from figures import X, Y, Z, Panel, section, square, walls
import numpy as np
import planar_mesh
from projection_mesher import ProjectionMesherFilters as pm
from vtkmodules.util.numpy_support import vtk_to_numpy

JUNCTION_COLOURS = [pictures.COLOURS[i] for i in (2, 0, 1, 3, 4)]  # inlet, wall, outlet1 to 3


def junction(grid, boundary, _lost):
    """Whole; the edges between the pipes; layers in a concave and in a convex corner."""
    shown = [walls(boundary, colours=JUNCTION_COLOURS)]
    view = (-0.45, -0.8, 0.4)
    return [(430, [Panel("dirty pipe junction, 1.3 mm, five layers", shown, view),
                   Panel("where the pipes meet", shown, view, box=(0.028, 0.072, -0.021, 0, 0.008, 0.03))], (11, 9)),
            (430, [square("section y = 0.5 mm", grid, Y, 0.0005),
                   square("concave edge", grid, Y, 0.0005, (0.032, 0.042, 0, 0, 0.0145, 0.0225)),
                   square("rim", grid, Y, 0.0005, (-0.0006, 0.0064, 0, 0, 0.0145, 0.0204))], (11, 5, 5))]


def motorcycle(grid, boundary, _lost):
    shown, view = [walls(boundary, outside=True)], (-0.5, -0.8, 0.3)
    return [(560, [Panel("a motorcycle of 331,653 triangles, 1/64 m", shown, view)], (1,)),
            (420, [Panel("front wheel and fairing", shown, view, box=(-0.3, 0.35, -0.36, 0, 0.02, 0.62)),
                   square("section y = 3 mm", grid, Y, 0.003, (-0.45, 2.0, 0, 0, 0.0, 1.5))], (1, 1))]


def port_half(grid, boundary, _lost):
    """Half of it: the plane of symmetry is a side of the mesh."""
    shown, view = [walls(boundary)], (-0.35, 0.3, 0.9)
    return [(560, [Panel("half an inlet port, 1 mm", shown, view, (0, 1, 0), (-0.04, 0.04, 0.142, 0.215, -0.038, 0)),
                   square("section z = -3 mm", grid, Z, -0.003, (-0.040, 0.040, 0.142, 0.215, 0, 0)),
                   square("valve and seat", grid, Z, -0.003, (0.0075, 0.0235, 0.159, 0.1775, 0, 0))], (6, 6, 5))]


def bowl(grid, boundary, _lost):
    shown = [walls(boundary)]
    return [(380, [Panel("half a piston bowl, turned by 30 degrees, 2 mm", shown, (-0.5, -0.8, -0.7)),
                   square("section x = 0", grid, X, 0.0)], (1, 1))]


def separating(grid, boundary, _lost):
    shown, view = [walls(boundary, outside=True)], (-0.7, -0.9, 0.6)
    return [(480, [Panel("two models of bodies, wings and fins pushed into each other", shown, view),
                   Panel("wing, fin and body", shown, (0.5, -0.9, 0.5), box=(4.4, 7.2, -1.5, 0.3, -0.5, 1.2))], (6, 5)),
            (400, [square("section y = 0.02", grid, Y, 0.02, (-0.4, 7.5, 0, 0, -0.9, 2.1)),
                   square("section x = 4.6", grid, X, 4.6, (0, 0, -1.3, 1.3, -0.8, 1.6))], (6, 5))]


def forklift(grid, boundary, _lost):
    shown = [walls(boundary, outside=True)]
    view = (-0.7, 0.35, 0.75)
    return [(560, [Panel("212 loose parts, 5,464 open edges", shown, view, (0, 1, 0))], (1,)),
            (420, [Panel("seat and driver", shown, view, (0, 1, 0), box=(-3.7, -2.6, 0.85, 1.95, 0, 0.5)),
                   square("section z = 5 mm", grid, Z, 0.005, (-4.9, 0.5, -0.2, 2.5, 0, 0))], (1, 1))]


def flange(grid, boundary, _lost):
    count = boundary.GetFieldData().GetAbstractArray("PatchNames").GetNumberOfValues()
    shown, view = [walls(boundary, colours=pictures.patch_colours(boundary, count))], (-0.45, -0.8, 0.4)
    return [(470, [Panel("flange", shown, view), square("section y = -2.2 mm", grid, Y, -0.0022)], (1, 1))]


REASONS = (("no wall sees it", (0.35, 0.35, 0.35)), ("too short", (0.20, 0.60, 0.90)),
           ("another feature is near", (0.85, 0.20, 0.15)), ("too acute", (0.63, 0.30, 0.70)),
           ("a limit", (0.92, 0.62, 0.10)), ("no free nodes", (0.15, 0.65, 0.30)))


def unresolved(_grid, boundary, lost):
    """The parts of features that no mesh edges lie on, a little before the wall, by the reason."""
    wall, view = walls(boundary, outside=True), np.array((-0.35, -0.9, 0.25))
    wall.GetProperty().EdgeVisibilityOff()
    pictures.colour_cells(lost, vtk_to_numpy(lost.GetCellData().GetArray("Reason")))
    lines = pictures.actor_of(lost, pictures.lookup([colour for _, colour in REASONS], len(REASONS)))
    lines.GetProperty().SetLineWidth(7)
    lines.GetProperty().LightingOff()
    lines.AddPosition(*(0.006 * view))
    return [(500, [Panel("a motorcycle's wheel and frame", [wall, lines], view, box=(-0.3, 0.75, -0.36, 0, 0.1, 0.68)),
                   figures.Key(REASONS)], (19, 6))]


# --------------------------------------------------------------------------------------------- meshes made of meshes
def kinds_of_cells(grid, title, box):
    """The section y = 0.5 mm with the shapes of cells in colours."""
    cells = pm.vtkMeshSlice()
    cells.SetInputData(grid)
    cells.GetPlane().SetNormal(0, 1, 0)
    cells.GetPlane().SetOrigin(0, 0.0005, 0)
    cells.Update()
    cut, place = cells.GetOutput(), {kind: i for i, kind in enumerate(KINDS)}
    of_cell = vtk_to_numpy(grid.GetCellTypesArray())[vtk_to_numpy(cut.GetCellData().GetArray("vtkOriginalCellIds"))]
    pictures.colour_cells(cut, np.array([place[kind] for kind in of_cell]))
    eye, up = figures.SQUARE[Y]
    return Panel(title, pictures.section_actors(cut, KIND_COLOURS), eye, up, box, depth=0)


def conversion(grid, *_others):
    """The same part of the junction as it is meshed, and converted."""
    box, panels = (0.030, 0.052, 0, 0, 0.008, 0.026), [kinds_of_cells(grid, "hexahedra (blue), polyhedra (violet)", (
        0.030, 0.052, 0, 0, 0.008, 0.026))]
    for shapes, title in ((1, "hybrid: pyramids yellow, tetrahedra red"), (0, "tetrahedra")):
        cells = pm.vtkConvertCells()
        cells.SetInputData(grid)
        cells.SetCellShapes(shapes)
        cells.Update()
        panels.append(kinds_of_cells(cells.GetOutput(), title, box))
    return [(400, panels, (1, 1, 1))]


def aerofoil(*_mesh):
    """A planar mesh; both edges of the profile enlarged."""
    made = planar_mesh.section_of_mesh()
    layers = vtk_to_numpy(made.GetOutput().GetCellData().GetArray("Layer")) > 0
    front = planar_mesh.front_faces(made, layers)

    def panel(title, box):
        return Panel(title, pictures.section_actors(front), *figures.SQUARE[Z], box, depth=0)
    return [(420, [panel("planar mesh, four layers", (-0.12, 1.12, -0.28, 0.28, 0, 0))], (1,)),
            (380, [panel("leading edge", (-0.02, 0.12, -0.02, 0.08, 0, 0)),
                   panel("trailing edge", (0.962, 0.998, -0.15, -0.127, 0, 0))], (1, 1))]


CASES = {"junction": junction, "motorcycle": motorcycle, "port_half": port_half, "bowl_30_2mm": bowl, "separating": separating,
         "forklift": forklift, "flange": flange, "unresolved": unresolved,
         "conversion": conversion, "aerofoil": aerofoil}
LOOKS = {"unresolved": {"width": 1000, "colours": 0}}  # the colours of short lines count
MESH_OF = {"conversion": "junction", "unresolved": "motorcycle", "aerofoil": None}  # the others are in the folder of their name


def main(meshes, folder, names):
    for name in names or CASES:
        mesh = MESH_OF.get(name, name)
        figures.draw(CASES[name](*(figures.read_mesh(os.path.join(meshes, mesh)) if mesh else ())),
                     os.path.join(folder, f"gallery_{name}.png"), **LOOKS.get(name, {"colours": 128}))
        print(name, flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 3 or set(sys.argv[3:]) - set(CASES):
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2], sys.argv[3:])
