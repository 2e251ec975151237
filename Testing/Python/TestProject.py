# SPDX-License-Identifier: BSD-3-Clause
import unittest

import numpy as np
from support import Messages, arrays, chain, pm, sphere


def off_sphere(stage):
    points = arrays(stage.GetOutputDataObject(1))["points"]
    return np.abs(np.linalg.norm(points, axis=1) - 0.5)


class TestProject(unittest.TestCase):
    def test_wall_reaches_the_sphere(self):
        stages = chain(sphere(64), 0.05, last=4)
        self.assertGreater(off_sphere(stages[2]).max(), 0.02)
        self.assertLess(off_sphere(stages[3]).max(), 0.003)  # the facets of the sphere leave 0.0012
        self.assertEqual(stages[2].GetOutput().GetNumberOfCells(), stages[3].GetOutput().GetNumberOfCells())

    def test_the_input_stays_as_it_was(self):
        stages = chain(sphere(), 0.1, last=3)
        before = {name: values.copy() for name, values in arrays(stages[2].GetOutput()).items()}
        project = pm.vtkProject()
        project.SetInputConnection(0, stages[2].GetOutputPort())
        project.SetInputDataObject(1, sphere())
        project.Update()
        after = arrays(stages[2].GetOutput())
        self.assertEqual(set(before), set(after))
        for name, values in before.items():
            self.assertTrue(np.array_equal(values, after[name]), name)

    def test_nodes_that_stay_short_are_listed_with_what_holds_them(self):
        stages = chain(sphere(64), 0.05, last=3)
        project = pm.vtkProject()
        project.SetInputConnection(0, stages[2].GetOutputPort())
        project.SetInputDataObject(1, sphere(64))
        project.SetMaximumWarpage(1)
        project.Update()
        data = project.GetOutputDataObject(1).GetFieldData()
        held = data.GetAbstractArray("StuckBy")
        reasons = [held.GetValue(i) for i in range(held.GetNumberOfValues())]
        self.assertIn("warpage of a face", reasons)
        self.assertEqual(data.GetArray("StuckPosition").GetNumberOfTuples(), len(reasons))
        self.assertGreater(data.GetArray("StuckDistance").GetRange()[0], 0)
        project.SetMaximumWarpage(72)
        project.Update()
        self.assertEqual(project.GetOutputDataObject(1).GetFieldData().GetAbstractArray("StuckBy").GetNumberOfValues(), 0)

    def test_front_without_layer_is_refused(self):
        stages = chain(sphere(), 0.1, last=2)
        project = pm.vtkProject()
        project.SetInputDataObject(0, stages[1].GetOutput())
        project.SetInputDataObject(1, sphere())
        messages = Messages(project)
        project.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("needs the output of Dummy Layer, but this grid is the output of Paint Front", messages.errors[0])
        self.assertEqual(project.GetOutputDataObject(0).GetNumberOfCells(), 0)
        self.assertEqual(project.GetOutputDataObject(1).GetNumberOfCells(), 0)

    def test_a_moved_point_is_noticed(self):
        stages = chain(sphere(), 0.1, last=3)
        grid = stages[2].GetOutput().NewInstance()
        grid.DeepCopy(stages[2].GetOutput())
        x, y, z = grid.GetPoint(7)
        grid.GetPoints().SetPoint(7, x + 1e-15, y, z)
        project = pm.vtkProject()
        project.SetInputDataObject(0, grid)
        project.SetInputDataObject(1, sphere())
        messages = Messages(project)
        project.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("have changed", messages.errors[0])


if __name__ == "__main__":
    unittest.main()
