#!/usr/bin/env bash
# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
#
# Called by rattler-build, which sets PREFIX, PYTHON and what recipe.yaml says.
# The module by pip, so that Python knows the package; the program from the same
# build folder, where its library lies already.
set -euo pipefail

definitions=(TSAR_CUDA="$TSAR_CUDA")
if [[ $TSAR_CUDA == ON ]]; then
  definitions+=(CMAKE_CUDA_ARCHITECTURES=all-major)
fi
"$PYTHON" -m pip install --verbose --no-build-isolation --no-deps \
  --config-settings=build-dir=build-conda \
  "${definitions[@]/#/--config-settings=cmake.define.}" .
cmake --build build-conda --target colmap_tsar_program tsar_manual
cmake --install build-conda --component runtime --prefix "$PREFIX"
