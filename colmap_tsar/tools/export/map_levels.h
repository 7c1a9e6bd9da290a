// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tsar {

// Maps as integer levels, for pictures: value = scale * level + offset.

struct Rgb16 {
  uint16_t r = 0;
  uint16_t g = 0;
  uint16_t b = 0;
};

constexpr int kMaxLevel = 65535;

// Levels of scale `step`. 0 stands for no depth, and for depths outside of the
// levels 1 to kMaxLevel after rounding, which are counted.
Image<uint16_t> DepthLevels(const Image<float>& depth,
                            double step,
                            int64_t* num_out_of_range);

// Levels of scale `step`, clamped to [1, kMaxLevel]. 0 stands for no depth.
Image<uint16_t> SigmaLevels(const Image<float>& sigma, double step);

constexpr double kNormalScale = 1.0 / 32767.0;
constexpr double kNormalOffset = -1.0;
Image<Rgb16> NormalLevels(const Image<Vec3f>& normal);

// The confidences of a confidence map's levels.
Image<float> ConfidencesOf(const Image<uint8_t>& levels);

// The smallest step of one significant digit at which this depth fits a level.
double StepFor(double depth);

// Statistics of the valid depths of a map; 0 if there are none.
struct DepthStatistics {
  int64_t num_depths = 0;
  float nearest = 0.f;
  float farthest = 0.f;
  float median = 0.f;
};

DepthStatistics MeasureDepth(const Image<float>& depth);

// The nearest and farthest depth of all maps, and the median of their medians.
DepthStatistics JoinStatistics(const std::vector<DepthStatistics>& maps);

// "17.3 % of the depths", for messages.
std::string ShareOfDepths(int64_t count, int64_t num_depths);

}  // namespace tsar
