// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/compose/compose_map.h"
#include "colmap_tsar/compose/depth_confidence.h"
#include "colmap_tsar/compose/occlusion_votes.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/priors/prior_raster.h"
#include "colmap_tsar/scene/adjustment/inverse_depth_error.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/view/planes/group_planes.h"
#include "colmap_tsar/view/superpixels/samples.h"

#include <cstdint>

namespace tsar {

// The largest residual of a measured depth that lies on a plane or a cylinder,
// in relative depths of one pixel of disparity.
inline constexpr float kOnSurface = 1.2f;

struct ComposeSceneOptions {
  // The largest residual of a measurement that lies on its plane, in relative
  // depths of one pixel of disparity.
  float on_plane = kOnSurface;
  // The log-odds above which a measurement off its plane is kept. It is below
  // 0, since losing a correct depth does more harm than keeping a wrong one.
  float min_log_odds = -1.25f;
};

// The label of a superpixel, with its origin and error.
struct ComposedSuperpixel {
  LabelOrigin origin = LabelOrigin::kNone;
  LabelMeasures label;
  InverseDepthError error{};  // Error of its plane.
  Vec3f prior_normal{};       // See AlignedPrior; (0, 0, 0): none.
};

struct ComposeSceneInputs {
  ImageView<const uint8_t> flags;  // Of the map; see MeasurementFlags.
  PlaneRaster scene_planes;        // Invalid where a superpixel has none.
  // The superpixel of each pixel of the raster, and the label of each
  // superpixel.
  ImageView<const uint16_t> superpixels;
  const ComposedSuperpixel* of_superpixel = nullptr;
  // ComputeTexture() of the raster.
  ImageView<const float> texture;
  PriorRaster prior{};  // May be empty.
};

// The label of the superpixel at a pixel of the map.
TSAR_HD inline const ComposedSuperpixel& SuperpixelAt(
    const ComposeSceneInputs& inputs, int x, int y) {
  return inputs.of_superpixel[ValueOnMap(
      inputs.superpixels, x, y, inputs.flags.width, inputs.flags.height)];
}

// Composes one map from the planes of the scene and the view's own
// measurements. Where a measurement and the plane of its superpixel are
// different surfaces, the one supported by the image and the other views is
// kept; where the scene has no plane, measurements are kept. own: the measured
// hypotheses, whose memory the result takes over.
ComposedMap ComposeScene(DepthNormalImages own,
                         const ComposeSceneInputs& inputs,
                         const ViewSurfaces& surfaces,
                         const DepthResolution& resolution,
                         const ComposeSceneOptions& options,
                         Device& device);

// The probability that each depth is correct to 1 %; 0 where there is none, and
// where a filled depth lies on the right surface with a probability below
// min_fill_confidence. noise: see ViewEvidence. variances_on_cylinders: of
// ApplyCylinders(); may be empty.
DeviceImage<float> ComputeSceneConfidence(
    const ComposedMap& composed,
    const ComposeSceneInputs& inputs,
    const ViewSurfaces& surfaces,
    const DepthResolution& resolution,
    ImageView<const float> variances_on_cylinders,
    float noise,
    float min_fill_confidence,
    Device& device);

// Fills pixels without a depth by the prior where that lies on the right
// surface with a probability of at least min_fill_confidence.
void FillByPrior(const ComposeSceneInputs& inputs,
                 float min_fill_confidence,
                 ComposedMap* composed,
                 DeviceImage<float>* confidence,
                 Device& device);

// The depth of a raster's plane at a pixel of the map; 0 where there is none.
TSAR_HD inline float DepthOnPlane(const PlaneRaster& raster, int x, int y) {
  const Plane plane = raster.At(x, y);
  return plane.Valid() ? plane.Depth(raster.intrinsics.Ray(x, y)) : 0.f;
}

// Whether a depth is exactly that of the plane, as set by the composition.
TSAR_HD inline bool IsOnPlane(const PlaneRaster& raster,
                              int x,
                              int y,
                              float depth) {
  return depth > 0.f && depth == DepthOnPlane(raster, x, y);
}

// The plane of the scene that each pixel of a composed map lies on.
// scene_planes: those of the composition. plane_ids: of their size, the index
// of the plane in the model plus one; 0 where it is not a plane of the model.
// Result, of the map's size: that number where the depth is exactly that of the
// plane, 0 elsewhere.
DeviceImage<uint16_t> MapPlanes(ImageView<const float> depth,
                                const PlaneRaster& scene_planes,
                                ImageView<const uint16_t> plane_ids,
                                Device& device);

}  // namespace tsar
