// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/views.h"
#include "colmap_tsar/view/compose.h"
#include "colmap_tsar/view/denoise/estimate_noise.h"

namespace tsar {

// Conditions for moving a pixel off its surface. Offsets are in pixels of
// disparity.
struct PhotometricOptions {
  // Smaller offsets may be errors of matching and leave the surface as it is.
  float min_offset = 0.08f;
  // Larger offsets are of another surface, or an edge in front.
  float max_offset = 0.8f;
  // The largest change of depth, relative to it.
  float max_depth_change = 0.01f;
  // The largest standard deviation of an offset by its texture, and the largest
  // difference of the offsets of two halves of the sources.
  float max_sigma = 0.1f;
  float max_difference_of_halves = 0.2f;
  int min_num_sources = 4;
  // The least texture of the pixel itself, in variances of the noise.
  float min_texture = 8.f;
  // The largest distance from the pixel of the centroid of the texture that
  // determines the offset.
  float max_texture_distance = 1.25f;
  // Pixels between others with an offset, at most twice this far apart, take
  // their neighbors' offsets.
  int closing_radius = 7;
  // The scale at which offsets are averaged, and their largest standard
  // deviation.
  float smoothing_sigma = 3.f;
  float max_deviation = 0.15f;
};

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
                                  const PhotometricOptions& options,
                                  Device& device);

}  // namespace tsar
