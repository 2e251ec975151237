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
from vtkmodules.vtkCommonDataModel import VTK_HEXAHEDRON, VTK_POLYHEDRON, VTK_PYRAMID, VTK_TETRA, VTK_WEDGE

simple.LoadPlugin(os.environ["PROJECTIONMESHER_PLUGIN"], remote=False, ns=globals())

HERE = os.path.dirname(os.path.abspath(__file__))
PAGE = os.path.join(HERE, "..", "..", "Docs", "ReaderAndWriter.md")


def snippets():
    """The page's pieces of Python."""
    with open(PAGE, encoding="utf-8") as file:
        return re.findall(r"^```python\n(.*?)^```", file.read(), re.M | re.S)


# The faces of standard cells, by the cell's corners.
FACES = {VTK_TETRA: ((0, 1, 3), (1, 2, 3), (2, 0, 3), (0, 2, 1)),
         VTK_PYRAMID: ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
         VTK_WEDGE: ((0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)),
         VTK_HEXAHEDRON: ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7))}


def uses_of_faces(grid):
    """How many cells have the faces of a grid of standard cells: a row of corners each, sorted, and the number."""
    found = arrays(grid)
    rows = []
    for kind, faces in FACES.items():
        first = found["offsets"][:-1][found["types"] == kind]
        for face in faces:
            corners = np.sort(found["connectivity"][first[:, None] + np.array(face)], axis=1)
            rows.append(np.pad(corners, ((0, 0), (4 - len(face), 0)), constant_values=-1))
    return np.unique(np.concatenate(rows), axis=0, return_counts=True)


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

    def run_snippet(self, word, mesh=None):
        code, = [code for code in snippets() if word in code]
        names = {**vars(simple), **globals(), "mesh": mesh or self.mesh}
        exec(compile(code, PAGE, "exec"), names)  # pylint: disable=exec-used

    def fetch(self, port, mesh=None):
        mesh = mesh or self.mesh
        mesh.UpdatePipeline()
        return mesh.GetClientSideObject().GetOutputDataObject(port)

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

    def assertSameStandardCells(self, back, grid):
        """The file has a section for each shape: cells of a shape are in their order, with their arrays."""
        left, right = arrays(back), arrays(grid)
        np.testing.assert_array_equal(left["points"], right["points"])
        self.assertEqual(len(left["types"]), len(right["types"]))
        order = np.argsort(left["types"], kind="stable"), np.argsort(right["types"], kind="stable")
        for name in ("types", "cell Level", "cell Layer"):
            np.testing.assert_array_equal(left[name][order[0]], right[name][order[1]])
        np.testing.assert_array_equal(cell_volumes(back)[order[0]], cell_volumes(grid)[order[1]])

    def test_converted_meshes(self):
        """Plain shapes with shared faces; and the boundary's patches beside them."""
        for shapes, kinds in (("Tetrahedra", {VTK_TETRA}), ("Hybrid", set(FACES))):
            converted = ConvertCells(Input=simple.OutputPort(self.mesh, 0), CellShapes=shapes)
            self.run_snippet("mesh.cgns", converted)
            blocks = read("mesh.cgns")
            grid, boundary, back = self.fetch(0, converted), self.fetch(1, converted), blocks.pop("Mesh")
            self.assertLessEqual(set(arrays(back)["types"]), kinds)
            self.assertSameStandardCells(back, grid)
            corners, uses = uses_of_faces(back)
            self.assertEqual(set(uses), {1, 2})
            self.assertEqual((uses == 1).sum(), boundary.GetNumberOfCells())
            faces = np.bincount(arrays(boundary)["cell PatchId"])
            self.assertEqual({name: block.GetNumberOfCells() for name, block in blocks.items()},
                             dict(zip(strings(boundary, "PatchNames"), faces)))
            outer = np.unique(corners[uses == 1])
            outer = {tuple(p) for p in arrays(back)["points"][outer[outer >= 0]]}
            self.assertEqual({tuple(p) for block in blocks.values() for p in arrays(block)["points"]}, outer)

    def test_boundary_as_stl(self):
        self.run_snippet("boundary.stl")
        surface = simple.servermanager.Fetch(SurfaceReader(FileName=os.path.abspath("boundary.stl")))
        self.assertEqual(strings(surface, "PatchNames"), strings(self.fetch(1), "PatchNames"))

    def test_every_snippet_is_run(self):
        self.assertEqual(len(snippets()), 2)


if __name__ == "__main__":
    unittest.main()
