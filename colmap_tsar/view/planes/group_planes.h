// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/plane_fit.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/scan_and_sort.h"

#include <cstdint>

namespace tsar {

// The largest distance from a plane at which a sample still lies on it, as a
// fraction of its depth.
struct PlaneTolerance {
  float relative = 1e-3f;
  // Lower bound, as a share of the relative depth of one pixel of disparity: it
  // equals the paper's 10^-3 at the paper's image size.
  float pixels = 0.3f;

  TSAR_HD float At(float depth, const DepthResolution& resolution) const {
    const float by_disparity = pixels * resolution.RelativeDepthError(depth);
    return by_disparity > relative ? by_disparity : relative;
  }
};

// The mean and covariance of the support of a plane in ray coordinates (x / z,
// y / z); outside of it the plane is extrapolated.
struct SupportArea {
  float mean_x = 0.f;
  float mean_y = 0.f;
  // The inverse of the covariance.
  float inverse_xx = 0.f;
  float inverse_xy = 0.f;
  float inverse_yy = 0.f;

  // The squared Mahalanobis distance of a ray from the mean of the support.
  TSAR_HD float SquaredDistance(const Vec3f& ray) const {
    const float x = ray.x - mean_x;
    const float y = ray.y - mean_y;
    return inverse_xx * x * x + 2.f * inverse_xy * x * y + inverse_yy * y * y;
  }
};

struct GroupPlaneOptions {
  PlaneTolerance tolerance;
  int num_hypotheses = 48;
  // The number of evenly spaced samples on which larger groups score their
  // hypotheses.
  int max_scored_samples = 2048;
  // Keys of the random numbers, together with the group's index.
  uint32_t image_id = 0;
  uint32_t iteration = 0;
  uint32_t seed = 0;
};

// The result of RANSAC for one group of pixels.
struct GroupPlane {
  Plane plane;            // Invalid where no three samples span one.
  int num_pixels = 0;     // Pixels of the group.
  int num_samples = 0;    // Pixels with a measured depth.
  int num_inliers = 0;    // Samples on the plane.
  int num_near = 0;       // Samples within three times the tolerance.
  SupportArea support;    // Support of the inliers.
  float min_depth = 0.f;  // Least depth of the samples.
  float max_depth = 0.f;
};

// The dominant plane of the samples of each group, by RANSAC and robust least
// squares of inverse depth on the inliers.
// samples: measurements on the raster of the groups, z = 0 where there is none.
Buffer<GroupPlane> FitGroupPlanes(const PixelGroups& groups,
                                  ImageView<const RayDepth> samples,
                                  const DepthResolution& resolution,
                                  const GroupPlaneOptions& options,
                                  Device& device);

}  // namespace tsar
