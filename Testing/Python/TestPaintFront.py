# SPDX-License-Identifier: BSD-3-Clause
import math
import unittest

from support import Messages, arrays, box, chain, differences, pm, sphere, strings
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkFiltersCore import vtkAppendPolyData, vtkThreshold
from vtkmodules.vtkFiltersGeneral import vtkTransformPolyDataFilter
from vtkmodules.vtkFiltersSources import vtkPlaneSource, vtkSphereSource
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
        self.assertEqual(front.GetOutputDataObject(2).GetNumberOfRows(), 0)
        self.assertEqual(front.GetOutputDataObject(3).GetNumberOfPoints(), 0)

    def test_leak_is_shown_on_a_port_of_its_own(self):
        front = self.front(self.octree.GetOutput(), Region=1)
        front.AddKeepOutPoint(0.9, 0, 0)  # outside the sphere, and so is the region
        messages = Messages(front)
        front.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("kept out", messages.errors[0])
        self.assertEqual(front.GetOutputDataObject(0).GetNumberOfCells(), 0)
        front.ClearKeepOutPoints()
        front.AddKeepOutPoint(0, 0, 0)
        front.Update()
        self.assertGreater(front.GetOutputDataObject(0).GetNumberOfCells(), 0)
        self.assertEqual(front.GetOutputDataObject(pm.vtkPaintFront.LEAKS).GetNumberOfCells(), 0)

    def test_leak_path_of_a_sphere_with_a_hole(self):
        source = vtkSphereSource()  # open about its north pole: a hole 0.34 wide
        source.SetThetaResolution(32)
        source.SetPhiResolution(32)
        source.SetStartPhi(20)
        source.Update()
        self.geometry = source.GetOutput()
        front = self.front(chain(self.geometry, 0.04, last=1)[0].GetOutput())
        messages = Messages(front)
        front.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("leak", messages.errors[0])
        leaks = front.GetOutputDataObject(pm.vtkPaintFront.LEAKS)
        self.assertEqual((leaks.GetNumberOfLines(), leaks.GetNumberOfVerts()), (1, 1))
        bottleneck = leaks.GetPoint(leaks.GetVerts().GetConnectivityArray().GetValue(0))
        self.assertLess(max(abs(bottleneck[0]), abs(bottleneck[1]), abs(bottleneck[2] - 0.47)), 0.04)
        self.assertAlmostEqual(arrays(leaks)["cell NarrowestWidth"][0], 0.34, delta=0.03)

    def test_room_behind_a_narrow_opening_is_warned_of(self):
        source = vtkSphereSource()  # open about its north pole: a hole 0.26 wide
        source.SetThetaResolution(32)
        source.SetPhiResolution(32)
        source.SetStartPhi(15)
        source.Update()
        self.geometry = source.GetOutput()
        front = self.front(chain(self.geometry, 0.04, last=1, SurfaceSize=0.04)[0].GetOutput(), Region=1)
        messages = Messages(front)
        front.Update()
        self.assertEqual((len(messages.errors), len(messages.warnings)), (0, 1))
        self.assertIn("a room", messages.warnings[0])
        self.assertGreater(front.GetOutputDataObject(0).GetNumberOfCells(), 0)
        leaks = front.GetOutputDataObject(pm.vtkPaintFront.LEAKS)
        self.assertEqual((leaks.GetNumberOfLines(), leaks.GetNumberOfVerts()), (1, 1))
        bottleneck = leaks.GetPoint(leaks.GetVerts().GetConnectivityArray().GetValue(0))
        self.assertLess(max(abs(bottleneck[0]), abs(bottleneck[1]), abs(bottleneck[2] - 0.483)), 0.04)
        front.ReportLeaksOff()
        front.Update()
        self.assertEqual(len(messages.warnings), 1)
        self.assertEqual(front.GetOutputDataObject(pm.vtkPaintFront.LEAKS).GetNumberOfCells(), 0)

    def two_spheres(self):
        small = vtkTransform()
        small.Translate(1.2, 0, 0)
        small.Scale(0.6, 0.6, 0.6)
        moved = vtkTransformPolyDataFilter()
        moved.SetInputData(self.geometry)
        moved.SetTransform(small)
        both = vtkAppendPolyData()
        both.AddInputData(self.geometry)
        both.AddInputConnection(moved.GetOutputPort())
        both.Update()
        return both.GetOutput()

    def test_table_of_regions_and_zones(self):
        geometry = self.two_spheres()
        stages = chain(geometry, 0.05, Region=pm.vtkPaintFront.ENCLOSED)
        table = stages[1].GetOutputDataObject(pm.vtkPaintFront.REGIONS)
        self.assertTrue(table.IsA("vtkTable"))
        self.assertEqual(table.GetNumberOfRows(), 3)
        columns = [table.GetColumnName(i) for i in range(table.GetNumberOfColumns())]
        self.assertEqual(columns, ["Region", "Volume", "Cells", "Open", "Chosen", "Zone", "Patches", "Point", "Bounds"])

        def column(name):
            return [table.GetValueByName(row, name) for row in range(3)]

        self.assertEqual([v.ToInt() for v in column("Open")], [1, 0, 0])
        self.assertEqual([v.ToInt() for v in column("Chosen")], [0, 1, 1])
        self.assertEqual([v.ToString() for v in column("Zone")], ["", "region_1", "region_2"])
        self.assertEqual([v.ToString() for v in column("Patches")], ["wall"] * 3)
        front = arrays(stages[1].GetOutput())
        self.assertEqual(sorted(set(front["cell Region"])), [1, 2])
        self.assertTrue((front["cell Zone"] == front["cell Region"] - 1).all())
        last = stages[-1].GetOutput()
        self.assertEqual(strings(last, "ZoneNames"), ["region_1", "region_2"])
        x = [last.GetCell(c).GetBounds()[0] for c in range(last.GetNumberOfCells())]
        self.assertEqual([int(v > 0.7) for v in x], list(arrays(last)["cell Zone"]))
        one = pm.vtkProjectionMesh()
        one.SetInputDataObject(geometry)
        one.SetFeatureSize(0.05)
        one.SetRegion(pm.vtkPaintFront.IDS)
        one.AddRegionId(1)
        one.AddRegionId(2)
        one.Update()
        fields = ("field RegionCells", "field RegionVolume", "field RegionOpen")
        self.assertEqual(differences(one.GetOutput(), last, fields), [])

    def test_invisible_slot(self):
        """Two plates 0.02 apart in a box, cells of 0.05: the space between them."""
        slot = vtkAppendPolyData()
        for z in (-0.01, 0.01):
            plate = vtkPlaneSource()
            plate.SetOrigin(-0.3, -0.3, z)
            plate.SetPoint1(0.3, -0.3, z)
            plate.SetPoint2(-0.3, 0.3, z)
            plate.Update()
            slot.AddInputData(plate.GetOutput())
        slot.AddInputData(box())
        slot.Update()
        stages = chain(slot.GetOutput(), 0.05, last=2)
        points = stages[1].GetOutputDataObject(pm.vtkPaintFront.INVISIBLE)
        found = arrays(points)
        self.assertGreater(points.GetNumberOfPoints(), 30)
        self.assertEqual(points.GetNumberOfVerts(), points.GetNumberOfPoints())
        self.assertTrue((abs(found["point Width"] - 0.02) < 1e-6).all())
        self.assertTrue((abs(found["point FeatureSize"] - 0.01) < 1e-6).all())
        self.assertTrue((abs(found["points"][:, 2]) < 1e-6).all())
        self.assertEqual(list(found["field PlaceCells"]), [points.GetNumberOfPoints()])
        self.assertIn("feature size of 0.01", strings(stages[1].GetOutput(), "Notes")[0])
        stages[1].ReportInvisibleOff()
        stages[1].Update()
        self.assertEqual(stages[1].GetOutputDataObject(pm.vtkPaintFront.INVISIBLE).GetNumberOfPoints(), 0)

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
