// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/vector.h"

#include <Eigen/Core>

namespace tsar {

// The vector rounded to floats.
inline Vec3f ToVec3f(const Eigen::Vector3d& vector) {
  return {static_cast<float>(vector.x()),
          static_cast<float>(vector.y()),
          static_cast<float>(vector.z())};
}

}  // namespace tsar
