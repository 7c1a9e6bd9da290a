// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/pipeline/compose.h"
#include "colmap_tsar/planes/group_planes.h"
#include "colmap_tsar/scene_planes/inverse_depth_error.h"
#include "colmap_tsar/scene_planes/label_view.h"
#include "colmap_tsar/scene_planes/surface_confidence.h"
#include "colmap_tsar/superpixels/samples.h"

#include <cstdint>

namespace tsar {

// A measured depth further than this from a plane or a cylinder does not lie on
// it, in relative depths of one pixel of disparity.
inline constexpr float kOnSurface = 1.2f;

struct ComposeSceneOptions {
  // Whether measurements off their plane may stand at all.
  bool keep_off_plane = true;
  // A measurement further from its plane keeps its own depth,
  PlaneTolerance on_plane{0.f, kOnSurface};
  // if at least so many pixels of the raster do so side by side, since specks
  // are noise,
  int min_blob = 20;
  // or if another view confirms it: thin and detailed things,
  bool keep_confirmed = true;
  // and lies further than this from its plane: where its texture is distinct,
  PlaneTolerance on_plane_distinct{0.f, kOnSurface};
  // and where it is weak. A plane within 1.5 % of a depth that is right to 1 %
  // is itself right to 2.5 %, and more often right than such depths are. A
  // depth that is trusted but not confirmed stands off its plane from 1.2
  // pixels of disparity on, but never alone.
  PlaneTolerance on_plane_weak{0.015f, kOnSurface};
};

// How a superpixel came by its plane, and how likely its depths are right.
struct ComposedSuperpixel {
  LabelEvidence evidence = LabelEvidence::kNone;
  SurfaceConfidence confidence;
  InverseDepthError error{};  // Of its plane.
  // Its surface is a curved one; then the error is not known.
  bool is_curved = false;
};

struct ComposeSceneInputs {
  ImageView<const uint8_t> ratings;  // Of the map: see MeasurementRating.
  PlaneRaster scene_planes;          // Invalid where a superpixel has none.
  // The superpixel of each pixel of the raster, and what is known of each.
  ImageView<const uint16_t> superpixels;
  const ComposedSuperpixel* of_superpixel = nullptr;
  // Used where the scene has no plane.
  PlaneRaster region_planes;
};

// Of the superpixel under a pixel of the map.
TSAR_HD inline const ComposedSuperpixel& SuperpixelAt(
    const ComposeSceneInputs& inputs, int x, int y) {
  const ImageView<const uint16_t>& raster = inputs.superpixels;
  return inputs.of_superpixel[raster(
      ReducedRaster::FromMap(x, inputs.ratings.width, raster.width),
      ReducedRaster::FromMap(y, inputs.ratings.height, raster.height))];
}

// One map from the planes of the scene and the view's own measurements: planes
// where there are any, measurements that lie off them, and where the scene has
// no plane, measurements and planes of regions.
// own: the measured hypotheses, whose memory the result takes over.
ComposedMap ComposeScene(DepthNormalImages own,
                         const ComposeSceneInputs& inputs,
                         const DepthResolution& resolution,
                         const ComposeSceneOptions& options,
                         Device& device);

// The probability that each depth is right to 1 %; 0 where there is none.
DeviceImage<float> RateSceneConfidence(const ComposedMap& composed,
                                       const ComposeSceneInputs& inputs,
                                       Device& device);

// The depth of the plane that a raster has at a pixel of the map; 0 where it
// has none.
TSAR_HD inline float DepthOnPlane(const PlaneRaster& raster, int x, int y) {
  const Plane plane = raster.At(x, y);
  return plane.Valid() ? plane.Depth(raster.intrinsics.Ray(x, y)) : 0.f;
}

// Whether a depth is exactly that of the plane: then composition put it there.
TSAR_HD inline bool IsOnPlane(const PlaneRaster& raster,
                              int x,
                              int y,
                              float depth) {
  return depth > 0.f && depth == DepthOnPlane(raster, x, y);
}

// Which plane of the scene each pixel of a composed map lies on.
// scene_planes: as the map was composed with. numbers: of its size, one more
// than the number of the plane in the model; 0 where that is not a plane of the
// model. Result, of the map's size: the number where the depth is exactly that
// of the plane, 0 elsewhere.
DeviceImage<uint16_t> MapPlanes(ImageView<const float> depth,
                                const PlaneRaster& scene_planes,
                                ImageView<const uint16_t> numbers,
                                Device& device);

}  // namespace tsar
