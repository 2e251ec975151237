# SPDX-License-Identifier: BSD-3-Clause
"""Which triangles and which patches the filters take from what a pipeline delivers."""
import unittest

from support import Messages, arrays, box, pm, sphere, strings
from vtkmodules.vtkCommonCore import vtkIntArray, vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import (vtkCellArray, vtkMultiBlockDataSet, vtkPartitionedDataSetCollection,
                                           vtkPolyData)
from vtkmodules.vtkFiltersCore import vtkStripper, vtkTriangleFilter


def front(geometry, patch_array=None, size=0.1):
    """The front's boundary and the messages."""
    mesh = pm.vtkProjectionMesh()
    mesh.SetInputDataObject(geometry)
    mesh.SetFeatureSize(size)
    mesh.SetStopAfter(2)
    mesh.SetFeatureDepth(1)  # Full: faces of the front that lie on one side of the box each
    if patch_array is not None:
        mesh.SetPatchArray(patch_array)
    messages = Messages(mesh)
    mesh.Update()
    return mesh.GetOutputDataObject(1), messages


def with_ids(surface, name, ids):
    array = vtkIntArray()
    array.SetName(name)
    for value in ids:
        array.InsertNextValue(value)
    surface.GetCellData().AddArray(array)
    return surface


def with_names(surface, name, values):
    array = vtkStringArray()
    array.SetName(name)
    for value in values:
        array.InsertNextValue(value)
    surface.GetFieldData().AddArray(array)
    return surface


def half_boxes():
    """The cuboid as two surfaces: x sides, the others."""
    parts = []
    for wanted in ((0, 1), (2, 3, 4, 5)):
        whole, part, polys = box(), vtkPolyData(), vtkCellArray()
        for face in wanted:
            polys.InsertNextCell(whole.GetCell(face))
        part.SetPoints(whole.GetPoints())
        part.SetPolys(polys)
        parts.append(part)
    return parts


class TestGeometryInput(unittest.TestCase):
    def test_quads_and_strips_count_as_triangles(self):
        quads, _ = front(box())
        triangles = vtkTriangleFilter()
        triangles.SetInputData(box())
        strips = vtkStripper()
        strips.SetInputConnection(triangles.GetOutputPort())
        strips.Update()
        self.assertGreater(strips.GetOutput().GetNumberOfStrips(), 0)
        stripped, _ = front(strips.GetOutput())
        self.assertGreater(quads.GetNumberOfCells(), 0)
        self.assertEqual(quads.GetNumberOfCells(), stripped.GetNumberOfCells())

    def test_lines_and_vertices_are_ignored(self):
        surface = box()
        lines, verts = vtkCellArray(), vtkCellArray()
        lines.InsertNextCell(2, (0, 6))
        verts.InsertNextCell(1, (3,))
        surface.SetLines(lines)
        surface.SetVerts(verts)
        with_ids(surface, "PatchId", [99, 99, 0, 0, 1, 1, 1, 1])  # vertices and lines come first
        with_names(surface, "PatchNames", ["x", "rest"])
        boundary, _ = front(surface)
        self.assertEqual(strings(boundary, "PatchNames"), ["x", "rest"])
        normal_x = [i for i in range(boundary.GetNumberOfCells()) if
                    boundary.GetCell(i).GetBounds()[1] - boundary.GetCell(i).GetBounds()[0] < 1e-12]
        ids = arrays(boundary)["cell PatchId"]
        self.assertTrue(all(ids[i] == 0 for i in normal_x))

    def test_only_lines_is_an_error(self):
        surface, lines, points = vtkPolyData(), vtkCellArray(), vtkPoints()
        points.InsertNextPoint(0, 0, 0)
        points.InsertNextPoint(1, 0, 0)
        lines.InsertNextCell(2, (0, 1))
        surface.SetPoints(points)
        surface.SetLines(lines)
        boundary, messages = front(surface)
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("no triangles", messages.errors[0])
        self.assertEqual(boundary.GetNumberOfCells(), 0)

    def test_not_a_number_is_an_error(self):
        surface = sphere()
        surface.GetPoints().SetPoint(3, float("nan"), 0, 0)
        boundary, messages = front(surface)
        self.assertEqual(len(messages.errors), 1)
        self.assertEqual(boundary.GetNumberOfCells(), 0)

    def test_ids_without_names(self):
        boundary, _ = front(with_ids(box(), "PatchId", [7, 7, 7, 7, 2, 2]))
        self.assertEqual(strings(boundary, "PatchNames"), ["patch2", "patch7"])

    def test_names_of_another_array(self):
        surface = with_names(with_ids(box(), "MaterialIds", [0, 0, 1, 1, 1, 1]), "MaterialNames", ["red", "blue"])
        boundary, _ = front(surface)
        self.assertEqual(strings(boundary, "PatchNames"), ["red", "blue"])

    def test_chosen_array_of_names(self):
        surface, array = box(), vtkStringArray()
        array.SetName("part")
        for value in ("a", "a", "b", "b", "b", "c"):
            array.InsertNextValue(value)
        surface.GetCellData().AddArray(array)
        boundary, _ = front(surface, "part")
        self.assertEqual(strings(boundary, "PatchNames"), ["a", "b", "c"])

    def test_chosen_array_that_is_missing(self):
        boundary, messages = front(box(), "nothing")
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("nothing", messages.errors[0])
        self.assertEqual(boundary.GetNumberOfCells(), 0)

    def test_blocks_are_patches(self):
        blocks = vtkMultiBlockDataSet()
        for i, part in enumerate(half_boxes()):
            blocks.SetBlock(i, part)
        blocks.GetMetaData(0).Set(blocks.NAME(), "ends")
        blocks.GetMetaData(1).Set(blocks.NAME(), "sides")
        boundary, _ = front(blocks)
        whole, _ = front(box())
        self.assertEqual(strings(boundary, "PatchNames"), ["ends", "sides"])
        self.assertEqual(boundary.GetNumberOfCells(), whole.GetNumberOfCells())

    def test_partitions_take_the_name_of_their_set(self):
        collection = vtkPartitionedDataSetCollection()
        for i, part in enumerate(half_boxes()):
            collection.SetPartition(i, 0, part)
            collection.GetMetaData(i).Set(vtkMultiBlockDataSet.NAME(), ("ends", "sides")[i])
        boundary, _ = front(collection)
        self.assertEqual(strings(boundary, "PatchNames"), ["ends", "sides"])


if __name__ == "__main__":
    unittest.main()
