// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"

#include <filesystem>
#include <vector>

namespace tsar {

// For each of Problems(), whether a file of image names lists its reference,
// see ReadImageList; the file may list an image several times. All are listed
// where the path is empty. Throws Error: what ReadImageList throws, and
// kMismatch where an image has no sources in patch-match.cfg.
std::vector<bool> FindListedImages(const Workspace& workspace,
                                   const std::filesystem::path& list);

}  // namespace tsar
