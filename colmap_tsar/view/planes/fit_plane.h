// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/view/planes/world_plane.h"

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The observations that a plane is fitted to, in blocks for vector
// instructions.
class FitSamples {
 public:
  // Unused entries have weight 0.
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
  // The first point; zero without points.
  Eigen::Vector3d First() const;
  // The medians of the points' coordinates; zero without points.
  Eigen::Vector3d Middle() const;

 private:
  int size_ = 0;
  std::vector<Block> blocks_;
};

// Fits a plane to the depths: Gauss-Newton steps from the initial plane to the
// nearest minimum of the weighted sum of the Cauchy loss of the
// NormalizedResidual.
// loss_scale: the scale of that loss, in expected errors. Only the loss
// suppresses outliers, so the initial plane must be nearer to the wanted plane
// than to others. Returns the initial plane if the observations do not
// determine one.
WorldPlane FitPlane(const WorldPlane& initial,
                    const FitSamples& samples,
                    double loss_scale);

struct JointPlane {
  WorldPlane plane;
  const FitSamples* samples = nullptr;  // Not null; may be empty.
};

// Fits planes that share one rotation while each moves along its normal
// independently; otherwise like FitPlane. axis: a unit vector, the only axis of
// rotation if given. Rotations that the samples do not determine, such as about
// a line that holds all of them, stay 0. A plane without samples turns about
// its point nearest to the origin. Returns the rotation from the old normals to
// the new ones.
Eigen::Matrix3d FitTogether(const std::optional<Eigen::Vector3d>& axis,
                            double loss_scale,
                            std::vector<JointPlane>* planes);

}  // namespace tsar
