// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/io/dense_maps.h"
#include "colmap_tsar/io/sparse_model.h"

#include <vector>

namespace tsar {

// A camera stored by another program, and the image to which it was assigned.
struct AssignedCamera {
  int image = -1;  // Index into SparseModel::images.
  StoredCamera camera;
};

// Checks that the cameras of another program match the images to which its maps
// were assigned: the most likely mistake is another order of the images. A
// camera matches if its rotation is within 1 degree, its center times `scale`
// within 1 % of the extent of all camera centers, and its ratios of principal
// point and focal lengths, which do not depend on the image's size, within 2 %.
// Of closer images, no other may match ten times as well as the assigned one.
//
// Throws Error kMismatch with a camera's file, the image and the cause: the
// camera of another image, or of none.
void CheckCameras(const std::vector<AssignedCamera>& cameras,
                  const SparseModel& model,
                  double scale);

// Comparison of a depth map with the sparse points that its image sees.
struct SparseComparison {
  // Points with a depth in their pixel.
  int num_points = 0;
  // The median ratio of map depth to point depth; 0 without such points.
  double ratio = 0.0;
};

// depth: any size and unit; 0 = none.
SparseComparison CompareWithSparse(const SparseModel& model,
                                   int image,
                                   const Image<float>& depth);

// The least number of points of a meaningful ratio.
constexpr int kMinSparsePoints = 5;

// The joint result of the ratios of all images.
struct ScaleVerdict {
  int num_images = 0;  // Those with enough points; the others do not count.
  double median = 1.0;
  double smallest = 1.0;
  double largest = 1.0;
  // Whether at least 80 % of the images are within 10 % of the median.
  bool is_consistent = false;
};
ScaleVerdict JudgeScale(const std::vector<SparseComparison>& comparisons);

// Whether a ratio differs so much from 1 that the depth is in another unit.
bool IsOffScale(double ratio);

}  // namespace tsar
