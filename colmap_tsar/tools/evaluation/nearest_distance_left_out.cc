// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// This file replaces nearest_distance.cc with TSAR_CLOUD_EVALUATION=OFF.

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/tools/evaluation/nearest_distance.h"

namespace tsar {

void RequireNearestDistances() {
  throw Error(ErrorCode::kUnsupported,
              "this build cannot score point clouds, as it was built without "
              "FLANN; build it with -DTSAR_CLOUD_EVALUATION=ON");
}

std::vector<double> NearestDistances(const std::vector<Eigen::Vector3d>&,
                                     const std::vector<Eigen::Vector3d>&,
                                     double) {
  RequireNearestDistances();
  return {};
}

}  // namespace tsar
