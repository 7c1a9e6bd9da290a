// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/base/image.h"

namespace tsar {

// Replaces the file in one step; the name should end in ".png". Throws Error
// kIo.
void WritePng(const ContainedPath& path, const Image<Rgb>& image);

}  // namespace tsar
