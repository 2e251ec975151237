# SPDX-License-Identifier: BSD-3-Clause
import unittest

import numpy as np
from support import Messages, arrays, box, chain, pm, sphere


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
