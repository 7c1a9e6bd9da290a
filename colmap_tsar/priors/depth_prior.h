// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"

#include <cstdint>
#include <string>

namespace tsar {

// The meaning of a depth prior's values, up to unknown factors per image.
enum class PriorType : uint8_t {
  kAuto = 0,      // Whichever of the others fits measured depths best.
  kMetric = 1,    // Depth times one factor.
  kRelative = 2,  // Depth times one factor, plus a constant.
  kInverse = 3,   // Inverse depth times one factor, plus a constant.
};

// External depth and normals of one image, from a network or a sensor. Its
// raster covers the whole photo and may have any size.
struct DepthPrior {
  PriorType type = PriorType::kAuto;
  // The values of the file; 0, negative or not finite: none. May be empty.
  Image<float> values;
  // The number that stood for "none", by FindNoDepth() of the values; 0: none.
  float no_depth = 0.f;
  // Unit vectors in the camera's frame, towards the camera; (0, 0, 0): none.
  // May be empty, or of another size than `values`.
  Image<Vec3f> normals;
};

// "auto", "metric", "relative" or "inverse".
std::string ToString(PriorType type);

}  // namespace tsar
