// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/plane_measurement.h"

#include "colmap_tsar/scene/discovery/observation_table.h"

#include <cmath>
#include <cstddef>
#include <map>

namespace tsar {
namespace {

// A plane nearer to the camera than this, relative to its measured depths, is
// seen edge-on.
constexpr double kMinRelativeHeight = 1e-9;

// The scale of the loss is half of the tolerance, as in DiscoverPlanes.
constexpr MeasurePlaneOptions kLossOfViews = {2.0, 0.5};

// Moments of the Cauchy weights of normally distributed errors of variance 1.
struct LossMoments {
  double mean_weight = 1.0;
  // Variance of an estimate from n observations, times n: above 1, the value of
  // least squares.
  double variance = 1.0;
};

LossMoments MomentsOf(double loss_scale) {
  LossMoments moments;
  const double a = loss_scale * loss_scale;
  if (loss_scale > 20.0) {
    return moments;
  }
  // The mean of 1 / (a + r^2); its derivative with respect to a gives the mean
  // of the square.
  const double mean = std::sqrt(M_PI / (2.0 * a)) * std::exp(0.5 * a) *
                      std::erfc(std::sqrt(0.5 * a));
  const double weight = a * mean;
  const double square = 0.5 * a * (1.0 + mean * (1.0 - a));
  moments.mean_weight = weight;
  moments.variance = a * (weight - square) / std::pow(2.0 * square - weight, 2);
  return moments;
}

}  // namespace

PlaneMeasurement MeasurePlane(int index,
                              const WorldPlane& plane,
                              const std::vector<DepthObservation>& observations,
                              const MeasurePlaneOptions& options) {
  PlaneMeasurement measurement;
  measurement.plane = index;
  if (observations.empty()) {
    return measurement;
  }
  measurement.center = observations.front().center;
  const double height = plane.Height(measurement.center);
  double weights = 0.0;
  Eigen::Vector3d feet = Eigen::Vector3d::Zero();
  for (const DepthObservation& observation : observations) {
    if (std::abs(height) <= kMinRelativeHeight * observation.depth) {
      return PlaneMeasurement{index, measurement.center};
    }
    // Along grazing rays a small error of depth is a tiny error of height; the
    // image is less precise than that.
    const double slope = RaySlope(plane, observation);
    const double grazing = std::abs(plane.normal.dot(observation.ray)) / slope;
    const double inverse_depth = 1.0 / observation.depth;
    const double scale =
        grazing / (observation.sigma * inverse_depth * inverse_depth);
    Eigen::Vector4d row;
    row << observation.ray, inverse_depth;
    row *= scale;
    const double residual = row.head<3>().dot(plane.normal) / height + row[3];
    const double loss_weight =
        1.0 / (1.0 + std::pow(residual / options.loss_scale, 2));
    const double weight = observation.weight * loss_weight;
    measurement.form += weight * row * row.transpose();
    const double sigma = observation.sigma * slope;
    const double information = weight / (sigma * sigma);
    measurement.information += information;
    feet += information * (FootPoint(plane, observation) - measurement.center);
    weights += observation.weight;
  }
  if (!(measurement.information > 0.0)) {
    return PlaneMeasurement{index, measurement.center};
  }
  measurement.foot = measurement.center + feet / measurement.information;
  // The sum is over the weights before the loss: otherwise a view that
  // contradicts others would keep its influence.
  const LossMoments moments = MomentsOf(options.loss_scale);
  const double share =
      1.0 /
      (moments.mean_weight *
       (moments.variance + weights * std::pow(options.common_deviation, 2)));
  measurement.form *= share;
  measurement.information *= share;
  return measurement;
}

std::vector<PlaneMeasurement> MeasureView(const ObservedView& view,
                                          const std::vector<int>& assignment,
                                          const std::vector<ModelPlane>& planes,
                                          double tolerance) {
  const ObservationTable observations({view});
  std::map<int, std::vector<int>> superpixels;  // Indexed by plane.
  for (size_t k = 0; k < assignment.size(); ++k) {
    if (assignment[k] >= 0) {
      superpixels[assignment[k]].push_back(static_cast<int>(k));
    }
  }
  const Eigen::Matrix3d to_world = view.camera.rotation.transpose();
  const Eigen::Vector3d center = view.camera.Center();
  std::vector<PlaneMeasurement> measurements;
  for (const auto& [plane, members] : superpixels) {
    std::vector<DepthObservation> of_plane;
    for (const int k : members) {
      for (int i = 0; i < observations.NumObservations(k); ++i) {
        DepthObservation& observation =
            of_plane.emplace_back(observations.At(k, i));
        observation.center = center;
        observation.ray = to_world * observation.ray;
        observation.sigma *= tolerance * kErrorShare;
        observation.weight /= kMaxSuperpixelWeight;
      }
    }
    const PlaneMeasurement measurement =
        MeasurePlane(plane, planes[plane].plane, of_plane, kLossOfViews);
    if (measurement.information > 0.0) {
      measurements.push_back(measurement);
    }
  }
  return measurements;
}

}  // namespace tsar
