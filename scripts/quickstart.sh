#!/usr/bin/env bash
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
#
# Builds the program, reconstructs the sample scene from its posed photos, and
# shows what refinement gained. Everything is written below the repository:
# build/ and sample/ (which is made anew every time; a sample/ that it did not
# make is left alone).
#
#   scripts/quickstart.sh [--skip-install] [--stereo tsar|colmap]
#
#   --skip-install   do not look for missing packages (and need no root rights)
#   --stereo         where the depth maps come from: tsar_stereo makes them of
#                    the photos (the default; without a GPU this takes some four
#                    minutes of one core), or COLMAP 3.10 has made them
set -euo pipefail

usage() {
  echo "usage: scripts/quickstart.sh [--skip-install] [--stereo tsar|colmap]" >&2
  exit 2
}

install=1
stereo=tsar
while (($#)); do
  case "$1 ${2:-}" in
    --skip-install*) install=0 ;;
    "--stereo tsar" | "--stereo colmap")
      stereo=$2
      shift ;;
    *) usage ;;
  esac
  shift
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."

program=build/bin/colmap_tsar
sample=sample
marker=$sample/made_by_quickstart
log=$(mktemp)
trap 'rm -f "$log"' EXIT

step() { printf '\n== %s\n' "$*"; }

# Runs a command whose output is of use only when it fails.
quietly() {
  if ! "$@" >"$log" 2>&1; then
    cat "$log" >&2
    echo "quickstart: failed: $*" >&2
    exit 1
  fi
}

# The same for what takes minutes: a line every ten seconds shows how far it is.
patiently() {
  local line next=0
  if ! "$@" 2>&1 | tee "$log" | while IFS= read -r line; do
    if ((SECONDS >= next)); then
      echo "${line:0:78}"
      next=$((SECONDS + 10))
    fi
  done; then
    cat "$log" >&2
    echo "quickstart: failed: $*" >&2
    exit 1
  fi
}

evaluate() {  # evaluate CLOUD.ply OUTPUT.json
  "$program" tsar_evaluate cloud --input_path "$1" \
    --ground_truth_path "$sample/scans/scan_alignment.mlp" \
    --tolerances 0.02,0.05 --json 1 >"$2"
}

if [[ (-e $sample || -L $sample) && ! -f $marker ]]; then
  echo "quickstart: $PWD/$sample is there already and was not made by this" \
    "script, or not to its end; move or remove it" >&2
  exit 1
fi

if ((install)); then
  step "Packages"
  scripts/install_dependencies.sh
fi

step "Build"
# One GPU architecture, this machine's, takes a fraction of the time of all.
if command -v nvidia-smi >/dev/null && nvidia-smi -L >/dev/null 2>&1; then
  gpu=(-DTSAR_CUDA=AUTO -DCMAKE_CUDA_ARCHITECTURES=native)
else
  gpu=(-DTSAR_CUDA=OFF)
fi
quietly cmake --preset release -DTSAR_TESTS=OFF "${gpu[@]}"
echo "compiling: some minutes the first time"
patiently cmake --build --preset release --target colmap_tsar_program
"$program" --version

step "Sample scene"
# The python3 of the packages has numpy; another that comes first may not.
python=python3
"$python" -c "import numpy" 2>/dev/null || python=/usr/bin/python3
rm -rf "$sample"
"$python" scripts/sample_scene.py unpack data/sample "$sample"
touch "$marker"
echo "$sample: 8 views of a room"
if [[ $stereo == tsar ]]; then
  step "Stereo"
  # In place of COLMAP's maps, which come with the scene.
  "$program" tsar_stereo --workspace_path "$sample" --overwrite 1
fi

step "Fusion of the maps before refinement"
quietly "$program" tsar_fuse --workspace_path "$sample" \
  --output_path "$sample/before.ply"
echo "$sample/before.ply"

step "Refinement, fusion and a page"
"$program" tsar_reconstruct --workspace_path "$sample" --output_path "$sample" \
  --stereo 0

step "Result, measured against the scene's laser scans"
evaluate "$sample/before.ply" "$sample/before.json"
evaluate "$sample/fused.ply" "$sample/after.json"
"$python" scripts/compare_scores.py "$sample/before.json" "$sample/after.json"

cat <<END

Open $sample/report/index.html in a browser: depth and normals of each image,
before and after. $sample/before.ply and fused.ply are for a viewer of point
clouds.

With a dense workspace of your own, as colmap image_undistorter makes it, one
command does the same, and its cloud is DENSE/reconstruction/fused.ply:

  $PWD/$program tsar_reconstruct --workspace_path DENSE

With depth maps of COLMAP's in it, from patch_match_stereo:

  $PWD/$program tsar_refine --workspace_path DENSE
  colmap stereo_fusion --workspace_path DENSE --output_path DENSE/fused.ply

The maps from before are kept; tsar_refine --workspace_path DENSE
--restore 1 puts them back.
END
