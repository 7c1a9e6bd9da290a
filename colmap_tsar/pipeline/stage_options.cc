// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/stage_options.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tsar {
namespace {

int ScaledLength(double length, double raster_scale) {
  return std::max(1, static_cast<int>(std::lround(length * raster_scale)));
}

// The tolerance about planes, in relative depths of one pixel of disparity,
// stays within these: COLMAP's maps are no better than the first, and what is
// worse than the second carries no plane.
constexpr double kMinTolerance = 0.7;
constexpr double kMaxTolerance = 2.0;

// A confirmed depth is moved onto its plane only within so many standard
// deviations of the depths about their planes, and within no less than this
// share of a pixel of disparity, which no matching resolves.
constexpr double kSpreadOnPlane = 3.0;
constexpr double kMinSpreadOnPlane = 0.3;

// The superpixels for which the lengths of BorderOptions hold.
constexpr double kDefaultSuperpixelSize = 400.0;

// The median of the views' noise; 0 where none has any.
double MedianNoise(const std::vector<ObservedView>& views) {
  std::vector<double> noise;
  for (const ObservedView& view : views) {
    if (view.evidence->noise > 0.f) {
      noise.push_back(view.evidence->noise);
    }
  }
  std::sort(noise.begin(), noise.end());
  return noise.empty() ? 0.0 : noise[noise.size() / 2];
}

}  // namespace

RefineOptions MeasuringOptions(const RefineOptions& options) {
  RefineOptions measuring = options;
  measuring.spread_medians = false;
  measuring.fill_before_regions = false;
  return measuring;
}

ConfidenceOptions MakeConfidenceOptions(const RefineOptions& options) {
  return {.use_ratio = options.cost_ratio};
}

CorrelationOptions MakeCorrelationOptions(const RefineOptions& options,
                                          uint32_t image_id) {
  CorrelationOptions result;
  result.num_iterations = options.num_iterations;
  result.window_radius = static_cast<float>(options.window_radius);
  result.disparity_tolerance = static_cast<float>(options.disparity_tolerance);
  result.spatial_sigma = static_cast<float>(options.spatial_sigma);
  result.color_sigma = static_cast<float>(options.color_sigma);
  result.readmit_filtered = options.readmit_filtered;
  result.spread_medians = options.spread_medians;
  result.small_windows = options.small_windows;
  result.pixel_distances = options.pixel_distances;
  result.use_superpixel_planes = options.superpixel_planes;
  result.use_weighted_median = options.weighted_median;
  result.planes.min_support = static_cast<float>(options.min_plane_support);
  result.planes.loose_tolerance =
      static_cast<float>(options.loose_plane_tolerance);
  result.planes.ransac.image_id = image_id;
  result.planes.ransac.seed = static_cast<uint32_t>(options.seed);
  return result;
}

HoughOptions MakeHoughOptions(const RefineOptions& options,
                              double raster_scale) {
  HoughOptions hough;
  hough.max_gap = ScaledLength(options.hough_max_gap, raster_scale);
  if (options.short_lines) {
    hough.min_length_share = 0.f;
  }
  return hough;
}

int MinRegionSize(const RefineOptions& options, double raster_scale) {
  const double area_scale = raster_scale * raster_scale;
  return static_cast<int>(options.min_region_size * area_scale);
}

RegionPlaneOptions MakeRegionPlaneOptions(const RefineOptions& options,
                                          double raster_scale,
                                          uint32_t image_id) {
  RegionPlaneOptions planes;
  planes.max_planes = options.max_region_planes;
  planes.use_core = options.region_cores;
  planes.rim_width =
      options.region_rims ? ScaledLength(planes.rim_width, raster_scale) : 0;
  planes.core_margin = ScaledLength(planes.core_margin, raster_scale);
  planes.min_rim_share = static_cast<float>(options.min_plane_support);
  planes.max_boundary_error = static_cast<float>(options.max_boundary_error);
  if (options.max_boundary_gap > 0.0) {
    // The test that follows alone decides.
    planes.min_samples = 3;
    planes.min_rim_share = 0.f;
    planes.max_boundary_error = std::numeric_limits<float>::infinity();
  }
  if (!options.bounded_regions) {
    planes.max_extrapolation = std::numeric_limits<float>::infinity();
  }
  planes.ransac.tolerance.pixels = 1.f;
  planes.ransac.num_hypotheses = 200;
  planes.ransac.image_id = image_id;
  planes.ransac.seed = static_cast<uint32_t>(options.seed);
  return planes;
}

double PlaneTolerance(const RefineOptions& options, double noise) {
  return std::clamp(
      options.plane_tolerance * noise, kMinTolerance, kMaxTolerance);
}

SceneOptions MakeSceneOptions(const RefineOptions& options,
                              const std::vector<ObservedView>& views) {
  const double tolerance = PlaneTolerance(options, MedianNoise(views));
  SceneOptions scene;
  scene.discovery.tolerance = tolerance;
  scene.discovery.min_gain = options.min_scene_plane;
  scene.discovery.manhattan_frame = options.manhattan_frame;
  scene.support.tolerance = tolerance;
  scene.measuring.tolerance = tolerance;
  scene.measuring.max_weight = scene.discovery.max_weight;
  scene.labels.tolerance = static_cast<float>(tolerance);
  scene.labels.unlabelled_cost = static_cast<float>(options.unlabelled_cost);
  if (!options.bounded_planes) {
    scene.labels.extrapolation_uncertainty = 0.f;
  }
  // Lengths of borders grow with the superpixels.
  const double border_scale =
      std::sqrt(options.superpixel_size / kDefaultSuperpixelSize);
  scene.borders.reach = ScaledLength(scene.borders.reach, border_scale);
  scene.borders.radius = ScaledLength(scene.borders.radius, border_scale);
  scene.borders.spatial_sigma *= static_cast<float>(border_scale);
  scene.surfaces.labels = scene.labels;
  scene.composition.on_plane =
      static_cast<float>(std::clamp(kSpreadOnPlane * MedianNoise(views),
                                    kMinSpreadOnPlane,
                                    double{scene.composition.on_plane}));
  return scene;
}

}  // namespace tsar
