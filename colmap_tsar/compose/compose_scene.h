// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/priors/prior_raster.h"
#include "colmap_tsar/scene/adjustment/inverse_depth_error.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/view/compose.h"
#include "colmap_tsar/view/depth_confidence.h"
#include "colmap_tsar/view/planes/group_planes.h"
#include "colmap_tsar/view/superpixels/samples.h"
#include "colmap_tsar/view/view_votes.h"

#include <cstdint>

namespace tsar {

// A measured depth further than this from a plane or a cylinder does not lie on
// it, in relative depths of one pixel of disparity.
inline constexpr float kOnSurface = 1.2f;

struct ComposeSceneOptions {
  // A measurement nearer to its plane lies on it, in relative depths of one
  // pixel of disparity.
  float on_plane = kOnSurface;
  // The log-odds from which on a measurement off its plane stands. Below 0,
  // since a depth that was right and is lost does more harm than one that was
  // wrong and stays.
  float min_log_odds = -1.25f;
};

// How a superpixel came by its plane.
struct ComposedSuperpixel {
  LabelEvidence evidence = LabelEvidence::kNone;
  LabelMeasures label;
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
  // ComputeTexture() of the raster.
  ImageView<const float> texture;
  PriorRaster prior{};  // May be empty.
};

// Of the superpixel under a pixel of the map.
TSAR_HD inline const ComposedSuperpixel& SuperpixelAt(
    const ComposeSceneInputs& inputs, int x, int y) {
  const ImageView<const uint16_t>& raster = inputs.superpixels;
  return inputs.of_superpixel[raster(
      ReducedRaster::FromMap(x, inputs.ratings.width, raster.width),
      ReducedRaster::FromMap(y, inputs.ratings.height, raster.height))];
}

// One map from the planes of the scene and the view's own measurements. Where a
// measurement and the plane of its superpixel are two surfaces, that of the two
// stands for which the image and the other views speak; where the scene has no
// plane, measurements stand.
// own: the measured hypotheses, whose memory the result takes over.
ComposedMap ComposeScene(DepthNormalImages own,
                         const ComposeSceneInputs& inputs,
                         const ViewSurfaces& surfaces,
                         const DepthResolution& resolution,
                         const ComposeSceneOptions& options,
                         Device& device);

// The probability that each depth is right to 1 %; 0 where there is none, and
// where nothing was measured and it is not as likely as min_fill_confidence
// that the depth lies on the right surface. noise: see ViewEvidence.
DeviceImage<float> RateSceneConfidence(const ComposedMap& composed,
                                       const ComposeSceneInputs& inputs,
                                       const ViewSurfaces& surfaces,
                                       const DepthResolution& resolution,
                                       float noise,
                                       float min_fill_confidence,
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
