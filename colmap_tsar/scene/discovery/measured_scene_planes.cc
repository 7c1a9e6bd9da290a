// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/measured_scene_planes.h"

#include "colmap_tsar/scene/discovery/superpixel_observations.h"
#include "colmap_tsar/view/planes/plane_uncertainty.h"

#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace tsar {
namespace {

// The superpixels that are assigned to each plane, indexed across all views.
std::vector<std::vector<int>> MembersOf(const DiscoveredPlanes& discovered) {
  std::vector<std::vector<int>> members(discovered.planes.size());
  int superpixel = 0;
  for (const std::vector<int>& of_view : discovered.assignment) {
    for (const int plane : of_view) {
      if (plane >= 0) {
        members[plane].push_back(superpixel);
      }
      ++superpixel;
    }
  }
  return members;
}

}  // namespace

void ThinOut(std::vector<DepthObservation>* samples) {
  const size_t count = samples->size();
  if (count <= kMaxPlaneSamples) {
    return;
  }
  const double scale = static_cast<double>(count) / kMaxPlaneSamples;
  for (size_t i = 0; i < kMaxPlaneSamples; ++i) {
    (*samples)[i] = (*samples)[i * count / kMaxPlaneSamples];
    (*samples)[i].weight *= scale;
  }
  samples->resize(kMaxPlaneSamples);
}

std::vector<MeasuredScenePlane> MeasureScenePlanes(
    const std::vector<ObservedView>& views,
    const DiscoveredPlanes& discovered,
    const DiscoverPlanesOptions& discovery,
    const PlaneSupportOptions& support) {
  if (discovered.planes.empty()) {
    return {};
  }
  std::vector<std::vector<DepthObservation>> superpixels =
      MeasuredSuperpixels(views, discovered, support);
  const SuperpixelObservations observations(views, discovery.max_weight);
  const SuperpixelObservations of_priors(
      views, discovery.max_weight, ObservationsOf::kPriors);
  const std::vector<std::vector<int>> members = MembersOf(discovered);
  const Eigen::Matrix3d to_world = views[0].camera.rotation.transpose();
  const Eigen::Vector3d origin = views[0].camera.Center();
  std::vector<MeasuredScenePlane> result;
  for (size_t p = 0; p < members.size(); ++p) {
    MeasuredScenePlane plane;
    plane.found = discovered.planes[p];
    const auto count_of = [&](const SuperpixelObservations& of_members) {
      size_t count = 0;
      for (const int k : members[p]) {
        count += of_members.NumObservations(k);
      }
      return count;
    };
    const SuperpixelObservations& sampled =
        count_of(observations) > 0 ? observations : of_priors;
    const size_t count = count_of(sampled);
    sampled.Sample(members[p], kMaxPlaneSamples, [&](DepthObservation sample) {
      sample.center = to_world * sample.center + origin;
      sample.ray = to_world * sample.ray;
      sample.sigma *= discovery.tolerance;
      plane.observations.push_back(sample);
    });
    for (DepthObservation& sample : plane.observations) {
      sample.weight *= static_cast<double>(count) / plane.observations.size();
    }
    plane.superpixels = std::move(superpixels[p]);
    ThinOut(&plane.superpixels);
    result.push_back(std::move(plane));
  }
  return result;
}

ModelPlane ToModelPlane(const MeasuredScenePlane& measured) {
  ModelPlane plane;
  plane.plane = measured.found.plane;
  plane.support = measured.found.support;
  const PlaneUncertainty uncertainty =
      ComputeUncertainty(plane.plane, measured.superpixels);
  plane.center = uncertainty.center;
  plane.axis_s = uncertainty.axes.col(0);
  plane.axis_t = uncertainty.axes.col(1);
  if (measured.superpixels.empty()) {
    for (const DepthObservation& observation : measured.observations) {
      plane.center +=
          FootPoint(plane.plane, observation) / measured.observations.size();
    }
    plane.axis_s = plane.plane.normal.unitOrthogonal();
    plane.axis_t = plane.plane.normal.cross(plane.axis_s);
  }
  // Rotation about one axis tilts the plane along the other.
  plane.covariance(0, 0) = uncertainty.slope_variance(1);
  plane.covariance(1, 1) = uncertainty.slope_variance(0);
  plane.covariance(2, 2) = uncertainty.height_variance;
  return plane;
}

}  // namespace tsar
