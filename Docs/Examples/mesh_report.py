# SPDX-License-Identifier: BSD-3-Clause
"""The table that mesh.py prints: what the mesh consists of, how good it is and what it cost."""
import collections
import ctypes

from vtkmodules.vtkCommonDataModel import (VTK_HEXAHEDRON, VTK_POLYHEDRON, VTK_PYRAMID, VTK_TETRA, VTK_VOXEL,
                                           VTK_WEDGE)

TYPE_NAMES = {VTK_VOXEL: "voxels", VTK_HEXAHEDRON: "hexahedra", VTK_WEDGE: "wedges", VTK_TETRA: "tetrahedra",
              VTK_PYRAMID: "pyramids", VTK_POLYHEDRON: "polyhedra"}


def peak_memory():
    """Peak resident memory of this process in MB since it was last reset."""
    try:
        with open("/proc/self/status", encoding="ascii") as status:
            return next(int(line.split()[1]) for line in status if line.startswith("VmHWM")) / 1024
    except (OSError, StopIteration):
        return float("nan")


def reset_peak_memory():
    try:
        with open("/proc/self/clear_refs", "w", encoding="ascii") as control:
            control.write("5")
    except OSError:
        pass  # then a stage's peak includes those before it


def return_memory():
    """What malloc holds of freed arrays goes back to the system; large ones do from now on when they are freed."""
    try:
        libc, mmap_threshold = ctypes.CDLL(None), -3
        libc.mallopt(mmap_threshold, 1 << 20)
        libc.malloc_trim(0)
    except (OSError, AttributeError):
        pass  # a C library that is not GNU's


def rows(title, pairs):
    """Lines of a part of the report."""
    return ["", title] + [f"  {name:38s} {value}" for name, value in pairs]


def cells(grid):
    types = bytes(memoryview(grid.GetCellTypesArray()))
    counts = {kind: types.count(kind) for kind in TYPE_NAMES}
    pairs = [("cells", f"{grid.GetNumberOfCells():,}")]
    pairs += [(f"  {name}", f"{counts[kind]:,}") for kind, name in TYPE_NAMES.items() if counts[kind]]
    return pairs + [("points", f"{grid.GetNumberOfPoints():,}")]


def patches(boundary):
    field = boundary.GetFieldData()
    names, kinds = field.GetAbstractArray("PatchNames"), field.GetAbstractArray("PatchTypes")
    faces = collections.Counter(memoryview(boundary.GetCellData().GetArray("PatchId")))
    meaning = {"wall": "geometry", "patch": "domain side"}
    return [(names.GetValue(i), f"{faces[i]:,} faces ({meaning[kinds.GetValue(i)]})")
            for i in range(names.GetNumberOfValues())]


def worst_measures(v):
    return [("faces and cells outside the limits", f"{v.GetViolations():,}"),
            ("smallest volume, in finest cells", f"{v.GetWorstVolume():.4g}"),
            ("smallest central tetrahedron, same", f"{v.GetWorstTet():.4g}"),
            ("largest angle internal / boundary", f"{v.GetWorstAngleInternal():.1f} / {v.GetWorstAngleBoundary():.1f} deg"),
            ("largest warpage", f"{v.GetWorstWarpage():.1f} deg"),
            ("smallest degradation internal / boundary", f"{v.GetWorstEtaInternal():.3f} / {v.GetWorstEtaBoundary():.3f}"),
            ("largest skewness internal / boundary", f"{v.GetWorstSkewInternal():.2f} / {v.GetWorstSkewBoundary():.2f}"),
            ("largest openness", f"{v.GetWorstOpenness():.1e}"),
            ("total volume", f"{v.GetTotalVolume():.6g}")]


def share(part, whole):
    form = ",d" if isinstance(part, int) else ",.4g"
    return f"{part:{form}} of {whole:{form}}" + (f" ({100 * part / whole:.1f}%)" if whole else "")


def features(stage):
    pairs = [("length of feature edges resolved", share(stage.GetResolvedLength(), stage.GetFeatureLength())),
             ("corners resolved", share(stage.GetResolvedCorners(), stage.GetCorners()))]
    lost = {}
    parts = stage.GetOutputDataObject(stage.UNRESOLVED).GetCellData()
    for i in range(parts.GetNumberOfTuples()):
        why = parts.GetAbstractArray("Why").GetValue(i)
        lost[why] = lost.get(why, 0) + parts.GetArray("Length").GetValue(i)
    return pairs + [(f"  not: {why}", f"{lost[why]:.4g}") for why in sorted(lost, key=lost.get, reverse=True)]


def layers(stage):
    pairs = [("wall faces", f"{stage.GetWallFaces():,}")]
    n = 1
    while n <= stage.GetLayers() or stage.GetFacesWithLayers(n):
        if stage.GetFacesWithLayers(n) or n <= stage.GetLayers():
            pairs.append((f"  with {n} layer{'s' if n > 1 else ''}", share(stage.GetFacesWithLayers(n), stage.GetWallFaces())))
        n += 1
    return pairs


def layer_table(table):
    """One line a patch; and why faces have fewer layers than were wanted. Covered: a layer at the wall. Growth: of
    heights, what 95% of the area have less of inside the layers, and median and 95% from the last layer outwards."""
    columns = [table.GetColumn(i) for i in range(table.GetNumberOfColumns())]
    value = {c.GetName(): c for c in columns}
    first_reason = [c.GetName() for c in columns].index("Thickness") + 1
    lines = ["", "Layers by patch (shares of area; lengths)", 29 * " " + "   faces wanted  mean   all of covered | first height "
             "wanted      mean     least  in 20% | thickness | growth  last to cells behind, 95%"]
    for row in range(table.GetNumberOfRows()):
        number = {name: column.GetValue(row) for name, column in value.items()}
        lines.append(f"  {number['Patch'][:27]:27s} {number['Faces']:8,d} {number['LayersWanted']:6d} {number['Layers']:5.2f} "
                     f"{number['AllLayers']:7.1f}% {number['Covered']:6.1f}% | {number['FirstHeightWanted']:19.3g} "
                     f"{number['FirstHeightMean']:9.3g} {number['FirstHeightLeast']:9.3g} {number['AsWanted']:6.1f}% | "
                     f"{number['Thickness']:9.3g} | {number['GrowthInside95']:6.2f} {number['GrowthOutside']:21.2f} "
                     f"{number['GrowthOutside95']:4.3g}")
    last = table.GetNumberOfRows() - 1
    reasons = [(c.GetName(), f"{c.GetValue(last):,} faces") for c in columns[first_reason:]] if last >= 0 else []
    return lines + (rows("Fewer layers, because", reasons) if reasons else [])


def of_stage(name, stage):
    """Lines on what a stage has just done; a stage of which there is nothing to say has none."""
    if name == "ResolveFeatures":
        return rows("Features", features(stage))
    if name == "BoundaryRefine":
        return rows("Layers", layers(stage)) + layer_table(stage.GetOutputDataObject(stage.LAYERS))
    return []


def of_mesh(grid, boundary, validity):
    """Lines on the mesh; validity: the filter that has measured it, None for an octree."""
    lines = rows("Mesh", cells(grid))
    if validity:
        lines += rows("Faces", [("internal", f"{validity.GetInternalFaces():,}"),
                                ("boundary", f"{validity.GetBoundaryFaces():,}")])
        lines += rows("Patches", patches(boundary))
        lines += rows("Worst measures", worst_measures(validity))
    return lines


def of_cost(measured):
    """measured: (step, seconds, peak in MB) of all."""
    lines = ["", "Cost" + 34 * " " + f"{'seconds':>9s} {'peak MB':>9s}"]
    lines += [f"  {step:34s} {seconds:11.2f} {megabytes:9.0f}" for step, seconds, megabytes in measured]
    return lines + [f"  {'total, largest':34s} {sum(m[1] for m in measured):11.2f} {max(m[2] for m in measured):9.0f}", ""]
