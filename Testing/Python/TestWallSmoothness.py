# SPDX-License-Identifier: BSD-3-Clause
"""The measure of a wall's smoothness: known angles, faces near sharp edges left out, flipped triangles no matter."""
import unittest

import numpy as np
import support
import vtkmodules.vtkCommonCore  # noqa: F401
import wall_smoothness
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkFiltersGeneral import vtkTransformPolyDataFilter


def triangles(data):
    filter_ = vtkTriangleFilter()
    filter_.SetInputData(data)
    filter_.Update()
    return filter_.GetOutput()


def turned(data, degrees):
    transform, filter_ = vtkTransform(), vtkTransformPolyDataFilter()
    transform.RotateX(degrees)
    filter_.SetTransform(transform)
    filter_.SetInputData(data)
    filter_.Update()
    return filter_.GetOutput()


class WallSmoothness(unittest.TestCase):
    def mesh(self, geometry, size):
        return support.chain(geometry, size, last=5, BaseSize=size)[-1].GetOutputDataObject(1)

    def test_flat_walls_have_no_deviation(self):
        box = triangles(support.box())
        off = wall_smoothness.deviations(self.mesh(box, 0.08), box, 0.08)
        self.assertGreater(len(off), 200)
        self.assertLess(off.max(), 1e-3)

    def test_a_turned_geometry_is_seen_by_its_angle(self):
        box = triangles(support.box())
        off = wall_smoothness.deviations(self.mesh(box, 0.08), turned(box, 3), 0.08)
        x_sides = off < 0.01  # those turn in their own planes
        self.assertGreater(x_sides.sum(), 50)
        np.testing.assert_allclose(off[~x_sides], 3, atol=1e-3)

    def test_sharp_edges(self):
        lines = wall_smoothness.sharp_edges(triangles(support.box()), 30)
        self.assertEqual(lines.GetNumberOfLines(), 12)
        self.assertIsNone(wall_smoothness.sharp_edges(support.sphere(), 30))

    def test_flipped_triangles_change_nothing(self):
        box = triangles(support.box())
        ids = vtk_to_numpy(box.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        ids[::3] = ids[::3, ::-1].copy()
        self.assertEqual(wall_smoothness.sharp_edges(box, 30).GetNumberOfLines(), 12)

    def test_the_wall_of_a_sphere_is_smooth(self):
        sphere = support.sphere(resolution=180)
        off = wall_smoothness.deviations(self.mesh(sphere, 0.05), sphere, 0.05)
        self.assertGreater(len(off), 800)
        self.assertLess(np.median(off), 1.5)
        self.assertLess(np.percentile(off, 95), 4)


if __name__ == "__main__":
    unittest.main()
