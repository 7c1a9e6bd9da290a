#!/usr/bin/env bash
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs what is missing, builds everything, and runs all tests:
# - an optimized build, with the benchmarks and the Python module, with CUDA
#   where nvcc is found, and warnings as errors: whole runs, the Python module,
#   and the unit tests of what must give the same bits however it is compiled;
# - a build under the address and undefined sanitizers: every unit test.
# The last line says how many passed, failed and were skipped (those that need
# what is not there, such as a network); the exit code is 0 only if none failed.
#
#   scripts/test.sh [--all]
#
#   --all   also the parts that tests/parts.json names, which are large and
#           rarely affected: the readers fed with hostile input (libFuzzer), the
#           distribution's COLMAP built with this project's patch, Slurm and
#           Snakemake (700 MB, services), a wheel, and Chromium. Without it, those
#           that a change of the last day may affect; Slurm, Snakemake and COLMAP
#           only with CI=true.
#
# With CI=true the CUDA part is compiled for one architecture alone, which is
# enough to see that it compiles.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
case $# in
  0) all= ;;
  *) [[ $# == 1 && $1 == --all ]] ||
       { echo "usage: scripts/test.sh [--all]" >&2; exit 2; }
     all=--all ;;
esac

scripts/install_dependencies.sh --tests
chosen=$(scripts/test_parts.py $all)
parts=" ${chosen%%$'\n'*} "
left_out_tests=${chosen##*$'\n'}
# includes PART: whether it is to be tested.
includes() { [[ $parts == *" $1 "* ]]; }
# The same of those that change the machine.
includes_on_this_machine() {
  [[ ${CI:-} == true || -n $all ]] && includes "$1"
}

if includes_on_this_machine clusters; then
  source scripts/apt.sh
  install_packages slurm-wlm snakemake ||
    echo "test: the tests of Slurm and Snakemake will be skipped"
fi

# Hits that survive a fresh checkout: by the compiler's content, not its date,
# and whatever the folder.
export CCACHE_COMPILERCHECK=content
export CCACHE_BASEDIR=$PWD
export CCACHE_NOHASHDIR=1
export CCACHE_INODECACHE=1  # A precompiled header is large: hashed once.
export QT_QPA_PLATFORM=offscreen  # For the tests that run COLMAP.

jobs=$(nproc)
log=$(mktemp)
trap 'rm -f "$log"' EXIT
passed=0
failed=0
skipped=0

build() {  # build PRESET [CMAKE_OPTION...]
  local preset=$1
  shift
  printf '\n== %s: build\n' "$preset"
  cmake --preset "$preset" -DTSAR_TESTS=ON "$@"
  cmake --build --preset "$preset" --parallel "$jobs"
}

run_tests() {  # run_tests PRESET
  local preset=$1
  printf '\n== %s: tests\n' "$preset"
  local status=0
  ctest --preset "$preset" --parallel "$jobs" --no-tests=error \
    --exclude-regex "$left_out_tests" 2>&1 |
    tee "$log" || status=$?
  local summary='^[0-9]+% tests passed, ([0-9]+) tests? failed out of ([0-9]+)'
  local line failures total left_out
  line=$(grep -E "$summary" "$log" || true)
  if [[ ! $line =~ $summary ]]; then
    echo "test: ctest of preset $preset ended without a summary" >&2
    exit 1
  fi
  failures=${BASH_REMATCH[1]}
  total=${BASH_REMATCH[2]}
  if ((status != 0 && failures == 0)); then
    echo "test: ctest of preset $preset failed without a failed test" >&2
    exit 1
  fi
  # To ctest these have passed.
  left_out=$(grep -cE '^[[:space:]]+[0-9]+ - .* \(Skipped\)$' "$log" || true)
  # Of processes that share the cases of a program, what passed in them and was
  # skipped counts by the case; one that failed stays one failure.
  local shards shards_failed cases cases_skipped
  read -r shards cases cases_skipped < <(count_cases "$preset")
  shards_failed=$(
    grep -cE '^[[:space:]]+[0-9]+ - [^ ]*\.[0-9]+of[0-9]+ \(' "$log" || true)
  passed=$((passed + total - failures - left_out - (shards - shards_failed) +
            cases))
  failed=$((failed + failures))
  skipped=$((skipped + left_out + cases_skipped))
}

# How many processes share the cases of a program (tests/CMakeLists.txt), how
# many cases passed in them and how many were skipped, by ctest's log.
count_cases() {  # count_cases PRESET
  local folder=build-$1
  [[ $1 != release ]] || folder=build
  awk '
    /^[0-9]+\/[0-9]+ Testing: / {
      shares = $3 ~ /\.[0-9]+of[0-9]+$/
      shards += shares
    }
    shares && /^\[ +(PASSED|SKIPPED) +\] [0-9]+ tests?[.,]/ { cases[$2] += $4 }
    END { print shards + 0, cases["PASSED"] + 0, cases["SKIPPED"] + 0 }
  ' "$folder/Testing/Temporary/LastTest.log"
}

# Has the tests of preset release include those of a COLMAP with the patch.
build_patched_colmap() {
  local status=0
  scripts/build_colmap.sh --prefix "$PWD/install" || status=$?
  case $status in
    0) cmake --preset release -DTSAR_PATCHED_COLMAP="$PWD/install/bin/colmap" ;;
    3) echo "test: SKIPPED the tests of a patched COLMAP, the distribution's" \
            "source package cannot be had" ;;
    *) echo "test: the patched COLMAP was not built" >&2
       exit 1 ;;
  esac
}

# The patched COLMAP of an earlier run is none of this one.
release_options=(
  -DTSAR_UNIT_TESTS=OFF -DTSAR_WARNINGS_AS_ERRORS=ON -DTSAR_BENCHMARKS=ON
  -DTSAR_PYTHON=ON
  -DTSAR_PATCHED_COLMAP=)
if [[ ${CI:-} == true ]]; then
  export CUDA_ARCHITECTURES=90
  release_options+=(-DCMAKE_CUDA_ARCHITECTURES=$CUDA_ARCHITECTURES)
fi
build release "${release_options[@]}"
if includes_on_this_machine patched_colmap; then
  build_patched_colmap
fi
run_tests release
# Here warnings stay warnings: on instrumented code GCC warns of what cannot be
# (-Wrestrict inside std::string, for one).
build debug -DTSAR_UNIT_TESTS=ON -DTSAR_WARNINGS_AS_ERRORS=OFF
run_tests debug
# The readers alone, by Clang, fed with a bounded number of hostile inputs.
if includes fuzz; then
  printf '\n== fuzz: build\n'
  cmake --preset fuzz
  cmake --build --preset fuzz --parallel "$jobs"
  run_tests fuzz
fi

printf '\n%d passed, %d failed, %d skipped\n' "$passed" "$failed" "$skipped"
((failed == 0))
