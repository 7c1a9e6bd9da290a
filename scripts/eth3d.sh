#!/usr/bin/env bash
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
#
# Reconstructs scenes of ETH3D's high-resolution multi-view benchmark, makes a
# submission of them, and scores those that come with laser scans.
# eth3d.sh --help explains it, docs/datasets.md tells more.
#
#   scripts/eth3d.sh SCENE --output_path OUTPUT [options]
set -euo pipefail

folder=$(dirname "${BASH_SOURCE[0]}")/datasets
exec "$folder/run.sh" "$folder/eth3d.py" "$@"
