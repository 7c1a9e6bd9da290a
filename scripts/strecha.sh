#!/usr/bin/env bash
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
#
# Reconstructs scenes of Strecha's multi-view stereo data, whose cameras are given
# as .camera files, and scores those for which a mesh or scans are given.
# strecha.sh --help explains it, docs/datasets.md tells more.
#
#   scripts/strecha.sh SCENE --output_path OUTPUT [options]
set -euo pipefail

folder=$(dirname "${BASH_SOURCE[0]}")/datasets
exec "$folder/run.sh" "$folder/strecha.py" "$@"
