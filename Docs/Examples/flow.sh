# SPDX-License-Identifier: BSD-3-Clause
# Shared by the examples that run OpenFOAM; source it. Needs $root, the checkout. Nothing is installed here but by mesh.sh.
#
#   need_program PROGRAM   ends the script when this program of OpenFOAM is not there
#   make_mesh OUT ...      ./mesh.sh; MESHER names another command that takes its options
#   need_patches OUT ...   ends the script when the mesh has no patch of one of these names
#   make_case OUT NAME     OUT/case: the dictionaries of the folder NAME beside this file, and the mesh
#   solve OUT PROGRAM ...  runs it there; what it says goes to OUT/case/log.PROGRAM
#   draw NAME OUT          pictures of the solution

source "$root/.ci/setup.sh"
export WM_PROJECT_DIR=${WM_PROJECT_DIR:-/usr/share/openfoam} # Debian's package is used without its bashrc

fail() {
  say "$(basename "$0"): $*"
  exit 1
}

need_program() {
  command -v "$1" > /dev/null || fail "OpenFOAM's $1 is missing; install Debian's package openfoam: apt-get install openfoam."
}

make_mesh() {
  local out=$1
  [[ "$(realpath -m "$out")" != *[[:space:]]* ]] || fail "OpenFOAM takes no folder with a blank in its path; name another than $out."
  [ ! -e "$out/case" ] || fail "There is a case in $out/case already; remove it or name another folder."
  "${MESHER:-$root/mesh.sh}" -o "$@" || fail "There is no mesh to run on."
}

need_patches() {
  local boundary=$1/polyMesh/boundary patch
  shift
  for patch in "$@"; do
    grep -q "^ *$patch *\$" "$boundary" || fail "The mesh has no patch $patch; name the geometry's solids $*."
  done
}

make_case() {
  cp -r "$root/Docs/Examples/$2" "$1/case"
  mkdir -p "$1/case/constant"
  cp -r "$1/polyMesh" "$1/case/constant/"
}

solve() {
  local out=$1 log
  shift
  log=$out/case/log.$1
  say "Running $1; $log grows meanwhile."
  (cd "$out/case" && exec "$@") > "$log" 2>&1 || {
    tail -n 20 "$log" >&2
    fail "$1 has failed; its log is $log."
  }
}

draw() {
  local display=()
  command -v xvfb-run > /dev/null && display=(xvfb-run -a)
  PYTHONPATH=${PYTHONPATH:+$PYTHONPATH:}$root/build/lib/python3/dist-packages \
    LD_LIBRARY_PATH=${LD_LIBRARY_PATH:+$LD_LIBRARY_PATH:}$root/build/lib \
    "${display[@]}" pvpython "$root/Docs/Examples/flow_pictures.py" "$@" || fail "No pictures could be made."
}
