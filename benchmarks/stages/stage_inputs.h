// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/compose/compose_map.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/view/correlation.h"
#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/refine_options.h"
#include "colmap_tsar/view/regions/edges.h"
#include "colmap_tsar/view/regions/region_planes.h"
#include "colmap_tsar/view/stage_options.h"
#include "colmap_tsar/view/superpixels/slic.h"
#include "colmap_tsar/view/superpixels/weighted_median.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace tsar {

// One image of a workspace with its sources, in the host's memory.
struct ViewSet {
  ViewData reference;
  std::vector<ViewData> sources;

  std::vector<const ViewData*> SourcePointers() const;
};

// The first image of patch-match.cfg and at most max_sources of its sources.
ViewSet LoadFirstView(const std::filesystem::path& workspace, int max_sources);

// What every stage gets from those before it, computed once with the defaults
// of tsar_refine (see RefineImage) and held in the device's memory.
class StageInputs {
 public:
  StageInputs(const ViewSet& view_set, Device& device);

  double NumPixels() const;        // Of the maps.
  double NumRasterPixels() const;  // Of superpixels and regions.
  double NumSources() const;

  // The options that depend on the size of the maps.
  WeightedMedianOptions MedianOptions(double radius) const;
  float MinScore() const;
  DepthNormalImages OwnMap() const;
  ComposedMap Compose(DepthNormalImages own) const;

  Device& device;
  const ViewSet& view_set;
  const RefineOptions options;
  const DeviceViews views;
  const int hough_max_gap;
  const int min_region_size;
  const RegionPlaneOptions plane_options;
  const MatchingCosts costs;
  const DeviceImage<uint8_t> agreement;
  const DeviceImage<float> confidence;
  const DeviceImage<float> discontinuity;
  const DeviceImage<float> score;
  const DeviceImage<float> raster_score;
  const Superpixels superpixels;
  const CorrelationResult correlation;
  const DeviceImage<RayDepth> samples;  // Trusted depths, on the raster.
  const PixelGroups superpixel_groups;
  const DeviceImage<Plane> superpixel_planes;
  const DeviceImage<uint8_t> edges;    // Before the segments are drawn.
  const DeviceImage<uint8_t> borders;  // Edges and segments.
  const Regions regions;
  const RegionPlanes region_planes;
  const DeviceImage<Plane> pixel_planes;  // Planes of the regions.
  const ComposedMap composed;
};

}  // namespace tsar
