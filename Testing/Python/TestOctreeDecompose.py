# SPDX-License-Identifier: BSD-3-Clause
import unittest

import numpy as np
from support import Messages, arrays, chain, pm, sphere
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter


class TestOctreeDecompose(unittest.TestCase):
    def test_voxels_tile_the_brick(self):
        (octree,) = chain(sphere(), 0.05, last=1)
        grid = octree.GetOutput()
        size = vtkCellSizeFilter()
        size.SetInputData(grid)
        size.Update()
        volume = arrays(size.GetOutput())["cell Volume"].sum()
        x0, x1, y0, y1, z0, z1 = grid.GetBounds()
        self.assertAlmostEqual(volume, (x1 - x0) * (y1 - y0) * (z1 - z0), places=9)
        self.assertEqual(len(np.unique(arrays(grid)["points"], axis=0)), grid.GetNumberOfPoints(), "points are shared")

    def test_cells_on_the_surface_have_the_wanted_size(self):
        (octree,) = chain(sphere(), 0.05, last=1, SurfaceSize=0.05)
        found = arrays(octree.GetOutput())
        cut = found["cell Cut"] == 1
        corners = found["points"][found["connectivity"].reshape(-1, 8)]
        edge = corners[:, 7] - corners[:, 0]
        self.assertTrue(cut.any() and not cut.all())
        self.assertLessEqual(edge[cut].max(), 0.05 * (1 + 1e-12))

    def test_domain_and_boxes(self):
        bounds = (-2, 2, -1, 1, -1, 1)
        octree = pm.vtkOctreeDecompose()
        octree.SetInputDataObject(sphere())
        octree.SetFeatureSize(0.1)
        octree.SetUseDomain(True)
        octree.SetDomainBounds(*bounds)
        octree.Update()
        self.assertEqual(octree.GetOutput().GetBounds(), bounds)
        cells = octree.GetOutput().GetNumberOfCells()
        octree.AddRefineBox(1, 2, -1, 1, -1, 1, 0.1)
        octree.Update()
        self.assertGreater(octree.GetOutput().GetNumberOfCells(), cells)
        octree.ClearRefineBoxes()
        octree.Update()
        self.assertEqual(octree.GetOutput().GetNumberOfCells(), cells)

    def test_budget(self):
        octree = pm.vtkOctreeDecompose()
        octree.SetInputDataObject(sphere())
        octree.SetFeatureSize(0.01)
        octree.SetMaximumCells(100)
        messages = Messages(octree)
        octree.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertEqual(octree.GetOutput().GetNumberOfCells(), 0)

    def test_unknown_patch_is_an_error(self):
        octree = pm.vtkOctreeDecompose()
        octree.SetInputDataObject(sphere())
        octree.SetFeatureSize(0.1)
        octree.AddPatchSize("no such patch", 0.05)
        messages = Messages(octree)
        octree.Update()
        self.assertIn("no such patch", "".join(messages.errors + messages.warnings))

    def test_empty_geometry(self):
        octree = pm.vtkOctreeDecompose()
        octree.SetInputDataObject(vtkPolyData())
        messages = Messages(octree)
        octree.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("no triangles", messages.errors[0])
        self.assertEqual(octree.GetOutput().GetNumberOfCells(), 0)

    def test_output_is_empty_again_after_an_error(self):
        octree = pm.vtkOctreeDecompose()
        octree.SetInputDataObject(sphere())
        octree.SetFeatureSize(0.1)
        octree.Update()
        self.assertGreater(octree.GetOutput().GetNumberOfCells(), 0)
        messages = Messages(octree)
        octree.SetInputDataObject(vtkPolyData())
        octree.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertEqual(octree.GetOutput().GetNumberOfCells(), 0)

    def test_progress_and_abort(self):
        octree = pm.vtkOctreeDecompose()
        octree.SetInputDataObject(sphere())
        octree.SetFeatureSize(0.02)
        seen = []

        def progress(algorithm, _event):
            seen.append(algorithm.GetProgressText())
            algorithm.SetAbortExecute(1)

        octree.AddObserver("ProgressEvent", progress)
        messages = Messages(octree)
        octree.Update()
        self.assertTrue(any(seen), "a pass has a caption")
        self.assertEqual(len(messages.warnings), 1)
        self.assertIn("Stopped", messages.warnings[0])
        self.assertEqual(octree.GetOutput().GetNumberOfCells(), 0)


if __name__ == "__main__":
    unittest.main()
