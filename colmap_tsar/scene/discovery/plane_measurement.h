// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/discovery/discover_planes.h"
#include "colmap_tsar/view/planes/depth_observation.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <vector>

#include <Eigen/Core>

namespace tsar {

// All that one view measured of one plane, condensed to what an adjustment of
// the plane needs. With q = normal / Height(center), the plane's inverse depth
// along a ray r is -q . r, so that the weighted squares of the errors of any
// number of inverse depths are one quadratic form of (q, 1).
struct PlaneMeasurement {
  int plane = -1;  // Its index among the planes that are adjusted.
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // Of the camera.
  // Of (q, 1), in units of expected errors; zero where nothing was measured.
  Eigen::Matrix4d form = Eigen::Matrix4d::Zero();
  // Of the plane's height at the foot: one over its variance.
  double information = 0.0;
  // The mean of the points on the plane that were measured, by information.
  Eigen::Vector3d foot = Eigen::Vector3d::Zero();
};

struct MeasurePlaneOptions {
  // Where Cauchy's loss turns from squares to logarithms, in expected errors.
  double loss_scale = 1.0;
  // Errors of one view about one plane go together: they have a part in common,
  // of this standard deviation in expected errors of a single observation. So
  // the variance of what n of them tell is 1 / n, or what the loss makes of
  // that, and the square of this. 0: they are independent.
  double common_deviation = 0.5;
};

// Condenses the observations of one view, with the weights of Cauchy's loss at
// this plane. Nothing is measured where there are no observations of a weight
// above 0, and where the plane passes through the camera. Throws
// std::invalid_argument where an observation is not finite, has no positive
// depth and sigma, has a negative weight, or belongs to another view than the
// first, and where an option is out of range.
PlaneMeasurement MeasurePlane(int index,
                              const WorldPlane& plane,
                              const std::vector<DepthObservation>& observations,
                              const MeasurePlaneOptions& options = {});

struct MeasureViewOptions {
  // How far a depth may be off a plane, in relative depths of one pixel of
  // disparity, and the expected error of one observation as a share of that.
  double tolerance = 1.0;
  double error_share = 0.25;
  // Pixels of full confidence that count as one measurement: neighbouring ones
  // err together.
  double full_weight = 40.0;
  // A superpixel counts for so many of them at most.
  double max_weight = 40.0;
  // The loss turns into a logarithm where that of the fits in DiscoverPlanes
  // does, at half of the tolerance.
  MeasurePlaneOptions planes = {2.0, 0.5};
};

// What a view measured of each plane that any of its superpixels is assigned
// to, in the order of the planes' numbers. assignment: per superpixel the
// number of its plane, or -1.
std::vector<PlaneMeasurement> MeasureView(const ObservedView& view,
                                          const std::vector<int>& assignment,
                                          const std::vector<WorldPlane>& planes,
                                          const MeasureViewOptions& options);

}  // namespace tsar
