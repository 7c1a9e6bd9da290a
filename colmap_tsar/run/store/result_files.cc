// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/result_files.h"

#include "colmap_tsar/base/remove_files.h"

namespace tsar {

std::array<ResultFile, 4> ResultFiles(const MapPaths& paths) {
  return {{{"confidence", &paths.confidence},
           {"provenance", &paths.provenance},
           {"planes", &paths.planes},
           {"sigma", &paths.sigma}}};
}

void RemoveResults(const MapPaths& paths) {
  for (const ResultFile& file : ResultFiles(paths)) {
    RemoveFile(*file.path);
  }
}

}  // namespace tsar
