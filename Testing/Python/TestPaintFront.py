# SPDX-License-Identifier: BSD-3-Clause
import math
import unittest

from support import Messages, arrays, chain, pm, sphere, strings
from vtkmodules.vtkFiltersCore import vtkThreshold
from vtkmodules.vtkCommonDataModel import vtkDataObject


class TestPaintFront(unittest.TestCase):
    def setUp(self):
        self.geometry = sphere()
        (self.octree,) = chain(self.geometry, 0.05, last=1)

    def front(self, grid, **properties):
        front = pm.vtkPaintFront()
        front.SetInputDataObject(0, grid)
        front.SetInputDataObject(1, self.geometry)
        for key, value in properties.items():
            getattr(front, "Set" + key)(value)
        return front

    def test_inside_of_a_sphere(self):
        front = self.front(self.octree.GetOutput())
        front.Update()
        grid, boundary = front.GetOutputDataObject(0), front.GetOutputDataObject(1)
        found = arrays(grid)
        volumes, is_open = found["field RegionVolume"], found["field RegionOpen"]
        self.assertEqual(sorted(volumes, reverse=True), list(volumes), "largest first")
        self.assertEqual(is_open.sum(), 1)
        volume = volumes[is_open == 0].max()
        self.assertLess(volume, math.pi / 6)
        self.assertGreater(volume, math.pi / 6 * 0.6)
        self.assertEqual(strings(boundary, "PatchNames"), ["wall"])
        self.assertEqual(boundary.GetNumberOfCells(), len(arrays(grid)["field BoundaryPatch"]))
        radius = (arrays(boundary)["points"] ** 2).sum(axis=1).max() ** 0.5
        self.assertLess(radius, 0.5)

    def test_seed_points(self):
        front = self.front(self.octree.GetOutput(), Region=2)
        front.AddSeedPoint(0, 0, 0)
        front.Update()
        inside = self.front(self.octree.GetOutput())
        inside.Update()
        self.assertGreater(front.GetOutput().GetNumberOfCells(), 0)
        self.assertEqual(front.GetOutput().GetNumberOfCells(), inside.GetOutput().GetNumberOfCells())

    def test_seed_point_outside_everything(self):
        front = self.front(self.octree.GetOutput(), Region=2)
        front.AddSeedPoint(100, 0, 0)
        messages = Messages(front)
        front.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertEqual(front.GetOutputDataObject(0).GetNumberOfCells(), 0)
        self.assertEqual(front.GetOutputDataObject(1).GetNumberOfCells(), 0)

    def test_edited_octree_is_refused(self):
        threshold = vtkThreshold()
        threshold.SetInputData(self.octree.GetOutput())
        threshold.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_CELLS, "Cut")
        threshold.SetLowerThreshold(0.5)
        threshold.SetThresholdFunction(vtkThreshold.THRESHOLD_UPPER)
        threshold.Update()
        front = self.front(threshold.GetOutput())
        messages = Messages(front)
        front.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("not as the suite made it", messages.errors[0])
        self.assertEqual(front.GetOutput().GetNumberOfCells(), 0)

    def test_edited_cut_flag_is_refused(self):
        grid = self.octree.GetOutput().NewInstance()
        grid.DeepCopy(self.octree.GetOutput())
        cut = grid.GetCellData().GetArray("Cut")
        cut.SetValue(0, 1 - cut.GetValue(0))
        front = self.front(grid)
        messages = Messages(front)
        front.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("arrays have changed", messages.errors[0])

    def test_wrong_stage_is_refused(self):
        stages = chain(self.geometry, 0.1, last=2)
        front = self.front(stages[-1].GetOutput())
        messages = Messages(front)
        front.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("needs the output of Octree Decompose", messages.errors[0])


if __name__ == "__main__":
    unittest.main()
