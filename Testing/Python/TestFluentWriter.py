# SPDX-License-Identifier: BSD-3-Clause
"""Fluent mesh files hold the mesh: by the file's own numbers, and by VTK's reader."""
import os
import tempfile
import unittest

import numpy as np
from fluent_file import FluentFile, cell_volumes
from support import Messages, arrays, box, chain, pm, strings
from vtkmodules.vtkCommonDataModel import (VTK_CONVEX_POINT_SET, VTK_HEXAHEDRON, VTK_POLYHEDRON, VTK_PYRAMID, VTK_WEDGE,
                                           vtkUnstructuredGrid)
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkFiltersGeneral import vtkTransformPolyDataFilter
from vtkmodules.vtkIOGeometry import vtkFLUENTReader

FLUENT_TYPE = {VTK_HEXAHEDRON: 4, VTK_WEDGE: 6, VTK_PYRAMID: 5, VTK_POLYHEDRON: 7}


def pipe_junction():
    reader = pm.vtkSurfaceReader()
    reader.SetFileName(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Data", "pipe_junction.stl"))
    reader.Update()
    return reader.GetOutput()


def turned(surface):
    """No mesh line lies along its edges: wall faces are cut in two where they run across."""
    transform = vtkTransform()
    transform.RotateZ(30)
    transform.RotateX(40)
    turn = vtkTransformPolyDataFilter()
    turn.SetTransform(transform)
    turn.SetInputData(surface)
    turn.Update()
    return turn.GetOutput()


def read_by_vtk(path):
    reader = vtkFLUENTReader()
    reader.SetFileName(path)
    silenced = Messages(reader)  # it misses the .dat file of results
    reader.Update()
    del silenced
    return reader.GetOutput()


class TestFluentWriter(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        geometry = pipe_junction()
        cls.stages = {"layers": chain(geometry, 0.006, Layers=3)[-1], "front": chain(geometry, 0.006, last=2)[-1],
                      "cut faces": chain(turned(box()), 0.1)[-1]}

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "mesh.msh")

    def write(self, stage, binary=True):
        writer = pm.vtkFluentWriter()
        writer.SetInputConnection(stage.GetOutputPort())
        writer.SetFileName(self.path)
        writer.SetBinary(binary)
        self.messages = Messages(writer)
        writer.Write()
        return FluentFile(self.path) if os.path.exists(self.path) else None

    def each_case(self, check):
        """Calls check(file, grid, boundary) for each mesh in both forms."""
        for name, stage in self.stages.items():
            for binary in (True, False):
                with self.subTest(mesh=name, binary=binary):
                    file = self.write(stage, binary)
                    self.assertEqual(self.messages.errors, [])
                    check(file, stage.GetOutputDataObject(0), stage.GetOutputDataObject(1))

    def test_points_types_and_volumes(self):
        def check(file, grid, boundary):
            types = arrays(grid)["types"]
            seen.update(types)
            seen.update(f"{boundary.GetCellSize(i)} corners" for i in range(boundary.GetNumberOfCells()))
            self.assertEqual(file.types.tolist(), [FLUENT_TYPE[t] for t in types])
            np.testing.assert_array_equal(file.points, arrays(grid)["points"])
            volumes = cell_volumes(grid)
            self.assertGreater(volumes.min(), 0)
            np.testing.assert_allclose(file.volumes(), volumes, rtol=1e-9)

        seen = set()
        self.each_case(check)
        self.assertLessEqual({VTK_HEXAHEDRON, VTK_POLYHEDRON, "3 corners", "4 corners"}, seen)

    def test_zones_are_the_patches(self):
        def check(file, _, boundary):
            names, patch = strings(boundary, "PatchNames"), arrays(boundary)["cell PatchId"]
            sizes = np.array([boundary.GetCellSize(i) for i in range(boundary.GetNumberOfCells())])
            expected = {name: (np.sum(patch == i), np.sum(sizes[patch == i])) for i, name in enumerate(names)
                        if np.any(patch == i)}
            zones = {zone[4]: zone for zone in file.face_zones.values()}
            first, last, *kind = zones.pop("interior-fluid")
            self.assertEqual(kind[:2], [2, "interior"])
            self.assertTrue(np.all(file.c1[first:last] >= 0))
            self.assertTrue(np.all(file.c1[last:] == -1))
            self.assertEqual({name: (zone[1] - zone[0], sum(map(len, file.faces[zone[0]:zone[1]])))
                              for name, zone in zones.items()}, expected)
            for name, zone in zones.items():
                self.assertEqual(zone[2:4], [10, "velocity-inlet"] if "inlet" in name else
                                 [5, "pressure-outlet"] if "outlet" in name else [3, "wall"])

        self.each_case(check)

    def test_read_back_by_vtk(self):
        """VTK keeps 32-bit coordinates, of a polyhedron its points alone, and turns wedges inside out."""
        def check(_, grid, __):
            back = read_by_vtk(self.path)
            self.assertEqual(back.GetNumberOfBlocks(), 1)
            back = back.GetBlock(0)
            self.assertEqual(back.GetNumberOfCells(), grid.GetNumberOfCells())
            types = arrays(grid)["types"]
            np.testing.assert_array_equal(arrays(back)["types"], np.where(types == VTK_POLYHEDRON, VTK_CONVEX_POINT_SET, types))
            for a, b in zip(self.corners(grid), self.corners(back)):
                np.testing.assert_array_equal(a, b)
            volumes, again = cell_volumes(self.plain_cells(grid)), cell_volumes(self.plain_cells(back))
            self.assertEqual(len(again), np.sum(types != VTK_POLYHEDRON))
            again[types[types != VTK_POLYHEDRON] == VTK_WEDGE] *= -1
            np.testing.assert_allclose(again, volumes, rtol=1e-4)

        self.each_case(check)

    @staticmethod
    def corners(grid):
        """Sorted points of each cell."""
        data = arrays(grid)
        return [np.sort(data["connectivity"][a:b]) for a, b in zip(data["offsets"][:-1], data["offsets"][1:])]

    @staticmethod
    def plain_cells(grid):
        plain = vtkUnstructuredGrid()
        plain.SetPoints(grid.GetPoints())
        for cell in range(grid.GetNumberOfCells()):
            if grid.GetCellType(cell) not in (VTK_POLYHEDRON, VTK_CONVEX_POINT_SET):
                plain.InsertNextCell(grid.GetCellType(cell), grid.GetCell(cell).GetPointIds())
        return plain

    def test_regions_are_zones_of_cells(self):
        front = chain(box(), 0.2, last=2)[-1]
        octree = front.GetInputAlgorithm()
        octree.SetUseDomain(True)
        octree.SetDomainBounds(-1, 1, -1, 1, -1, 1)
        front.SetRegionToPoints()
        front.AddSeedPoint(0, 0, 0)
        front.AddSeedPoint(0.9, 0.9, 0.9)
        mesh = pm.vtkDummyLayer()
        mesh.SetInputConnection(front.GetOutputPort())
        file = self.write(mesh)
        self.assertEqual(self.messages.errors, [])
        grid = mesh.GetOutputDataObject(0)
        zone = arrays(grid)["cell Zone"]
        names = strings(grid, "ZoneNames")
        self.assertEqual(len(names), 2)
        self.assertEqual([z[1] - z[0] for z in file.cell_zones.values()], np.bincount(zone).tolist())
        np.testing.assert_allclose(file.volumes(), cell_volumes(grid)[np.argsort(zone, kind="stable")], rtol=1e-9)
        self.assertEqual({z[4] for z in file.face_zones.values()} - {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"},
                         {f"{kind}-{z[4]}" for kind in ("interior", "wall") for z in file.cell_zones.values()})
        of_cell = np.repeat(list(file.cell_zones), [z[1] - z[0] for z in file.cell_zones.values()])
        for first, last, *_ in file.face_zones.values():
            self.assertEqual(len(set(of_cell[file.c0[first:last]])), 1)
        blocks = read_by_vtk(self.path)
        self.assertEqual([blocks.GetBlock(i).GetNumberOfCells() for i in range(2)], np.bincount(zone).tolist())

    def test_paraview_offers_and_saves_it(self):
        from paraview import simple
        simple.LoadPlugin(os.environ["PROJECTIONMESHER_PLUGIN"], remote=False, ns=globals())
        mesh = ProjectionMesh(Geometry=simple.Sphere(ThetaResolution=24, PhiResolution=24), FeatureSize=0.1)  # noqa: F821
        factory = simple.servermanager.vtkSMProxyManager.GetProxyManager().GetWriterFactory()
        self.assertIn("Fluent mesh(*.msh )", factory.GetSupportedFileTypes(mesh.SMProxy, 0))
        for binary, index in ((1, b"(3013 "), (0, b"(13 (3 ")):
            simple.SaveData(self.path, proxy=simple.OutputPort(mesh, 0), Binary=binary)
            file = FluentFile(self.path)
            self.assertEqual(len(file.types), mesh.GetDataInformation().GetNumberOfCells())
            self.assertIn(index, file.data)

    def test_same_bytes_again_and_through_a_saved_grid(self):
        from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter
        saved = self.path.replace(".msh", ".vtu")
        first = self.write(self.stages["layers"]).data
        vtu = vtkXMLUnstructuredGridWriter()
        vtu.SetInputConnection(self.stages["layers"].GetOutputPort())
        vtu.SetFileName(saved)
        vtu.SetDataModeToBinary()
        vtu.Write()
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(saved)
        self.assertEqual(self.write(reader).data, first)

    def test_refusals(self):
        self.write(self.stages["layers"])
        with open(self.path, "rb") as file:
            good = file.read()
        octree = self.stages["front"].GetInputAlgorithm()
        self.write(octree)
        self.assertEqual(len(self.messages.errors), 1)
        self.assertIn("Octree Decompose", self.messages.errors[0])
        with open(self.path, "rb") as file:
            self.assertEqual(file.read(), good)
        foreign = vtkUnstructuredGrid()  # of another tool: without what the suite's grids carry
        foreign.CopyStructure(self.stages["layers"].GetOutputDataObject(0))
        for grid in (vtkUnstructuredGrid(), foreign):
            writer = pm.vtkFluentWriter()
            writer.SetInputData(grid)
            writer.SetFileName(self.path)
            messages = Messages(writer)
            writer.Write()
            self.assertEqual(len(messages.errors), 1)
            self.assertIn("The Fluent writer", messages.errors[0])
        self.path = ""
        self.write(self.stages["layers"])
        self.assertIn("FileName", self.messages.errors[0])
        self.path = os.path.join(tempfile.gettempdir(), "no such folder", "a.msh")
        self.write(self.stages["layers"])
        self.assertIn("Cannot write", self.messages.errors[0])


if __name__ == "__main__":
    unittest.main()
