# SPDX-License-Identifier: BSD-3-Clause
"""Mesh Quality Report: tables and arrays, grids of other origin, and OpenFOAM's figures. With PROJECTIONMESHER_FOAM_CASES
naming a folder of cases, each with constant/polyMesh and the log.checkMesh of checkMesh -constant -allGeometry
-allTopology, every figure of every log is compared."""
import glob
import math
import os
import tempfile
import unittest

import numpy as np
from foam_case import empty_direction, read_log, read_mesh
from support import Messages, box, chain, pm, sphere
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import VTK_TRIANGLE, vtkUnstructuredGrid

MEASURES = ("Volume", "CentralTet", "FacePyramid", "Openness", "EtaInternal", "EtaBoundary", "AngleInternal",
            "AngleBoundary", "Warpage", "SkewInternal", "SkewBoundary", "NonOrthogonality", "FaceWeight", "VolumeRatio",
            "FaceArea", "Flatness", "FaceConcavity", "FaceTet", "AspectRatio", "Determinant", "CellConcavity")
DIGITS = 2e-5  # checkMesh prints six digits


def report_on(grid, **properties):
    report = pm.vtkMeshQualityReport()
    report.SetInputDataObject(0, grid)
    for name, value in properties.items():
        getattr(report, "Set" + name)(value)
    report.Update()
    return report


def column(table, name):
    array = table.GetColumnByName(name)
    if array.IsA("vtkStringArray"):
        return [array.GetValue(i) for i in range(array.GetNumberOfValues())]
    return vtk_to_numpy(array)


def summary(report):
    """Measure to its row, as a dict."""
    table = report.GetOutputDataObject(pm.vtkMeshQualityReport.SUMMARY)
    names = [table.GetColumnName(i) for i in range(table.GetNumberOfColumns())]
    return {row[0]: dict(zip(names, row)) for row in zip(*(column(table, name) for name in names))}


def figures(report):
    """The report's figures under the names of foam_case.FIGURES."""
    rows = summary(report)
    found = {"concave cells": report.GetConcaveCells(),
             "Skewness max": np.nanmax([rows["SkewInternal"]["Maximum"], rows["SkewBoundary"]["Maximum"]])}
    for name, row in rows.items():
        found.update({f"{name} min": row["Minimum"], f"{name} max": row["Maximum"], f"{name} mean": row["Mean"],
                      f"{name} outside": row["Outside"]})
    return found


def compare(folder):
    """(figure, ours, checkMesh's) of a case."""
    mesh = os.path.join(folder, "constant", "polyMesh")
    report = report_on(read_mesh(mesh), EmptyDirection=empty_direction(mesh))
    ours = figures(report)
    return [(name, ours[name], theirs) for name, theirs in read_log(os.path.join(folder, "log.checkMesh")).items()]


def same(name, ours, theirs):
    if name.startswith(("NonOrthogonality m", "FaceConcavity m")):
        return math.isclose(ours, theirs, rel_tol=DIGITS, abs_tol=1e-4)  # an arc cosine near 1 has few digits
    if name.startswith("Skewness"):
        return math.isclose(ours, theirs, rel_tol=DIGITS, abs_tol=1e-7)
    return math.isclose(ours, theirs, rel_tol=DIGITS, abs_tol=1e-12 if "Determinant" in name else 0)


def stripped(grid):
    """The same cells without what the suite writes."""
    plain = vtkUnstructuredGrid()
    plain.CopyStructure(grid)
    return plain


class MeshQualityReport(unittest.TestCase):
    def test_cubes(self):
        front = chain(box(), 0.2, last=2, RefineEdges=False, Separate=False)[-1].GetOutput(0)
        report = report_on(front)
        rows = summary(report)
        self.assertEqual(tuple(rows), MEASURES)
        for name, value in (("Volume", 1), ("FaceWeight", 0.5), ("VolumeRatio", 1), ("Flatness", 1), ("AspectRatio", 1),
                            ("NonOrthogonality", 0), ("Warpage", 0)):
            self.assertAlmostEqual(rows[name]["Minimum"], value, places=5, msg=name)
            self.assertAlmostEqual(rows[name]["Maximum"], value, places=5, msg=name)
            np.testing.assert_allclose(vtk_to_numpy(report.GetOutput(0).GetCellData().GetArray(name)), value, atol=1e-5)
        self.assertEqual(sum(row["Outside"] for row in rows.values()), 0)
        self.assertEqual(report.GetOutputDataObject(1).GetNumberOfCells(), 0)
        self.assertEqual(report.GetConcaveCells(), 0)

    def test_tables_agree_with_the_arrays(self):
        report = report_on(chain(sphere(), 0.1)[-1].GetOutput(0), WorstPlaces=4, Bins=12)
        worst, bins = report.GetOutputDataObject(2), report.GetOutputDataObject(3)
        self.assertEqual(worst.GetNumberOfRows(), 4 * len(MEASURES))
        self.assertEqual(bins.GetNumberOfRows(), 12 * len(MEASURES))
        cells = report.GetOutput(0).GetCellData()
        for name, value, cell in zip(column(worst, "Measure")[::4], column(worst, "Value")[::4], column(worst, "Cell")[::4]):
            self.assertEqual(np.float32(value), cells.GetArray(name).GetValue(cell), name)
        rows = summary(report)
        counts = column(bins, "Count").reshape(-1, 12).sum(axis=1)
        np.testing.assert_array_equal(counts[:4], report.GetOutput(0).GetNumberOfCells())
        np.testing.assert_array_equal(column(bins, "From")[::12], [row["Minimum"] for row in rows.values()])
        self.assertEqual(rows["FaceTet"]["Outside"], 0)
        for position, patch, face in zip(column(worst, "Position"), column(worst, "Patch"), column(worst, "Face")):
            self.assertLess(np.abs(position).max(), 0.51)
            self.assertTrue(face >= 0 or patch == "")

    def test_faces_outside(self):
        grid = chain(sphere(), 0.1, last=4)[-1].GetOutput(0)
        limit = 0.8 * summary(report_on(grid))["NonOrthogonality"]["Maximum"]
        report = report_on(grid, MaximumNonOrthogonality=limit)
        faces, outside = report.GetOutputDataObject(1), summary(report)["NonOrthogonality"]["Outside"]
        angles = vtk_to_numpy(faces.GetCellData().GetArray("NonOrthogonality"))
        self.assertGreater(outside, 0)
        self.assertEqual(np.count_nonzero(angles > limit), outside)
        broken = vtk_to_numpy(faces.GetCellData().GetArray("Broken"))
        self.assertGreaterEqual(broken.min(), 1)
        total = sum(r["Outside"] for r in summary(report).values() if r["Of"] == "faces")
        self.assertEqual(broken.sum(), total)

    def test_a_grid_without_the_stamp(self):
        """The same figures, but for volumes, which are then in the grid's own units."""
        grid = chain(sphere(), 0.1, last=4)[-1].GetOutput(0)
        own, foreign = summary(report_on(grid)), summary(report_on(stripped(grid)))
        size = grid.GetFieldData().GetArray("FinestSize").GetValue(0)
        for name in MEASURES:
            scale = size ** 3 if name in ("Volume", "CentralTet", "FacePyramid") else 1
            for key in ("Minimum", "Maximum", "Mean"):
                self.assertAlmostEqual(own[name][key] * scale, foreign[name][key], delta=1e-12 * max(1, abs(own[name][key])))

    def test_written_and_read_as_openfoam_does(self):
        """A polyMesh, read as polyhedra, has the figures of the grid."""
        stage = chain(sphere(), 0.1)[-1]
        own = figures(report_on(stripped(stage.GetOutput(0))))
        with tempfile.TemporaryDirectory() as folder:
            writer = pm.vtkPolyMeshWriter()
            writer.SetInputConnection(stage.GetOutputPort(0))
            writer.SetFileName(os.path.join(folder, "case.foam"))
            writer.Write()
            read = figures(report_on(read_mesh(os.path.join(folder, "constant", "polyMesh"))))
        self.assertEqual(set(own), set(read))
        for name, value in own.items():
            self.assertTrue(math.isclose(value, read[name], rel_tol=1e-9, abs_tol=1e-9), (name, value, read[name]))

    def test_other_cells_are_refused(self):
        grid = stripped(chain(box(), 0.25, last=2)[-1].GetOutput(0))
        grid.InsertNextCell(VTK_TRIANGLE, 3, [0, 1, 2])
        for wrong in (grid, vtkUnstructuredGrid()):
            report = pm.vtkMeshQualityReport()
            report.SetInputDataObject(0, wrong)
            messages = Messages(report)
            report.Update()
            self.assertEqual(len(messages.errors), 1)
            self.assertIn("Mesh Quality Report", messages.errors[0])
            self.assertEqual(report.GetOutput(0).GetNumberOfCells(), 0)

    @unittest.skipUnless(os.environ.get("PROJECTIONMESHER_FOAM_CASES"), "names no folder of OpenFOAM cases")
    def test_checkmesh_agrees(self):
        logs = sorted(glob.glob(os.path.join(os.environ["PROJECTIONMESHER_FOAM_CASES"], "*", "log.checkMesh")))
        self.assertGreater(len(logs), 0)
        for log in logs:
            rows = compare(os.path.dirname(log))
            self.assertGreater(len(rows), 15, log)
            wrong = [row for row in rows if not same(*row)]
            self.assertEqual(wrong, [], os.path.basename(os.path.dirname(log)))


if __name__ == "__main__":
    unittest.main()
