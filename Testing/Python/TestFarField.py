# SPDX-License-Identifier: BSD-3-Clause
import os
import tempfile
import unittest

import numpy as np
from support import Messages, arrays, chain, differences, pm, sphere, strings, validity
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter


def inner_mesh(last=6):
    """The outside of a sphere of diameter 1 in a box of edge 3."""
    return chain(sphere(), 0.25, last=last, UseDomain=True, DomainBounds=(-1.5, 1.5, -1.5, 1.5, -1.5, 1.5),
                 BaseSize=0.5, Region=1)


def far_field(mesh, **properties):
    far = pm.vtkFarField()
    far.SetInputDataObject(mesh)
    for key, value in properties.items():
        getattr(far, "Set" + key)(value)
    far.Update()
    return far


def boundary_of(far, patch):
    """Points of the faces of a patch of the boundary port."""
    found = arrays(far.GetOutputDataObject(1))
    faces = np.flatnonzero(found["cell PatchId"] == strings(far.GetOutputDataObject(1), "PatchNames").index(patch))
    offsets = found["offsets"]
    ids = np.concatenate([found["connectivity"][offsets[f]:offsets[f + 1]] for f in faces])
    return found["points"][ids]


class TestFarField(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.stages = inner_mesh()
        cls.inner = cls.stages[-1].GetOutput()

    def test_far_box(self):
        far = far_field(self.inner, UseBounds=True, FarBounds=(-4, 9, -5, 5, -1.5, 6), ExtendZmin=False)
        outer = validity(far.GetOutput())
        self.assertEqual(outer.GetViolations(), 0, outer.GetDescription())
        self.assertAlmostEqual(far.GetFarVolume(), 13 * 10 * 7.5 - 27, places=9)
        self.assertAlmostEqual(outer.GetTotalVolume(), validity(self.inner).GetTotalVolume() + far.GetFarVolume(), places=8)
        self.assertEqual(far.GetOutput().GetNumberOfCells(), self.inner.GetNumberOfCells() + far.GetFarCells())
        self.assertTrue((boundary_of(far, "xmax")[:, 0] == 9).all())
        ground = boundary_of(far, "zmin")
        self.assertTrue((ground[:, 2] == -1.5).all())
        self.assertEqual((ground[:, 0].min(), ground[:, 0].max()), (-4, 9))

    def test_far_cells_are_no_layer_cells(self):
        far = far_field(self.inner, Distance=4)
        found, inner = arrays(far.GetOutput()), arrays(self.inner)
        added = slice(self.inner.GetNumberOfCells(), None)
        self.assertTrue((found["cell Layer"][added] == 0).all())
        self.assertTrue((found["cell Level"][added] == 0).all())
        np.testing.assert_array_equal(found["cell Layer"][:len(inner["cell Layer"])], inner["cell Layer"])

    def test_half_sphere(self):
        far = far_field(self.inner, Shape=1, Radius=8, ExtendZmin=False)
        self.assertEqual(validity(far.GetOutput()).GetViolations(), 0)
        distance = np.linalg.norm(boundary_of(far, "far") - (0, 0, -1.5), axis=1)
        np.testing.assert_allclose(distance, 8, rtol=1e-13)
        self.assertAlmostEqual(far.GetFarVolume() / (2 / 3 * np.pi * 512 - 27), 1, delta=0.03)
        names = strings(far.GetOutput(), "PatchNames")
        self.assertIn("zmin", names)
        self.assertNotIn("xmin", names)

    def test_saved_and_read_back(self):
        far = far_field(self.inner, Distance=4)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "far.vtu")
            writer = vtkXMLUnstructuredGridWriter()
            writer.SetFileName(path)
            writer.SetInputData(far.GetOutput())
            writer.SetDataModeToBinary()
            writer.Write()
            reader = vtkXMLUnstructuredGridReader()
            reader.SetFileName(path)
            reader.Update()
            self.assertEqual(differences(reader.GetOutput(), far.GetOutput()), [])
            # A second far field on the first, from the file as from memory.
            again = [far_field(mesh, Distance=9).GetOutput() for mesh in (reader.GetOutput(), far.GetOutput())]
            self.assertEqual(differences(*again), [])
            self.assertEqual(validity(again[0]).GetViolations(), 0)
            case = pm.vtkPolyMeshWriter()
            case.SetFileName(os.path.join(folder, "case.foam"))
            case.SetInputDataObject(far.GetOutput())
            case.Write()
            with open(os.path.join(folder, "constant", "polyMesh", "boundary"), encoding="ascii") as file:
                self.assertIn("xmax", file.read())

    def test_the_chain_goes_on_from_it(self):
        far = far_field(self.stages[1].GetOutput(), Distance=4)
        layer = pm.vtkDummyLayer()
        layer.SetInputConnection(far.GetOutputPort())
        layer.Update()
        self.assertEqual(validity(layer.GetOutput()).GetViolations(), 0)
        faces = (arrays(far.GetOutputDataObject(1))["cell PatchId"] == 0).sum()
        self.assertEqual(layer.GetOutput().GetNumberOfCells(), far.GetOutput().GetNumberOfCells() + faces)

    def refusal(self, mesh, **properties):
        far = pm.vtkFarField()
        far.SetInputDataObject(mesh)
        for key, value in properties.items():
            getattr(far, "Set" + key)(value)
        messages = Messages(far)
        far.Update()
        self.assertEqual(len(messages.errors), 1)
        self.assertEqual(far.GetOutput().GetNumberOfCells(), 0)
        self.assertEqual(far.GetFarCells(), 0)
        return messages.errors[0]

    def test_refusals(self):
        self.assertIn("xmin of 0 is not outside the domain, which ends at -1.5", self.refusal(self.inner, UseBounds=True))
        self.assertIn("does not reach around the domain", self.refusal(self.inner, Shape=1, Radius=2))
        inside = chain(sphere(), 0.25, last=2)[-1].GetOutput()
        self.assertIn("no domain sides to extend", self.refusal(inside))
        octree = self.stages[0].GetOutput()
        self.assertIn("needs the output of Boundary Refine", self.refusal(octree))


if __name__ == "__main__":
    unittest.main()
