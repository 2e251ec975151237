# SPDX-License-Identifier: BSD-3-Clause
"""Meshes models from outside with this suite and with OpenFOAM's snappyHexMesh at the same cell size, and compares.

    pvpython compare_snappy.py FOLDER GEOMETRY [...] [--division 150] [--judge JUDGE.py]

Both mesh the same box, a quarter of the model's diagonal wider than the model, with cells that are 16 times as large far
away as the diagonal / division on the model; without layers. snappyHexMesh is set as in OpenFOAM's own motorBike
tutorial: edges of 30 degrees extracted and snapped to. What it made stays in FOLDER. The judge is one for
collection.py. Needs OpenFOAM's programs (package openfoam) and projection_mesher on PYTHONPATH.
"""
import argparse
import json
import os
import subprocess
import time

import numpy
from collection import NOT_A_SIDE, corners_of, diagonal_of, read_surface

LEVELS = 4
HEADER = 'FoamFile {{ version 2.0; format ascii; class dictionary; object {}; }}\n'
DICTIONARIES = {
    "controlDict": "application snappyHexMesh; startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1;\n"
                   "writeControl timeStep; writeInterval 1; writeFormat binary; writePrecision 12; writeCompression off;\n",
    "fvSchemes": "ddtSchemes { default steadyState; } gradSchemes { default Gauss linear; } divSchemes { default none; }\n"
                 "laplacianSchemes { default Gauss linear corrected; } interpolationSchemes { default linear; }\n"
                 "snGradSchemes { default corrected; }\n",
    "fvSolution": "",
    "surfaceFeatureExtractDict": "geometry.stl { extractionMethod extractFromSurface; includedAngle 150;\n"
                                 "subsetFeatures { nonManifoldEdges yes; openEdges yes; } }\n",
    "blockMeshDict": """vertices ( ({0} {1} {2}) ({3} {1} {2}) ({3} {4} {2}) ({0} {4} {2})
           ({0} {1} {5}) ({3} {1} {5}) ({3} {4} {5}) ({0} {4} {5}) );
blocks ( hex (0 1 2 3 4 5 6 7) ({6} {7} {8}) simpleGrading (1 1 1) );
boundary ( xmin {{ type patch; faces ((0 4 7 3)); }} xmax {{ type patch; faces ((2 6 5 1)); }}
           ymin {{ type patch; faces ((1 5 4 0)); }} ymax {{ type patch; faces ((3 7 6 2)); }}
           zmin {{ type patch; faces ((0 3 2 1)); }} zmax {{ type patch; faces ((4 5 6 7)); }} );
""",
    "snappyHexMeshDict": """castellatedMesh true; snap true; addLayers false;
geometry {{ geometry.stl {{ type triSurfaceMesh; name geometry; }} }}
castellatedMeshControls
{{
    maxLocalCells 10000000; maxGlobalCells 20000000; minRefinementCells 10; maxLoadUnbalance 0.10;
    nCellsBetweenLevels 3; features ( {{ file "geometry.eMesh"; level {9}; }} );
    refinementSurfaces {{ geometry {{ level ({9} {9}); }} }}
    refinementRegions {{ }}
    resolveFeatureAngle 30; locationInMesh ({10} {11} {12}); allowFreeStandingZoneFaces true;
}}
snapControls
{{
    nSmoothPatch 3; tolerance 2.0; nSolveIter 30; nRelaxIter 5;
    nFeatureSnapIter 10; implicitFeatureSnap false; explicitFeatureSnap true; multiRegionFeatureSnap false;
}}
addLayersControls {{ layers {{ }} relativeSizes true; expansionRatio 1; finalLayerThickness 0.3; minThickness 0.1; nGrow 0;
    featureAngle 60; nRelaxIter 3; nSmoothSurfaceNormals 1; nSmoothNormals 3; nSmoothThickness 10; maxFaceThicknessRatio 0.5;
    maxThicknessToMedialRatio 0.3; minMedialAxisAngle 90; nBufferCellsNoExtrude 0; nLayerIter 50; }}
meshQualityControls
{{
    maxNonOrtho 65; maxBoundarySkewness 20; maxInternalSkewness 4; maxConcave 80; minVol 1e-30; minTetQuality 1e-30;
    minArea -1; minTwist 0.02; minDeterminant 0.001; minFaceWeight 0.05; minVolRatio 0.01; minTriangleTwist -1;
    nSmoothScale 4; errorReduction 0.75;
}}
mergeTolerance 1e-6;
""",
}


def box_around(surface, base):
    """Corners of a box of whole base cells around a surface."""
    points = corners_of(surface).reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    wider = 0.25 * numpy.linalg.norm(high - low)
    cells = numpy.ceil((high - low + 2 * wider) / base).astype(int)
    low = 0.5 * (low + high) - 0.5 * base * cells
    return low, low + base * cells, cells


def write_case(folder, surface, low, high, cells):
    from vtkmodules.vtkIOGeometry import vtkSTLWriter
    for name in ("system", "constant/triSurface"):
        os.makedirs(os.path.join(folder, name), exist_ok=True)
    writer = vtkSTLWriter()
    writer.SetFileName(os.path.join(folder, "constant/triSurface/geometry.stl"))
    writer.SetInputData(surface)
    writer.SetFileTypeToBinary()
    writer.Write()
    seed = low + 1.003e-3 * (high - low)
    values = [*low, *high, *cells, LEVELS, *seed]
    for name, text in DICTIONARIES.items():
        with open(os.path.join(folder, "system", name), "w", encoding="ascii") as out:
            out.write(HEADER.format(name) + (text.format(*values) if "{0}" in text or "{9}" in text else text))


def run_snappy(folder):
    environment = {**os.environ, "WM_PROJECT_DIR": os.environ.get("WM_PROJECT_DIR", "/usr/share/openfoam")}
    for name in ("PYTHONPATH", "LD_LIBRARY_PATH"):
        environment.pop(name, None)
    start = time.perf_counter()
    for command in (["surfaceFeatureExtract"], ["blockMesh"], ["snappyHexMesh", "-overwrite"]):
        with open(os.path.join(folder, f"log.{command[0]}"), "w", encoding="utf-8") as log:
            if subprocess.run(command, cwd=folder, env=environment, stdout=log, stderr=log, check=False).returncode:
                raise SystemExit(f"{command[0]} failed; see {log.name}.")
    return time.perf_counter() - start, os.path.join(folder, "constant", "polyMesh")


def run_suite(folder, surface, low, high, base):
    from projection_mesher import ProjectionMesherFilters as pm
    mesh, writer = pm.vtkProjectionMesh(), pm.vtkPolyMeshWriter()
    start = time.perf_counter()
    mesh.SetInputDataObject(0, surface)
    mesh.SetFeatureSize(base / 2**LEVELS)
    mesh.SetBaseSize(base)
    mesh.SetUseDomain(True)
    mesh.SetDomainBounds(*numpy.column_stack([low, high]).ravel())
    mesh.SetRegion(pm.vtkPaintFront.OUTSIDE)
    mesh.SetStopAfter(5)  # Resolve Features
    mesh.Update()
    writer.SetInputDataObject(mesh.GetOutputDataObject(0))
    writer.SetDirectory(os.path.join(folder, "polyMesh"))
    writer.Write()
    return time.perf_counter() - start, os.path.join(folder, "polyMesh")


def judged(judge, mesh, geometry, size):
    report = mesh + ".json"
    subprocess.run(["pvpython", judge, mesh, "--geometry", geometry, "--l-feat", repr(size), "--walls", NOT_A_SIDE, "--json",
                    report], env={k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "LD_LIBRARY_PATH")},
                   stdout=subprocess.DEVNULL, check=True)
    with open(report, encoding="ascii") as data:
        return json.load(data)


def row(model, program, seconds, report):
    features = report.get("features", {"captured": float("nan"), "reachable": float("nan")})
    print(f"| {model} | {program} | {report['cells']:,} | {seconds:.0f} | {report['violations']:,} "
          f"| {100 * report['mesh_to_geometry_over_l']['below_0p05']:.1f} "
          f"| {100 * report['geometry_to_mesh_over_l']['below_0p1']:.1f} "
          f"| {100 * features['captured']:.1f} of {100 * features['reachable']:.0f} |", flush=True)


def compare(path, options):
    model = os.path.basename(path).split(".")[0]
    folder = os.path.join(options.folder, model)
    surface, _errors = read_surface(path)
    size = diagonal_of(surface) / options.division
    low, high, cells = box_around(surface, size * 2**LEVELS)
    write_case(folder, surface, low, high, cells)
    for program, run in (("this suite", lambda: run_suite(folder, surface, low, high, size * 2**LEVELS)),
                         ("snappyHexMesh", lambda: run_snappy(folder))):
        seconds, mesh = run()
        if options.judge:
            row(model, program, seconds, judged(options.judge, mesh, path, size))
        else:
            print(f"{model}: {program} {seconds:.0f} s, {mesh}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("geometry", nargs="+")
    parser.add_argument("--division", type=float, default=150)
    parser.add_argument("--judge")
    options = parser.parse_args()
    print("| model | program | cells | seconds | violations | wall % | geometry % | features %, of reachable % |\n"
          "|---|---|---|---|---|---|---|---|")
    for path in options.geometry:
        compare(path, options)


if __name__ == "__main__":
    main()
