// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/store/result_files.h"

#include "colmap_tsar/base/atomic_file.h"

namespace tsar {

std::array<const ContainedPath*, 5> ResultFiles(const MapPaths& paths) {
  return {&paths.confidence,
          &paths.former_confidence,
          &paths.sigma,
          &paths.provenance,
          &paths.planes};
}

void RemoveResults(const MapPaths& paths) {
  for (const ContainedPath* path : ResultFiles(paths)) {
    RemoveFile(*path);
  }
}

}  // namespace tsar
