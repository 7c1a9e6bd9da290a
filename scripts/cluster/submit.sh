#!/usr/bin/env bash
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
#
# Has Slurm refine a dense workspace on several machines that share its file
# system: an array job that observes the images, a job that finds the planes of
# the scene once all are observed, an array job that composes the maps, and a job
# that ends the work. Jobs that are killed are queued
# again and go on where they were. docs/cluster.md tells more.
#
#   submit.sh WORKSPACE NUM_SHARDS [OPTION_OF_TSAR_REFINE...]
#
# The program is colmap_tsar on the path of the nodes, or TSAR_PROGRAM. What the
# jobs need is for sbatch's own variables to say, which count for all:
# SBATCH_PARTITION, SBATCH_ACCOUNT, SBATCH_TIMELIMIT, SBATCH_GPUS_PER_TASK...
set -euo pipefail

if (($# < 2)) || ! [[ $2 =~ ^[1-9][0-9]*$ ]]; then
  echo "usage: $(basename "$0") WORKSPACE NUM_SHARDS [OPTION_OF_TSAR_REFINE...]" >&2
  exit 1
fi
workspace=$(realpath -- "$1")
num_shards=$2
shift 2
if ! command -v sbatch >/dev/null; then
  echo "$(basename "$0"): there is no sbatch; run it where Slurm's commands are" >&2
  exit 1
fi
folder=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

# submit NAME SBATCH_OPTION... -- SCRIPT ARGUMENT...: prints the job's number.
submit() {
  local name=$1 options=()
  shift
  while [[ $1 != -- ]]; do
    options+=("$1")
    shift
  done
  shift
  # What a cluster's name follows with --parsable is none of the number.
  sbatch --parsable --requeue --job-name="tsar_$name" "${options[@]}" "$@" |
    cut -d ';' -f 1
}

array=--array=0-$((num_shards - 1))
observe=$(submit observe "$array" -- \
  "$folder/shard.sbatch" observe "$num_shards" "$workspace" "$@")
model=$(submit model \
  --dependency="afterok:$observe" --kill-on-invalid-dep=yes -- \
  "$folder/shard.sbatch" model "$num_shards" "$workspace" "$@")
compose=$(submit compose "$array" \
  --dependency="afterok:$model" --kill-on-invalid-dep=yes -- \
  "$folder/shard.sbatch" compose "$num_shards" "$workspace" "$@")
merge=$(submit merge \
  --dependency="afterok:$compose" --kill-on-invalid-dep=yes -- \
  "$folder/merge.sbatch" "$workspace" "$@")
echo "observe $observe, model $model, compose $compose, merge $merge"
