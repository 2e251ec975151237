# SPDX-License-Identifier: BSD-3-Clause
"""Geometries of test cases 2, 3 and 4 in A. Shevelko, "Octree-based Projection Mesh Generation for Complex 'Dirty'
Geometries", 2006, sections 5.3 to 5.5, in metres.

The thesis shows its models in figures and gives a few dimensions of each. Those are kept; shapes and dimensions that it
leaves open are chosen here, and said to be, at each model. Each function returns a vtkPolyData whose cell array PatchId
and field array PatchNames the mesher understands.
"""
import numpy as np
import vtkmodules.vtkCommonCore  # noqa: F401  (VTK's core must load before modules built on it)
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData, vtkPolygon


class Surface:
    """Triangles as they are added: points (n, 3), triangles (m, 3), a patch for each triangle."""

    def __init__(self, *patch_names):
        self.patch_names = patch_names
        self.points, self.triangles, self.patches = np.zeros((0, 3)), np.zeros((0, 3), int), np.zeros(0, int)

    def add(self, points, triangles, patch=0):
        triangles = np.asarray(triangles)
        self.triangles = np.vstack([self.triangles, triangles + len(self.points)])
        self.points = np.vstack([self.points, points])
        self.patches = np.append(self.patches, np.full(len(triangles), patch))

    def poly_data(self):
        """Points at the same place become one, triangles without area are left out."""
        points, index = np.unique(np.round(self.points, 12) + 0.0, axis=0, return_inverse=True)
        triangles = index.reshape(-1)[self.triangles]
        a, b, c = triangles.T
        full = (a != b) & (b != c) & (c != a)
        data, place, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
        place.SetData(numpy_to_vtk(points, deep=True))
        triangles = triangles[full]
        cells.SetData(numpy_to_vtkIdTypeArray(np.arange(0, 3 * len(triangles) + 1, 3), deep=True),
                      numpy_to_vtkIdTypeArray(np.ascontiguousarray(triangles).ravel(), deep=True))
        data.SetPoints(place)
        data.SetPolys(cells)
        patches = numpy_to_vtk(self.patches[full].astype(np.int32), deep=True)
        patches.SetName("PatchId")
        data.GetCellData().AddArray(patches)
        names = vtkStringArray()
        names.SetName("PatchNames")
        for name in self.patch_names:
            names.InsertNextValue(name)
        data.GetFieldData().AddArray(names)
        return data


# ------------------------------------------------------------------------------------------------------ small parts
def lathe(profile, count, angle=2 * np.pi, start=0.0):
    """Turns a profile of (radius, height) about z, `count` segments in `angle`; normals to the left of the profile
    as it runs upwards, that is outwards of what it encloses with the axis."""
    r, z = np.asarray(profile, float).T
    phi = start + angle * np.arange(count + 1) / count
    if np.isclose(angle, 2 * np.pi):
        phi[-1] = phi[0]
    points = np.stack([np.outer(r, np.cos(phi)), np.outer(r, np.sin(phi)), np.outer(z, np.ones(count + 1))], axis=-1)
    return points.reshape(-1, 3), strips(len(r), count + 1)


def strips(rows, columns):
    """Two triangles for each square of a grid of points."""
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = (i * columns + j).ravel()
    b, c, d = a + 1, a + columns + 1, a + columns
    return np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def line(start, end, pieces):
    """Points of a straight piece of profile, without its start."""
    t = np.arange(1, pieces + 1)[:, None] / pieces
    return np.asarray(start) * (1 - t) + np.asarray(end) * t


def arc(centre, radius, begin, end, pieces):
    """The same of a circle, between two angles in degrees."""
    phi = np.radians(begin + (end - begin) * np.arange(1, pieces + 1) / pieces)
    return np.asarray(centre) + radius * np.column_stack([np.cos(phi), np.sin(phi)])


def polygon_triangles(points):
    """A flat polygon in the plane z = 0, by cutting off ears."""
    polygon, found = vtkPolygon(), vtkIdList()
    polygon.GetPoints().SetNumberOfPoints(len(points))
    polygon.GetPointIds().SetNumberOfIds(len(points))
    for i, (x, y) in enumerate(points):
        polygon.GetPoints().SetPoint(i, x, y, 0)
        polygon.GetPointIds().SetId(i, i)
    polygon.Triangulate(found)
    return np.array([found.GetId(i) for i in range(found.GetNumberOfIds())]).reshape(-1, 3)


def turned(parts, count, half=False):
    """The body that parts, [(patch, profile), ...] from axis to axis, enclose when turned about z; half: the half
    with y > 0, and a patch `symmetry`."""
    names = sorted({name for name, _ in parts}) + (["symmetry"] if half else [])
    surface = Surface(*names)
    for name, profile in parts:
        points, triangles = lathe(profile, count, np.pi if half else 2 * np.pi)
        surface.add(points, triangles, names.index(name))
    if half:
        outline = np.vstack([profile[:-1] for _, profile in parts] + [parts[-1][1][-1:]])
        triangles = polygon_triangles(outline)
        for side in (1, -1):
            points = np.column_stack([side * outline[:, 0], np.zeros(len(outline)), outline[:, 1]])
            surface.add(points, triangles[:, ::side], names.index("symmetry"))
    return surface


# ------------------------------------------------------------------------------------------------- 2: piston bowl
BOWL_SEGMENTS = 107
BORE, HEIGHT = 0.093, 0.019   # diameter of the cylinder, height of the space above the piston
BOWL, SQUISH = 0.052, 0.004   # chosen: diameter of the bowl, height of the space above the piston's crown


def bowl_profile():
    """(radius, height) from the axis: a central cone with a round tip, a torus, a straight wall, the piston's crown,
    the cylinder, and the head back to the axis. All of it chosen but the two dimensions above."""
    top, tip, fillet = 0.006, 0.003, 0.006
    torus = np.array([BOWL / 2 - fillet, fillet])
    profile = [np.array([[0.0, top]]), arc((0.0, top - tip), tip, 90, 60, 6)]
    profile.append(line(profile[-1][-1], torus + fillet * np.array([-0.5, -np.sqrt(0.75)]), 14))
    profile.append(arc(torus, fillet, 240, 360, 24))
    for place, pieces in (((BOWL / 2, HEIGHT - SQUISH), 12), ((BORE / 2, HEIGHT - SQUISH), 15),
                          ((BORE / 2, HEIGHT), 10), ((0, HEIGHT), 42)):
        profile.append(line(profile[-1][-1], place, pieces))
    return np.vstack(profile)


def piston_bowl(degrees=0.0):
    """Case 2: half of the space above a piston with a bowl, 26,352 triangles, turned about z. The thesis gives 0.093,
    0.046 and 0.019 m; they are taken as the extents of the half, 0.093 / 2 being 0.046. The bowl is chosen."""
    surface = turned([("wall", bowl_profile())], BOWL_SEGMENTS, half=True)
    phi = np.radians(degrees)
    turn = np.array([[np.cos(phi), -np.sin(phi), 0], [np.sin(phi), np.cos(phi), 0], [0, 0, 1]])
    surface.points = surface.points @ turn.T
    return surface.poly_data()


# -------------------------------------------------------------------------------------------------- 3: inlet port
PORT_SEGMENTS = 64
LENGTH, CYLINDER, PORT_LENGTH = 0.3, 0.075, 0.126  # whole length, diameter of the cylinder, length of the port
PORT, VALVE, LIFT = 0.028, 0.041, 0.006            # diameters of port and valve, and how far it is open
STEM, MARGIN = 0.006, 0.0015                       # chosen: diameter of the stem, height of the valve's rim


def port_profile():
    """[(patch, (radius, height) ...)] of the flow's space from the outlet's centre round to the valve's centre."""
    head, valve, seat = LENGTH - PORT_LENGTH, VALVE / 2, (VALVE - PORT) / 2
    outlet = np.vstack([[(0, 0)], line((0, 0), (CYLINDER / 2, 0), 3)])
    wall = np.vstack([outlet[-1:], line(outlet[-1], (CYLINDER / 2, head), 8), line((CYLINDER / 2, head), (valve, head), 2),
                      line((valve, head), (PORT / 2, head + seat), 2), line((PORT / 2, head + seat), (PORT / 2, LENGTH), 9)])
    inlet = np.vstack([wall[-1:], line(wall[-1], (STEM / 2, LENGTH), 1)])
    # The valve's back: the seat's cone, then a round into the stem that is tangent to both.
    rim = np.array([valve, head - LIFT])
    back = rim + (-seat, seat)
    radius = (back[0] - STEM / 2) / (1 - np.cos(np.radians(45)))
    centre = np.array([STEM / 2 + radius, back[1] + radius * np.sin(np.radians(45))])
    round_ = arc(centre, radius, 180, 225, 8)
    stem = np.vstack([inlet[-1:], line(inlet[-1], (STEM / 2, centre[1]), 4), round_, line(round_[-1], rim, 2),
                      line(rim, rim - (0, MARGIN), 1), line(rim - (0, MARGIN), (0, rim[1] - MARGIN), 3)])
    return [("outlet", outlet), ("wall", wall), ("inlet", inlet), ("wall", stem)]


def inlet_port(half=False):
    """Case 3: a port with an open valve on a cylinder, along y; half: cut at z = 0 by a patch `symmetry`. The thesis
    gives diameters and lengths in a figure of a bent port; here the port is straight and round about the stem, so that
    the narrow annulus at the seat, which the case is about, is kept, and the bend is not."""
    surface = turned(port_profile(), PORT_SEGMENTS // (2 if half else 1), half)
    surface.points = surface.points[:, [0, 2, 1]] * (1, 1, -1)  # z to y
    return surface.poly_data()


# ------------------------------------------------------------------------------------------- 4: separating models
BODY_SEGMENTS = 76  # facets of less than 5 degrees, so that only edges that are meant are sharp
MODEL_LENGTH, MODEL_DIAMETER, SECOND_LENGTH, DISTANCE = 7.0, 1.0, 4.0, 1.0
NOSE, NOSE_GAP = 2.0, 0.01  # chosen: length of the nose, gap between nose and body


def prism(root, tip):
    """A closed body between two polygons of the same number of corners, root counter-clockwise seen from the tip."""
    n = len(root)
    following = (np.arange(n) + 1) % n
    i = np.arange(n)
    fan = np.column_stack([np.zeros(n - 2, int), i[1:-1], i[2:]])
    sides = np.vstack([np.column_stack([i, following, following + n]), np.column_stack([i, following + n, i + n])])
    return np.vstack([root, tip]), np.vstack([sides, fan[:, ::-1], fan + n])


def wing(root_x, tip_x, span, side, thickness):
    """A wing of diamond section from inside the body outwards along y; root_x, tip_x: where its chords begin and end;
    thickness: half of it, over the chord, so that its four sides are flat."""
    def section(x, y):
        middle, half = (x[0] + x[1]) / 2, thickness * (x[1] - x[0])
        return np.array([(x[0], y, 0), (middle, y, -half), (x[1], y, 0), (middle, y, half)])
    return prism(section(root_x, 0.2 * side)[::-side], section(tip_x, span * side)[::-side])


def fin():
    """A fin upwards, of a section with six corners."""
    def section(begin, end, z):
        chord = end - begin
        a, b, half = begin + 0.25 * chord, end - 0.25 * chord, 0.04 * chord
        return np.array([(begin, 0, z), (a, -half, z), (b, -half, z), (end, 0, z), (b, half, z), (a, half, z)])
    return prism(section(5.4, 6.9, 0.3), section(6.2, 6.9, 1.3))


def one_model():
    """[(points, triangles)] of the parts of a model of 444 triangles: a closed body, a nose without a base that does
    not touch it, two wings, two small wings, a fin; parts reach into each other. Shapes and sizes are chosen."""
    n, radius = BODY_SEGMENTS, MODEL_DIAMETER / 2
    phi = 2 * np.pi * np.arange(n) / n
    circle = radius * np.column_stack([np.zeros(n), np.cos(phi), np.sin(phi)])
    body = prism(circle + (NOSE + NOSE_GAP, 0, 0), circle + (MODEL_LENGTH, 0, 0))
    i = np.arange(n)
    nose = (np.vstack([circle + (NOSE, 0, 0), [(0, 0, 0)]]), np.column_stack([(i + 1) % n, i, np.full(n, n)]))
    parts = [body, nose, fin()]
    for side in (1, -1):
        parts.append(wing((3.0, 5.2), (4.4, 5.2), 1.8, side, 0.055))
        parts.append(wing((6.1, 6.9), (6.5, 6.9), 1.1, side, 0.1))
    return parts


def separating_models():
    """Case 4: two models of cones, cylinders and wings, 888 triangles, merged and not cleaned: parts hidden in others,
    gaps left open. The second is a scaled copy. The thesis gives the two lengths, the diameter and a distance."""
    surface = Surface("model1", "model2")
    for points, triangles in one_model():
        surface.add(points, triangles, 0)
        surface.add(points * (SECOND_LENGTH / MODEL_LENGTH) + (1.0, 0, DISTANCE), triangles, 1)
    return surface.poly_data()


SEPARATING_DOMAIN = (-1.0, 8.0, -3.0, 3.0, -1.5, 3.0)  # chosen, VTK's order
