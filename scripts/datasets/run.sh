#!/usr/bin/env bash
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
#
# Starts a Python script by a Python that has numpy: what the scripts of the data
# sets and their tests have in common.
#
#   scripts/datasets/run.sh SCRIPT.py [ARGUMENT...]
set -euo pipefail

# The python3 of the packages has numpy; another that comes first may not.
python=python3
if ! "$python" -c "import numpy" 2>/dev/null; then
  python=/usr/bin/python3
  if ! "$python" -c "import numpy" 2>/dev/null; then
    echo "ERROR: no python3 with numpy; scripts/install_dependencies.sh" \
      "installs it" >&2
    exit 1
  fi
fi
export PYTHONDONTWRITEBYTECODE=1
exec "$python" "$@"
