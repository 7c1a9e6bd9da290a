// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/version.h"

namespace tsar {

std::string VersionText() {
  return std::string("colmap_tsar " TSAR_VERSION) +
         (TSAR_CUDA_ENABLED ? " (with CUDA)" : " (without CUDA)");
}

}  // namespace tsar
