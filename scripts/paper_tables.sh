#!/usr/bin/env bash
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
#
# Runs the ablation, the parameters and the scores of clouds of the TSAR-MVS paper
# on data that you have, and prints its tables with ours beside them.
# paper_tables.sh --help explains it, docs/datasets.md tells more.
#
#   scripts/paper_tables.sh --eth3d SCENES --output_path OUTPUT [options]
set -euo pipefail

folder=$(dirname "${BASH_SOURCE[0]}")/datasets
exec "$folder/run.sh" "$folder/paper_tables.py" "$@"
