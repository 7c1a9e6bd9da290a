// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/scene/evidence/observed_view.h"

#include <climits>
#include <cmath>
#include <cstdint>

namespace tsar {

// The factors that map the colors of a source to those of the reference:
// exposure and white balance, and vignetting, which darkens a pixel by
// `falloff` times the square of its distance from the image center, in half
// diagonals.
struct ColorGain {
  Vec3f balance{1.f, 1.f, 1.f};
  float falloff = 0.f;

  // The factors at two pixels, given their squared distances.
  TSAR_HD Vec3f At(float reference, float source) const {
    return balance * (1.f + falloff * (source - reference));
  }
};

// The squared distance of a pixel from the image center, in half diagonals.
TSAR_HD inline float SquaredRadius(float x, float y, int width, int height) {
  const float u = 2.f * x - static_cast<float>(width - 1);
  const float v = 2.f * y - static_cast<float>(height - 1);
  return (u * u + v * v) / static_cast<float>(width * width + height * height);
}

// A view that looks at the same scene as the reference. Lengths are in units of
// the sparse model throughout.
struct ObservedSource {
  Intrinsics intrinsics;        // Of its raster.
  RelativePose from_reference;  // Into its camera's frame.
  // Resolution of its map, which may be larger than the raster.
  DepthResolution resolution;
  int width = 0;  // Size of its raster.
  int height = 0;
  // The images of ViewEvidence, of the size of the raster; empty where not
  // requested. Depths are along its optical axis, 0 where nothing is certain.
  ImageView<const float> confident_depth;
  ImageView<const uint16_t> superpixels;  // Of each pixel.
  ImageView<const Rgb> color;
  ColorGain gain;
};

// A point in a source view.
struct SeenPoint {
  float depth = 0.f;  // Along the source's optical axis.
  float x = 0.f;      // Its position on the raster, in pixels,
  float y = 0.f;
  int column = 0;  // and the pixel there.
  int row = 0;
};

// Projects a point in the reference camera's frame into a source. Returns
// false, with `seen` undefined, where the point is behind the camera or outside
// the image, or a coordinate is NaN. Occlusion is not tested.
TSAR_HD inline bool FindInSource(const ObservedSource& source,
                                 const Vec3f& point,
                                 SeenPoint* seen) {
  const Vec3f position = source.from_reference * point;
  if (!(position.z > 0.f)) {
    return false;
  }
  seen->depth = position.z;
  source.intrinsics.Project(position, &seen->x, &seen->y);
  // Floats are compared, since far outside they do not fit into integers.
  if (!(seen->x >= 0.f && seen->y >= 0.f && seen->x < source.width - 0.5f &&
        seen->y < source.height - 0.5f)) {
    return false;
  }
  seen->column = static_cast<int>(seen->x + 0.5f);
  seen->row = static_cast<int>(seen->y + 0.5f);
  return true;
}

// The source without its rasters. Both cameras are those of the views' rasters,
// with poses from the world into their frames.
ObservedSource MakeObservedSource(const ObservedView& reference,
                                  const ObservedView& source);

// Estimates the gain from the points that both views measured; neutral where
// these are few.
ColorGain EstimateColorGain(const ObservedView& reference,
                            const ObservedView& source);

// Whether the source measured the same depth at a point in the reference
// camera's frame. max_gap: the largest distance from the source's depth, in
// relative depths of one pixel of disparity.
TSAR_HD inline bool Confirms(const ObservedSource& source,
                             const Vec3f& point,
                             float max_gap) {
  SeenPoint seen;
  if (!FindInSource(source, point, &seen)) {
    return false;
  }
  const float measured = source.confident_depth(seen.column, seen.row);
  return measured > 0.f &&
         fabsf(seen.depth - measured) /
                 (measured * source.resolution.RelativeDepthError(measured)) <
             max_gap;
}

// The evenly spaced pixels of a superpixel at which votes are taken.
struct VoteSampling {
  int pixels_per_test = 1;
  int max_tests = INT_MAX;

  TSAR_HD int NumTests(int num_pixels) const {
    const int all = num_pixels / pixels_per_test;
    const int num_tests = all < max_tests ? all : max_tests;
    return num_tests > 1 ? num_tests : 1;
  }

  // The index of a test's pixel among those of the superpixel.
  TSAR_HD static int Pixel(int test, int num_tests, int num_pixels) {
    return static_cast<int>((2 * test + 1) * static_cast<int64_t>(num_pixels) /
                            (2 * num_tests));
  }
};

// For the depths of other views on a plane.
inline constexpr VoteSampling kPlaneSampling{9};

}  // namespace tsar
