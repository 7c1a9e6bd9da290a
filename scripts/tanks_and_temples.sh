#!/usr/bin/env bash
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
#
# Reconstructs scenes of Tanks and Temples, from images alone or with given camera
# poses, makes a submission of them, and scores those that come with ground truth.
# tanks_and_temples.sh --help explains it, docs/datasets.md tells more.
#
#   scripts/tanks_and_temples.sh SCENE --output_path OUTPUT [options]
set -euo pipefail

folder=$(dirname "${BASH_SOURCE[0]}")/datasets
exec "$folder/run.sh" "$folder/tanks_and_temples.py" "$@"
