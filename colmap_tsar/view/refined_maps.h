// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/vector.h"

#include <array>
#include <cmath>
#include <cstdint>

namespace tsar {

// The provenance of a pixel's depth; the values of provenance maps.
enum class Provenance : uint8_t {
  kNone = 0,
  kMeasured = 1,
  kSuperpixelPlane = 2,
  kInterpolated = 3,
  kRegionPlane = 4,
  kOtherViews = 5,  // Planes that other views measured there.
  kGuessed = 6,     // Scene planes that no view measured there.
  kPrior = 7,       // An external depth prior.
};

// The names of these values for users, in their order.
constexpr std::array<const char*, 8> kProvenanceNames = {"none",
                                                         "measured",
                                                         "superpixel plane",
                                                         "interpolated",
                                                         "region plane",
                                                         "other views",
                                                         "guessed",
                                                         "prior"};

// The result for one image; all have the size of the original maps.
struct RefinedMaps {
  Image<float> depth;         // See map_io.h.
  Image<Vec3f> normal;        // See map_io.h.
  Image<uint8_t> confidence;  // See ToConfidenceLevel().
  Image<uint8_t> provenance;  // Values of Provenance; 0 = no depth.
  // 1 + the index of the pixel's scene plane (scene_model.h), 0 = none; empty
  // without a model of the scene.
  Image<uint16_t> planes{};
  // The standard deviation of each depth in the units of the map, provided that
  // its surface is the right one, as a half (arithmetic.h); 0 = no depth. Empty
  // if not requested.
  Image<uint16_t> sigma{};
};

// The values of confidence maps: a confidence in [0, 1] in 255 steps. 0 is
// reserved for no depth; positive values below one step become 1.
TSAR_HD inline uint8_t ToConfidenceLevel(float confidence) {
  if (!(confidence > 0.f)) {
    return 0;
  }
  const float level = 255.f * (confidence < 1.f ? confidence : 1.f);
  return static_cast<uint8_t>(level < 1.f ? 1.f : level + 0.5f);
}

TSAR_HD inline float ConfidenceOfLevel(uint8_t level) {
  return static_cast<float>(level) / 255.f;
}

}  // namespace tsar
