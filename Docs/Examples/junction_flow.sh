#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# From STL to picture: meshes the dirty pipe junction, runs OpenFOAM's simpleFoam on it (air, 1 m/s at the inlet, k-epsilon)
# until the residuals are small, prints iterations, mass balance and pressure drop, and draws velocity.png and pressure.png.
#
#   Docs/Examples/junction_flow.sh [OUT [FEATURE_SIZE [GEOMETRY]]]    (default: junction_flow, 0.0013 m, the dirty STL)
#
# Exits 0 only when the flow has converged and what comes in goes out. Needs Debian's package openfoam.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
source "$root/Docs/Examples/flow.sh"
out=${1:-junction_flow}
size=${2:-0.0013}
geometry=${3:-$root/Testing/Data/pipe_junction_dirty.stl}

need_program simpleFoam
# Cells in the middle at most twice the smallest: a solver needs them where the geometry alone does not.
make_mesh "$out" "$geometry" --feature-size "$size" --base-size "$(awk "BEGIN { print 2 * $size }")" --layers 5
need_patches "$out" inlet wall outlet1 outlet2 outlet3
make_case "$out" junction_flow
solve "$out" simpleFoam
draw junction "$out"
pvpython "$root/Docs/Examples/flow_report.py" junction "$out/case"
