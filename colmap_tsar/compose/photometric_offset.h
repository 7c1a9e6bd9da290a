// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/compose/compose_map.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/views.h"
#include "colmap_tsar/view/denoise/estimate_noise.h"

namespace tsar {

// Larger offsets, in pixels of disparity, belong to another surface, or an edge
// in front.
constexpr float kMaxPhotometricOffset = 0.8f;

// The largest number of sources: more cost time and memory, and see the surface
// from farther away.
constexpr int kMaxPhotometricSources = 8;

struct PhotometricInputs {
  Intrinsics intrinsics;
  ImageView<const float> gray;
  // Images with their depth maps; empty depth maps occlude nothing.
  // At most kMaxPhotometricSources.
  const Buffer<SourceView>& sources;
  DepthResolution resolution;
  NoiseCurve noise;  // Noise of the images.
};

// The photometric offset of the surface from the depth of each pixel.
struct PhotometricOffsets {
  // The weight of a pixel that keeps its depth.
  static constexpr float kNeverMoves = -1.f;

  DeviceImage<float> offset;
  // 1 / sigma^2; 0 where the offset is unknown and may be taken from neighbors.
  DeviceImage<float> weight;
};

// The depth at an offset; positive offsets are toward the camera.
TSAR_HD inline float DepthAtOffset(float depth,
                                   float offset,
                                   const DepthResolution& resolution) {
  return depth / (1.f + offset * depth * resolution.error_per_depth);
}

// Compares each measured pixel that has texture with the sources, with the
// plane of its depth and normal moved along the ray. The log-likelihood of an
// offset adds up over the sources; its curvature is the inverse of the offset's
// variance, and the agreement of two halves of the sources tests its
// reliability.
PhotometricOffsets MeasureOffsets(const ComposedMap& composed,
                                  const PhotometricInputs& inputs,
                                  Device& device);

}  // namespace tsar
