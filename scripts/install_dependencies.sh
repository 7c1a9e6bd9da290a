#!/usr/bin/env bash
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs every package that building, testing and trying this project needs.
# Made for Debian 12 and Ubuntu 24.04; run as root or as a user with sudo. Does
# nothing, and needs no network, where all of them are there already.
#
#   scripts/install_dependencies.sh [--tests]
#
#   --tests   also what only scripts/test.sh needs: Clang for the fuzzers, and
#             Chromium, by which a test looks at the page of tsar_report;
#             without Chromium that test is skipped
#
# The CUDA toolkit is not among them: where nvcc is found it is used, elsewhere
# the same program is built for the CPU alone.
set -euo pipefail

source "$(dirname "${BASH_SOURCE[0]}")/apt.sh"

for_tests=0
for argument in "$@"; do
  case $argument in
    --tests) for_tests=1 ;;
    *) echo "usage: scripts/install_dependencies.sh [--tests]" >&2
       exit 2 ;;
  esac
done

packages=(
  # Compiler and build.
  build-essential
  ccache
  cmake
  ninja-build
  pkg-config
  # Manual pages and shell completions, which the build makes.
  python3
  # Libraries. OpenCV's CMake package lies in libopencv-dev and names all of
  # OpenCV's libraries, so that the three that are used do not suffice.
  libboost-dev
  libboost-program-options-dev
  libceres-dev
  libeigen3-dev
  libflann-dev
  libgoogle-glog-dev
  libgtest-dev
  liblz4-dev
  libopencv-dev
  libxxhash-dev
  nlohmann-json3-dev
  # The benchmarks, which -DTSAR_BENCHMARKS=ON builds.
  libbenchmark-dev
  # The Python module, which -DTSAR_PYTHON=ON builds. python3-venv is for its
  # tests, and for users: pip installs nothing outside of a virtual environment.
  pybind11-dev
  python3-dev
  python3-venv
  # Packages by cpack, and the tests of the manual pages.
  dpkg-dev
  file
  groff-base
  # The sample scene and the comparison with COLMAP's own fusion.
  colmap
  python3-numpy
  # Pictures that the Python module exports.
  python3-opencv
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

if ((for_tests)); then
  packages+=(clang libclang-rt-dev)
fi
install_packages "${packages[@]}"
# Ubuntu's package of Chromium only asks for a snap.
if ((for_tests)) && [[ $distribution != ubuntu-* ]]; then
  install_packages chromium chromium-driver python3-selenium ||
    echo "install_dependencies: no Chromium; the test of tsar_report's page" \
         "will be skipped" >&2
fi
