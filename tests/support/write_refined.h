// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/write_back.h"

#include <utility>

namespace tsar {

// Puts refined maps in the place of an image's originals, all steps at once.
inline void WriteRefined(const Workspace& workspace,
                         int image,
                         const RefinedMaps& maps,
                         ImageRecord record) {
  WriteBack write_back(workspace, image, std::move(record));
  write_back.PrepareFiles(maps);
  write_back.Commit();
}

}  // namespace tsar
