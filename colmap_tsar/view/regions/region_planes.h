// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/view/planes/group_planes.h"
#include "colmap_tsar/view/regions/regions.h"

namespace tsar {

// The largest number of planes of a region, which may hold several surfaces,
// such as a wall and a ceiling that meet without a visible edge.
constexpr int kMaxPlanesPerRegion = 4;

struct RegionPlaneOptions {
  // At most kMaxPlanesPerRegion.
  int max_planes = kMaxPlanesPerRegion;
  // Whether the core and the rim are fitted separately. If not, one fit uses
  // both, as in the paper.
  bool use_core = true;
  // The width of the rim around a region, in pixels of the regions' raster.
  int rim_width = 8;
  // The distance of the core from the region's border, in pixels. Closer to it,
  // matching windows take the depth of the foreground.
  int core_margin = 3;
  // The least number of samples that support a plane, in the core or on the
  // rim.
  int min_samples = 50;
  // Samples of the core support a plane if they are this many times denser at
  // the plane than next to it; noise has the same density everywhere.
  float min_core_contrast = 1.5f;
  // Samples of the rim support a plane if this share of them lies on it.
  float min_rim_share = 0.3f;
  // Further planes of a region need at least this share of the first one's
  // inliers.
  float min_further_share = 0.5f;
  // gamma: the largest mean gap between the plane and the samples on the rim,
  // as a fraction of depth; each gap is clamped to twice that, so that the
  // distance of an object in front of a wall does not dominate.
  float max_boundary_error = 0.02f;
  // The largest extrapolation of a plane, in standard deviations of its
  // support; beyond it, errors of the tilt dominate.
  float max_extrapolation = 3.f;
  GroupPlaneOptions ransac;
};

// A plane and its support in the image.
struct SupportedPlane {
  Plane plane;  // Invalid if the samples support none.
  SupportArea support;
};

struct RegionPlanes {
  // The labels of the regions, grown by their rims.
  DeviceImage<int> grown;
  // Plane `slot` of region k is planes[k * kMaxPlanesPerRegion + slot].
  Buffer<SupportedPlane> planes;
};

// Finds each region's planes one after the other in the reliable samples in it
// and on its rim. The core decides if it supports a plane, because frames,
// sills and posters on the rim protrude from the wall; the rim decides if the
// core has no support, as in tiles between grooves. samples: reliable
// measurements on the regions' raster, z = 0 elsewhere.
RegionPlanes FitRegionPlanes(const Regions& regions,
                             ImageView<const RayDepth> samples,
                             const DepthResolution& resolution,
                             const RegionPlaneOptions& options,
                             Device& device);

// The plane of each pixel of a region: of several planes, the one with most
// samples nearby. Invalid further from the plane's support than
// max_extrapolation, and outside the regions.
DeviceImage<Plane> AssignRegionPlanes(const Regions& regions,
                                      const RegionPlanes& planes,
                                      ImageView<const RayDepth> samples,
                                      const Intrinsics& intrinsics,
                                      const DepthResolution& resolution,
                                      const RegionPlaneOptions& options,
                                      Device& device);

}  // namespace tsar
