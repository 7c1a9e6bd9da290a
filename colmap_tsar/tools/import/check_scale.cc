// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/check_scale.h"

#include <algorithm>
#include <cmath>

namespace tsar {
namespace {

// The quantile of the values at a share; reorders them.
template <typename T>
T Quantile(double share, std::vector<T>* values) {
  const size_t index = std::min(
      values->size() - 1,
      static_cast<size_t>(share * static_cast<double>(values->size())));
  std::ranges::nth_element(*values, values->begin() + index);
  return (*values)[index];
}

template <typename T>
void SetRange(std::vector<T>* values, float* near, float* far) {
  if (!values->empty()) {
    *near = static_cast<float>(Quantile(0.05, values));
    *far = static_cast<float>(Quantile(0.95, values));
  }
}

}  // namespace

SparseComparison CompareWithSparse(const SparseModel& model,
                                   int image,
                                   const Image<float>& depth) {
  const SparseModel::ModelImage& view = model.images[image];
  const Camera camera = view.camera.Resized(depth.Width(), depth.Height());
  std::vector<double> ratios;
  std::vector<double> sparse_depths;
  for (const int index : view.point_indices) {
    const Eigen::Vector3d point =
        camera.rotation * model.points[index] + camera.translation;
    if (!(point.z() > 0.0)) {
      continue;
    }
    sparse_depths.push_back(point.z());
    const double x = camera.fx * point.x() / point.z() + camera.cx;
    const double y = camera.fy * point.y() / point.z() + camera.cy;
    if (!(x > -0.5 && y > -0.5 && x < depth.Width() - 0.5 &&
          y < depth.Height() - 0.5)) {
      continue;
    }
    const float here = depth(static_cast<int>(std::lround(x)),
                             static_cast<int>(std::lround(y)));
    if (here > 0.f) {
      ratios.push_back(here / point.z());
    }
  }
  std::vector<float> depths;
  std::ranges::copy_if(depth, std::back_inserter(depths), [](float value) {
    return value > 0.f;
  });
  SparseComparison comparison;
  comparison.num_points = static_cast<int>(ratios.size());
  if (!ratios.empty()) {
    comparison.ratio = Quantile(0.5, &ratios);
  }
  SetRange(&depths, &comparison.near, &comparison.far);
  SetRange(&sparse_depths, &comparison.sparse_near, &comparison.sparse_far);
  return comparison;
}

ScaleVerdict JudgeScale(const std::vector<SparseComparison>& comparisons) {
  constexpr double kMaxDeviation = 0.1;
  constexpr double kMinShare = 0.8;
  std::vector<double> ratios;
  for (const SparseComparison& comparison : comparisons) {
    if (comparison.num_points >= kMinSparsePoints) {
      ratios.push_back(comparison.ratio);
    }
  }
  ScaleVerdict verdict;
  if (ratios.empty()) {
    return verdict;
  }
  verdict.num_images = static_cast<int>(ratios.size());
  verdict.median = Quantile(0.5, &ratios);
  verdict.smallest = *std::ranges::min_element(ratios);
  verdict.largest = *std::ranges::max_element(ratios);
  const auto num_near = std::ranges::count_if(ratios, [&](double ratio) {
    return std::abs(ratio - verdict.median) <= kMaxDeviation * verdict.median;
  });
  verdict.is_consistent = static_cast<double>(num_near) >=
                          kMinShare * static_cast<double>(ratios.size());
  return verdict;
}

bool IsOffScale(double ratio) {
  constexpr double kMax = 1.2;
  return ratio > kMax || ratio < 1.0 / kMax;
}

}  // namespace tsar
