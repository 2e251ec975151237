# SPDX-License-Identifier: BSD-3-Clause
"""Mesh Validity against measures computed here, and its refusals."""
import unittest

import numpy as np
from support import Messages, box, chain, differences, pm, sphere
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkMassProperties, vtkTriangleFilter


def measured(stage, **properties):
    validity = pm.vtkMeshValidity()
    validity.SetInputConnection(stage.GetOutputPort(0))
    for name, value in properties.items():
        getattr(validity, "Set" + name)(value)
    validity.Update()
    return validity


def cell_array(validity, name):
    return vtk_to_numpy(validity.GetOutput(0).GetCellData().GetArray(name))


class MeshValidity(unittest.TestCase):
    def test_front_of_equal_cubes(self):
        """Before any node moves, every cell is a cube: all measures are known."""
        front = chain(box(), 0.2, last=2, RefineEdges=False, Separate=False)[-1]
        validity = measured(front)
        self.assertEqual(validity.GetViolations(), 0, validity.GetDescription())
        self.assertEqual(validity.GetDescription(), "")
        cells = front.GetOutput(0).GetNumberOfCells()
        self.assertGreater(cells, 8)
        np.testing.assert_allclose(cell_array(validity, "CellVolume"), 1, rtol=1e-5)
        np.testing.assert_allclose(cell_array(validity, "SmallestTet"), 1 / 24, rtol=1e-5)
        np.testing.assert_allclose(cell_array(validity, "Angle"), 0, atol=1e-4)
        np.testing.assert_allclose(cell_array(validity, "Skewness"), 0, atol=1e-5)
        size = front.GetOutput(0).GetFieldData().GetArray("FinestSize").GetValue(0)
        self.assertAlmostEqual(validity.GetTotalVolume() / (cells * size ** 3), 1, places=9)
        self.assertEqual(2 * validity.GetInternalFaces() + validity.GetBoundaryFaces(), 6 * cells)

    def test_volume_is_that_of_the_boundary(self):
        validity = measured(chain(sphere(), 0.1)[-1])
        triangles = vtkTriangleFilter()
        triangles.SetInputData(validity.GetOutputDataObject(1))
        mass = vtkMassProperties()
        mass.SetInputConnection(triangles.GetOutputPort())
        mass.Update()
        self.assertAlmostEqual(validity.GetTotalVolume() / mass.GetVolume(), 1, delta=2e-3)
        self.assertEqual(validity.GetBoundaryFaces(), validity.GetOutputDataObject(1).GetNumberOfCells())

    def test_worst_values_are_the_worst_of_the_arrays(self):
        validity = measured(chain(sphere(), 0.1)[-1])
        self.assertEqual(validity.GetViolations(), 0, validity.GetDescription())
        self.assertAlmostEqual(validity.GetWorstVolume(), cell_array(validity, "CellVolume").min(), places=5)
        self.assertAlmostEqual(validity.GetWorstTet(), cell_array(validity, "SmallestTet").min(), places=5)
        self.assertAlmostEqual(max(validity.GetWorstAngleInternal(), validity.GetWorstAngleBoundary()),
                               cell_array(validity, "Angle").max(), places=3)
        self.assertAlmostEqual(validity.GetWorstWarpage(), cell_array(validity, "Warpage").max(), places=3)
        self.assertLess(validity.GetWorstOpenness(), 1e-12)

    def test_stricter_limits_are_broken(self):
        stage = chain(sphere(), 0.1, last=4)[-1]
        wide = measured(stage)
        worst = wide.GetWorstAngleInternal()
        strict = measured(stage, MaximumAngleInternal=0.9 * worst)
        self.assertGreater(strict.GetViolations(), 0)
        self.assertIn("angle", strict.GetDescription())

    def test_the_mesh_passes_through_unchanged(self):
        stage = chain(sphere(), 0.1, last=3)[-1]
        validity = measured(stage)
        added = {f"cell {n}" for n in ("CellVolume", "SmallestTet", "Degradation", "Angle", "Warpage", "Skewness")}
        self.assertEqual(set(differences(stage.GetOutput(0), validity.GetOutput(0))), added)

    def test_octree_is_refused(self):
        octree = chain(box(), 0.25, last=1)[-1]
        validity = pm.vtkMeshValidity()
        validity.SetInputConnection(octree.GetOutputPort(0))
        messages = Messages(validity)
        validity.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertEqual(validity.GetOutput(0).GetNumberOfCells(), 0)


if __name__ == "__main__":
    unittest.main()
