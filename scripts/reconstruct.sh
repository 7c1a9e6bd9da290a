#!/usr/bin/env bash
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
#
# Makes a refined point cloud, a report and, on request, meshes, textures and exports
# of the photos in a folder.
# reconstruct.sh --help explains it, docs/recipes.md tells more.
#
#   scripts/reconstruct.sh PHOTOS OUTPUT [options]
set -euo pipefail

folder=$(dirname "${BASH_SOURCE[0]}")/datasets
exec "$folder/run.sh" "$folder/reconstruct.py" "$@"
