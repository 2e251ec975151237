# SPDX-License-Identifier: BSD-3-Clause
"""What Docs/ReaderAndWriter.md says of ParaView's CGNS writer, and the code it gives."""
import os
import re
import tempfile
import unittest

import numpy as np
from fluent_file import cell_volumes
from paraview import simple
from support import arrays, strings
from vtkmodules.vtkCommonDataModel import VTK_HEXAHEDRON, VTK_POLYHEDRON

simple.LoadPlugin(os.environ["PROJECTIONMESHER_PLUGIN"], remote=False, ns=globals())

HERE = os.path.dirname(os.path.abspath(__file__))
PAGE = os.path.join(HERE, "..", "..", "Docs", "ReaderAndWriter.md")


def snippets():
    """The page's pieces of Python."""
    with open(PAGE, encoding="utf-8") as file:
        return re.findall(r"^```python\n(.*?)^```", file.read(), re.M | re.S)


def read(path):
    """Blocks of all bases by name."""
    reader = simple.CGNSSeriesReader(FileNames=[path])
    reader.UpdatePipelineInformation()
    reader.Bases = reader.GetProperty("Bases").Available
    reader.CellArrayStatus = reader.GetProperty("CellArrayStatus").Available
    reader.PointArrayStatus = reader.GetProperty("PointArrayStatus").Available
    tree = simple.servermanager.Fetch(reader)
    found, walk = {}, tree.NewIterator()
    while not walk.IsDoneWithTraversal():
        found[walk.GetCurrentMetaData().Get(tree.NAME())] = walk.GetCurrentDataObject()
        walk.GoToNextItem()
    return found


class TestCgns(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.geometry = SurfaceReader(FileName=os.path.join(HERE, "..", "Data", "pipe_junction.stl"))
        cls.mesh = ProjectionMesh(Geometry=cls.geometry, FeatureSize=0.006)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)

    def run_snippet(self, word):
        code, = [code for code in snippets() if word in code]
        exec(compile(code, PAGE, "exec"), {**vars(simple), **globals(), "mesh": self.mesh})  # pylint: disable=exec-used

    def fetch(self, port):
        self.mesh.UpdatePipeline()
        return self.mesh.GetClientSideObject().GetOutputDataObject(port)

    def assertSameMesh(self, back, grid):
        self.assertEqual(back.GetNumberOfCells(), grid.GetNumberOfCells())
        np.testing.assert_array_equal(arrays(back)["points"], arrays(grid)["points"])
        for name in ("cell Level", "cell Layer", "point Fixed"):
            np.testing.assert_array_equal(arrays(back)[name], arrays(grid)[name])
        # VTK 9.2 reads the faces of polyhedra turned inward.
        np.testing.assert_allclose(np.abs(cell_volumes(back)), cell_volumes(grid), rtol=1e-9)

    def test_mesh_alone(self):
        simple.SaveData("mesh.cgns", proxy=simple.OutputPort(self.mesh, 0))
        blocks = read("mesh.cgns")
        self.assertEqual(len(blocks), 1)
        grid = self.fetch(0)
        self.assertIn(VTK_POLYHEDRON, arrays(grid)["types"])
        self.assertSameMesh(next(iter(blocks.values())), grid)

    def test_mesh_of_plain_shapes(self):
        """Written as hexahedra, not as polyhedra."""
        front = ProjectionMesh(Geometry=self.geometry, FeatureSize=0.006, StopAfter="Paint Front")
        simple.SaveData("mesh.cgns", proxy=simple.OutputPort(front, 0))
        back = next(iter(read("mesh.cgns").values()))
        grid = simple.servermanager.Fetch(simple.OutputPort(front, 0))
        self.assertEqual(set(arrays(grid)["types"]), {VTK_HEXAHEDRON})
        self.assertEqual(set(arrays(back)["types"]), {VTK_HEXAHEDRON})
        self.assertSameMesh(back, grid)

    def test_mesh_with_patches(self):
        self.run_snippet("mesh.cgns")
        blocks = read("mesh.cgns")
        self.assertSameMesh(blocks.pop("Mesh"), self.fetch(0))
        boundary = self.fetch(1)
        faces = np.bincount(arrays(boundary)["cell PatchId"])
        self.assertGreater(len(faces), 1)
        self.assertEqual({name: block.GetNumberOfCells() for name, block in blocks.items()},
                         dict(zip(strings(boundary, "PatchNames"), faces)))

    def test_boundary_as_stl(self):
        self.run_snippet("boundary.stl")
        surface = simple.servermanager.Fetch(SurfaceReader(FileName=os.path.abspath("boundary.stl")))
        self.assertEqual(strings(surface, "PatchNames"), strings(self.fetch(1), "PatchNames"))

    def test_every_snippet_is_run(self):
        self.assertEqual(len(snippets()), 2)


if __name__ == "__main__":
    unittest.main()
