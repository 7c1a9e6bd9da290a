// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/export/picture_file.h"

#include <cstdint>

namespace tsar {

// Maps in whole numbers, for pictures. A value is scale times its level, plus
// offset.

constexpr int kMaxLevel = 65535;

// Scale: step. 0 stands for no depth, and for depths that no level from 1 to
// kMaxLevel is the nearest of, which are counted.
Image<uint16_t> DepthLevels(const Image<float>& depth,
                            double step,
                            int64_t* num_out_of_range);

// Scale: step. 0 stands for no depth alone; what no level is the nearest of
// becomes 1 or kMaxLevel.
Image<uint16_t> SigmaLevels(const Image<float>& sigma, double step);

constexpr double kNormalScale = 1.0 / 32767.0;
constexpr double kNormalOffset = -1.0;
Image<Rgb16> NormalLevels(const Image<Vec3f>& normal);

// Those of a confidence map.
Image<float> ConfidencesOf(const Image<uint8_t>& levels);

// The smallest step of one digit at which a level holds this depth.
double StepFor(double depth);

}  // namespace tsar
