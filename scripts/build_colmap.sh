#!/usr/bin/env bash
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
#
# Builds COLMAP with the commands of this project inside (colmap tsar_refine
# and the others): takes the source package of the distribution, applies the
# patch for its version, and builds without the graphical interface, with CUDA
# where nvcc is found.
#
#   scripts/build_colmap.sh [--prefix DIR] [--source DIR] [--skip-install]
#                           [VERSION] [-- CMAKE_ARGUMENT...]
#
#   VERSION          the version to build; by default the one that the
#                    distribution has (3.8 on Debian 12, 3.9.1 on Ubuntu 24.04)
#   --source DIR     take COLMAP's source from DIR, a release or a checkout of
#                    VERSION (3.8 to 4.1), instead of the distribution; DIR is
#                    copied every time and not changed
#   --prefix DIR     where to install; by default install/ in this repository
#   --skip-install   do not look for missing packages (and need no root rights)
#   CMAKE_ARGUMENT   for COLMAP's CMake, after the script's own: for example
#                    -DFETCH_POSELIB=OFF -DFETCH_FAISS=OFF, from 3.12 on, where
#                    both are installed and nothing shall be downloaded
#
# The variable CUDA_ARCHITECTURES, in CMake's words, overrides the choice of
# GPUs. The system's lists of package sources stay as they are. Exit code 3: the
# source package cannot be had; any other code but 0: something else went wrong.
set -euo pipefail

# The text above.
usage() { sed -n '5,/^[^#]/s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; }

prefix=
source=
version=
install=1
cmake_arguments=()
while (($#)); do
  case $1 in
    --prefix | --source)
      (($# > 1)) || { usage >&2; exit 2; }
      # On a line of its own, so that an empty DIR ends the script.
      value=$(realpath -m -- "$2")
      printf -v "${1#--}" %s "$value"
      shift ;;
    --skip-install) install=0 ;;
    -h | --help) usage; exit 0 ;;
    --) cmake_arguments=("${@:2}")
        break ;;
    -*) usage >&2; exit 2 ;;
    *) [[ -z $version ]] || { usage >&2; exit 2; }
       version=$1 ;;
  esac
  shift
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
repository=$PWD
source scripts/apt.sh
source scripts/apt_source.sh
: "${prefix:=$repository/install}"

fail() { echo "build_colmap: $1" >&2; exit "${2:-1}"; }
step() { printf '\n== %s\n' "$*"; }

if ((install)); then
  step "Packages"
  scripts/install_dependencies.sh
  install_packages dpkg-dev patch
fi

# since VERSION: whether that one or a later one is built.
since() { [[ $(printf '%s\n' "$1" "$version" | sort -V | head -1) == "$1" ]]; }

# What the version needs beside the packages of install_dependencies.sh. PoseLib
# (from 3.11 on), faiss (3.12) and the ONNX runtime (4.0) are downloaded by
# COLMAP's CMake. OpenBLAS, for faiss, must be the one with OpenMP; it takes the
# place of the system's BLAS, so who has a faiss of their own is spared it.
install_colmap_packages() {
  local packages=(
    libboost-graph-dev
    libboost-system-dev
    libcgal-dev
    libglew-dev
    libmetis-dev
    libsqlite3-dev
  )
  if since 4.0; then
    packages+=(libopenimageio-dev libsuitesparse-dev openimageio-tools)
  else
    packages+=(libfreeimage-dev)
  fi
  if since 3.12; then
    packages+=(libcurl4-openssl-dev libssl-dev)
    if [[ " ${cmake_arguments[*]} " != *" -DFETCH_FAISS=OFF "* ]]; then
      packages+=(libopenblas-openmp-dev)
    fi
  else
    packages+=(libboost-filesystem-dev libboost-test-dev)
  fi
  install_packages "${packages[@]}"
}

# The patch for a version is that of its line; a patch for all of 3.11 has the
# name colmap-3.11.patch. What is later than all of them may well be as the last.
find_patch() {  # find_patch VERSION
  local name last
  for name in "$1" "$(cut -d. -f1,2 <<<"$1")"; do
    if [[ -f patches/colmap-$name.patch ]]; then
      echo "$repository/patches/colmap-$name.patch"
      return
    fi
  done
  last=$(cd patches && printf '%s\n' colmap-*.patch | sort -V | tail -1)
  name=${last#colmap-}
  if ! since "${name%.patch}"; then
    fail "no patch for COLMAP $1; there is $(cd patches && echo *.patch)"
  fi
  echo "build_colmap: no patch for COLMAP $1, trying $last" >&2
  echo "$repository/patches/$last"
}

work=$repository/build-colmap
apt_folder=$work/apt
fetch_source() {  # sets version and source
  local all chosen
  read_apt_sources ||
    fail "apt knows no suite of Debian or Ubuntu; run apt-get update" 3
  # Every version with the upstream part of it, the newest last.
  all=$(source_versions colmap)
  chosen=$(while read -r full; do
             [[ -n $full ]] || continue
             upstream=${full#*:}
             upstream=${upstream%-*}
             upstream=${upstream%%[+~]*}
             if [[ -z $version || $version == "$upstream" ]]; then
               echo "$full $upstream"
             fi
           done <<<"$all" | tail -1)
  if [[ -z $chosen ]]; then
    all=${all//$'\n'/ }
    fail "the distribution has no source of COLMAP${version:+ $version} (it \
has: ${all:-none}); get it and name its folder by --source" 3
  fi
  version=${chosen#* }
  source=$work/$version/distribution
  if [[ ! -f $source/CMakeLists.txt ]]; then
    unpack_source colmap "${chosen% *}" "$source" ||
      fail "apt-get source colmap failed, see above" 3
  fi
}

step "Source of COLMAP"
if [[ -z $source ]]; then
  fetch_source
else
  [[ -n $version ]] || fail "--source needs the VERSION that it holds"
  [[ -f $source/CMakeLists.txt ]] || fail "$source: holds no CMakeLists.txt"
  [[ $source/ != "$work"/* ]] || fail "--source must not lie in $work"
fi
patch=$(find_patch "$version")
if ((install)); then
  install_colmap_packages
fi
echo "COLMAP $version from $source, with $(basename "$patch")"

# A copy is patched. With another folder or patch nothing stays of what was
# built; a folder of the user's is copied always, since it may have been edited.
step "Patch"
patched=$work/$version/source
digest=$({ echo "$source" && cat "$patch"; } | sha256sum)
if [[ $(cat "$patched/patched" 2>/dev/null) != "$digest" ]]; then
  rm -rf "$patched" "$work/$version/build"
fi
if [[ ! -d $patched || $source/ != "$work"/* ]]; then
  rm -rf "$patched"
  mkdir -p "$work/$version"
  cp -a "$source" "$patched"
  patch -s -p1 --fuzz=0 --no-backup-if-mismatch -d "$patched" <"$patch" ||
    fail "$(basename "$patch") does not fit; is it COLMAP $version?"
  echo "$digest" >"$patched/patched"
fi
echo "$patched"

# One GPU architecture, this machine's, takes a fraction of the time of all.
architectures=all-major
if command -v nvidia-smi >/dev/null && nvidia-smi -L >/dev/null 2>&1; then
  architectures=native
fi

# The preset undoes the TSAR_CUDA=OFF of an earlier build. The other options of
# a folder that is in use stay: scripts/test.sh has just built it, has named the
# GPUs, and goes on with it.
step "TSAR for COLMAP"
options=()
if [[ ! -f build/build.ninja ]]; then
  options+=(-DTSAR_TESTS=OFF)
  : "${CUDA_ARCHITECTURES:=$architectures}"
fi
if [[ -n ${CUDA_ARCHITECTURES:-} ]]; then
  options+=(-DCMAKE_CUDA_ARCHITECTURES="$CUDA_ARCHITECTURES")
fi
: "${CUDA_ARCHITECTURES:=$architectures}"
cmake --preset release "${options[@]}"
cmake --build --preset release --target colmap_tsar_program tsar_manual
cmake --install build --prefix "$prefix" >/dev/null

step "COLMAP $version"
cuda=OFF
if command -v nvcc >/dev/null; then
  cuda=ON
  release=$(nvcc --version | sed -n 's/.*release \([0-9]*\)\..*/\1/p')
  # Its bundle adjustment on the GPU uses what CUDA 12 no longer has.
  if ! since 3.9 && ((release >= 12)); then
    echo "COLMAP $version does not compile with CUDA $release: its own" \
         "commands are built without CUDA; those of TSAR for COLMAP have it"
    cuda=OFF
  fi
fi
launcher=()
if command -v ccache >/dev/null; then
  export CCACHE_COMPILERCHECK=content CCACHE_NOHASHDIR=1
  export CCACHE_BASEDIR=$repository
  launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache
            -DCMAKE_CXX_COMPILER_LAUNCHER=ccache
            -DCMAKE_CUDA_COMPILER_LAUNCHER=ccache)
fi
# Without what was found before: the prefix may be another one. The prefix goes
# by the environment, for an argument may set CMAKE_PREFIX_PATH.
CMAKE_PREFIX_PATH=$prefix${CMAKE_PREFIX_PATH:+:$CMAKE_PREFIX_PATH} \
cmake -G Ninja -S "$patched" -B "$work/$version/build" \
  -UColmapTsar_DIR -UCMAKE_PREFIX_PATH \
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$prefix" \
  -DGUI_ENABLED=OFF -DTESTS_ENABLED=OFF \
  -DCUDA_ENABLED="$cuda" -DCMAKE_CUDA_ARCHITECTURES="$CUDA_ARCHITECTURES" \
  "${launcher[@]}" "${cmake_arguments[@]}"
cmake --build "$work/$version/build"
cmake --install "$work/$version/build" >/dev/null

printf '\n%s has these commands more:\n' "$prefix/bin/colmap"
"$prefix/bin/colmap" help | grep '^ *tsar_' ||
  fail "the program that was built does not list them"
