# SPDX-License-Identifier: BSD-3-Clause
"""Meshes a folder of models inside and outside at several sizes, and makes the tables of Docs/Collection.md.

    pvpython collection.py run FOLDER RESULTS.jsonl [--divisions 30 80] [--judge JUDGE.py] [--check SCRIPT] [...]
    pvpython collection.py table RESULTS.jsonl PAGE.md

`run` starts a process for each run, so that a crash or a hang is a result too, and appends one line of JSON for it to
the results; what is in them already is not run again, so it may be stopped and continued. FOLDER (default: the
environment variable PROJECTIONMESHER_GEOMETRY) is searched for .stl, .obj and .ply, also .gz. Every mesh is measured by
Mesh Quality Report and, where given, by a judge (a script for pvpython: `JUDGE.py polyMesh --geometry FILE --l-feat L
--walls REGEX --json OUT`) and by a script that takes a polyMesh folder and exits 0 when OpenFOAM accepts the mesh.
`table` writes the tables between the marks in PAGE.md. projection_mesher must be on PYTHONPATH.
"""
import argparse
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

ENDINGS = (".stl", ".obj", ".ply")
SIDES = ("xmin", "xmax", "ymin", "ymax", "zmin", "zmax")
REGIONS = ("inside", "outside")
GEOMETRY_SAMPLES = 20000
NOT_A_SIDE = "^(?!(" + "|".join(SIDES) + ")(_[0-9]+)?$)"


# ---------------------------------------------------------------------------------------------------- one run
def read_surface(path):
    """Triangles, and the reader's errors."""
    from projection_mesher import ProjectionMesherFilters as pm
    from vtkmodules.vtkFiltersCore import vtkTriangleFilter
    reader, triangles = pm.vtkSurfaceReader(), vtkTriangleFilter()
    reader.SetFileName(path)
    errors = collect(reader, "ErrorEvent")
    reader.Update()
    triangles.SetInputDataObject(reader.GetOutput())
    triangles.PassVertsOff()
    triangles.PassLinesOff()
    triangles.Update()
    return triangles.GetOutput(), errors


def diagonal_of(surface):
    """Of the box around the triangles that have an area: stray points do not count."""
    import numpy
    corners = corners_of(surface)
    used = corners[area_of(corners) > 0].reshape(-1, 3)
    return float(numpy.linalg.norm(used.max(axis=0) - used.min(axis=0))) if len(used) else 0.0


def collect(algorithm, event):
    """The list that the texts of the event will be in, without VTK's decoration."""
    texts = []

    def observer(_caller, _event, text):
        texts.append(" ".join(re.sub(r"^.*?\(0x[0-9a-f]+\): ", "", text.strip(), flags=re.S).split()))
    observer.CallDataType = "string0"
    algorithm.AddObserver(event, observer)
    algorithm.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)  # it only repeats that there was one
    return texts


def mesh_one(path, division, region, layers, folder):
    """Meshes one side of one model into folder/polyMesh; what came of it."""
    from projection_mesher import ProjectionMesherFilters as pm
    surface, errors = read_surface(path)
    if not surface.GetNumberOfPolys():
        return {"status": "sentence", "text": errors[0] if errors else "The file holds no triangles."}
    diagonal = diagonal_of(surface)
    mesh = pm.vtkProjectionMesh()
    mesh.SetInputDataObject(0, surface)
    mesh.SetPatchArray("PatchId")
    mesh.SetFeatureSize(diagonal / division)
    mesh.SetRegion(pm.vtkPaintFront.OUTSIDE if region == "outside" else pm.vtkPaintFront.INSIDE)
    mesh.SetLayers(layers)
    mesh.SetThreads(1)
    errors, warnings = collect(mesh, "ErrorEvent"), collect(mesh, "WarningEvent")
    start = time.process_time()
    mesh.Update()
    result = {"diagonal": diagonal, "seconds": time.process_time() - start, "warnings": warnings}
    grid, boundary = mesh.GetOutputDataObject(0), mesh.GetOutputDataObject(1)
    if errors or not grid.GetNumberOfCells():
        return {**result, "status": "sentence", "text": errors[0] if errors else ""}
    size = grid.GetFieldData().GetArray("FinestSize").GetTuple1(0)
    result.update(status="mesh", cells=grid.GetNumberOfCells(), finest=size, memory=peak_memory(),
                  feature_length=mesh.GetFeatureLength(), resolved_length=mesh.GetResolvedLength(),
                  wall_faces=mesh.GetWallFaces(), layered=mesh.GetFacesWithLayers(layers),
                  quality=quality(pm, grid), **wall_distance(surface, boundary, size))
    writer = pm.vtkPolyMeshWriter()
    writer.SetInputDataObject(grid)
    writer.SetDirectory(os.path.join(folder, "polyMesh"))
    writer.Write()
    return result


def peak_memory():
    """MB."""
    import resource
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def quality(pm, grid):
    """The worst of each measure by the project's own report, and how many are outside their limits."""
    report = pm.vtkMeshQualityReport()
    report.SetInputDataObject(0, grid)
    report.SetThreads(1)
    report.Update()
    table = report.GetOutputDataObject(report.SUMMARY)
    rows = {}
    for row in range(table.GetNumberOfRows()):
        entry = {table.GetColumnName(c): table.GetValue(row, c).ToString() for c in range(table.GetNumberOfColumns())}
        rows[entry["Measure"]] = {key: float(entry[key]) for key in ("Minimum", "Maximum", "Outside")}
    return rows


class Surface:
    """Closest distance to a set of triangles."""

    def __init__(self, polydata):
        from vtkmodules.vtkCommonCore import mutable
        from vtkmodules.vtkCommonDataModel import vtkGenericCell, vtkStaticCellLocator
        self.locator = vtkStaticCellLocator()
        self.locator.SetDataSet(polydata)
        self.locator.BuildLocator()
        self.scratch = [0.0] * 3, vtkGenericCell(), mutable(0), mutable(0), mutable(0.0)

    def distance(self, points):
        import numpy
        result = numpy.empty(len(points))
        for i, point in enumerate(points):
            self.locator.FindClosestPoint(point, *self.scratch)
            result[i] = self.scratch[-1].get() ** 0.5
        return result


def wall_samples(boundary):
    """Points, face centres and edge middles of the wall, and the wall as triangles about the face centres."""
    import numpy
    from vtkmodules.util.numpy_support import vtk_to_numpy
    kinds = boundary.GetFieldData().GetAbstractArray("PatchTypes")
    wall = numpy.array([kinds.GetValue(i) == "wall" for i in range(kinds.GetNumberOfValues())])
    sizes = numpy.diff(vtk_to_numpy(boundary.GetPolys().GetOffsetsArray()))
    faces = wall[vtk_to_numpy(boundary.GetCellData().GetArray("PatchId"))]
    ids = vtk_to_numpy(boundary.GetPolys().GetConnectivityArray())[numpy.repeat(faces, sizes)]
    sizes = sizes[faces]
    points = vtk_to_numpy(boundary.GetPoints().GetData())
    face = numpy.repeat(numpy.arange(len(sizes)), sizes)
    following = numpy.arange(1, len(ids) + 1)
    following[numpy.cumsum(sizes) - 1] = numpy.cumsum(sizes) - sizes
    a, b = points[ids], points[ids[following]]
    mean = numpy.column_stack([numpy.bincount(face, a[:, k]) for k in range(3)]) / sizes[:, None]
    area = numpy.linalg.norm(numpy.cross(a - mean[face], b - mean[face]), axis=1)
    third = area[:, None] * (a + b + mean[face]) / 3
    centre = numpy.column_stack([numpy.bincount(face, third[:, k]) for k in range(3)]) / numpy.bincount(face, area)[:, None]
    return points[numpy.unique(ids)], numpy.concatenate([centre, (a + b) / 2]), numpy.stack([a, b, centre[face]], axis=1)


def soup(corners):
    """Polydata of triangles: #T by 3 corners by 3 coordinates."""
    import numpy
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    polydata, points, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    points.SetData(numpy_to_vtk(numpy.ascontiguousarray(corners.reshape(-1, 3)), deep=1))
    cells.SetData(3, numpy_to_vtkIdTypeArray(numpy.arange(3 * len(corners), dtype=numpy.int64), deep=1))
    polydata.SetPoints(points)
    polydata.SetPolys(cells)
    return polydata


def corners_of(surface):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    points = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)
    return points[vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)]


def area_of(corners):
    import numpy
    return numpy.linalg.norm(numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2


def wall_distance(surface, boundary, size):
    """Shares of the wall near the geometry, and of points thrown evenly on the geometry near the wall."""
    import numpy
    nodes, between, triangles = wall_samples(boundary)
    if not len(nodes):
        return {"wall_points": 0, "near": None, "wall": None, "geometry": None}
    geometry = Surface(surface)
    near, others = (geometry.distance(points) < 0.05 * size for points in (nodes, between))
    corners, generator = corners_of(surface), numpy.random.default_rng(1)
    area = area_of(corners)
    chosen = corners[generator.choice(len(corners), GEOMETRY_SAMPLES, p=area / area.sum())]
    u, v = numpy.sqrt(generator.random((GEOMETRY_SAMPLES, 1))), generator.random((GEOMETRY_SAMPLES, 1))
    thrown = (1 - u) * chosen[:, 0] + u * (1 - v) * chosen[:, 1] + u * v * chosen[:, 2]
    return {"wall_points": len(nodes), "near": float(near.mean()),
            "wall": float((near.sum() + others.sum()) / (len(near) + len(others))),
            "geometry": float((Surface(soup(triangles)).distance(thrown) < 0.1 * size).mean())}


def one(options):
    with open(options.result, "w", encoding="utf-8") as out:
        json.dump(mesh_one(options.geometry, options.division, options.region, options.layers, options.folder), out)


# ---------------------------------------------------------------------------------------------------- all runs
def models(folder):
    found = []
    for where, folders, names in os.walk(folder):
        folders.sort()
        found += [os.path.join(where, name) for name in sorted(names)
                  if re.sub(r"\.gz$", "", name.lower()).endswith(ENDINGS)]
    return found


def run_one(path, division, region, options, folder):
    """In a process of its own, so that a crash or a hang is a result like any other."""
    answer = os.path.join(folder, "answer.json")
    command = ["pvpython", os.path.abspath(__file__), "one", path, str(division), region, str(options.layers), folder, answer]
    with open(os.path.join(folder, "log"), "w+", encoding="utf-8", errors="replace") as log:
        try:
            done = subprocess.run(command, stdout=log, stderr=subprocess.STDOUT, timeout=options.timeout, check=False)
        except subprocess.TimeoutExpired:
            return {"status": "hang", "text": f"no end within {options.timeout:g} s"}
        log.seek(0)
        tail = log.read()[-400:]
    if done.returncode != 0 or not os.path.exists(answer):
        return {"status": "crash", "text": f"exit code {done.returncode}: {tail}"}
    with open(answer, encoding="utf-8") as file:
        return json.load(file)


def check_mesh(script, mesh):
    done = subprocess.run([script, mesh], capture_output=True, text=True, errors="replace", check=False)
    failed = re.findall(r"\*\*\*.*", done.stdout)
    return "Mesh OK" if done.returncode == 0 else "; ".join(failed) or done.stdout[-200:] or done.stderr[-200:]


def judge_mesh(script, mesh, path, size, folder):
    """What the table needs of the judge's answer; a geometry that the judge cannot read is left out."""
    answer = os.path.join(folder, "judge.json")
    command = ["pvpython", script, mesh, "--l-feat", repr(size), "--walls", NOT_A_SIDE, "--json", answer]
    for geometry in (["--geometry", path], []):
        done = subprocess.run(command + geometry, capture_output=True, text=True, errors="replace", check=False)
        if done.returncode == 0 and os.path.exists(answer):
            break
    else:
        return {"failed": done.stderr[-300:]}
    with open(answer, encoding="utf-8") as file:
        full = json.load(file)
    result = {key: full[key] for key in ("violations", "thesis_violations", "boundary", "validity")}
    for name, key in (("mesh_to_geometry_over_l", "below_0p05"), ("geometry_to_mesh_over_l", "below_0p1"),
                      ("features", "captured"), ("features", "reachable")):
        result[key] = full.get(name, {}).get(key)
    return result


def run(options):
    done = {key(entry) for entry in read_results(options.results)}
    files = models(options.folder)
    for division in options.divisions:
        for path in files:
            for region in REGIONS:
                entry = {"model": os.path.relpath(path, options.folder), "division": division, "region": region}
                wanted = not options.only or re.search(options.only, entry["model"])
                if not wanted or key(entry) in done:
                    continue
                with tempfile.TemporaryDirectory() as folder:
                    entry.update(run_one(path, division, region, options, folder))
                    measure_mesh(entry, path, options, folder)
                with open(options.results, "a", encoding="utf-8") as results:
                    results.write(json.dumps(entry) + "\n")
                print(summary_line(entry), flush=True)


def measure_mesh(entry, path, options, folder):
    mesh = os.path.join(folder, "polyMesh")
    if entry["status"] != "mesh":
        return
    if options.check:
        entry["check"] = check_mesh(options.check, mesh)
    if options.judge and entry["division"] in (options.judge_at or options.divisions):
        entry["judge"] = judge_mesh(options.judge, mesh, path, entry["finest"], folder)
    if options.keep:
        target = os.path.join(options.keep, re.sub(r"\W", "_", f"{entry['model']}_{entry['division']}_{entry['region']}"))
        shutil.rmtree(target, ignore_errors=True)
        shutil.copytree(mesh, target)


def key(entry):
    return entry["model"], entry["division"], entry["region"]


def read_results(path):
    """The last entry of each run, so that a run that was made again replaces the first."""
    entries = {}
    if os.path.exists(path):
        with open(path, encoding="utf-8") as file:
            for line in file:
                entry = json.loads(line)
                entries[key(entry)] = entry
    return list(entries.values())


def summary_line(entry):
    head = f"{entry['model']} 1/{entry['division']:g} {entry['region']}:"
    if entry["status"] != "mesh":
        return f"{head} {entry['status']}: {entry.get('text', '')}"
    judge = entry.get("judge", {})
    return (f"{head} {entry['cells']} cells, {entry['seconds']:.1f} s, outside limits {outside(entry)}, "
            f"near {entry['near'] or 0:.3f}, check {entry.get('check')}, judge {judge.get('violations', judge.get('failed'))}")


KEPT = ("Volume", "CentralTet", "FacePyramid", "Openness", "EtaInternal", "EtaBoundary", "AngleInternal", "AngleBoundary",
        "Warpage", "SkewInternal", "SkewBoundary")


def outside(entry):
    """Faces and cells outside the limits that every stage keeps."""
    return int(sum(entry["quality"][name]["Outside"] for name in KEPT))


# ---------------------------------------------------------------------------------------------------- tables
SENTENCES = (("too thin", "closed, but too thin"), ("leaks", "The widest leak"), ("nothing enclosed", "encloses nothing"),
             ("budget", "budget|memory"), ("no triangles", "no triangles"))
HEADS = ("model", "cells", "s", "min eta", "angle internal", "angle boundary", "skewness", "non-orthogonality",
         "volume / l³", "wall", "geometry")


def sentence_kind(entry):
    for kind, pattern in SENTENCES:
        if re.search(pattern, entry["text"]):
            return kind
    return entry["text"] or "no sentence"


def worst(entry, extreme, *names):
    return extreme(entry["quality"][name][{min: "Minimum", max: "Maximum"}[extreme]] for name in names)


def percent(value):
    return "–" if value is None else f"{100 * value:.1f}"


def captured(entry):
    """Share of the sharp edges near the wall, as the judge sees them; none where the wall is near no sharp edge."""
    return entry["judge"].get("captured") if entry.get("judge", {}).get("reachable") else None


def on_edges(entry):
    """Share of all feature lines, by the project's own count."""
    return entry["resolved_length"] / entry["feature_length"] if entry["feature_length"] else None


def figures(entry):
    """A run's columns after the model's name."""
    if entry["status"] != "mesh":
        return [sentence_kind(entry) if entry["status"] == "sentence" else entry["status"]] + [""] * (len(HEADS) - 1)
    judge = entry.get("judge", {})
    wall, geometry = judge.get("below_0p05", entry.get("wall")), judge.get("below_0p1", entry.get("geometry"))
    return [f"{entry['cells']:,}", f"{entry['seconds']:.1f}", f"{worst(entry, min, 'EtaInternal', 'EtaBoundary'):.2f}",
            f"{worst(entry, max, 'AngleInternal'):.0f}", f"{worst(entry, max, 'AngleBoundary'):.0f}",
            f"{worst(entry, max, 'SkewInternal', 'SkewBoundary'):.1f}", f"{worst(entry, max, 'NonOrthogonality'):.0f}",
            f"{worst(entry, min, 'Volume'):.3f}", percent(wall), percent(geometry), percent(captured(entry) if judge else on_edges(entry))]


def row(cells):
    return "| " + " | ".join(cells) + " |"


def heading(heads):
    return [row(heads), "|" + "---|" * len(heads)]


def model_table(entries):
    """A row for each model; inside / outside in each cell."""
    of_model, judged = {}, any("judge" in entry for entry in entries)
    for entry in entries:
        of_model.setdefault(entry["model"], {})[entry["region"]] = figures(entry)
    lines = heading([*HEADS, "sharp edges" if judged else "feature lines"])
    for model in sorted(of_model):
        sides = [of_model[model].get(region, ["–"] + [""] * (len(HEADS) - 1)) for region in REGIONS]
        both = [" / ".join(x or "–" for x in pair) if any(pair) else "" for pair in zip(*sides)]
        lines.append(row([re.sub(r"\.gz$", "", model)] + both))
    return lines


def median(values, form="{:.1f}"):
    return form.format(statistics.median(values)) if values else "–"


def median_percent(values):
    return median([100 * v for v in values if v is not None])


def bad(entry):
    """Whether the run ended in neither a valid mesh nor a sentence."""
    if entry["status"] != "mesh":
        return entry["status"] != "sentence" or not entry["text"]
    return bool(outside(entry) or entry.get("check", "Mesh OK") != "Mesh OK" or entry.get("judge", {}).get("violations"))


def summary_column(entries):
    meshes = [e for e in entries if e["status"] == "mesh"]
    judged = [e["judge"] for e in meshes if "violations" in e.get("judge", {})]
    wall = [e.get("judge", {}).get("below_0p05", e.get("wall")) for e in meshes]
    geometry = [e.get("judge", {}).get("below_0p1", e.get("geometry")) for e in meshes]
    sentences = [sentence_kind(e) for e in entries if e["status"] == "sentence"]
    return [("runs", len(entries)), ("meshes", len(meshes)),
            ("sentences", "; ".join(f"{sentences.count(kind)} {kind}" for kind in sorted(set(sentences))) or 0),
            ("crashes, hangs", sum(e["status"] in ("crash", "hang") for e in entries)),
            ("meshes that OpenFOAM accepts", f"{sum(e.get('check') == 'Mesh OK' for e in meshes)} of "
             f"{sum('check' in e for e in meshes)} checked"),
            ("violations, by the judge", f"{sum(j['violations'] for j in judged)} in {len(judged)} meshes" if judged else "–"),
            ("outside the limits, by Mesh Quality Report", sum(outside(e) for e in meshes)),
            ("cells in all", f"{sum(e['cells'] for e in meshes):,}"),
            ("seconds in all", f"{sum(e['seconds'] for e in meshes):,.0f}"),
            ("cells a second, median", median([e["cells"] / e["seconds"] for e in meshes], "{:,.0f}")),
            ("wall nodes within 0.05 l, %: median", median_percent([e["near"] for e in meshes])),
            ("wall within 0.05 l, %: median", median_percent(wall)),
            ("geometry within 0.1 l, %: median", median_percent(geometry)),
            ("sharp edges captured, %: median", median_percent([captured(e) for e in meshes])),
            ("feature lines on mesh edges, %: median", median_percent([on_edges(e) for e in meshes]))]


def summary_table(entries):
    groups = sorted({(e["division"], e["region"]) for e in entries})
    columns = [dict(summary_column([e for e in entries if (e["division"], e["region"]) == g])) for g in groups]
    lines = heading([""] + [f"1/{division:g} {region}" for division, region in groups])
    return lines + [row([name] + [str(column[name]) for column in columns]) for name in (columns[0] if columns else [])]


def failure_table(entries):
    lines = heading(["run", "what"])
    for e in filter(bad, entries):
        what = e.get("text") or f"{outside(e)} outside, {e.get('check')}, judge {e.get('judge', {}).get('violations')}"
        lines.append(row([f"{e['model']} 1/{e['division']:g} {e['region']}", " ".join(what.split()).replace("|", "/")]))
    return lines if len(lines) > 2 else ["None."]


def table(options):
    entries = read_results(options.results)
    with open(options.page, encoding="utf-8") as file:
        page = file.read()
    tables = {"summary": summary_table(entries), "failures": failure_table(entries)}
    for division in sorted({e["division"] for e in entries}):
        tables[f"1/{division:g}"] = model_table([e for e in entries if e["division"] == division])
    for name, lines in tables.items():
        marks = f"<!-- table {name} -->", f"<!-- end {name} -->"
        page = re.sub(f"(?s){marks[0]}.*?{marks[1]}", lambda _, m=marks, t=lines: "\n".join([m[0], *t, m[1]]), page)
    with open(options.page, "w", encoding="utf-8") as file:
        file.write(page)


# ---------------------------------------------------------------------------------------------------- command line
def parser():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    modes = p.add_subparsers(dest="mode", required=True)
    a = modes.add_parser("run", help="mesh what is not in the results yet")
    a.add_argument("folder", nargs="?", default=os.environ.get("PROJECTIONMESHER_GEOMETRY"))
    a.add_argument("results")
    a.add_argument("--divisions", type=float, nargs="+", default=[30, 80], help="of the diagonal of the bounding box")
    a.add_argument("--layers", type=int, default=1)
    a.add_argument("--only", metavar="REGEX", help="models whose path in the folder matches")
    a.add_argument("--judge", metavar="SCRIPT", help="judges each mesh")
    a.add_argument("--judge-at", type=float, nargs="+", metavar="DIVISION", help="judge only these divisions")
    a.add_argument("--check", metavar="SCRIPT", help="exits 0 when OpenFOAM accepts a polyMesh")
    a.add_argument("--timeout", type=float, default=600, help="seconds for a run")
    a.add_argument("--keep", metavar="DIR", help="keep the polyMesh folders here")
    a = modes.add_parser("one", help="a single run, started by run")
    for name, kind in (("geometry", str), ("division", float), ("region", str), ("layers", int), ("folder", str),
                       ("result", str)):
        a.add_argument(name, type=kind)
    a = modes.add_parser("table", help="write the tables into a page, between its marks")
    a.add_argument("results")
    a.add_argument("page")
    return p


def main():
    options = parser().parse_args()
    {"run": run, "one": one, "table": table}[options.mode](options)


if __name__ == "__main__":
    main()
