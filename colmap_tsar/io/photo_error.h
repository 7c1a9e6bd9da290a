// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"

#include <cstdint>
#include <string>

namespace tsar {

// More OpenCV does not decode; and pixels are numbered by an int.
inline constexpr int64_t kMaxNumPixels = int64_t{1} << 30;

// The errors of the files in this folder that decode photos. name: the file;
// what: the reason, such as "it breaks off".
//
// Error for a known format whose content is not all there (kCorrupt).
Error DamagedPhoto(const std::string& name, const std::string& what);
// Error for a file that cannot be decoded, whatever it is (kCorrupt).
Error UnreadablePhoto(const std::string& name, const std::string& what);

// Throws kUnsupported. To be called before memory is taken for the pixels.
void RequirePossibleSize(const std::string& name,
                         int64_t width,
                         int64_t height);

}  // namespace tsar
