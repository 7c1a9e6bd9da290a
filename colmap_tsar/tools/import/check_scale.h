// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/io/sparse_model.h"

#include <optional>
#include <vector>

namespace tsar {

// A depth map against the sparse points that its image sees.
struct SparseComparison {
  // Points with a depth in their pixel.
  int num_points = 0;
  // The median of map's depth over point's depth; 0 without such points.
  double ratio = 0.0;
  // The 5th and the 95th of a hundred depths of the map; 0 for an empty map.
  float near = 0.f;
  float far = 0.f;
  // The same of the depths of all sparse points in the image.
  float sparse_near = 0.f;
  float sparse_far = 0.f;
};

// depth: of any size, in any unit; 0 = none.
SparseComparison CompareWithSparse(const SparseModel& model,
                                   int image,
                                   const Image<float>& depth);

// As many points as a ratio needs to say something.
constexpr int kMinSparsePoints = 5;

// What the ratios of all images say together.
struct ScaleVerdict {
  int num_images = 0;  // Those with enough points; the others do not count.
  double median = 1.0;
  double smallest = 1.0;
  double largest = 1.0;
  // Whether four of five images are within 10 % of the median.
  bool is_consistent = false;
};
ScaleVerdict JudgeScale(const std::vector<SparseComparison>& comparisons);

// Whether a ratio is so far from 1 that the depth is in another unit.
bool IsOffScale(double ratio);

}  // namespace tsar
