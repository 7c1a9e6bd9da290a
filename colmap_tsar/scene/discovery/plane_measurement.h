// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/discovery/discover_planes.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <vector>

#include <Eigen/Core>

namespace tsar {

// The measurements of one plane in one view, condensed for its adjustment. With
// q = normal / Height(center), the plane's inverse depth along a ray r is -q .
// r, so that the weighted squares of the errors of any number of inverse depths
// are one quadratic form of (q, 1).
struct PlaneMeasurement {
  int plane = -1;  // Its index among the planes that are adjusted.
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // Camera center.
  // The quadratic form of (q, 1), in units of expected errors; zero where
  // nothing was measured.
  Eigen::Matrix4d form = Eigen::Matrix4d::Zero();
  // The inverse variance of the plane's height at the foot.
  double information = 0.0;
  // The mean of the measured points on the plane, weighted by information.
  Eigen::Vector3d foot = Eigen::Vector3d::Zero();
};

struct MeasurePlaneOptions {
  // Scale of the Cauchy loss, in expected errors.
  double loss_scale = 1.0;
  // The standard deviation of the error that all observations of one view at
  // one plane share, in expected errors of a single one. The variance of the
  // mean of n of them is thus 1 / n, as weighted by the loss, plus its square.
  double common_deviation = 0.5;
};

// Condenses the observations of one view, with the weights of Cauchy's loss at
// this plane. Nothing is measured where there are no observations of a weight
// above 0, and where the plane passes through the camera. Observations must be
// finite, with a positive depth and sigma.
PlaneMeasurement MeasurePlane(int index,
                              const WorldPlane& plane,
                              const std::vector<DepthObservation>& observations,
                              const MeasurePlaneOptions& options = {});

// The measurement of each plane to which a superpixel of the view is assigned,
// in the order of planes. assignment: per superpixel the index of its plane, or
// -1; tolerance: of residuals, in relative depths of one pixel of disparity.
std::vector<PlaneMeasurement> MeasureView(const ObservedView& view,
                                          const std::vector<int>& assignment,
                                          const std::vector<ModelPlane>& planes,
                                          double tolerance);

}  // namespace tsar
