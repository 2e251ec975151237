# SPDX-License-Identifier: BSD-3-Clause
"""OpenFOAM's polyMesh folders as grids, and the figures of a checkMesh log; for comparisons. read_mesh takes ascii
and binary files (32-bit labels, 64-bit scalars), plain lists and compact ones."""
import os
import re

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints
from vtkmodules.vtkCommonDataModel import VTK_POLYHEDRON, vtkUnstructuredGrid

COMMENTS = re.compile(rb"/\*.*?\*/|//[^\n]*", re.S)
LIST = re.compile(rb"\s*(\d+)\s*\(")
NUMBER = r"[-+]?(?:\d+\.?\d*(?:[eE][-+]?\d+)?|nan|inf)"


class Lists:
    """The lists of one file, one after the other."""

    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        end = data.index(b"}", data.index(b"FoamFile")) + 1
        self.header = data[:end]
        self.binary = b"binary" in re.search(rb"format\s+(\w+)", self.header).group(1)
        self.data = data[end:] if self.binary else COMMENTS.sub(b"", data[end:])
        start = re.search(rb"(?:^|\n)\s*\d+\s*\(", self.data)
        self.at = start.start()

    def numbers(self, dtype, width=1):
        """The next list of numbers or of tuples of `width` numbers."""
        match = LIST.match(self.data, self.at)
        count = int(match.group(1)) * width
        if self.binary:
            values = np.frombuffer(self.data, dtype, count, match.end())
            self.at = match.end() + values.nbytes + 1
            return values
        end = self.data.rindex(b")")
        text = self.data[match.end():end].replace(b"(", b" ").replace(b")", b" ")
        return np.array(text.split()[:count], dtype=dtype)

    def rows(self):
        """The next list of lists of labels, as offsets and values."""
        if self.binary:
            return self.numbers("<i4"), self.numbers("<i4")
        found = re.findall(rb"(\d+)\s*\(([^()]*)\)", self.data[LIST.match(self.data, self.at).end():])
        sizes = np.array([int(size) for size, _ in found])
        values = np.array(b" ".join(row for _, row in found).split(), dtype="<i4")
        return np.concatenate(([0], np.cumsum(sizes))), values


def read_mesh(folder):
    """A polyMesh folder as a grid of polyhedra."""
    points = Lists(os.path.join(folder, "points")).numbers("<f8", 3).reshape(-1, 3)
    offsets, values = Lists(os.path.join(folder, "faces")).rows()
    owner = Lists(os.path.join(folder, "owner")).numbers("<i4")
    neighbour = Lists(os.path.join(folder, "neighbour")).numbers("<i4")
    rows = [values[a:b].tolist() for a, b in zip(offsets[:-1], offsets[1:])]
    streams = [[0] for _ in range(int(max(owner.max(), neighbour.max(initial=0))) + 1)]
    for face, row in enumerate(rows):
        streams[owner[face]] += [len(row)] + row
        streams[owner[face]][0] += 1
        if face < len(neighbour):
            streams[neighbour[face]] += [len(row)] + row[::-1]
            streams[neighbour[face]][0] += 1
    grid = vtkUnstructuredGrid()
    coordinates = vtkPoints()
    coordinates.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    grid.SetPoints(coordinates)
    ids = vtkIdList()
    for stream in streams:
        ids.SetNumberOfIds(len(stream))
        for i, value in enumerate(stream):
            ids.SetId(i, value)
        grid.InsertNextCell(VTK_POLYHEDRON, ids)
    return grid


def empty_direction(folder):
    """1, 2, 3 = x, y, z when patches are empty and the mesh is one cell thick that way, else 0."""
    with open(os.path.join(folder, "boundary"), "rb") as file:
        text = COMMENTS.sub(b"", file.read())
    faces = [range(int(b), int(b) + int(a)) for a, b in
             re.findall(rb"type\s+empty;[^}]*?nFaces\s+(\d+);\s*startFace\s+(\d+);", text)]
    chosen = [f for patch in faces for f in patch]
    if not chosen:
        return 0
    points = Lists(os.path.join(folder, "points")).numbers("<f8", 3).reshape(-1, 3)
    offsets, values = Lists(os.path.join(folder, "faces")).rows()
    corners = points[values[offsets[chosen[0]]:offsets[chosen[0] + 1]]]
    return int(np.argmin(np.ptp(corners, axis=0))) + 1


# name: the pattern of the log; None of it when the log does not say (checkMesh is silent about a count of 0).
FIGURES = {
    "NonOrthogonality max": rf"Mesh non-orthogonality Max: ({NUMBER})",
    "NonOrthogonality mean": rf"Mesh non-orthogonality Max: {NUMBER} average: ({NUMBER})",
    "NonOrthogonality outside": r"severely non-orthogonal \(> 70 degrees\) faces: (\d+)",
    "Skewness max": rf"Max skewness = ({NUMBER})",
    "AspectRatio max": rf"(?:Max aspect ratio = |High aspect ratio cells found, Max aspect ratio: )({NUMBER})",
    "Volume min": rf"Min volume = ({NUMBER})",
    "Volume max": rf"Max volume = ({NUMBER})",
    "FaceArea min": rf"Minimum face area = ({NUMBER})",
    "FaceArea max": rf"Maximum face area = ({NUMBER})",
    "Flatness min": rf"Face flatness .*?: min = ({NUMBER})",
    "Flatness mean": rf"Face flatness .*average = ({NUMBER})",
    "Determinant min": rf"Cell determinant .*?: minimum: ({NUMBER})",
    "Determinant mean": rf"Cell determinant .* average: ({NUMBER})",
    "Determinant outside": r"small determinant .* number of cells: (\d+)",
    "FaceWeight min": rf"Face interpolation weight : minimum: ({NUMBER})",
    "FaceWeight mean": rf"Face interpolation weight .* average: ({NUMBER})",
    "FaceWeight outside": r"small interpolation weight .* number of faces: (\d+)",
    "VolumeRatio min": rf"Face volume ratio : minimum: ({NUMBER})",
    "VolumeRatio mean": rf"Face volume ratio .* average: ({NUMBER})",
    "VolumeRatio outside": r"small volume ratio .* number of faces: (\d+)",
    "FaceConcavity outside": r"There are (\d+) faces with concave angles",
    "FaceConcavity max": rf"Max concave angle = ({NUMBER})",
    "FaceTet outside": r"Writing (\d+) faces with low quality or negative volume decomposition tets",
    "concave cells": r"Concave cells .*number of cells: (\d+)",
}


def read_log(path):
    """Figure by name; a count that the log is silent about is 0, anything else is left out."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    found = {}
    for name, pattern in FIGURES.items():
        match = re.search(pattern, text)
        if match:
            found[name] = float(match.group(1).rstrip("."))
        elif name.endswith(("outside", "cells")):
            found[name] = 0.0
    return found
