# SPDX-License-Identifier: BSD-3-Clause
"""Detect Features on shapes whose curves are known, and its refusals."""
import math
import unittest

import numpy as np
from support import Messages, box, pm, polyline, sphere
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkFiltersCore import vtkAppendPolyData
from vtkmodules.vtkFiltersGeneral import vtkTransformPolyDataFilter

SHARP, INTERSECTION, GIVEN = 1, 16, 32


def moved(data, x, y, z):
    transform = vtkTransform()
    transform.Translate(x, y, z)
    move = vtkTransformPolyDataFilter()
    move.SetInputData(data)
    move.SetTransform(transform)
    move.Update()
    return move.GetOutput()


def two_boxes():
    both = vtkAppendPolyData()
    both.AddInputData(box())
    both.AddInputData(moved(box(), 0.5, 0.5, 0.5))
    both.Update()
    return both.GetOutput()


def detected(geometry, **properties):
    features = pm.vtkDetectFeatures()
    features.SetInputData(geometry)
    for name, value in properties.items():
        getattr(features, "Set" + name)(value)
    features.Update()
    return features.GetOutputDataObject(0)


def array(output, name):
    return vtk_to_numpy(output.GetCellData().GetArray(name))


class DetectFeatures(unittest.TestCase):
    def test_cube(self):
        output = detected(box())
        self.assertEqual(output.GetNumberOfVerts(), 8)
        self.assertEqual(output.GetNumberOfLines(), 12)
        self.assertEqual(sorted(array(output, "Kind")), [0] * 8 + [SHARP] * 12)
        np.testing.assert_array_equal(array(output, "Curve"), [-1] * 8 + list(range(12)))
        np.testing.assert_allclose(array(output, "Length"), [0] * 8 + [1] * 12)

    def test_given_curves(self):
        features = pm.vtkDetectFeatures()
        features.SetInputData(0, box())
        features.SetInputData(1, polyline([(-0.5, 0, 0.5), (0.5, 0.2, 0.5)]))
        features.Update()
        output = features.GetOutputDataObject(0)
        kind = array(output, "Kind")
        self.assertEqual(output.GetNumberOfLines(), 12 + 2 + 1)  # two edges of the box are split
        self.assertAlmostEqual(array(output, "Length")[kind == GIVEN].sum(), math.hypot(1, 0.2))

    def test_two_boxes_cut_in_a_hexagon(self):
        output = detected(two_boxes())
        length, kind = array(output, "Length"), array(output, "Kind")
        self.assertAlmostEqual(length[kind == INTERSECTION].sum(), 3, places=12)
        self.assertAlmostEqual(length[kind == SHARP].sum(), 24, places=12)
        self.assertEqual(output.GetNumberOfVerts(), 16 + 6)
        self.assertEqual(detected(two_boxes(), Intersections=False).GetNumberOfLines(), 24)

    def test_angle(self):
        """Facets of a coarse sphere are edges only for an angle below the one between them."""
        self.assertEqual(detected(sphere(24)).GetNumberOfCells(), 0)
        self.assertGreater(detected(sphere(24), SharpAngle=2).GetNumberOfLines(), 100)

    def test_closed_curves_end_where_they_start(self):
        pierced = vtkAppendPolyData()
        pierced.AddInputData(sphere(24))
        pierced.AddInputData(moved(sphere(24), 0.5, 0.1, 0.05))
        pierced.Update()
        output = detected(pierced.GetOutput())
        self.assertEqual(output.GetNumberOfCells(), 1)
        line = output.GetCell(0).GetPointIds()
        self.assertEqual(line.GetId(0), line.GetId(line.GetNumberOfIds() - 1))
        radius = math.sqrt(0.25 - (0.25 + 0.01 + 0.0025) / 4)
        self.assertAlmostEqual(array(output, "Length")[0], 2 * math.pi * radius, delta=0.05)

    def test_nothing_to_look_at_is_refused(self):
        features = pm.vtkDetectFeatures()
        features.SetInputData(vtkPolyData())
        messages = Messages(features)
        features.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertEqual(features.GetOutputDataObject(0).GetNumberOfCells(), 0)


if __name__ == "__main__":
    unittest.main()
