# SPDX-License-Identifier: BSD-3-Clause
import os
import tempfile
import unittest

import numpy as np
from support import Messages, arrays, chain, differences, pm, sphere, strings, validity
from vtkmodules.vtkCommonDataModel import VTK_HEXAHEDRON, VTK_PYRAMID, VTK_TETRA, VTK_WEDGE, vtkUnstructuredGrid
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter

JUNCTION = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Data", "pipe_junction_dirty.stl")


def junction(layers):
    reader = pm.vtkSurfaceReader()
    reader.SetFileName(JUNCTION)
    mesh = pm.vtkProjectionMesh()
    mesh.SetInputConnection(reader.GetOutputPort())
    mesh.SetFeatureSize(0.005)
    mesh.SetLayers(layers)
    mesh.Update()
    return mesh.GetOutputDataObject(0)


def convert(mesh, shapes=0, **properties):
    cells = pm.vtkConvertCells()
    cells.SetInputDataObject(mesh)
    cells.SetCellShapes(shapes)
    for key, value in properties.items():
        getattr(cells, "Set" + key)(value)
    cells.Update()
    return cells


def cell_volumes(mesh):
    """By VTK, cell by cell."""
    sizes = vtkCellSizeFilter()
    sizes.SetInputDataObject(mesh)
    sizes.Update()
    return arrays(sizes.GetOutput())["cell Volume"]


def patch_vectors(boundary):
    """Sum of area vectors of each patch."""
    found = arrays(boundary)
    points, ids, offsets = found["points"], found["connectivity"], found["offsets"]
    sums = np.zeros((len(strings(boundary, "PatchNames")), 3))
    for face, patch in enumerate(found["cell PatchId"]):
        row = points[ids[offsets[face]:offsets[face + 1]]] - points[0]
        sums[patch] += 0.5 * np.cross(row, np.roll(row, -1, axis=0)).sum(axis=0)
    return sums


class TestConvertCells(unittest.TestCase):
    def check(self, mesh, cells, kinds):
        out = cells.GetOutput()
        types = arrays(out)["types"]
        self.assertEqual(set(types) - set(kinds), set())
        made = {VTK_TETRA: cells.GetTetrahedra(), VTK_PYRAMID: cells.GetPyramids(), VTK_WEDGE: cells.GetWedges(),
                VTK_HEXAHEDRON: cells.GetHexahedra()}
        for kind, count in made.items():
            self.assertEqual((types == kind).sum(), count)
        volumes = cell_volumes(out)
        self.assertGreater(volumes.min(), 0)
        self.assertAlmostEqual(volumes.sum() / cells.GetVolume(), 1, places=3)  # VTK cuts warped quads its own way
        whole = validity(mesh).GetTotalVolume()
        self.assertAlmostEqual(cells.GetVolume() / whole, 1, delta=5e-4)  # warped wall polygons are cut along diagonals
        self.assertAlmostEqual(cells.GetVolume() - cells.GetVolumeChange(), whole, delta=1e-12 * whole)
        self.assertAlmostEqual(validity(out).GetTotalVolume(), cells.GetVolume(), delta=1e-12 * whole)
        self.assertLess(cells.GetMaxSkewness(), 4)
        self.assertLess(cells.GetMaxNonOrthogonality(), 90)

    def test_junction(self):
        for layers in (1, 5):
            mesh = junction(layers)
            tetrahedra, hybrid = convert(mesh), convert(mesh, 1)
            self.check(mesh, tetrahedra, [VTK_TETRA])
            self.check(mesh, hybrid, [VTK_TETRA, VTK_PYRAMID, VTK_WEDGE, VTK_HEXAHEDRON])
            self.assertLess(tetrahedra.GetOutput().GetNumberOfCells(), 7 * mesh.GetNumberOfCells())
            self.assertLess(hybrid.GetOutput().GetNumberOfCells(), 1.5 * mesh.GetNumberOfCells())
            self.assertGreater(hybrid.GetCellsThatStay(), 0.9 * mesh.GetNumberOfCells())
            self.assertEqual(strings(hybrid.GetOutput(), "PatchNames"), strings(mesh, "PatchNames"))
            np.testing.assert_allclose(patch_vectors(tetrahedra.GetOutputDataObject(1)),
                                       patch_vectors(hybrid.GetOutputDataObject(1)), atol=1e-15)

    def test_front_without_layers(self):
        mesh = chain(sphere(), 0.1, last=2)[-1].GetOutput()
        for shapes in (0, 1):
            cells = convert(mesh, shapes)
            self.assertAlmostEqual(cells.GetVolumeChange(), 0, places=14)
            self.assertGreater(cell_volumes(cells.GetOutput()).min(), 0)

    def test_other_filters_take_it(self):
        mesh = chain(sphere(), 0.2)[-1].GetOutput()
        for shapes in (0, 1):
            cells = convert(mesh, shapes)
            report = pm.vtkMeshQualityReport()
            report.SetInputDataObject(cells.GetOutput())
            report.Update()
            self.assertEqual(report.GetOutput().GetNumberOfCells(), cells.GetOutput().GetNumberOfCells())
            with tempfile.TemporaryDirectory() as folder:
                case = pm.vtkPolyMeshWriter()
                case.SetDirectory(folder)
                case.SetInputDataObject(cells.GetOutput())
                case.Write()
                with open(os.path.join(folder, "owner"), encoding="latin-1") as file:
                    self.assertIn(f"nCells:{cells.GetOutput().GetNumberOfCells()}", file.read().replace(" ", ""))

    def test_saved_and_read_back(self):
        mesh = chain(sphere(), 0.2)[-1].GetOutput()
        cells = convert(mesh, 1)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "mesh.vtu")
            for data, check in ((mesh, lambda read: self.assertEqual(
                    differences(convert(read, 1).GetOutput(), cells.GetOutput()), [])),
                    (cells.GetOutput(), lambda read: self.assertEqual(validity(read).GetViolations(),
                                                                      validity(cells.GetOutput()).GetViolations()))):
                writer = vtkXMLUnstructuredGridWriter()
                writer.SetFileName(path)
                writer.SetInputData(data)
                writer.SetDataModeToBinary()
                writer.Write()
                reader = vtkXMLUnstructuredGridReader()
                reader.SetFileName(path)
                reader.Update()
                self.assertEqual(differences(reader.GetOutput(), data), [])
                check(reader.GetOutput())

    def test_same_bits_for_any_number_of_threads(self):
        mesh = junction(1)
        for shapes in (0, 1):
            self.assertEqual(differences(*(convert(mesh, shapes, Threads=n).GetOutput() for n in (1, 2))), [])

    def refusal(self, mesh):
        cells = pm.vtkConvertCells()
        cells.SetInputDataObject(mesh)
        messages = Messages(cells)
        cells.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertEqual(cells.GetOutput().GetNumberOfCells(), 0)
        self.assertEqual(cells.GetTetrahedra(), 0)
        return messages.errors[0]

    def test_refusals(self):
        self.assertIn("Convert Cells", self.refusal(vtkUnstructuredGrid()))
        self.assertIn("needs the output of", self.refusal(chain(sphere(), 0.2, last=1)[-1].GetOutput()))
        finished = chain(sphere(), 0.2)[-1].GetOutput()
        moved = vtkUnstructuredGrid()
        moved.DeepCopy(finished)
        moved.GetPoints().SetPoint(0, 9, 9, 9)
        self.assertIn("not as the suite made it", self.refusal(moved))
        plain = vtkUnstructuredGrid()
        plain.CopyStructure(finished)
        self.assertIn("Convert Cells", self.refusal(plain))

    def test_no_stage_follows(self):
        finished = convert(chain(sphere(), 0.2, last=2)[-1].GetOutput()).GetOutput()
        layer = pm.vtkDummyLayer()
        layer.SetInputDataObject(finished)
        messages = Messages(layer)
        layer.Update()
        self.assertEqual(len(messages.errors), 1)


if __name__ == "__main__":
    unittest.main()
