# SPDX-License-Identifier: BSD-3-Clause
import unittest

import numpy as np
from support import Messages, arrays, chain, pm, sphere


class TestDummyLayer(unittest.TestCase):
    def test_one_prism_on_each_wall_face(self):
        stages = chain(sphere(), 0.1, last=3)
        front, layer = stages[1].GetOutput(), stages[2].GetOutput()
        faces = stages[1].GetOutputDataObject(1).GetNumberOfCells()
        self.assertEqual(layer.GetNumberOfCells(), front.GetNumberOfCells() + faces)
        self.assertEqual((arrays(layer)["cell Layer"] == 1).sum(), faces)

    def test_thickness_is_the_height_over_the_cell_size(self):
        heights = []
        for thickness in (0.2, 0.4):  # thinner prisms are below the limit on degradation, and are raised
            stages = chain(sphere(), 0.1, last=3, Thickness=thickness, SurfaceSize=0.1)
            found = arrays(stages[2].GetOutput())
            wall = found["point Base"] >= 0
            step = found["points"][wall] - found["points"][found["point Base"][wall]]
            heights.append(np.median(np.linalg.norm(step, axis=1)))
        self.assertGreater(heights[0], 0)
        self.assertAlmostEqual(heights[1] / heights[0], 2, delta=0.3)

    def test_octree_is_refused(self):
        (octree,) = chain(sphere(), 0.1, last=1)
        layer = pm.vtkDummyLayer()
        layer.SetInputDataObject(octree.GetOutput())
        messages = Messages(layer)
        layer.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("needs the output of Paint Front", messages.errors[0])
        self.assertIn("output of Octree Decompose", messages.errors[0])
        self.assertEqual(layer.GetOutput().GetNumberOfCells(), 0)


if __name__ == "__main__":
    unittest.main()
