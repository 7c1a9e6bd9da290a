// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"

namespace tsar {

// The luminance of a color, 0 to 255, with the weights of Rec. 601.
TSAR_HD inline float GrayLevel(const Rgb& color) {
  return 0.299f * color.r + 0.587f * color.g + 0.114f * color.b;
}

}  // namespace tsar
