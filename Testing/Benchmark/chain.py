# SPDX-License-Identifier: BSD-3-Clause
"""What the whole chain costs, stage by stage, and how that grows: meshes a geometry at several feature sizes on one thread and
prints the tables of Docs/Performance.md, processor seconds and the most memory held.

    pvpython chain.py GEOMETRY SIZE [SIZE ...] [--coarsest FACTOR] [--threads N] [options of mesh.sh]

FACTOR: the base size in feature sizes, for meshes that are alike at all sizes. Then the finished mesh is converted to tetrahedra and to standard cells, measured, sliced and written. projection_mesher must be
on PYTHONPATH. Medians of several runs say more than one."""
import argparse
import os
import resource
import sys
import tempfile
import time

from projection_mesher import ProjectionMesherFilters as pm

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Docs", "Examples"))
import mesh as command  # noqa: E402  only now can it be found
import mesh_report  # noqa: E402


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("geometry")
    p.add_argument("sizes", nargs="+", type=float)
    p.add_argument("--threads", default="1")
    p.add_argument("--coarsest", type=float)
    known, others = p.parse_known_args()
    return known, others


def cost(action):
    """Processor seconds of all threads, and the peak in MB while it runs."""
    mesh_report.return_memory()
    mesh_report.reset_peak_memory()
    before = sum(resource.getrusage(resource.RUSAGE_SELF)[:2])
    start = time.perf_counter()
    action()
    return sum(resource.getrusage(resource.RUSAGE_SELF)[:2]) - before, time.perf_counter() - start, mesh_report.peak_memory()


class Costs:
    """Runs steps in place of mesh.py's Runner; rows of name, seconds, by the clock, MB."""

    def __init__(self):
        self.rows = []

    def run(self, name, algorithm):
        self.rows.append((name, *cost(algorithm.Update)))


def chain(geometry, size, threads, others):
    """(name, seconds, by the clock, MB) of each stage, and the mesh."""
    costs = Costs()
    with tempfile.TemporaryDirectory() as folder:
        options = command.parser().parse_args([geometry, "--feature-size", str(size), "--threads", threads, "-o", folder] + others)
        grid, _, _ = command.mesh_geometry(pm, costs, options, command.read_geometry(pm, costs, options))
    return costs.rows, grid


def afterwards(grid, threads):
    """What is done with a finished mesh."""
    rows = []
    for name, algorithm in (("to tetrahedra", pm.vtkConvertCells()), ("to standard cells", pm.vtkConvertCells()),
                            ("Mesh Quality Report", pm.vtkMeshQualityReport()), ("Mesh Slice", pm.vtkMeshSlice())):
        algorithm.SetInputDataObject(grid)
        algorithm.SetThreads(int(threads))
        if name == "to standard cells":
            algorithm.SetCellShapes(1)
        if name == "Mesh Slice":
            algorithm.GetPlane().SetOrigin(*grid.GetCenter())
            algorithm.GetPlane().SetNormal(0, 1, 0)
        rows.append((name, *cost(algorithm.Update)))
    with tempfile.TemporaryDirectory() as folder:
        foam, fluent = pm.vtkPolyMeshWriter(), pm.vtkFluentWriter()
        foam.SetDirectory(folder)
        fluent.SetFileName(os.path.join(folder, "mesh.msh"))
        for name, writer in (("polyMesh, binary", foam), (".msh, binary", fluent)):
            writer.SetInputDataObject(grid)
            rows.append((name, *cost(writer.Write)))
    return rows


def main():
    known, others = arguments()
    for size in known.sizes:
        base = ["--base-size", str(known.coarsest * size)] if known.coarsest else []
        stages, grid = chain(known.geometry, size, known.threads, others + base)
        cells = grid.GetNumberOfCells()
        print(f"\n{os.path.basename(known.geometry)}, {size:g}: {cells:,} cells, {known.threads} thread(s)\n")
        print("| stage | CPU s | s | µs a cell | peak MB |\n|---|---|---|---|---|")
        total = ("all stages", *(sum(row[i] for row in stages[1:]) for i in (1, 2)), max(row[3] for row in stages))
        for name, seconds, clock, peak in stages + [total] + afterwards(grid, known.threads):
            print(f"| {name} | {seconds:.2f} | {clock:.2f} | {1e6 * seconds / cells:.1f} | {peak:,.0f} |", flush=True)


if __name__ == "__main__":
    main()
