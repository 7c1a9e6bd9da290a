// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/view/planes/depth_observation.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The observations that a plane is fitted to, side by side so that vector units
// work on several at once.
class FitSamples {
 public:
  // Unused ones weigh nothing.
  struct Block {
    static constexpr int kSize = 8;
    double x[kSize] = {};  // The points.
    double y[kSize] = {};
    double z[kSize] = {};
    double ray_x[kSize] = {};
    double ray_y[kSize] = {};
    double ray_z[kSize] = {};
    double min_slope[kSize] = {};  // The least value of RaySlope().
    double sigma[kSize] = {};
    double weight[kSize] = {};
  };

  void Add(const DepthObservation& observation);
  const std::vector<Block>& Blocks() const { return blocks_; }
  // The medians of the points' coordinates; zero without any.
  Eigen::Vector3d Middle() const;

 private:
  int size_ = 0;
  std::vector<Block> blocks_;
};

// The plane that fits the depths best, from the initial one on: a few steps of
// Gauss-Newton towards the least weighted sum of Cauchy's loss of the
// NormalizedResidual. loss_scale: where that turns from squares to logarithms,
// in expected errors. Observations off the plane are told by the loss alone, so
// the initial plane has to be nearer to the wanted plane than to others. The
// initial plane where the observations do not determine one.
WorldPlane FitPlane(const WorldPlane& initial,
                    const FitSamples& samples,
                    double loss_scale);

struct JointPlane {
  WorldPlane plane;
  const FitSamples* samples = nullptr;  // Not null; may be empty.
};

// Fits planes that turn together, by one rotation, while each moves along its
// normal by itself; otherwise like FitPlane. axis: where they may only turn
// about this one, a unit vector. They do not turn about what their samples
// leave open, such as a line on which all of these lie. One without samples
// turns about its point that is nearest to the origin. Returns the rotation
// from the old normals to the new ones.
Eigen::Matrix3d FitTogether(const std::optional<Eigen::Vector3d>& axis,
                            double loss_scale,
                            std::vector<JointPlane>* planes);

}  // namespace tsar
