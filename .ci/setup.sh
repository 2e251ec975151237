# SPDX-License-Identifier: BSD-3-Clause
# Set-up shared by mesh.sh and test.sh; source it. Needs $root, the checkout. Debian 12.
#
#   setup_packages   installs what is missing
#   setup_build DIR [CMAKE_OPTION ...] [-- TARGET ...]   configures once, builds what changed
#
# Both are quick when there is nothing to do, say nothing but what a person waits for, and keep the rest in a log.

packages=(
  g++ cmake ninja-build
  # ParaView, and what its CMake configuration asks for
  paraview paraview-dev python3-paraview libboost-iostreams-dev libblosc-dev libimath-dev qtbase5-dev libqt5svg5-dev
  libqt5xmlpatterns5-dev qtxmlpatterns5-dev-tools qttools5-dev libqt5opengl5-dev libutfcpp-dev libopenmpi-dev
  libhdf5-mpi-dev libxml2-dev zlib1g-dev libgl-dev libglew-dev libfreetype-dev libpython3-dev libdouble-conversion-dev
  libexpat1-dev libjpeg-dev libpng-dev liblz4-dev liblzma-dev libtiff-dev libnetcdf-dev libtheora-dev python3-mpi4py
  # the kernel
  libopenvdb-dev libtbb-dev libeigen3-dev libfmt-dev
  # tests, benchmarks, pictures
  libgtest-dev libbenchmark-dev python3-numpy python3-scipy python3-matplotlib xvfb xauth libgl1-mesa-dri
)

# say SENTENCE: to the person, on standard error
say() { printf '%s\n' "$*" >&2; }

# logged LOG COMMAND ...: runs the command, its output in the log; on failure shows the log's end and fails
logged() {
  local log=$1
  shift
  if ! "$@" >> "$log" 2>&1; then
    tail -n 40 "$log" >&2
    say "Failed: $*  (whole log: $log)"
    return 1
  fi
}

missing_packages() {
  comm -23 <(printf '%s\n' "${packages[@]}" | sort) \
    <(dpkg-query -W -f '${db:Status-Abbrev} ${Package}\n' "${packages[@]}" 2> /dev/null | sed -n 's/^ii *//p' | sort)
}

setup_packages() {
  if ! command -v dpkg-query > /dev/null; then
    say "This is no Debian system: the packages listed in .ci/setup.sh are taken as installed."
    return 0
  fi
  local missing sudo=()
  mapfile -t missing < <(missing_packages)
  [ ${#missing[@]} -eq 0 ] && return 0
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo > /dev/null; then
      say "Packages are missing; run as root: apt-get install ${missing[*]}"
      return 1
    fi
    sudo=(sudo)
  fi
  mkdir -p "$root/build"
  say "Installing ${#missing[@]} Debian packages: ${missing[*]}"
  logged "$root/build/packages.log" "${sudo[@]}" apt-get update -q
  logged "$root/build/packages.log" "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -q -y --no-install-recommends "${missing[@]}"
}

setup_build() {
  local directory=$1 options=() targets=()
  shift
  while [ $# -gt 0 ] && [ "$1" != -- ]; do
    options+=("$1")
    shift
  done
  [ $# -gt 0 ] && shift
  targets=("$@")
  mkdir -p "$directory"
  local log=$directory/setup.log
  (
    flock 9 # two commands at once build once
    : > "$log"
    # A build directory belongs to the checkout and the options it was configured with.
    local wanted="$root ${options[*]}"
    if [ ! -f "$directory/build.ninja" ] || [ "$(cat "$directory/.configured" 2> /dev/null)" != "$wanted" ]; then
      rm -rf "$directory/CMakeCache.txt" "$directory/CMakeFiles" "$directory/.configured"
      command -v ccache > /dev/null && options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
      say "Configuring ${directory#"$root"/} ..."
      logged "$log" cmake -S "$root" -B "$directory" -G Ninja "${options[@]}"
      printf '%s' "$wanted" > "$directory/.configured"
    fi
    if [ "$(ninja -C "$directory" -n "${targets[@]}" 2> /dev/null | tail -n 1)" != "ninja: no work to do." ]; then
      say "Building ${directory#"$root"/} (the first time takes some minutes) ..."
      logged "$log" ninja -C "$directory" "${targets[@]}"
    fi
  ) 9> "$directory/.lock"
}
