# SPDX-License-Identifier: BSD-3-Clause
"""Mesh Slice: areas of sections against those of the geometry, cells and data it carries, other programs' grids."""
import os
import shutil
import subprocess
import tempfile
import unittest

import numpy as np
from support import Messages, box, chain, differences, pm, sphere
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkIdList, vtkLogger, vtkPoints
from vtkmodules.vtkCommonDataModel import (VTK_HEXAGONAL_PRISM, VTK_HEXAHEDRON, VTK_LINE, VTK_PENTAGONAL_PRISM,
                                           VTK_POLYHEDRON, VTK_PYRAMID, VTK_QUADRATIC_TETRA, VTK_TETRA, VTK_TRIANGLE,
                                           VTK_VOXEL, VTK_WEDGE, vtkMultiBlockDataSet, vtkPlane, vtkUnstructuredGrid)
from vtkmodules.vtkFiltersCore import vtkCutter, vtkPlaneCutter
from vtkmodules.vtkFiltersGeneral import vtkDataSetTriangleFilter
from vtkmodules.vtkImagingCore import vtkRTAnalyticSource

vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_WARNING)  # VTK's cutter of surfaces says that it runs


def sliced(grid, normal, origin, crinkle=False, threads=0):
    plane = vtkPlane()
    plane.SetNormal(*normal)
    plane.SetOrigin(*origin)
    cut = pm.vtkMeshSlice()
    cut.SetInputDataObject(grid)
    cut.SetPlane(plane)
    cut.SetCrinkle(crinkle)
    cut.SetThreads(threads)
    cut.Update()
    return cut.GetOutputDataObject(0)


def rows(polydata):
    """(points, corners, the corner after each, offsets) of the polygons."""
    corners = vtk_to_numpy(polydata.GetPolys().GetConnectivityArray())
    offsets = vtk_to_numpy(polydata.GetPolys().GetOffsetsArray())
    after = np.arange(len(corners)) + 1
    after[offsets[1:] - 1] = offsets[:-1]
    return vtk_to_numpy(polydata.GetPoints().GetData()).astype(float), corners, corners[after], offsets


def areas(polydata, normal):
    """Of each polygon, by its outline: positive when it runs counter-clockwise."""
    if polydata.GetNumberOfPolys() == 0:
        return np.zeros(0)
    points, corners, after, offsets = rows(polydata)
    normal = np.array(normal, float) / np.linalg.norm(normal)
    points = points - points.mean(axis=0)
    return 0.5 * np.add.reduceat(np.cross(points[corners], points[after]) @ normal, offsets[:-1])


def free_sides(polydata):
    """Sides that no other polygon shares, as pairs of points."""
    _, corners, after, _ = rows(polydata)
    sides, count = np.unique(np.sort(np.stack([corners, after], axis=1), axis=1), axis=0, return_counts=True)
    return sides[count == 1], int((count > 2).sum())


def outline_area(boundary, normal, origin):
    """The area that a closed surface's lines in the plane enclose, whichever way they run."""
    plane = vtkPlane()
    plane.SetNormal(*normal)
    plane.SetOrigin(*origin)
    cutter = vtkCutter()
    cutter.SetCutFunction(plane)
    cutter.SetInputData(boundary)
    cutter.Update()
    lines = cutter.GetOutput()
    points = vtk_to_numpy(lines.GetPoints().GetData()).astype(float)
    ends = vtk_to_numpy(lines.GetLines().GetConnectivityArray()).reshape(-1, 2)
    middle = points.mean(axis=0)  # of a convex section: every line turns about it the same way
    return 0.5 * np.linalg.norm(np.cross(points[ends[:, 0]] - middle, points[ends[:, 1]] - middle), axis=1).sum()


def arrays_of(data):
    return [data.GetFieldData().GetArrayName(i) for i in range(data.GetFieldData().GetNumberOfArrays())]


def one_cell(kind, points, faces=None):
    grid, at = vtkUnstructuredGrid(), vtkPoints()
    for p in points:
        at.InsertNextPoint(*p)
    grid.SetPoints(at)
    if faces:
        stream = vtkIdList()
        for n in (len(faces), *(n for face in faces for n in (len(face), *face))):
            stream.InsertNextId(n)
        grid.InsertNextCell(kind, stream)
    else:
        grid.InsertNextCell(kind, len(points), list(range(len(points))))
    return grid


def ring(count, z):
    return [(np.cos(2 * np.pi * k / count), np.sin(2 * np.pi * k / count), z) for k in range(count)]


SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
CUBE = [(x, y, z) for z in (0, 1) for x, y in SQUARE]


class MeshSlice(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.ball = chain(sphere(48), 0.08)[-1]
        cls.grid = cls.ball.GetOutput(0)

    def test_a_box_at_planes_of_the_grid_and_off_them(self):
        grid = chain(box(), 0.125)[-1].GetOutput(0)
        types = vtk_to_numpy(grid.GetCellTypesArray())
        self.assertIn(VTK_HEXAHEDRON, types)
        planes = np.unique(vtk_to_numpy(grid.GetPoints().GetData())[:, 2])
        self.assertGreater(len(planes), 8)
        for z in [*planes, *(planes[1:] + planes[:-1]) / 2]:
            for normal in ((0, 0, 1), (0, 0, -2)):
                area = areas(sliced(grid, normal, (0.3, 0.2, z)), normal)
                self.assertAlmostEqual(area.sum(), 1, places=6, msg=f"z = {z}")
                self.assertGreater(area.min(), 0)

    def test_a_ball_has_the_area_its_boundary_encloses(self):
        self.assertIn(VTK_POLYHEDRON, vtk_to_numpy(self.grid.GetCellTypesArray()))
        inner = vtk_to_numpy(self.grid.GetPoints().GetData())
        inner = inner[np.argmin(np.linalg.norm(inner, axis=1))]
        for normal in ((1, 0, 0), (0, -1, 0), (1, 1, 0), (1, 2, 3), (-2, 1, 5)):
            for origin in ((0, 0, 0), inner, (0.1, 0.05, 0.02), (0.2, 0.2, 0.2)):
                section = sliced(self.grid, normal, origin)
                area = areas(section, normal)
                wanted = outline_area(self.ball.GetOutputDataObject(1), normal, origin)
                self.assertAlmostEqual(area.sum() / wanted, 1, delta=2e-4, msg=f"{normal} {origin}")
                self.assertGreater(area.min(), 0)

    def test_no_holes(self):
        """Sides that polygons do not share are on the boundary: no hole, however small, anywhere inside."""
        section = sliced(self.grid, (0, 0, 1), (0, 0, 0))
        sides, shared_by_three = free_sides(section)
        self.assertEqual(shared_by_three, 0)
        radius = np.linalg.norm(rows(section)[0][sides.ravel()], axis=1)
        self.assertGreater(radius.min(), 0.49)
        self.assertEqual(len(np.unique(sides)), len(sides))  # one closed outline

    def test_the_symmetry_plane_of_a_half(self):
        """Cells lie on one side of it only; VTK's cutter shows it for one direction of the normal at most."""
        half = chain(box(), 0.2, UseDomain=True, DomainBounds=(0, 2, -1, 1, -1, 1), Region=1)[-1].GetOutput(0)
        for normal in ((1, 0, 0), (-1, 0, 0)):
            self.assertAlmostEqual(areas(sliced(half, normal, (0, 0, 0)), normal).sum(), 4 - 1, places=6)
            self.assertAlmostEqual(areas(sliced(half, normal, (2, 0, 0)), normal).sum(), 4, places=6)
            self.assertEqual(sliced(half, normal, (2.1, 0, 0)).GetNumberOfCells(), 0)

    def test_an_octree_is_covered_once(self):
        """Its cells hang on each other without sharing faces."""
        octree = chain(sphere(), 0.05, last=1)[-1].GetOutput(0)
        self.assertEqual(set(vtk_to_numpy(octree.GetCellTypesArray())), {VTK_VOXEL})
        low, high = np.reshape(octree.GetBounds(), (3, 2)).T
        for z in (low[2], (low[2] + high[2]) / 2, high[2], low[2] + 0.3 * (high[2] - low[2])):
            for sign in (1, -1):
                area = areas(sliced(octree, (0, 0, sign), (0, 0, z)), (0, 0, sign)).sum()
                self.assertAlmostEqual(area / ((high[0] - low[0]) * (high[1] - low[1])), 1, places=9)

    def test_every_cell_type(self):
        wedge = [(0, 0, 0), (0, 1, 0), (1, 0, 0), (0, 0, 1), (0, 1, 1), (1, 0, 1)]
        cells = [(VTK_TETRA, [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], 0.125),
                 (VTK_VOXEL, [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], 1),
                 (VTK_HEXAHEDRON, CUBE, 1), (VTK_WEDGE, wedge, 0.5), (VTK_PYRAMID, CUBE[:4] + [(0.5, 0.5, 1)], 0.25),
                 (VTK_PENTAGONAL_PRISM, ring(5, 0) + ring(5, 1), 2.5 * np.sin(2 * np.pi / 5)),
                 (VTK_HEXAGONAL_PRISM, ring(6, 0) + ring(6, 1), 3 * np.sin(np.pi / 3)),
                 (VTK_QUADRATIC_TETRA, [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (.5, 0, 0), (.5, .5, 0), (0, .5, 0),
                                        (0, 0, .5), (.5, 0, .5), (0, .5, .5)], 0.125)]
        for kind, points, wanted in cells:
            section = sliced(one_cell(kind, points), (0, 0, 1), (0, 0, 0.5))
            self.assertAlmostEqual(abs(areas(section, (0, 0, 1)).sum()), wanted, places=6, msg=f"type {kind}")
            self.assertEqual(sliced(one_cell(kind, points), (0, 0, 1), (0, 0, 0.5), True).GetCellType(0), kind)
        prism = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
        section = sliced(one_cell(VTK_POLYHEDRON, CUBE, prism), (0, 0, 1), (0, 0, 0.5))
        self.assertAlmostEqual(areas(section, (0, 0, 1)).sum(), 1)
        self.assertEqual(sliced(one_cell(VTK_TRIANGLE, CUBE[1:4:2] + CUBE[4:5]), (0, 0, 1), (0, 0, .5)).GetNumberOfLines(), 1)
        self.assertEqual(sliced(one_cell(VTK_LINE, CUBE[::4]), (0, 0, 1), (0, 0, .5)).GetNumberOfVerts(), 1)

    def test_one_polygon_a_cell_with_its_data(self):
        section = sliced(self.grid, (1, 2, 3), (0.01, 0.02, 0.03))
        cells = vtk_to_numpy(section.GetCellData().GetArray("vtkOriginalCellIds"))
        self.assertEqual(len(np.unique(cells)), section.GetNumberOfCells())
        for name in ("Level", "Layer"):
            np.testing.assert_array_equal(vtk_to_numpy(section.GetCellData().GetArray(name)),
                                          vtk_to_numpy(self.grid.GetCellData().GetArray(name))[cells])

    def test_point_data_are_interpolated(self):
        grid = vtkUnstructuredGrid()
        grid.ShallowCopy(self.grid)
        linear = vtk_to_numpy(grid.GetPoints().GetData()) @ np.array([1.0, -2.0, 3.0])
        field = numpy_to_vtk(linear, deep=True)
        field.SetName("Linear")
        grid.GetPointData().AddArray(field)
        section = sliced(grid, (1, 2, 3), (0.01, 0.02, 0.03))
        points = rows(section)[0]
        np.testing.assert_allclose((points - (0.01, 0.02, 0.03)) @ (1, 2, 3), 0, atol=1e-12)
        np.testing.assert_allclose(vtk_to_numpy(section.GetPointData().GetArray("Linear")), points @ (1, -2, 3), atol=1e-12)

    def test_crinkle_shows_the_same_cells_whole(self):
        for normal, origin in (((1, 2, 3), (0.01, 0.02, 0.03)), ((0, 0, 1), (0, 0, 0))):
            section, cells = sliced(self.grid, normal, origin), sliced(self.grid, normal, origin, crinkle=True)
            self.assertTrue(cells.IsA("vtkUnstructuredGrid"))
            names = "vtkOriginalCellIds"
            ids = vtk_to_numpy(cells.GetCellData().GetArray(names))
            cut = vtk_to_numpy(section.GetCellData().GetArray(names))  # a bent face may dip through the plane twice
            np.testing.assert_array_equal(ids, np.unique(cut))
            np.testing.assert_array_equal(vtk_to_numpy(cells.GetCellTypesArray()),
                                          vtk_to_numpy(self.grid.GetCellTypesArray())[ids])

    def test_cells_of_a_crinkle_slice_can_be_measured(self):
        cells = sliced(self.grid, (0, 0, 1), (0, 0, 0.01), crinkle=True)
        report = pm.vtkMeshQualityReport()
        report.SetInputDataObject(cells)
        report.Update()
        self.assertEqual(report.GetOutput(0).GetNumberOfCells(), cells.GetNumberOfCells())
        self.assertIn("ProjectionMesherStamp", arrays_of(self.grid))  # which the input keeps

    def test_names_of_patches_stay(self):
        self.assertIn("PatchNames", arrays_of(sliced(self.grid, (0, 0, 1), (0, 0, 0.01))))

    def test_tetrahedra_agree_with_vtk(self):
        """Where VTK's fast cutter works the section is the same; also an input in single precision."""
        source, tets = vtkRTAnalyticSource(), vtkDataSetTriangleFilter()
        source.SetWholeExtent(-5, 5, -5, 5, -5, 5)
        tets.SetInputConnection(source.GetOutputPort())
        tets.Update()
        plane = vtkPlane()
        plane.SetNormal(1, 2, 3)
        plane.SetOrigin(0.1, 0.2, 0.3)
        cutter = vtkPlaneCutter()
        cutter.SetPlane(plane)
        cutter.SetInputData(tets.GetOutput())
        cutter.GeneratePolygonsOn()
        cutter.Update()
        theirs, ours = cutter.GetOutput(), sliced(tets.GetOutput(), (1, 2, 3), (0.1, 0.2, 0.3))
        if theirs.IsA("vtkPartitionedDataSet"):
            theirs = theirs.GetPartition(0)
        self.assertAlmostEqual(areas(ours, (1, 2, 3)).sum(), np.abs(areas(theirs, (1, 2, 3))).sum(), places=3)
        self.assertEqual(ours.GetPoints().GetDataType(), tets.GetOutput().GetPoints().GetDataType())
        for z in range(-5, 6):
            self.assertAlmostEqual(areas(sliced(tets.GetOutput(), (0, 0, 1), (0, 0, z)), (0, 0, 1)).sum(), 100, places=3)

    def test_same_bits_for_any_number_of_threads(self):
        one, many = (sliced(self.grid, (0, 0, 1), (0, 0, 0), threads=n) for n in (1, 4))
        self.assertEqual(differences(one, many), [])

    def test_blocks(self):
        blocks = vtkMultiBlockDataSet()
        blocks.SetNumberOfBlocks(3)
        blocks.SetBlock(0, self.grid)
        blocks.SetBlock(2, one_cell(VTK_HEXAHEDRON, CUBE))
        for crinkle, kind in ((False, "vtkPolyData"), (True, "vtkUnstructuredGrid")):
            result = sliced(blocks, (0, 0, 1), (0, 0, 0.25), crinkle)
            self.assertTrue(result.GetBlock(0).IsA(kind))
            self.assertGreater(result.GetBlock(0).GetNumberOfCells(), 50)
            self.assertEqual(result.GetBlock(2).GetNumberOfCells(), 1)

    def test_it_follows_its_plane_and_option(self):
        cut = pm.vtkMeshSlice()
        cut.SetInputDataObject(one_cell(VTK_HEXAHEDRON, CUBE))
        cut.Update()
        self.assertEqual(cut.GetOutput().GetNumberOfCells(), 1)  # the default, z = 0, is a side
        cut.GetPlane().SetOrigin(0, 0, 0.5)
        cut.Update()
        self.assertEqual(cut.GetOutput().GetBounds()[4:], (0.5, 0.5))
        cut.CrinkleOn()
        cut.Update()
        self.assertEqual(cut.GetOutput().GetBounds()[4:], (0, 1))

    def test_nothing_and_nonsense(self):
        self.assertEqual(sliced(vtkUnstructuredGrid(), (0, 0, 1), (0, 0, 0)).GetNumberOfCells(), 0)
        broken = one_cell(VTK_HEXAHEDRON, CUBE[:7] + [(0, float("nan"), 1)])
        self.assertEqual(sliced(broken, (0, 0, 1), (0, 0, 0.5)).GetNumberOfCells(), 0)
        for plane in (None, vtkPlane()):
            cut = pm.vtkMeshSlice()
            cut.SetInputDataObject(self.grid)
            cut.SetPlane(plane)
            if plane:
                plane.SetNormal(0, 0, 0)
            messages = Messages(cut)
            cut.Update()
            self.assertEqual(len(messages.errors), 1)
            self.assertIn("normal", messages.errors[0])
            self.assertEqual(cut.GetOutput().GetNumberOfCells(), 0)

    def test_pictures_of_cross_sections(self):
        if not shutil.which("xvfb-run"):
            self.skipTest("pictures need xvfb-run")
        script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Docs", "Examples", "cross_sections.py")
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(["xvfb-run", "-a", "pvpython", script, folder, "section_bowl"], check=True, capture_output=True)
            with open(os.path.join(folder, "section_bowl.png"), "rb") as file:
                head = file.read(24)
        self.assertEqual(head[1:4], b"PNG")
        self.assertEqual([int.from_bytes(head[i:i + 4], "big") for i in (16, 20)], [1800, 1240])


if __name__ == "__main__":
    unittest.main()
