# SPDX-License-Identifier: BSD-3-Clause
import math
import unittest

import numpy as np
from support import Messages, arrays, box, chain, pm, polyline, sphere
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersCore import vtkAppendPolyData


class TestResolveFeatures(unittest.TestCase):
    def test_edges_of_a_box(self):
        features = chain(box(1, 0.8, 0.6), 0.08, last=5)[-1]
        self.assertAlmostEqual(features.GetFeatureLength(), 4 * (1 + 0.8 + 0.6), places=6)
        self.assertEqual(features.GetCorners(), 8)
        self.assertGreater(features.GetResolvedLength(), 0.9 * features.GetFeatureLength())
        self.assertGreaterEqual(features.GetResolvedCorners(), 7)

    def test_corners_of_a_box_are_mesh_points(self):
        features = chain(box(), 0.1, last=5)[-1]
        points = arrays(features.GetOutputDataObject(1))["points"]
        at_corner = np.all(np.abs(np.abs(points) - 0.5) < 1e-6, axis=1)
        self.assertEqual(at_corner.sum(), features.GetResolvedCorners())

    def test_a_smooth_surface_has_none(self):
        features = chain(sphere(64), 0.1, last=5)[-1]
        self.assertEqual(features.GetFeatureLength(), 0)
        self.assertEqual(features.GetCorners(), 0)

    def test_unresolved_parts_are_shown_with_the_reason(self):
        inner = box(0.4, 0.4, 0.4)  # nothing of it is on the outer box's wall
        both = vtkAppendPolyData()
        both.AddInputData(box())
        both.AddInputData(inner)
        both.Update()
        features = chain(both.GetOutput(), 0.1, last=5, Region=pm.vtkPaintFront.OUTSIDE)[-1]
        parts = features.GetOutputDataObject(features.UNRESOLVED)
        data = parts.GetCellData()
        hidden = [i for i in range(parts.GetNumberOfLines())
                  if data.GetAbstractArray("Why").GetValue(i) == "no wall of the mesh sees it"]
        self.assertEqual(len(hidden), 12)
        self.assertAlmostEqual(sum(data.GetArray("Length").GetValue(i) for i in hidden), 12 * 0.4, places=6)
        for i in hidden:
            self.assertLessEqual(np.abs(parts.GetCell(i).GetBounds()).max(), 0.2 + 1e-6)

    def test_given_curves_are_followed(self):
        points = [(-0.5, -0.2, 0.5), (0, 0.1, 0.5), (0.5, 0.13, 0.5)]
        features = chain(box(), 0.1, last=5)[-1]
        features.SetInputDataObject(2, polyline(points))
        features.Update()
        length = 12 + math.dist(points[0], points[1]) + math.dist(points[1], points[2])
        self.assertAlmostEqual(features.GetFeatureLength(), length)
        self.assertGreater(features.GetResolvedLength(), 0.97 * length)

    def test_given_curves_without_lines_are_an_error(self):
        projected = chain(box(), 0.2, last=4)[-1]
        features = pm.vtkResolveFeatures()
        features.SetInputDataObject(0, projected.GetOutputDataObject(0))
        features.SetInputDataObject(1, box())
        features.SetInputDataObject(2, vtkPolyData())
        messages = Messages(features)
        features.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("contain no lines", messages.errors[0])

    def test_layer_that_was_not_projected_is_refused(self):
        stages = chain(sphere(), 0.1, last=3)
        features = pm.vtkResolveFeatures()
        features.SetInputDataObject(0, stages[2].GetOutput())
        features.SetInputDataObject(1, sphere())
        messages = Messages(features)
        features.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("needs the output of Project", messages.errors[0])
        self.assertEqual(features.GetOutput().GetNumberOfCells(), 0)


if __name__ == "__main__":
    unittest.main()
