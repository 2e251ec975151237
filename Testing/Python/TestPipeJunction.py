# SPDX-License-Identifier: BSD-3-Clause
"""The pipe junction: the generator gives the shipped files; the clean model is closed, the dirty one is not."""
import math
import os
import sys
import tempfile
import unittest

from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkMassProperties
from vtkmodules.vtkIOGeometry import vtkSTLReader

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Data")
sys.path.insert(0, DATA)
import pipe_junction  # noqa: E402

PATCHES = ["inlet", "wall", "outlet1", "outlet2", "outlet3"]


def read(directory, name):
    reader = vtkSTLReader()
    reader.SetFileName(os.path.join(directory, name))
    reader.Update()
    return reader.GetOutput()


def edge_count(surface, kind, angle=None):
    """Edges of one kind: Boundary, NonManifold or Feature."""
    edges = vtkFeatureEdges()
    edges.SetInputData(surface)
    for other in ("Boundary", "NonManifold", "Feature", "Manifold"):
        getattr(edges, f"Set{other}Edges")(other == kind)
    if angle is not None:
        edges.SetFeatureAngle(angle)
    edges.Update()
    return edges.GetOutput().GetNumberOfLines()


def volume_and_area(surface):
    mass = vtkMassProperties()
    mass.SetInputData(surface)
    mass.Update()
    return mass.GetVolume(), mass.GetSurfaceArea()


def solids(path):
    with open(path, encoding="ascii") as lines:
        return [line.split()[1] for line in lines if line.startswith("solid")]


class PipeJunction(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.TemporaryDirectory()
        pipe_junction.write_models(cls.directory.name)
        cls.clean = read(cls.directory.name, "pipe_junction.stl")
        cls.dirty = read(cls.directory.name, "pipe_junction_dirty.stl")

    @classmethod
    def tearDownClass(cls):
        cls.directory.cleanup()

    def test_shipped_files_are_the_generated_ones(self):
        for name in ("pipe_junction.stl", "pipe_junction_dirty.stl"):
            with open(os.path.join(DATA, name), "rb") as shipped:
                with open(os.path.join(self.directory.name, name), "rb") as generated:
                    self.assertEqual(shipped.read(), generated.read(), name)

    def test_patches(self):
        for name in ("pipe_junction.stl", "pipe_junction_dirty.stl"):
            self.assertEqual(solids(os.path.join(self.directory.name, name)), PATCHES)

    def test_clean_model_is_a_closed_sphere(self):
        self.assertEqual(self.clean.GetNumberOfCells(), 1956)
        self.assertEqual(edge_count(self.clean, "Boundary"), 0)
        self.assertEqual(edge_count(self.clean, "NonManifold"), 0)
        points, faces = self.clean.GetNumberOfPoints(), self.clean.GetNumberOfCells()
        self.assertEqual(points - 3 * faces // 2 + faces, 2)  # Euler's number

    def test_clean_model_has_the_given_dimensions(self):
        bounds = self.clean.GetBounds()
        for have, want in zip(bounds, (0, 0.15, -0.02, 0.02, -0.0575, 0.0575)):
            self.assertAlmostEqual(have, want, places=6)

    def test_sharp_edges_are_the_rims_and_the_creases_alone(self):
        """Four rims and two creases of 40 edges each; everywhere else the surface is smooth."""
        self.assertEqual(edge_count(self.clean, "Feature", 40), 240)
        self.assertEqual(edge_count(self.clean, "Feature", 20), 240)

    def test_volume_and_area(self):
        """Against the cylinders, less the curved piece that a branch and the main pipe share (integrated)."""
        volume, area = volume_and_area(self.clean)
        exact_volume = math.pi * 0.02 ** 2 * 0.15
        exact_area = 2 * math.pi * 0.02 * 0.15 + 2 * math.pi * 0.02 ** 2
        for radius in (0.015, 0.0125):
            steps = 2000
            for k in range(steps):
                phi = math.pi * (k + 0.5) / steps
                y = radius * math.cos(phi)
                height = 0.0575 - math.sqrt(0.02 ** 2 - y * y)
                exact_volume += 2 * (radius * math.sin(phi)) ** 2 * height * math.pi / steps
                exact_area += 2 * radius * height * math.pi / steps  # the branch's side ...
                hole = 2 * radius * math.sin(phi) * 0.02 / math.sqrt(0.02 ** 2 - y * y)
                exact_area -= hole * radius * math.sin(phi) * math.pi / steps  # ... less the hole it stands on
            exact_area += math.pi * radius ** 2
        self.assertAlmostEqual(volume / exact_volume, 1, delta=0.006)
        self.assertAlmostEqual(area / exact_area, 1, delta=0.003)
        self.assertLess(volume, exact_volume)  # facets are chords

    def test_dirty_model_has_the_stated_faults(self):
        self.assertEqual(self.dirty.GetNumberOfCells(), 1911)
        self.assertEqual(edge_count(self.dirty, "Boundary"), 351)
        self.assertGreater(edge_count(self.dirty, "NonManifold"), 0)

    def test_faults_are_small(self):
        """No point of the dirty model is farther than 0.8 mm from the clean surface."""
        from vtkmodules.vtkCommonCore import mutable
        from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator
        locator = vtkStaticCellLocator()
        locator.SetDataSet(self.clean)
        locator.BuildLocator()
        worst, point, cell, sub, distance2 = 0.0, [0.0] * 3, mutable(0), mutable(0), mutable(0.0)
        for i in range(self.dirty.GetNumberOfPoints()):
            locator.FindClosestPoint(self.dirty.GetPoint(i), point, cell, sub, distance2)
            worst = max(worst, math.sqrt(distance2.get()))
        self.assertLess(worst, 0.8e-3)


if __name__ == "__main__":
    unittest.main()
