# SPDX-License-Identifier: BSD-3-Clause
import unittest

import numpy

from support import Messages, arrays, box, chain, pm, sphere


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

    def test_what_was_made_is_on_the_faces_and_in_the_table(self):
        refine = chain(box(1, 0.8, 0.6), 0.1, Layers=4, FirstHeight=0.004)[-1]
        boundary, table = arrays(refine.GetOutputDataObject(1)), refine.GetOutputDataObject(refine.LAYERS)
        layers, reasons = boundary["cell Layers"], boundary["cell LayerReason"]
        for n in range(1, 5):
            self.assertEqual((layers == n).sum(), refine.GetFacesWithLayers(n))
        self.assertTrue(((layers < 4) == (reasons > 0)).all())
        several = layers > 1
        self.assertGreater(several.mean(), 0.9)
        first = boundary["cell FirstHeight"][several]
        self.assertGreater((abs(first / 0.004 - 1) < 0.2).mean(), 0.95)
        self.assertTrue((boundary["cell FirstHeightWanted"] == 0.004).all())
        self.assertTrue((boundary["cell LayerThickness"] >= boundary["cell FirstHeight"] * 0.999).all())
        inside, outside = boundary["cell GrowthInside"], boundary["cell GrowthOutside"]
        self.assertTrue((inside[several] > 1).all())
        self.assertTrue((inside[layers == 1] == 0).all())
        self.assertTrue((outside > 0).all())
        names = refine.GetOutputDataObject(1).GetFieldData().GetAbstractArray("LayerReasonNames")
        self.assertEqual(names.GetNumberOfValues(), 11)
        row = {table.GetColumnName(i): table.GetValue(0, i).ToString() for i in range(table.GetNumberOfColumns())}
        self.assertEqual(table.GetNumberOfRows(), 1)
        self.assertEqual(row["Patch"], "wall")
        self.assertEqual(int(row["Faces"]), refine.GetWallFaces())
        self.assertLess(numpy.median(outside), float(row["GrowthOutside95"]))
        self.assertGreater(numpy.quantile(outside, 0.9), float(row["GrowthOutside"]))
        self.assertGreaterEqual(inside.max(), float(row["GrowthInside95"]))
        self.assertGreater(float(row["GrowthInside95"]), 1.2)
        self.assertAlmostEqual(float(row["Area"]), 2 * (0.8 + 0.6 + 0.48), delta=0.02)
        for i, name in enumerate(names.GetValue(k) for k in range(1, 11)):
            self.assertEqual(int(row.get(name, 0)), (reasons == i + 1).sum(), name)

    def test_layers_on_patches_of_their_own(self):
        before = chain(box(), 0.12, last=5)[-1].GetOutput()
        refine = pm.vtkBoundaryRefine()
        refine.SetInputDataObject(before)
        refine.AddPatchLayer("w*", 0, 1.2, 0, 0, 0)
        refine.Update()
        self.assertEqual(refine.GetOutput().GetNumberOfCells(), before.GetNumberOfCells())
        refine.ClearPatchLayers()
        refine.Update()
        self.assertGreater(refine.GetOutput().GetNumberOfCells(), before.GetNumberOfCells())

    def test_contradictions_are_refused(self):
        before = chain(box(), 0.12, last=5)[-1].GetOutput()
        for properties, words in (({"YPlus": 1}, "needs the flow"),
                                  ({"FirstHeight": 0.1, "TotalThickness": 0.01}, "cannot grow")):
            refine = pm.vtkBoundaryRefine()
            refine.SetInputDataObject(before)
            for name, value in properties.items():
                getattr(refine, "Set" + name)(value)
            messages = Messages(refine)
            refine.Update()
            self.assertEqual(len(messages.errors), 1)
            self.assertIn(words, messages.errors[0])
            self.assertEqual(refine.GetOutput().GetNumberOfCells(), 0)
            self.assertEqual(refine.GetOutputDataObject(refine.LAYERS).GetNumberOfRows(), 0)

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
