# SPDX-License-Identifier: BSD-3-Clause
"""Fluent mesh files, ascii and binary, and volumes of cells from their faces; for comparisons."""
import re

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkIdList
from vtkmodules.vtkCommonDataModel import VTK_POLYHEDRON

SECTION = re.compile(rb"\((\d+) \(([^()]*)\)\s*\(?")
END = re.compile(rb"\)\nEnd of Binary Section   (\d+)\)\n")


class FluentFile:
    """points (#P by 3), types (of cells), faces (arrays of points), c0 and c1 (-1 = none), cell_zones and face_zones
    (dictionaries: id -> [first, last + 1, type of the section, word, name]). All ids count from 0 but those of zones."""

    def __init__(self, path):
        with open(path, "rb") as file:
            self.data = file.read()
        self.points = self.types = None
        self.faces, self.c0, self.c1, self.cell_zones, self.face_zones = [], [], [], {}, {}
        at = 0
        while match := SECTION.search(self.data, at):
            at = self.read_section(int(match[1]), match[2].split(), match.end(), match[0].endswith(b"("))
        self.c0, self.c1 = np.array(self.c0), np.array(self.c1)

    def read_section(self, index, header, at, has_body):
        if index == 45:
            zone = int(header[0])
            (self.cell_zones if zone in self.cell_zones else self.face_zones)[zone] += [h.decode() for h in header[1:]]
        elif index % 1000 in (10, 12, 13):
            numbers = [int(word, 16) for word in header]
            if numbers[0] == 0:
                self.declare(index, numbers[2])
            else:
                return self.read_body(index, numbers, at, has_body)
        return at

    def declare(self, index, count):
        if index == 10:
            self.points = np.empty((count, 3))
        elif index == 12:
            self.types = np.empty(count, dtype=int)

    def read_body(self, index, header, at, has_body):
        zone, first, last, kind, element = header
        count = last - first + 1
        if index % 1000 == 10:
            values, at = self.numbers(at, index, "<f8", 3 * count)
            self.points[first - 1:last] = values.reshape(-1, 3)
        elif index % 1000 == 12:
            self.cell_zones[zone] = [first - 1, last, kind]
            values = element
            if has_body:
                values, at = self.numbers(at, index, "<i4", count)
            self.types[first - 1:last] = values
        else:
            assert len(self.faces) == first - 1, "faces of zones follow one another"
            self.face_zones[zone] = [first - 1, last, kind]
            at = self.read_faces(at, index, count, element)
        return at

    def numbers(self, at, index, dtype, count=None):
        """The numbers of a body, and where it ends. In ascii integers are hexadecimal."""
        if index > 3000:
            end = next(m.start() for m in END.finditer(self.data, at) if int(m[1]) == index)
            values = np.frombuffer(self.data, dtype, (end - at) // int(dtype[2]), at)
        else:
            end = self.data.index(b")", at)
            words = self.data[at:end].split()
            values = np.array(words, dtype=float) if "f" in dtype else np.array([int(word, 16) for word in words])
        assert count is None or len(values) == count, "the body has as many numbers as its header says"
        return values, end + 1

    def read_faces(self, at, index, count, element):
        values, at = self.numbers(at, index, "<i4")
        start = 0
        for _ in range(count):
            corners = element
            if element in (0, 5):
                corners, start = values[start], start + 1
            self.faces.append(values[start:start + corners] - 1)
            self.c0.append(values[start + corners] - 1)
            self.c1.append(values[start + corners + 1] - 1)
            start += corners + 2
        assert start == len(values), "nothing is left behind the last face"
        return at

    def volumes(self):
        """Of each cell, from the faces as they are oriented: normals enter c0 and leave c1."""
        origin = self.points.mean(axis=0)
        sums = np.zeros(len(self.types))
        for face, c0, c1 in zip(self.faces, self.c0, self.c1):
            volume = cone(self.points[face] - origin)
            sums[c0] -= volume
            if c1 >= 0:
                sums[c1] += volume
        return sums


def cone(corners):
    """Signed volume between the origin and a polygon that is triangulated about the mean of its corners."""
    return corners.mean(axis=0) @ np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0) / 6


def cell_faces(grid, cell):
    """The faces of a grid's cell as lists of points, outward."""
    if grid.GetCellType(cell) == VTK_POLYHEDRON:
        ids = vtkIdList()
        grid.GetFaceStream(cell, ids)
        stream = [ids.GetId(i) for i in range(1, ids.GetNumberOfIds())]
        faces = []
        while stream:
            faces.append(stream[1:1 + stream[0]])
            stream = stream[1 + stream[0]:]
        return faces
    shape = grid.GetCell(cell)
    return [[face.GetPointId(i) for i in range(face.GetNumberOfPoints())]
            for face in map(shape.GetFace, range(shape.GetNumberOfFaces()))]


def cell_volumes(grid):
    """Of each cell, by the same measure as FluentFile's."""
    points = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
    origin = points.mean(axis=0)
    return np.array([sum(cone(points[face] - origin) for face in cell_faces(grid, cell))
                     for cell in range(grid.GetNumberOfCells())])
