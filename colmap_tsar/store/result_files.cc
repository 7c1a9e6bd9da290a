// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/store/result_files.h"

#include "colmap_tsar/base/atomic_file.h"

namespace tsar {

void RemoveResults(const MapPaths& paths) {
  for (const ContainedPath* path : {&paths.confidence,
                                    &paths.former_confidence,
                                    &paths.sigma,
                                    &paths.provenance,
                                    &paths.planes}) {
    RemoveFile(*path);
  }
}

}  // namespace tsar
