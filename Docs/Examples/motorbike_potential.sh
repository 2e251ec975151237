#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Potential flow around OpenFOAM's motorBike at 20 m/s: meshes the space around it (cells of 1/64 m at the surface), runs
# potentialFoam, prints the mass balance, and draws flow.png, the speed in the middle plane and the pressure coefficient on
# the surface.
#
#   Docs/Examples/motorbike_potential.sh [OUT [FEATURE_SIZE [GEOMETRY]]]    (default: motorbike_potential, 1/64 m)
#
# Needs Debian's package openfoam, and openfoam-examples for the geometry.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
source "$root/Docs/Examples/flow.sh"
out=${1:-motorbike_potential}
size=${2:-0.015625}
geometry=${3:-/usr/share/doc/openfoam-examples/examples/resources/geometry/motorBike.obj.gz}

need_program potentialFoam
[ -f "$geometry" ] || fail "There is no file $geometry; install Debian's package openfoam-examples or name the file."
make_mesh "$out" "$geometry" --feature-size "$size" --base-size 1 --layers 1 \
  --domain -5 -4 0 15 4 8 --refine-box -1 -0.7 0 8 0.7 2.5 0.0625
make_case "$out" motorbike_potential
solve "$out" potentialFoam -writePhi -writephi
# The velocity is taken from the potential: that which potentialFoam 1912 itself writes is wrong in cells that are no bricks.
solve "$out" postProcess -time 0 -funcs '(grad(Phi) flowRatePatch(name=xmin) flowRatePatch(name=xmax))'
draw motorbike "$out"
pvpython "$root/Docs/Examples/flow_report.py" motorbike "$out/case"
