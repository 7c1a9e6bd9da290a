// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/views.h"
#include "colmap_tsar/view/compose.h"
#include "colmap_tsar/view/denoise/noise_curve.h"

namespace tsar {

// When a pixel leaves its surface. Offsets are in pixels of disparity.
struct PhotometricOptions {
  // Less may be the error of matching: the surface stays as smooth as it is.
  float min_offset = 0.08f;
  // A surface further off is another one, or an edge in front of it.
  float max_offset = 0.8f;
  // The same as a share of the depth.
  float max_depth_change = 0.01f;
  // The standard deviation that the texture gives an offset, and how far two
  // halves of the sources may differ.
  float max_sigma = 0.1f;
  float max_difference_of_halves = 0.2f;
  int min_num_sources = 4;
  // The own texture of a pixel, in variances of the noise.
  float min_texture = 8.f;
  // How far the texture that tells the offset may lie to one side of the pixel.
  float max_texture_distance = 1.25f;
  // Between pixels with an offset of their own, those at most twice this far
  // apart take their neighbours'.
  int closing_radius = 7;
  // How far offsets are averaged, and how far they may spread.
  float smoothing_sigma = 3.f;
  float max_spread = 0.15f;
};

// The sources that are asked, at most: more cost time and memory, and see the
// surface from farther away.
constexpr int kMaxPhotometricSources = 8;

struct PhotometricInputs {
  Intrinsics intrinsics;
  ImageView<const float> gray;
  // Images, and the depths that they came with; empty depths hide nothing.
  // At most kMaxPhotometricSources.
  const Buffer<SourceView>& sources;
  DepthResolution resolution;
  NoiseCurve noise;  // Of the images.
};

// How far the surface that the images show lies off a depth.
struct PhotometricOffsets {
  // Of weights: the pixel keeps its depth.
  static constexpr float kNeverMoves = -1.f;

  DeviceImage<float> offset;
  // 1 / sigma^2; 0 where the offset is not known but may be that of the
  // neighbours.
  DeviceImage<float> weight;
};

// A positive offset is nearer to the camera.
TSAR_HD inline float DepthAtOffset(float depth,
                                   float offset,
                                   const DepthResolution& resolution) {
  return depth / (1.f + offset * depth * resolution.error_per_depth);
}

// Compares each measured pixel that has texture with the sources, with the
// plane of its depth and normal moved along the ray. The log-likelihood of an
// offset adds up over the sources; its curvature is the inverse of the offset's
// variance, and two halves of the sources tell whether it can be believed.
PhotometricOffsets MeasureOffsets(const ComposedMap& composed,
                                  const PhotometricInputs& inputs,
                                  const PhotometricOptions& options,
                                  Device& device);

}  // namespace tsar
