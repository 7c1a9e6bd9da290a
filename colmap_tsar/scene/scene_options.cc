// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/scene_options.h"

#include "colmap_tsar/base/median.h"

#include <algorithm>
#include <cmath>

namespace tsar {
namespace {

// Limits of the tolerance at planes, in relative depths of one pixel of
// disparity: COLMAP's maps are no better than the first, and maps worse than
// the second support no plane.
constexpr double kMinTolerance = 0.7;
constexpr double kMaxTolerance = 2.0;

// The superpixel size for which LabelOptions::crease_reach holds.
constexpr double kDefaultSuperpixelSize = 400.0;

}  // namespace

double MedianNoise(const std::vector<ObservedView>& views) {
  std::vector<double> noise;
  for (const ObservedView& view : views) {
    if (view.evidence->noise > 0.f) {
      noise.push_back(view.evidence->noise);
    }
  }
  return noise.empty() ? 0.0 : UpperMedian(&noise);
}

double ScenePlaneTolerance(const RefineOptions& options, double noise) {
  return std::clamp(
      options.plane_tolerance * noise, kMinTolerance, kMaxTolerance);
}

SceneOptions MakeSceneOptions(const RefineOptions& options,
                              const std::vector<ObservedView>& views) {
  const double tolerance = ScenePlaneTolerance(options, MedianNoise(views));
  SceneOptions scene;
  scene.discovery.tolerance = tolerance;
  scene.discovery.min_gain = options.min_scene_plane;
  scene.discovery.manhattan_frame = options.manhattan_frame;
  scene.labels.tolerance = static_cast<float>(tolerance);
  scene.labels.unlabeled_cost = static_cast<float>(options.unlabeled_cost);
  if (!options.bounded_planes) {
    scene.labels.extrapolation_uncertainty = 0.f;
  }
  // Lengths at borders scale with the superpixels.
  scene.labels.crease_reach *= static_cast<float>(
      std::sqrt(options.superpixel_size / kDefaultSuperpixelSize));
  return scene;
}

}  // namespace tsar
