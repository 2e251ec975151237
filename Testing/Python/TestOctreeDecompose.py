# SPDX-License-Identifier: BSD-3-Clause
import unittest

import numpy as np
from support import Messages, arrays, chain, pm, sphere, strings
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

    def test_every_leaf_says_why_it_is_small(self):
        octree = pm.vtkOctreeDecompose()
        octree.SetInputDataObject(sphere())
        octree.SetFeatureSize(0.03)
        octree.AddRefineSphere(0.6, 0.6, 0.6, 0.1, 0.03)
        octree.AddPatchSize("wall", 0.06)
        octree.Update()
        found, names = arrays(octree.GetOutput()), strings(octree.GetOutput(), "RefinedByNames")
        reason, patch = found["cell RefinedBy"], found["cell RefinedByPatch"]
        self.assertEqual(len(names), 19)
        self.assertTrue((found["cell Level"][reason == 0] == 0).all() and (reason[found["cell Level"] == 0] == 0).all())
        self.assertGreater((reason == names.index("sphere")).sum(), 0)
        by_patch = reason == names.index("patch size")
        self.assertTrue(by_patch.any() and (patch[by_patch] == 0).all())
        self.assertTrue((patch[reason == names.index("balance")] == -1).all())

    def test_shapes_and_distances(self):
        def cells(**rows):
            octree = pm.vtkOctreeDecompose()
            octree.SetInputDataObject(sphere())
            octree.SetInputDataObject(1, sphere(radius=0.2))
            octree.SetFeatureSize(0.02)
            for name, values in rows.items():
                getattr(octree, "Add" + name)(*values)
            messages = Messages(octree)
            octree.Update()
            self.assertEqual(messages.errors, [])
            return octree.GetOutput().GetNumberOfCells()

        plain = cells()
        self.assertGreater(cells(RefineSphere=(0, 0, 0, 0.2, 0.02)), plain)
        self.assertGreater(cells(RefineCylinder=(0, 0, -0.3, 0, 0, 0.3, 0.1, 0.02)), plain)
        self.assertGreater(cells(PatchDistance=("wall", 0.1, 0.02)), plain)
        self.assertGreater(cells(SurfaceDistance=(0.05, 0.02)), plain)

    def test_size_surface_serves_the_one_filter_too(self):
        mesh = pm.vtkProjectionMesh()
        mesh.SetInputDataObject(sphere())
        mesh.SetFeatureSize(0.05)
        mesh.SetStopAfter(2)
        mesh.Update()
        plain = mesh.GetOutput().GetNumberOfCells()
        mesh.AddSurfaceDistance(0.1, 0.05)
        messages = Messages(mesh)
        mesh.Update()
        self.assertIn("no size surface", "".join(messages.errors))
        mesh.SetInputDataObject(1, sphere(radius=0.1))
        mesh.Update()
        self.assertGreater(mesh.GetOutput().GetNumberOfCells(), plain)

    def test_refused_sizes(self):
        for name, values in (("RefineSphere", (0, 0, 0, 0, 0.1)), ("RefineCylinder", (0, 0, 0, 0, 0, 0, 1, 0.1)),
                             ("PatchDistance", ("nowhere", 0.1, 0.1)), ("PatchDistance", ("wall", 0.1, -1)),
                             ("SurfaceDistance", (0.1, 0.1))):
            octree = pm.vtkOctreeDecompose()
            octree.SetInputDataObject(sphere())
            octree.SetFeatureSize(0.1)
            getattr(octree, "Add" + name)(*values)
            messages = Messages(octree)
            octree.Update()
            self.assertEqual(len(messages.errors), 1, name)
            self.assertEqual(octree.GetOutput().GetNumberOfCells(), 0)

    def test_budget_of_memory(self):
        octree = pm.vtkOctreeDecompose()
        octree.SetInputDataObject(sphere())
        octree.SetFeatureSize(0.01)
        octree.SetMaximumMemory(0.001)
        messages = Messages(octree)
        octree.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("0.001 GB", messages.errors[0])

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
