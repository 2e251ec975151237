#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Meshes triangle geometry: ./mesh.sh [GEOMETRY ...] [-o OUT] [options]; ./mesh.sh --help lists them. Without a geometry
# it meshes the shipped pipe junction. Sets up and builds what is missing first, into ./build.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$root/.ci/setup.sh"

setup_packages
setup_build "$root/build" -DCMAKE_BUILD_TYPE=Release -- ProjectionMesherFiltersPython

export PYTHONPATH=$root/build/lib/python3/dist-packages${PYTHONPATH:+:$PYTHONPATH}
export LD_LIBRARY_PATH=$root/build/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
# pvpython would load all of ParaView: 150 MB that meshing has no use for.
exec /usr/bin/python3 "$root/Docs/Examples/mesh.py" "$@"
