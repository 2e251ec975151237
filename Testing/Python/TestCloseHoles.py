# SPDX-License-Identifier: BSD-3-Clause
import math
import unittest

import numpy as np
from support import Messages, arrays, box, chain, pm, sphere, strings
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet, vtkPolyData
from vtkmodules.vtkCommonCore import vtkIdList

SIZE = 0.04


def punched(surface, centre, radius):
    """A copy without the triangles whose centre lies in the ball."""
    points = vtk_to_numpy(surface.GetPoints().GetData())
    kept = vtkPolyData()
    kept.SetPoints(surface.GetPoints())
    kept.Allocate(surface.GetNumberOfCells())
    ids = vtkIdList()
    for cell in range(surface.GetNumberOfCells()):
        surface.GetCellPoints(cell, ids)
        corners = [ids.GetId(k) for k in range(ids.GetNumberOfIds())]
        if np.linalg.norm(points[corners].mean(axis=0) - centre) > radius:
            kept.InsertNextCell(surface.GetCellType(cell), ids)
    return kept


def close_holes(geometry, **properties):
    holes = pm.vtkCloseHoles()
    holes.SetInputDataObject(0, geometry)
    holes.SetFeatureSize(SIZE)
    holes.SetSurfaceSize(SIZE)
    for key, value in properties.items():
        getattr(holes, "Set" + key)(value)
    return holes


class TestCloseHoles(unittest.TestCase):
    def setUp(self):
        self.whole = sphere(64)
        self.leaky = punched(self.whole, (0.5, 0, 0), 0.12)

    def volume(self, geometry):
        front = chain(geometry, SIZE, last=2, SurfaceSize=SIZE)[-1]
        self.assertGreater(front.GetOutput().GetNumberOfCells(), 0)
        found = arrays(front.GetOutput())
        return found["field RegionVolume"][found["field RegionOpen"] == 0].max()

    def test_leak_is_shown_at_the_hole(self):
        holes = close_holes(self.leaky, Method=0)
        holes.Update()
        paths, table = holes.GetOutputDataObject(1), holes.GetOutputDataObject(3)
        self.assertEqual(table.GetNumberOfRows(), 1)
        self.assertEqual(paths.GetNumberOfLines(), 1)
        self.assertEqual(paths.GetNumberOfVerts(), 1)
        width = table.GetColumnByName("Width").GetValue(0)
        place = np.array(table.GetColumnByName("Place").GetTuple3(0))
        self.assertGreater(width, 0.18)
        self.assertLess(width, 0.26)
        self.assertLess(np.linalg.norm(place - (0.5, 0, 0)), SIZE)
        self.assertEqual(table.GetColumnByName("Closed").GetValue(0), 0)
        self.assertGreater(table.GetColumnByName("SealingSize").GetValue(0), width)
        found = {name: vtk_to_numpy(paths.GetCellData().GetArray(name)) for name in ("Leak", "NarrowestWidth", "SealingSize")}
        self.assertEqual(list(found["Leak"]), [0, 0])
        self.assertEqual(list(found["NarrowestWidth"]), [width, width])
        points = vtk_to_numpy(paths.GetPoints().GetData())
        clearance = np.abs(np.linalg.norm(points, axis=1) - 0.5)  # at most: the hole has no surface
        widths = vtk_to_numpy(paths.GetPointData().GetArray("Width"))
        self.assertTrue((widths >= 2 * clearance - 0.01).all())
        self.assertLess(np.linalg.norm(points[0]), 0.5)
        self.assertGreater(np.linalg.norm(points[-1]), 0.5)
        self.assertEqual(holes.GetOutputDataObject(0).GetNumberOfCells(), self.leaky.GetNumberOfCells())

    def test_closed_geometry_meshes_like_the_whole_one(self):
        whole = self.volume(self.whole)
        for method in (1, 2):
            holes = close_holes(self.leaky, Method=method)
            holes.Update()
            closed = holes.GetOutputDataObject(0)
            self.assertEqual(strings(closed, "PatchNames"), ["wall", "closed_holes"])
            self.assertAlmostEqual(self.volume(closed) / whole, 1, delta=0.03)
            membranes = arrays(holes.GetOutputDataObject(2))
            self.assertEqual(membranes["cell Closed"].min(), 1)

    def test_closing_faces_arrive_in_their_own_patch(self):
        holes = close_holes(self.leaky)
        holes.Update()
        last = chain(holes.GetOutputDataObject(0), SIZE, SurfaceSize=SIZE)[-1]
        boundary = last.GetOutputDataObject(1)
        names = strings(boundary, "PatchNames")
        self.assertEqual(names, ["wall", "closed_holes"])
        patch = arrays(boundary)["cell PatchId"]
        points = arrays(boundary)["points"]
        self.assertGreater((patch == 1).sum(), 0)
        offsets, connectivity = arrays(boundary)["offsets"], arrays(boundary)["connectivity"]
        for face in np.flatnonzero(patch == 1):
            centre = points[connectivity[offsets[face]:offsets[face + 1]]].mean(axis=0)
            self.assertLess(np.linalg.norm(centre - (0.5, 0, 0)), 0.12 + 2 * SIZE)

    def test_blocks_keep_their_names(self):
        blocks = vtkMultiBlockDataSet()
        parts = {"front": punched(self.leaky, (-1, 0, 0), 1), "back": punched(self.leaky, (1, 0, 0), 1)}
        left = self.leaky.GetNumberOfCells() - sum(p.GetNumberOfCells() for p in parts.values())
        self.assertLessEqual(left, 0, "each triangle is in a part")
        for i, (name, part) in enumerate(parts.items()):
            blocks.SetBlock(i, part)
            blocks.GetMetaData(i).Set(vtkMultiBlockDataSet.NAME(), name)
        holes = close_holes(blocks)
        holes.Update()
        self.assertEqual(strings(holes.GetOutputDataObject(0), "PatchNames"), ["front", "back", "closed_holes"])

    def test_given_points(self):
        holes = close_holes(self.leaky, Method=0)
        holes.AddInsidePoint(-0.2, 0.1, 0)
        holes.AddOutsidePoint(-0.6, 0, 0)
        self.assertEqual((holes.GetNumberOfInsidePoints(), holes.GetNumberOfOutsidePoints()), (1, 1))
        holes.Update()
        points = vtk_to_numpy(holes.GetOutputDataObject(1).GetPoints().GetData())
        self.assertLess(math.dist(points[0], (-0.2, 0.1, 0)), 1e-9)
        self.assertLess(math.dist(points[-1], (-0.6, 0, 0)), 1e-9)
        holes.ClearInsidePoints()
        holes.AddInsidePoint(50, 0, 0)
        messages = Messages(holes)
        holes.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("lies outside the domain", messages.errors[0])
        self.assertEqual(holes.GetOutputDataObject(0).GetNumberOfCells(), 0)
        self.assertEqual(holes.GetOutputDataObject(3).GetNumberOfRows(), 0)

    def test_an_opening_as_wide_as_the_room_is_shown_and_closed_for_a_point(self):
        cube = box()
        opened = vtkPolyData()
        opened.SetPoints(cube.GetPoints())
        opened.Allocate(5)
        ids = vtkIdList()
        for side in range(1, 6):  # all but x = -0.5
            cube.GetCellPoints(side, ids)
            opened.InsertNextCell(cube.GetCellType(side), ids)
        columns = {}
        for method, points in ((0, []), (1, []), (1, [(0.1, 0.2, 0)])):
            holes = close_holes(opened, Method=method)
            for point in points:
                holes.AddInsidePoint(*point)
            holes.Update()
            table = holes.GetOutputDataObject(3)
            columns[method, len(points)] = [[table.GetColumnByName(name).GetValue(row) for name in ("Wide", "Closed")]
                                            for row in range(table.GetNumberOfRows())]
        self.assertEqual(columns, {(0, 0): [[1, 0]], (1, 0): [], (1, 1): [[0, 1]]})
        self.assertEqual(table.GetColumnByName("Place").GetTuple3(0)[0], -0.5)
        self.assertAlmostEqual(table.GetColumnByName("Area").GetValue(0), 1, delta=1e-6)

    def test_wide_holes_stay_open(self):
        holes = close_holes(self.leaky, MaximumWidth=0.1)
        holes.Update()
        self.assertEqual(holes.GetOutputDataObject(3).GetColumnByName("Closed").GetValue(0), 0)
        self.assertEqual(strings(holes.GetOutputDataObject(0), "PatchNames"), ["wall"])


if __name__ == "__main__":
    unittest.main()
