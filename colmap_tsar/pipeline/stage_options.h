// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/filtering/confidence.h"
#include "colmap_tsar/pipeline/compose_scene.h"
#include "colmap_tsar/pipeline/refine_options.h"
#include "colmap_tsar/scene_planes/curved_surfaces.h"
#include "colmap_tsar/scene_planes/discover_planes.h"
#include "colmap_tsar/scene_planes/label_view.h"
#include "colmap_tsar/scene_planes/plane_measurement.h"
#include "colmap_tsar/scene_planes/plane_support.h"
#include "colmap_tsar/scene_planes/refine_borders.h"
#include "colmap_tsar/segmentation/hough.h"
#include "colmap_tsar/segmentation/region_planes.h"
#include "colmap_tsar/superpixels/correlation.h"

#include <cstdint>
#include <vector>

namespace tsar {

// Of a view whose measurements serve the planes of the scene: these need every
// pixel's own depth, and no others.
RefineOptions MeasuringOptions(const RefineOptions& options);

// What single stages make of the options of a run. raster_scale: that of
// DeviceViews; lengths shrink by it, areas by its square. image_id keys the
// random numbers.

ConfidenceOptions MakeConfidenceOptions(const RefineOptions& options);

CorrelationOptions MakeCorrelationOptions(const RefineOptions& options,
                                          uint32_t image_id);

HoughOptions MakeHoughOptions(const RefineOptions& options,
                              double raster_scale);

// The least number of pixels of a region on the raster.
int MinRegionSize(const RefineOptions& options, double raster_scale);

RegionPlaneOptions MakeRegionPlaneOptions(const RefineOptions& options,
                                          double raster_scale,
                                          uint32_t image_id);

// For the planes of the scene.
struct SceneOptions {
  DiscoverPlanesOptions discovery;
  PlaneSupportOptions support;
  MeasureViewOptions measuring;
  LabelOptions labels;
  BorderOptions borders;
  CurvedSurfaceOptions surfaces;
  ComposeSceneOptions composition;
};

// How far depths may lie off a plane, in relative depths of one pixel of
// disparity. noise: see ViewEvidence.
double PlaneTolerance(const RefineOptions& options, double noise);

// views: those that see the scene; the tolerance follows from their noise.
SceneOptions MakeSceneOptions(const RefineOptions& options,
                              const std::vector<ObservedView>& views);

}  // namespace tsar
