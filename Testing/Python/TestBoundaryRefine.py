# SPDX-License-Identifier: BSD-3-Clause
import unittest

from support import Messages, arrays, chain, pm, sphere


class TestBoundaryRefine(unittest.TestCase):
    def test_layers_of_a_sphere(self):
        stages = chain(sphere(), 0.1, Layers=3)
        refine, before = stages[-1], stages[-2].GetOutput()
        faces = refine.GetWallFaces()
        self.assertEqual(faces, refine.GetOutputDataObject(1).GetNumberOfCells())
        by_layers = {n: refine.GetFacesWithLayers(n) for n in range(1, 4)}
        self.assertEqual(sum(by_layers.values()), faces)
        self.assertGreater(by_layers[3], 0.9 * faces)
        made = sum((n - 1) * count for n, count in by_layers.items())
        self.assertEqual(refine.GetOutput().GetNumberOfCells(), before.GetNumberOfCells() + made)
        layer = arrays(refine.GetOutput())["cell Layer"]
        self.assertEqual((layer == 1).sum(), faces)
        self.assertEqual((layer == 3).sum(), by_layers[3])

    def test_features_may_be_skipped(self):
        project = chain(sphere(), 0.1, last=4)[-1]
        refine = pm.vtkBoundaryRefine()
        refine.SetInputConnection(project.GetOutputPort())
        refine.Update()
        self.assertGreater(refine.GetOutput().GetNumberOfCells(), project.GetOutput().GetNumberOfCells())

    def test_refining_twice_is_refused(self):
        stages = chain(sphere(), 0.1)
        again = pm.vtkBoundaryRefine()
        again.SetInputConnection(stages[-1].GetOutputPort())
        messages = Messages(again)
        again.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("needs the output of Resolve Features", messages.errors[0])
        self.assertEqual(again.GetOutput().GetNumberOfCells(), 0)


if __name__ == "__main__":
    unittest.main()
