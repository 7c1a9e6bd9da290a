// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/depth_interval.h"

#include <algorithm>
#include <vector>

namespace tsar {

std::optional<DepthInterval> SparseDepthInterval(const SparseModel& model,
                                                 int image) {
  constexpr double kPercentile = 0.01;
  constexpr double kStretch = 0.25;
  const SparseModel::ModelImage& view = model.images[image];
  std::vector<double> depths;
  for (const int point : view.point_indices) {
    const double depth =
        (view.camera.rotation * model.points[point] + view.camera.translation)
            .z();
    if (depth > 0.0) {
      depths.push_back(depth);
    }
  }
  if (depths.empty()) {
    return std::nullopt;
  }
  std::sort(depths.begin(), depths.end());
  const double last = static_cast<double>(depths.size() - 1);
  return DepthInterval{depths[kPercentile * last] * (1.0 - kStretch),
                       depths[(1.0 - kPercentile) * last] * (1.0 + kStretch)};
}

}  // namespace tsar
