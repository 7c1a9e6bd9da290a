// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tsar {

// The values of confidence maps: a confidence in [0, 1] in 255 steps. 0 is
// reserved for no depth; positive values below one step become 1.
inline uint8_t ToConfidenceLevel(float confidence) {
  return confidence > 0.f
             ? static_cast<uint8_t>(std::lround(
                   255.f * std::clamp(confidence, 1.f / 255.f, 1.f)))
             : uint8_t{0};
}

TSAR_HD inline float ConfidenceOfLevel(uint8_t level) {
  return static_cast<float>(level) / 255.f;
}

}  // namespace tsar
