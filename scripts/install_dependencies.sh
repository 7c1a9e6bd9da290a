#!/usr/bin/env bash
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs every package that building, testing and trying this project needs.
# Made for Debian 12 and Ubuntu 24.04; run as root or as a user with sudo. Does
# nothing, and needs no network, where all of them are there already.
#
# The CUDA toolkit is not among them: where nvcc is found it is used, elsewhere
# the same program is built for the CPU alone.
set -euo pipefail

packages=(
  # Compiler and build.
  build-essential
  ccache
  cmake
  ninja-build
  pkg-config
  # Libraries. OpenCV's CMake package lies in libopencv-dev and names all of
  # OpenCV's libraries, so that the three that are used do not suffice.
  libboost-program-options-dev
  libeigen3-dev
  libflann-dev
  libgoogle-glog-dev
  libgtest-dev
  liblz4-dev
  libopencv-dev
  nlohmann-json3-dev
  # The benchmarks, which -DTSAR_BENCHMARKS=ON builds.
  libbenchmark-dev
  # The Python module, which -DTSAR_PYTHON=ON builds. python3-venv is for its
  # tests, and for users: pip installs nothing outside of a virtual environment.
  pybind11-dev
  python3-dev
  python3-venv
  # The sample scene and the comparison with COLMAP's own fusion.
  colmap
  python3
  python3-numpy
)

# Other systems may name their packages otherwise.
distribution=unknown
if [[ -r /etc/os-release ]]; then
  distribution=$(. /etc/os-release && echo "${ID:-unknown}-${VERSION_ID:-}")
fi
case $distribution in
  debian-12 | ubuntu-24.04) ;;
  *) echo "install_dependencies: $distribution was never tried (only Debian 12" \
          "and Ubuntu 24.04); going on with their package names" >&2 ;;
esac

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "install_dependencies: no apt-get on this system; install by hand what" \
       "stands for: ${packages[*]}" >&2
  exit 1
fi

missing=()
for package in "${packages[@]}"; do
  state=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $state == installed ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  echo "install_dependencies: all ${#packages[@]} packages are installed"
  exit 0
fi

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    echo "install_dependencies: run it as root, or install sudo; missing:" \
         "${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

echo "install_dependencies: installing ${missing[*]}"
apt_get() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get -qq -o Dpkg::Use-Pty=0 "$@"
}
# apt-get's report is long and of use only when it fails.
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! { apt_get update &&
       apt_get install -y --no-install-recommends "${missing[@]}"; } \
     >"$log" 2>&1; then
  cat "$log" >&2
  echo "install_dependencies: apt-get failed, see above" >&2
  exit 1
fi
echo "install_dependencies: done"
