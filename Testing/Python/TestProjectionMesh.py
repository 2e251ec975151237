# SPDX-License-Identifier: BSD-3-Clause
"""The one-filter form against the chain of six, on any number of threads, also by way of files."""
import os
import tempfile
import unittest

from support import Messages, STAGES, WITH_GEOMETRY, box, chain, differences, pm, sphere
from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter

# Not passed on by the later filters.
REPORTS = ("field RegionCells", "field RegionVolume", "field RegionOpen",
           "field StuckPosition", "field StuckDistance", "field StuckBy")


def one_filter(geometry, size, **properties):
    mesh = pm.vtkProjectionMesh()
    mesh.SetInputDataObject(geometry)
    mesh.SetFeatureSize(size)
    for key, value in properties.items():
        getattr(mesh, "Set" + key)(value)
    mesh.Update()
    return mesh


class TestProjectionMesh(unittest.TestCase):
    def assertSame(self, a, b):
        for port in (0, 1):
            self.assertEqual(differences(a.GetOutputDataObject(port), b.GetOutputDataObject(port), REPORTS), [])

    def test_equals_the_chain(self):
        for geometry, size, least in ((sphere(), 0.07, 500), (box(1, 0.8, 0.6), 0.1, 100)):
            stages = chain(geometry, size)
            mesh = one_filter(geometry, size)
            self.assertGreater(mesh.GetOutput().GetNumberOfCells(), least)
            self.assertSame(mesh, stages[-1])

    def test_stop_after_each_stage(self):
        stages = chain(box(), 0.12)
        for number, stage in enumerate(stages[1:], start=2):
            self.assertSame(one_filter(box(), 0.12, StopAfter=number), stage)

    def test_threads_do_not_matter(self):
        one = one_filter(box(1, 0.8, 0.6), 0.08, Threads=1)
        two = one_filter(box(1, 0.8, 0.6), 0.08, Threads=2)
        self.assertSame(one, two)

    def test_a_stage_saved_and_read_back_continues_the_same(self):
        geometry = box(1, 0.8, 0.6)
        stages = chain(geometry, 0.1)
        with tempfile.TemporaryDirectory() as folder:
            for before, after, name in zip(stages, stages[1:], STAGES[1:]):
                path = os.path.join(folder, name + ".vtu")
                writer = vtkXMLUnstructuredGridWriter()
                writer.SetInputConnection(before.GetOutputPort())
                writer.SetFileName(path)
                writer.SetDataModeToBinary()  # VTK 9.2 cannot read appended data back with Expat 2.6 and later
                self.assertEqual(writer.Write(), 1)
                reader = vtkXMLUnstructuredGridReader()
                reader.SetFileName(path)
                reader.Update()
                self.assertEqual(differences(before.GetOutput(), reader.GetOutput()), [])
                again = getattr(pm, name)()
                again.SetInputConnection(0, reader.GetOutputPort())
                if name in WITH_GEOMETRY:
                    again.SetInputDataObject(WITH_GEOMETRY[name], geometry)
                again.Update()
                self.assertGreater(again.GetOutput().GetNumberOfCells(), 0)
                self.assertSame(after, again)

    def test_a_mesh_nobody_wants_is_freed_when_it_has_been_read(self):
        geometry = box(1, 0.8, 0.6)
        kept = chain(geometry, 0.1)
        grid = vtkUnstructuredGrid()
        grid.DeepCopy(kept[0].GetOutput())
        for name, expected in zip(STAGES[1:], kept[1:]):
            stage = getattr(pm, name)()
            stage.SetInputDataObject(0, grid)
            stage.GetInputAlgorithm(0, 0).ReleaseDataFlagOn()
            if name in WITH_GEOMETRY:
                stage.SetInputDataObject(WITH_GEOMETRY[name], geometry)
            left = []  # cells of the input as the stage goes on
            stage.AddObserver("ProgressEvent", lambda *_, data=grid, cells=left: cells.append(data.GetNumberOfCells()))
            stage.Update()
            self.assertSame(stage, expected)
            self.assertEqual(left[-1], 0)
            grid = stage.GetOutput()
        for stage in kept:  # of these nobody said so
            self.assertGreater(stage.GetOutput().GetNumberOfCells(), 0)

    def test_report(self):
        mesh = one_filter(box(), 0.12)
        self.assertEqual([mesh.GetPatchName(i) for i in range(mesh.GetNumberOfPatches())], ["wall"])
        self.assertEqual(mesh.GetPatchFaces(0), mesh.GetOutputDataObject(1).GetNumberOfCells())
        self.assertEqual(sum(mesh.GetFacesWithLayers(n) for n in range(1, 4)), mesh.GetWallFaces())
        self.assertAlmostEqual(mesh.GetFeatureLength(), 12, places=6)
        self.assertEqual(mesh.GetCorners(), 8)
        self.assertIsNone(mesh.GetPatchName(99))

    def test_a_changed_property_runs_again(self):
        mesh = one_filter(sphere(), 0.1)
        cells = mesh.GetOutput().GetNumberOfCells()
        mesh.SetLayers(1)
        mesh.Update()
        self.assertLess(mesh.GetOutput().GetNumberOfCells(), cells)
        mesh.SetFeatureSize(0.05)
        mesh.Update()
        self.assertGreater(mesh.GetOutput().GetNumberOfCells(), cells)

    def test_outside_needs_room(self):
        mesh = pm.vtkProjectionMesh()
        mesh.SetInputDataObject(sphere())
        mesh.SetFeatureSize(0.1)
        mesh.SetUseDomain(True)
        mesh.SetDomainBounds(-1, 1, -1, 1, -1, 1)
        mesh.SetRegion(1)
        messages = Messages(mesh)
        mesh.Update()
        self.assertEqual(messages.errors, [])
        names = [mesh.GetPatchName(i) for i in range(mesh.GetNumberOfPatches()) if mesh.GetPatchFaces(i)]
        self.assertEqual(sorted(names), sorted(["wall", "xmin", "xmax", "ymin", "ymax", "zmin", "zmax"]))


if __name__ == "__main__":
    unittest.main()
