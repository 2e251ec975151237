# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import tempfile
import unittest

from support import Messages, chain, pm, sphere

FILES = ["boundary", "faces", "neighbour", "owner", "points"]


class TestPolyMeshWriter(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.mesh = chain(sphere(), 0.1)[-1]

    def writer(self, stage):
        writer = pm.vtkPolyMeshWriter()
        writer.SetInputConnection(stage.GetOutputPort())
        self.messages = Messages(writer)
        return writer

    def count(self, name):
        """The length a list file states before its opening bracket."""
        with open(os.path.join(self.folder, name), "rb") as file:
            body = file.read().split(b"}", 1)[1]
        return int(re.search(rb"^\s*(\d+)\s*\(", re.sub(rb"//[^\n]*", b"", body)).group(1))

    def test_case_file(self):
        writer = self.writer(self.mesh)
        writer.SetFileName(os.path.join(self.folder, "a.foam"))
        self.assertEqual(writer.Write(), 1)
        self.assertEqual(self.messages.errors, [])
        self.assertTrue(os.path.exists(writer.GetFileName()))
        self.assertEqual(sorted(os.listdir(os.path.join(self.folder, "constant", "polyMesh"))), FILES)

    def test_folder_in_ascii(self):
        writer = self.writer(self.mesh)
        writer.SetDirectory(self.folder)
        writer.SetBinary(False)
        writer.Write()
        self.assertEqual(sorted(os.listdir(self.folder)), FILES)
        self.assertEqual(self.count("points"), self.mesh.GetOutput().GetNumberOfPoints())
        faces = self.mesh.GetOutputDataObject(1).GetNumberOfCells()
        with open(os.path.join(self.folder, "boundary")) as file:
            text = file.read()
        self.assertIn("wall", text)
        self.assertEqual(int(re.search(r"nFaces\s+(\d+);", text).group(1)), faces)
        self.assertEqual(self.count("owner"), self.count("neighbour") + faces)

    def test_octree_is_refused(self):
        writer = self.writer(chain(sphere(), 0.1, last=1)[0])
        writer.SetDirectory(self.folder)
        writer.Write()
        self.assertEqual(len(self.messages.errors), 1)
        self.assertIn("Octree Decompose", self.messages.errors[0])
        self.assertEqual(os.listdir(self.folder), [])

    def test_no_place_to_write(self):
        writer = self.writer(self.mesh)
        writer.Write()
        self.assertEqual(len(self.messages.errors), 1)
        self.assertIn("FileName", self.messages.errors[0])
        blocked = os.path.join(self.folder, "file")
        open(blocked, "w").close()
        writer.SetDirectory(os.path.join(blocked, "polyMesh"))
        writer.Write()
        self.assertEqual(len(self.messages.errors), 2)


if __name__ == "__main__":
    unittest.main()
