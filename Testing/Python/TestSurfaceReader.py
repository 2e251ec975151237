# SPDX-License-Identifier: BSD-3-Clause
import gzip
import io
import os
import tarfile
import tempfile
import unittest
import unittest.mock

from support import Messages, arrays, box, differences, pm, sphere, strings
from vtkmodules.vtkIOGeometry import vtkSTLWriter
from vtkmodules.vtkIOPLY import vtkPLYWriter

FACET = " facet normal 0 0 1\n  outer loop\n   vertex 0 0 {0}\n   vertex 1 0 {0}\n   vertex 0 1 {0}\n  endloop\n endfacet\n"
OBJ = """v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 2 3
g first
f 1 2 4
f 1 2 3 \\
 4
g second part
usemtl red
f 1 3 4
l 1 2
p 3
g first
f 2 3 4
"""


class TestSurfaceReader(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def write(self, name, text, pack=False):
        path = os.path.join(self.folder.name, name)
        data = text.encode() if isinstance(text, str) else text
        with (gzip.open if pack else open)(path, "wb") as file:
            file.write(data)
        return path

    def read(self, path):
        reader = pm.vtkSurfaceReader()
        reader.SetFileName(path)
        self.messages = Messages(reader)
        reader.Update()
        return reader.GetOutput()

    def assertParts(self, surface, names, ids):
        self.assertEqual(strings(surface, "PatchNames"), names)
        self.assertEqual(arrays(surface)["cell PatchId"].tolist(), ids)

    def test_stl_with_several_solids(self):
        text = ("solid one two\n" + FACET.format(0) + "endsolid one two\nsolid\n" + FACET.format(1) + FACET.format(2) +
                "endsolid\nSOLID empty\nendsolid\nsolid one two\n" + FACET.format(3) + "endsolid\n")
        for name, pack in (("part.stl", False), ("part.STL.gz", True)):
            self.assertParts(self.read(self.write(name, text, pack)), ["one two", "part"], [0, 1, 1, 0])

    def test_binary_stl_is_named_after_its_file(self):
        writer = vtkSTLWriter()
        writer.SetInputData(sphere())
        writer.SetFileTypeToBinary()
        writer.SetFileName(os.path.join(self.folder.name, "ball.stl"))
        writer.Write()
        surface = self.read(writer.GetFileName())
        self.assertParts(surface, ["ball"], [0] * sphere().GetNumberOfCells())

    def test_obj_groups(self):
        for pack in (False, True):
            surface = self.read(self.write("part.obj" + ".gz" * pack, OBJ, pack))
            self.assertEqual(surface.GetNumberOfCells(), 5, "lines and points are dropped")
            self.assertParts(surface, ["part", "first", "second part"], [0, 1, 1, 2, 1])

    def test_obj_objects_where_there_are_no_groups(self):
        text = "o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\no b\r\nf 1 2 4\nf 1 3 4\n"
        self.assertParts(self.read(self.write("x.obj", text)), ["a", "b"], [0, 1, 1])

    def test_ply(self):
        writer = vtkPLYWriter()
        writer.SetInputData(box())
        writer.SetFileName(os.path.join(self.folder.name, "cube.ply"))
        writer.Write()
        self.assertParts(self.read(writer.GetFileName()), ["cube"], [0] * 6)

    def test_names_become_patches_of_the_mesh(self):
        writer = vtkSTLWriter()
        writer.SetInputData(sphere())
        writer.SetFileTypeToASCII()
        writer.SetFileName(os.path.join(self.folder.name, "x.stl"))
        writer.Write()
        with open(writer.GetFileName()) as file:
            lines = file.readlines()
        lines[0] = "solid hull\n"
        mesh = pm.vtkProjectionMesh()
        mesh.SetInputDataObject(self.read(self.write("y.stl", "".join(lines))))
        mesh.SetFeatureSize(0.1)
        mesh.SetStopAfter(2)
        mesh.Update()
        self.assertEqual(strings(mesh.GetOutputDataObject(1), "PatchNames"), ["hull"])

    def assertRefused(self, path, *words):
        surface = self.read(path)
        self.assertEqual(len(self.messages.errors), 1)
        for word in words:
            self.assertIn(word, self.messages.errors[0])
        self.assertEqual(surface.GetNumberOfCells(), 0)

    def test_missing_file(self):
        self.assertRefused(os.path.join(self.folder.name, "none.stl"), "There is no file", "none.stl")

    def test_unknown_format(self):
        self.assertRefused(self.write("x.step", "ISO-10303-21;"), ".step", ".stl")

    def test_obj_in_an_archive_that_is_called_obj(self):
        archive = io.BytesIO()
        with tarfile.open(fileobj=archive, mode="w") as tar:
            entry = tarfile.TarInfo("part.obj")
            entry.size = len(OBJ.encode())
            tar.addfile(entry, io.BytesIO(OBJ.encode()))
        surface = self.read(self.write("part.obj.gz", archive.getvalue(), pack=True))
        self.assertEqual(self.messages.errors, [])
        self.assertEqual(differences(surface, self.read(self.write("part.obj", OBJ))), [])

    def test_damaged_gzip(self):
        path = self.write("x.stl.gz", "solid a\n" + FACET.format(0) * 200 + "endsolid\n", pack=True)
        with open(path, "r+b") as file:
            file.truncate(os.path.getsize(path) // 2)
        room = os.path.join(self.folder.name, "room")  # of its own: others may be unpacking at the same time
        os.mkdir(room)
        with unittest.mock.patch.dict(os.environ, TMPDIR=room):
            self.assertRefused(path, "cannot be unpacked")
        self.assertEqual(os.listdir(room), [])


if __name__ == "__main__":
    unittest.main()
