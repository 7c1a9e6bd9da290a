// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/plane_support.h"

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/median.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <algorithm>
#include <cstddef>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace tsar {
namespace {

// Stands for an unknown variance: its square root is far beyond every depth,
// and its products with lengths stay finite.
constexpr double kUnknownVariance = 1e30;
// Observations of less confidence affect only the extent, not the variances.
constexpr float kMinMeasuredConfidence = 0.5f;
// Cells with this many times fewer observations than the median one hold noise.
constexpr int kMinCellShare = 20;
constexpr int kMinCellCount = 2;

// The observations of one plane in all views.
struct PlaneObservations {
  std::vector<DepthObservation> superpixels;  // One each, measured.
  std::vector<Eigen::Vector3d> points;        // All.
};

// Adds the observations of one superpixel to the plane that it is assigned to.
void AddSuperpixel(const ObservedView& view,
                   size_t superpixel,
                   const WorldPlane& plane,
                   double tolerance,
                   PlaneObservations* result) {
  const ViewEvidence& evidence = *view.evidence;
  const DepthResolution& resolution = evidence.resolution;
  const Eigen::Vector3d center = view.camera.Center();
  const Eigen::Matrix3d to_world = view.camera.rotation.transpose();
  const int begin = evidence.first_observation[superpixel];
  const int end = evidence.first_observation[superpixel + 1];
  DepthObservation mean;
  mean.center = center;
  mean.ray.setZero();
  mean.depth = 0.0;
  double confidence = 0.0;
  int num_measured = 0;
  for (int i = begin; i < end; ++i) {
    const Observation& observation = evidence.observations[i];
    const RayDepth& sample = observation.sample;
    DepthObservation depth;
    depth.center = center;
    depth.ray = to_world * Eigen::Vector3d(sample.x, sample.y, 1.0);
    depth.depth = sample.z;
    depth.sigma = sample.z * resolution.RelativeDepthError(sample.z) *
                  evidence.ErrorOf(i);
    if (!(std::abs(NormalizedResidual(plane, depth)) < tolerance)) {
      continue;
    }
    result->points.push_back(FootPoint(plane, depth));
    if (observation.confidence >= kMinMeasuredConfidence &&
        !evidence.IsOfPrior(i)) {
      ++num_measured;
      confidence += observation.confidence;
      mean.ray += depth.ray;
      mean.depth += depth.depth;
    }
  }
  if (num_measured == 0) {
    return;
  }
  mean.ray /= num_measured;
  mean.depth /= num_measured;
  mean.sigma = kErrorShare * tolerance * mean.depth *
               resolution.RelativeDepthError(static_cast<float>(mean.depth));
  double total = 0.0;
  for (int i = begin; i < end; ++i) {
    total += evidence.observations[i].confidence;
  }
  mean.weight = std::min(
      1.0,
      evidence.weights[superpixel] * confidence / total / kMaxSuperpixelWeight);
  result->superpixels.push_back(mean);
}

// The frame of a plane, in the reference camera's frame.
PlaneFrame MakeFrame(const WorldPlane& plane,
                     const PlaneObservations& observations,
                     const Camera& reference) {
  const PlaneUncertainty uncertainty =
      ComputeUncertainty(plane, observations.superpixels);
  Eigen::Vector3d center = uncertainty.center;
  Eigen::Vector3d axis_s = uncertainty.axes.col(0);
  Eigen::Vector3d axis_t = uncertainty.axes.col(1);
  if (observations.superpixels.empty()) {
    center.setZero();
    for (const Eigen::Vector3d& point : observations.points) {
      center += point / observations.points.size();
    }
  }
  if (!(axis_s.norm() > 0.5 && axis_t.norm() > 0.5)) {
    axis_s = plane.normal.unitOrthogonal();
    axis_t = plane.normal.cross(axis_s);
  }
  const auto bounded = [](double variance) {
    return static_cast<float>(std::min(variance, kUnknownVariance));
  };
  PlaneFrame frame;
  frame.center = ToVec3f(reference.rotation * center + reference.translation);
  frame.axis_s = ToVec3f(reference.rotation * axis_s);
  frame.axis_t = ToVec3f(reference.rotation * axis_t);
  frame.height_variance = bounded(uncertainty.height_variance);
  frame.slope_variance_s = bounded(uncertainty.slope_variance(0));
  frame.slope_variance_t = bounded(uncertainty.slope_variance(1));
  return frame;
}

// Adds the cells in which the plane was observed, and the cell size.
void AddCells(const PlaneFrame& frame,
              const PlaneObservations& observations,
              const Camera& reference,
              int num_cells,
              PlaneSupport* support) {
  std::vector<PlanePoint> points;
  PlanePoint low{INFINITY, INFINITY};
  PlanePoint high{-INFINITY, -INFINITY};
  for (const Eigen::Vector3d& point : observations.points) {
    points.push_back(frame.Coordinates(
        ToVec3f(reference.rotation * point + reference.translation)));
    low = {std::min(low.s, points.back().s), std::min(low.t, points.back().t)};
    high = {std::max(high.s, points.back().s),
            std::max(high.t, points.back().t)};
  }
  const float cell = std::max(high.s - low.s, high.t - low.t) / num_cells;
  support->cell_sizes.push_back(points.empty() ? 0.f : cell);
  if (points.empty() || !(cell > 0.f)) {
    return;
  }
  // The farthest point lies on the outer border of the last cell.
  const auto index = [&](float distance) {
    return std::min(static_cast<int>(distance / cell), num_cells - 1);
  };
  std::vector<int> counts(num_cells * num_cells, 0);
  for (const PlanePoint& point : points) {
    ++counts[index(point.s - low.s) * num_cells + index(point.t - low.t)];
  }
  std::vector<int> observed = counts;
  std::erase(observed, 0);
  const int median = UpperMedian(&observed);
  for (int i = 0; i < num_cells * num_cells; ++i) {
    if (counts[i] >= kMinCellCount && counts[i] * kMinCellShare >= median) {
      support->cells.push_back({low.s + (i / num_cells + 0.5f) * cell,
                                low.t + (i % num_cells + 0.5f) * cell});
    }
  }
}

}  // namespace

PlaneSupport FindPlaneSupport(const std::vector<ObservedView>& views,
                              const DiscoveredPlanes& discovered,
                              double tolerance,
                              int num_cells) {
  std::vector<PlaneObservations> observations(discovered.planes.size());
  for (size_t i = 0; i < views.size(); ++i) {
    for (size_t s = 0; s < discovered.assignment[i].size(); ++s) {
      const int plane = discovered.assignment[i][s];
      if (plane >= 0) {
        AddSuperpixel(views[i],
                      s,
                      discovered.planes[plane].plane,
                      tolerance,
                      &observations[plane]);
      }
    }
  }
  PlaneSupport support;
  support.first_cell.push_back(0);
  for (size_t k = 0; k < observations.size(); ++k) {
    const Camera& reference = views[0].camera;
    support.frames.push_back(
        MakeFrame(discovered.planes[k].plane, observations[k], reference));
    AddCells(
        support.frames.back(), observations[k], reference, num_cells, &support);
    support.first_cell.push_back(static_cast<int>(support.cells.size()));
  }
  return support;
}

}  // namespace tsar
