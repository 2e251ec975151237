# SPDX-License-Identifier: BSD-3-Clause
"""Boundaries as STL files: closed, of the mesh's volume, with a solid for each patch; and what surface reader and
writer make of each other's files."""
import os
import re
import tempfile
import unittest

import numpy as np
from fluent_file import cell_volumes
from support import Messages, arrays, box, chain, differences, pm, sphere, strings
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkStripper, vtkTriangleFilter
from vtkmodules.vtkIOGeometry import vtkSTLReader, vtkSTLWriter

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Data")


def read(path):
    reader = pm.vtkSurfaceReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def triangles(path):
    """Corners of the triangles of an ascii file, #T by 3 by 3, to the bit."""
    with open(path, encoding="utf-8") as file:
        return np.array([line.split()[1:] for line in file if line.lstrip().startswith("vertex")], dtype=float).reshape(-1, 3, 3)


def enclosed(corners):
    origin = corners.mean(axis=(0, 1))
    return np.linalg.det(corners - origin).sum() / 6


def loose_edges(path):
    """Edges that are not in two triangles, of the file as VTK reads it."""
    reader = vtkSTLReader()
    reader.SetFileName(path)
    edges = vtkFeatureEdges()
    edges.SetInputConnection(reader.GetOutputPort())
    edges.FeatureEdgesOff()
    edges.BoundaryEdgesOn()
    edges.NonManifoldEdgesOn()
    edges.Update()
    return edges.GetOutput().GetNumberOfCells()


class TestSurfaceWriter(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.mesh = chain(read(os.path.join(DATA, "pipe_junction.stl")), 0.006)[-1]

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "part.stl")

    def write(self, surface, path=None):
        writer = pm.vtkSurfaceWriter()
        writer.SetInputDataObject(surface)
        writer.SetFileName(path or self.path)
        self.messages = Messages(writer)
        writer.Write()
        return path or self.path

    def test_boundary_is_closed_and_has_the_meshs_volume(self):
        self.write(self.mesh.GetOutputDataObject(1))
        self.assertEqual(self.messages.errors, [])
        volume = cell_volumes(self.mesh.GetOutputDataObject(0)).sum()
        self.assertAlmostEqual(enclosed(triangles(self.path)) / volume, 1, delta=1e-12)
        self.assertEqual(loose_edges(self.path), 0)

    def test_solids_are_the_patches(self):
        boundary = self.mesh.GetOutputDataObject(1)
        with open(self.write(boundary), encoding="utf-8") as file:
            text = file.read()
        names = strings(boundary, "PatchNames")
        self.assertEqual(re.findall("^solid (.*)$", text, re.M), names)
        self.assertEqual(re.findall("^endsolid (.*)$", text, re.M), names)
        self.assertGreater(len(names), 1)

    def test_written_files_read_back_the_same(self):
        boundary = self.mesh.GetOutputDataObject(1)
        first = read(self.write(boundary))
        self.assertEqual(strings(first, "PatchNames"), strings(boundary, "PatchNames"))
        again = read(self.write(first, self.path + "2.stl"))
        self.assertEqual(differences(first, again), [])

    def test_patches_in_any_order(self):
        """Solids that come in turns are two solids of the file written, and the same two patches."""
        facet = " facet normal 0 0 1\n  outer loop\n   vertex 0 0 {0}\n   vertex 1 0 {0}\n   vertex 0 1 {0}\n  endloop\n endfacet\n"
        with open(self.path, "w", encoding="utf-8") as file:
            for i, name in enumerate(("in let", "wall", "in let")):
                file.write(f"solid {name}\n{facet.format(i)}endsolid {name}\n")
        surface = read(self.path)
        self.assertEqual(arrays(surface)["cell PatchId"].tolist(), [0, 1, 0])
        again = read(self.write(surface))
        self.assertEqual(strings(again, "PatchNames"), ["in let", "wall"])
        self.assertEqual(arrays(again)["cell PatchId"].tolist(), [0, 0, 1])
        self.assertEqual(triangles(self.path)[:, 0, 2].tolist(), [0, 2, 1])

    def test_a_surface_without_patches_is_called_after_the_file(self):
        self.assertEqual(strings(read(self.write(box())), "PatchNames"), ["part"])
        self.assertEqual(triangles(self.path).shape[0], 12)
        self.assertAlmostEqual(enclosed(triangles(self.path)), 1, delta=1e-12)

    def test_strips(self):
        stripper = vtkStripper()
        stripper.SetInputData(sphere())
        stripper.Update()
        self.assertGreater(stripper.GetOutput().GetNumberOfStrips(), 0)
        self.write(stripper.GetOutput())
        found = triangles(self.path)
        self.assertEqual(len(found), sphere().GetNumberOfCells())
        self.assertEqual(loose_edges(self.path), 0)
        self.write(sphere())
        self.assertAlmostEqual(enclosed(found), enclosed(triangles(self.path)), delta=1e-9)

    def test_vtks_own_writer(self):
        """As the page says: no names, and to be triangulated first."""
        triangulate = vtkTriangleFilter()
        triangulate.SetInputData(self.mesh.GetOutputDataObject(1))
        writer = vtkSTLWriter()
        writer.SetInputConnection(triangulate.GetOutputPort())
        writer.SetFileName(self.path)
        writer.Write()
        self.assertEqual(strings(read(self.path), "PatchNames"), ["Visualization Toolkit generated SLA File"])
        volume = cell_volumes(self.mesh.GetOutputDataObject(0)).sum()
        self.assertAlmostEqual(enclosed(triangles(self.path)) / volume, 1, delta=5e-3)  # its diagonals cut warped quads

    def test_refusals(self):
        self.write(box())
        with open(self.path, "rb") as file:
            good = file.read()
        self.write(vtkPolyData())
        self.assertEqual(len(self.messages.errors), 1)
        self.assertIn("no polygons", self.messages.errors[0])
        with open(self.path, "rb") as file:
            self.assertEqual(file.read(), good)
        self.write(box(), os.path.join(self.path, "below.stl"))
        self.assertIn("Cannot write", self.messages.errors[0])
        writer = pm.vtkSurfaceWriter()
        writer.SetInputDataObject(box())
        messages = Messages(writer)
        writer.Write()
        self.assertIn("FileName", messages.errors[0])


if __name__ == "__main__":
    unittest.main()
