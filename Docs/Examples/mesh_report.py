# SPDX-License-Identifier: BSD-3-Clause
"""The table that mesh.py prints: what the mesh consists of, how good it is and what it cost."""
from vtkmodules.vtkCommonDataModel import (VTK_HEXAHEDRON, VTK_POLYHEDRON, VTK_PYRAMID, VTK_TETRA, VTK_VOXEL,
                                           VTK_WEDGE)
from vtkmodules.util.numpy_support import vtk_to_numpy
import numpy

TYPE_NAMES = {VTK_VOXEL: "voxels", VTK_HEXAHEDRON: "hexahedra", VTK_WEDGE: "wedges", VTK_TETRA: "tetrahedra",
              VTK_PYRAMID: "pyramids", VTK_POLYHEDRON: "polyhedra"}


def rows(title, pairs):
    print(f"\n{title}")
    for name, value in pairs:
        print(f"  {name:38s} {value}")


def cells(grid):
    types = numpy.bincount(vtk_to_numpy(grid.GetCellTypesArray()), minlength=max(TYPE_NAMES) + 1)
    pairs = [("cells", f"{grid.GetNumberOfCells():,}")]
    pairs += [(f"  {name}", f"{types[kind]:,}") for kind, name in TYPE_NAMES.items() if types[kind]]
    return pairs + [("points", f"{grid.GetNumberOfPoints():,}")]


def patches(boundary):
    field = boundary.GetFieldData()
    names, kinds = field.GetAbstractArray("PatchNames"), field.GetAbstractArray("PatchTypes")
    of_face = vtk_to_numpy(boundary.GetCellData().GetArray("PatchId"))
    counts = numpy.bincount(of_face, minlength=names.GetNumberOfValues())
    meaning = {"wall": "geometry", "patch": "domain side"}
    return [(names.GetValue(i), f"{counts[i]:,} faces ({meaning[kinds.GetValue(i)]})") for i in range(len(counts))]


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
    """One line a patch; and why faces have fewer layers than were wanted. Covered: a layer at the wall."""
    columns = [table.GetColumn(i) for i in range(table.GetNumberOfColumns())]
    value = {c.GetName(): c for c in columns}
    first_reason = [c.GetName() for c in columns].index("Thickness") + 1
    print("\nLayers by patch (shares of area; lengths)\n" + 29 * " " + "   faces wanted  mean   all of covered | first height "
          "wanted      mean     least  in 20% | thickness")
    for row in range(table.GetNumberOfRows()):
        number = {name: column.GetValue(row) for name, column in value.items()}
        print(f"  {number['Patch'][:27]:27s} {number['Faces']:8,d} {number['LayersWanted']:6d} {number['Layers']:5.2f} "
              f"{number['AllLayers']:7.1f}% {number['Covered']:6.1f}% | {number['FirstHeightWanted']:19.3g} "
              f"{number['FirstHeightMean']:9.3g} {number['FirstHeightLeast']:9.3g} {number['AsWanted']:6.1f}% | "
              f"{number['Thickness']:9.3g}")
    last = table.GetNumberOfRows() - 1
    reasons = [(c.GetName(), f"{c.GetValue(last):,} faces") for c in columns[first_reason:]] if last >= 0 else []
    if reasons:
        rows("Fewer layers, because", reasons)


def print_report(filters, last, validity, measured):
    """filters: the stages that ran; last: the filter that holds the mesh, a stage or what came after it."""
    grid = last.GetOutputDataObject(0)
    rows("Mesh", cells(grid))
    if validity:
        rows("Faces", [("internal", f"{validity.GetInternalFaces():,}"),
                       ("boundary", f"{validity.GetBoundaryFaces():,}")])
        rows("Patches", patches(last.GetOutputDataObject(1)))
        rows("Worst measures", worst_measures(validity))
    if len(filters) > 4:
        rows("Features", features(filters[4]))
    if len(filters) > 5:
        rows("Layers", layers(filters[5]))
        layer_table(filters[5].GetOutputDataObject(filters[5].LAYERS))
    print("\nCost" + 34 * " " + f"{'seconds':>9s} {'peak MB':>9s}")
    for stage, seconds, megabytes in measured:
        print(f"  {stage:34s} {seconds:11.2f} {megabytes:9.0f}")
    print(f"  {'total, largest':34s} {sum(m[1] for m in measured):11.2f} {max(m[2] for m in measured):9.0f}")
    print(flush=True)
