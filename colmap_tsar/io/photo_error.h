// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"

#include <cstdint>
#include <string>

namespace tsar {

// OpenCV's limit; pixels are also indexed by an int.
inline constexpr int64_t kMaxNumPixels = int64_t{1} << 30;

// The errors of the files in this folder that decode photos. name: the file;
// what: the reason, such as "it breaks off".
//
// The error for a known format with incomplete content (kCorrupt).
Error DamagedPhoto(const std::string& name, const std::string& what);
// The error for a file that cannot be decoded (kCorrupt).
Error UnreadablePhoto(const std::string& name, const std::string& what);

// Throws kUnsupported for too many pixels. Must be called before memory is
// allocated for them.
void RequirePossibleSize(const std::string& name,
                         int64_t width,
                         int64_t height);

}  // namespace tsar
