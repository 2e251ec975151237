# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import tempfile
import unittest

import numpy as np
from support import Messages, arrays, chain, differences, pm, strings
from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid
from vtkmodules.vtkFiltersSources import vtkCylinderSource
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter


def around_cylinder():
    """Outside of a cylinder of diameter 1 along y, which stands through its domain; two layers."""
    source = vtkCylinderSource()
    source.SetResolution(40)
    source.SetHeight(2)
    source.Update()
    return chain(source.GetOutput(), 0.1, UseDomain=True, DomainBounds=(-1, 2, -0.4, 0.4, -1, 1), BaseSize=0.4, Region=1,
                 Layers=2)[-1].GetOutput()


def planar(mesh, **properties):
    section = pm.vtkPlanarMesh()
    section.SetInputDataObject(mesh)
    section.SetAxis(1)
    for key, value in properties.items():
        getattr(section, "Set" + key)(value)
    section.Update()
    return section


class TestPlanarMesh(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.mesh = around_cylinder()

    def test_section(self):
        section = planar(self.mesh, Thickness=0.5)
        out = section.GetOutput()
        self.assertAlmostEqual(section.GetArea(), 6 - 20 * np.sin(2 * np.pi / 40) / 4, delta=0.01)
        check = pm.vtkMeshValidity()
        check.SetInputDataObject(out)
        check.Update()
        self.assertEqual(check.GetViolations(), 0, check.GetDescription())
        self.assertAlmostEqual(check.GetTotalVolume(), 0.5 * section.GetArea(), places=12)
        found = arrays(out)
        np.testing.assert_allclose(np.abs(found["points"][:, 1]), 0.25, atol=1e-15)
        self.assertEqual(found["cell Layer"].max(), 2)
        names, kinds = strings(out, "PatchNames"), strings(out, "PatchTypes")
        self.assertEqual((names[-2:], kinds[-2:]), (["back", "front"], ["empty", "empty"]))
        patches = arrays(section.GetOutputDataObject(1))["cell PatchId"]
        for name in ("back", "front"):
            self.assertEqual((patches == names.index(name)).sum(), out.GetNumberOfCells())

    def test_openfoam_case(self):
        section = planar(self.mesh)
        with tempfile.TemporaryDirectory() as folder:
            writer = pm.vtkPolyMeshWriter()
            writer.SetDirectory(folder)
            writer.SetInputDataObject(section.GetOutput())
            writer.Write()
            with open(os.path.join(folder, "boundary"), encoding="ascii") as file:
                text = file.read()
        kinds = dict(re.findall(r"(\w+)\s*\{\s*type\s+(\w+);", text))
        self.assertEqual((kinds["front"], kinds["back"], kinds["xmin"]), ("empty", "empty", "patch"))
        self.assertNotIn("ymin", kinds)
        report = pm.vtkMeshQualityReport()
        report.SetInputDataObject(section.GetOutput())
        report.SetEmptyDirection(2)
        report.Update()
        self.assertEqual(report.GetOutput().GetNumberOfCells(), section.GetOutput().GetNumberOfCells())

    def test_saved_and_read_back(self):
        section = planar(self.mesh)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "planar.vtu")
            writer = vtkXMLUnstructuredGridWriter()
            writer.SetFileName(path)
            writer.SetInputData(section.GetOutput())
            writer.SetDataModeToBinary()
            writer.Write()
            reader = vtkXMLUnstructuredGridReader()
            reader.SetFileName(path)
            reader.Update()
            self.assertEqual(differences(reader.GetOutput(), section.GetOutput()), [])
            # A section of the section, which is one cell thick: the same polygons.
            again = planar(reader.GetOutput())
            self.assertEqual(again.GetOutput().GetNumberOfCells(), section.GetOutput().GetNumberOfCells())
            self.assertAlmostEqual(again.GetArea(), section.GetArea(), places=12)
            self.assertEqual(len(set(strings(again.GetOutput(), "PatchNames"))), len(strings(again.GetOutput(), "PatchNames")))

    def refusal(self, mesh, **properties):
        section = pm.vtkPlanarMesh()
        section.SetInputDataObject(mesh)
        for key, value in properties.items():
            getattr(section, "Set" + key)(value)
        messages = Messages(section)
        section.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertEqual(section.GetOutput().GetNumberOfCells(), 0)
        self.assertEqual(section.GetArea(), 0)
        return messages.errors[0]

    def test_refusals(self):
        self.assertIn("does not cut the mesh", self.refusal(self.mesh, Position=3))
        self.assertIn("Planar Mesh", self.refusal(vtkUnstructuredGrid()))
        plain = vtkUnstructuredGrid()
        plain.CopyStructure(self.mesh)
        self.assertIn("Planar Mesh", self.refusal(plain))


if __name__ == "__main__":
    unittest.main()
