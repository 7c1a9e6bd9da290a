// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/view/planes/group_planes.h"
#include "colmap_tsar/view/regions/regions.h"

namespace tsar {

// A region may hold several surfaces, such as a wall and a ceiling that meet
// without a visible edge.
constexpr int kMaxPlanesPerRegion = 4;

struct RegionPlaneOptions {
  // At most kMaxPlanesPerRegion.
  int max_planes = kMaxPlanesPerRegion;
  // Whether the core is looked at apart from the rim. If not, one fit takes
  // both, as in the paper.
  bool use_core = true;
  // How far around a region its rim reaches, in pixels of the regions' raster.
  int rim_width = 8;
  // How far inside a region its core begins. Closer to the border, matching
  // windows take the depth of what stands in front.
  int core_margin = 3;
  // The least number of samples that carry a plane, in the core or on the rim.
  int min_samples = 50;
  // Samples of the core carry a plane when they are this many times denser
  // around it than beside it: noise is as dense everywhere.
  float min_core_contrast = 3.f;
  // Samples of the rim carry a plane when this share of them lies on it.
  float min_rim_share = 0.3f;
  // Further planes of a region need at least this share of the first one's
  // inliers.
  float min_further_share = 0.5f;
  // gamma: the largest mean gap between the plane and the samples on the rim,
  // as a fraction of depth; each gap counts up to twice that, so that an object
  // in front of a wall is one disagreement and not metres of it.
  float max_boundary_error = 0.02f;
  // How far from its support a plane is believed, in standard deviations of the
  // support: beyond, the plane's tilt decides and nothing measured it.
  float max_extrapolation = 3.f;
  GroupPlaneOptions ransac;
};

// A plane and where on the image it was measured.
struct SupportedPlane {
  Plane plane;  // Invalid where the samples carry none.
  SupportArea support;
};

struct RegionPlanes {
  // The labels of the regions, grown by their rims.
  DeviceImage<int> grown;
  // Number `slot` of region k is planes[k * kMaxPlanesPerRegion + slot].
  Buffer<SupportedPlane> planes;
};

// Finds each region's planes one after the other in the reliable samples in it
// and on its rim. The core decides wherever it carries a plane, because frames,
// sills and posters stand proud of the wall whose rim they are; the rim decides
// where the core has nothing, as in tiles between grooves.
// samples: reliable measurements on the regions' raster, z = 0 elsewhere.
RegionPlanes FitRegionPlanes(const Regions& regions,
                             ImageView<const RayDepth> samples,
                             const DepthResolution& resolution,
                             const RegionPlaneOptions& options,
                             Device& device);

}  // namespace tsar
