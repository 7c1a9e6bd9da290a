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
#                           [VERSION]
#
#   VERSION          the version to build; by default the one that the
#                    distribution has (3.8 on Debian 12, 3.9.1 on Ubuntu 24.04)
#   --source DIR     take COLMAP's source from DIR, a release or a checkout of
#                    VERSION (3.8 to 3.10), instead of the distribution; DIR is
#                    copied every time and not changed
#   --prefix DIR     where to install; by default install/ in this repository
#   --skip-install   do not look for missing packages (and need no root rights)
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
    -*) usage >&2; exit 2 ;;
    *) [[ -z $version ]] || { usage >&2; exit 2; }
       version=$1 ;;
  esac
  shift
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
repository=$PWD
source scripts/apt.sh
: "${prefix:=$repository/install}"

fail() { echo "build_colmap: $1" >&2; exit "${2:-1}"; }
step() { printf '\n== %s\n' "$*"; }

# What COLMAP needs beside the packages of install_dependencies.sh.
packages=(
  dpkg-dev
  libboost-filesystem-dev
  libboost-graph-dev
  libboost-system-dev
  libboost-test-dev
  libcgal-dev
  libfreeimage-dev
  libglew-dev
  libmetis-dev
  libsqlite3-dev
  patch
)
if ((install)); then
  step "Packages"
  scripts/install_dependencies.sh
  install_packages "${packages[@]}"
fi

# The patch for a version is that of its line; a patch for all of 3.11 has the
# name colmap-3.11.patch.
find_patch() {  # find_patch VERSION
  local name
  for name in "$1" "$(cut -d. -f1,2 <<<"$1")"; do
    if [[ -f patches/colmap-$name.patch ]]; then
      echo "$repository/patches/colmap-$name.patch"
      return
    fi
  done
  fail "no patch for COLMAP $1; there is $(cd patches && echo *.patch)"
}

# apt-get with entries for source packages of the configured suites. These, the
# lists and the cache are kept in the folder `apt` and nowhere else.
work=$repository/build-colmap
apt=$work/apt
apt_sources() {
  "$@" -qq -o APT::Sandbox::User=root \
    -o Dir::Etc::sourcelist="$apt/sources.list" \
    -o Dir::Etc::sourceparts=/dev/null -o Dir::State::lists="$apt/lists" \
    -o Dir::Cache="$apt/cache"
}

fetch_source() {  # sets version and source
  local keys=() keyring origin all chosen
  mkdir -p "$apt/lists/partial" "$apt/cache/archives/partial"
  for keyring in debian ubuntu; do
    if [[ -f /usr/share/keyrings/$keyring-archive-keyring.gpg ]]; then
      keys+=("/usr/share/keyrings/$keyring-archive-keyring.gpg")
    fi
  done
  local signed=
  ((${#keys[@]} == 0)) || signed="[signed-by=$(IFS=,; echo "${keys[*]}")] "
  for origin in Debian Ubuntu; do
    apt-get indextargets "Identifier: Packages" "Origin: $origin" --format \
      "deb-src $signed\$(REPO_URI) \$(RELEASE) \$(COMPONENT)"
  done | sort -u >"$apt/sources.list"
  [[ -s $apt/sources.list ]] ||
    fail "apt knows no suite of Debian or Ubuntu; run apt-get update" 3
  # Without a network the lists of an earlier run will do. Lists that cannot be
  # fetched are no error to apt-get unless it is told so.
  apt_sources apt-get update -o APT::Update::Error-Mode=any ||
    echo "build_colmap: going on with the package lists that are here" >&2
  # Every version with the upstream part of it, the newest last.
  all=$({ apt_sources apt-cache showsrc colmap || true; } |
        sed -n 's/^Version: //p' | sort -Vu)
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
  if [[ -f $source/CMakeLists.txt ]]; then
    return
  fi
  # Unpacked beside and moved, so that what is there is whole.
  rm -rf "$work/$version/fetch"
  mkdir -p "$work/$version/fetch"
  (cd "$work/$version/fetch" &&
   apt_sources apt-get source "colmap=${chosen% *}") ||
    fail "apt-get source colmap failed, see above" 3
  mv "$work/$version/fetch"/colmap-*/ "$source"
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
  if [[ $(printf '%s\n' 3.9 "$version" | sort -V | head -1) != 3.9 ]] &&
     ((release >= 12)); then
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
# Without what was found before: the prefix may be another one.
cmake -G Ninja -S "$patched" -B "$work/$version/build" -UColmapTsar_DIR \
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$prefix" \
  -DCMAKE_PREFIX_PATH="$prefix" -DGUI_ENABLED=OFF -DTESTS_ENABLED=OFF \
  -DCUDA_ENABLED="$cuda" -DCMAKE_CUDA_ARCHITECTURES="$CUDA_ARCHITECTURES" \
  "${launcher[@]}"
cmake --build "$work/$version/build"
cmake --install "$work/$version/build" >/dev/null

printf '\n%s has these commands more:\n' "$prefix/bin/colmap"
"$prefix/bin/colmap" help | grep '^ *tsar_' ||
  fail "the program that was built does not list them"
