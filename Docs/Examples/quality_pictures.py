# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of a mesh's quality: quality_pictures.py MESH.vtu HISTOGRAMS.png WORST.png [MEASURE] draws a histogram of each
measure with its limit red, and the boundary of the mesh with the cells worst in MEASURE (NonOrthogonality unless told)
coloured. Prints the ranges and the worst place of each measure. Run with pvpython; without a display, under xvfb-run."""
import sys

import matplotlib
import numpy as np
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  the renderer
from projection_mesher import ProjectionMesherFilters as pm
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkThreshold
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from vtkmodules.vtkRenderingCore import vtkActor, vtkDataSetMapper, vtkRenderer, vtkRenderWindow

from mesh_pictures import write_picture

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402  after the choice of what draws

SIZE = (1400, 1000)
WORST_CELLS = 60


def column(table, name):
    array = table.GetColumnByName(name)
    if array.IsA("vtkStringArray"):
        return np.array([array.GetValue(i) for i in range(array.GetNumberOfValues())])
    return vtk_to_numpy(array)


def report_on(path):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    report = pm.vtkMeshQualityReport()
    report.SetInputConnection(reader.GetOutputPort())
    report.SetWorstPlaces(WORST_CELLS)
    report.Update()
    return report


def print_tables(report):
    summary, worst = report.GetOutputDataObject(report.SUMMARY), report.GetOutputDataObject(report.WORST)
    names, positions = column(worst, "Measure"), column(worst, "Position")
    print(f"{'measure':18}{'minimum':>12}{'maximum':>12}{'mean':>12}{'limit':>10}{'outside':>9}  worst at")
    rows = zip(*(column(summary, n) for n in ("Measure", "Minimum", "Maximum", "Mean", "Limit", "Outside")))
    for name, low, high, mean, limit, outside in rows:
        place = " ".join(f"{x:.5g}" for x in positions[np.argmax(names == name)]) if name in names else ""
        print(f"{name:18}{low:12.5g}{high:12.5g}{mean:12.5g}{limit:10.3g}{outside:9d}  {place}")


def draw_histograms(report, path):
    table, summary = report.GetOutputDataObject(report.HISTOGRAMS), report.GetOutputDataObject(report.SUMMARY)
    of, low, high, counts = (column(table, n) for n in ("Measure", "From", "To", "Count"))
    names = column(summary, "Measure")
    limits = dict(zip(names, column(summary, "Limit")))
    columns = 4
    figure, axes = pyplot.subplots(-(-len(names) // columns), columns, figsize=(15, 14))
    for axis, name in zip(axes.flat, names):
        own = of == name
        axis.bar(low[own], counts[own], (high - low)[own], align="edge", color="steelblue", log=True)
        if low[own][0] > 0 and high[own][-1] > 1e3 * low[own][0]:
            axis.set_xscale("log")
        if low[own][0] <= limits[name] <= high[own][-1]:
            axis.axvline(limits[name], color="red")
        axis.set_title(name, fontsize=10)
        axis.tick_params(labelsize=7)
    for axis in axes.flat[len(names):]:
        axis.axis("off")
    figure.tight_layout()
    figure.savefig(path, dpi=90)


def actor_of(data):
    mapper = vtkDataSetMapper()
    mapper.SetInputData(data)
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    return actor


def worst_cells(report, measure):
    """The cells worst in a measure, as a grid."""
    grid = report.GetOutput(0)
    worst = report.GetOutputDataObject(report.WORST)
    chosen = np.zeros(grid.GetNumberOfCells(), dtype=np.uint8)
    chosen[column(worst, "Cell")[column(worst, "Measure") == measure]] = 1
    array = numpy_to_vtk(chosen, deep=True)
    array.SetName("Chosen")
    marked = grid.NewInstance()
    marked.ShallowCopy(grid)
    marked.GetCellData().AddArray(array)
    threshold = vtkThreshold()
    threshold.SetInputData(marked)
    threshold.SetInputArrayToProcess(0, 0, 0, 1, "Chosen")
    threshold.SetUpperThreshold(1)
    threshold.SetThresholdFunction(vtkThreshold.THRESHOLD_UPPER)
    threshold.Update()
    return threshold.GetOutput()


def draw_worst(report, measure, path):
    skin = vtkGeometryFilter()
    skin.SetInputData(report.GetOutput(0))
    skin.Update()
    body, worst = actor_of(skin.GetOutput()), actor_of(worst_cells(report, measure))
    body.GetProperty().SetColor(0.75, 0.78, 0.82)
    body.GetProperty().SetOpacity(0.25)
    worst.GetProperty().SetColor(0.85, 0.15, 0.1)
    worst.GetProperty().EdgeVisibilityOn()
    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    for actor in (body, worst):
        renderer.AddActor(actor)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(*SIZE)
    window.AddRenderer(renderer)
    renderer.ResetCamera()
    renderer.GetActiveCamera().Azimuth(35)
    renderer.GetActiveCamera().Elevation(25)
    renderer.ResetCamera()
    renderer.GetActiveCamera().Zoom(1.3)
    write_picture(window, path)


def main():
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    report = report_on(sys.argv[1])
    if report.GetOutput(0).GetNumberOfCells() == 0:
        sys.exit(1)
    print_tables(report)
    draw_histograms(report, sys.argv[2])
    draw_worst(report, sys.argv[4] if len(sys.argv) == 5 else "NonOrthogonality", sys.argv[3])


if __name__ == "__main__":
    main()
