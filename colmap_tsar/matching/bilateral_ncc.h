// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"

#include <cmath>

namespace tsar {

// The cost of a window that carries no evidence: its centre leaves the source
// image, or one of the two windows has no texture.
constexpr float kUndefinedCost = -1.f;

// A window of 11 x 11 pixels of which every second row and column is sampled.
// Windows of another radius have as many samples, closer together or farther
// apart.
constexpr float kPatchRadius = 5.f;
constexpr int kPatchSide = 6;
constexpr int kPatchSize = kPatchSide * kPatchSide;

// Widths of the bilateral weights, those of COLMAP: the window's radius in
// pixels, and 0.2 of the range of grey levels.
constexpr float kPatchSpatialSigma = 5.f;
constexpr float kPatchColorSigma = 51.f;

// Windows whose weighted variance (grey levels squared) is lower have no
// texture; below it, 8-bit quantisation is all there is.
constexpr float kMinPatchVariance = 0.65f;

// Grey level at a position between pixels; positions outside take the border's.
TSAR_HD inline float SampleBilinear(const ImageView<const float>& image,
                                    float x,
                                    float y) {
  x = fminf(fmaxf(x, 0.f), static_cast<float>(image.width - 1));
  y = fminf(fmaxf(y, 0.f), static_cast<float>(image.height - 1));
  const int x0 = static_cast<int>(x);
  const int y0 = static_cast<int>(y);
  const int x1 = x0 + 1 < image.width ? x0 + 1 : x0;
  const int y1 = y0 + 1 < image.height ? y0 + 1 : y0;
  const float fx = x - x0;
  const float fy = y - y0;
  const float top = image(x0, y0) + fx * (image(x1, y0) - image(x0, y0));
  const float bottom = image(x0, y1) + fx * (image(x1, y1) - image(x0, y1));
  return top + fy * (bottom - top);
}

// The reference's window with its bilateral weights, gathered once and compared
// with every source. Values are relative to the centre, which keeps the sums of
// squares small.
struct ReferencePatch {
  float center_x;
  float center_y;
  float radius;
  float step;  // Between samples.
  float value[kPatchSize];
  float weight[kPatchSize];
  float mean;
  float variance;

  TSAR_HD ReferencePatch(const ImageView<const float>& gray,
                         float x,
                         float y,
                         float window_radius = kPatchRadius)
      : center_x(x),
        center_y(y),
        radius(window_radius),
        step(2.f * window_radius / (kPatchSide - 1)) {
    const float spatial_sigma = kPatchSpatialSigma * radius / kPatchRadius;
    const float center = SampleBilinear(gray, x, y);
    float sum_weight = 0.f;
    float sum = 0.f;
    float sum_squares = 0.f;
    for (int i = 0; i < kPatchSize; ++i) {
      const float dx = OffsetX(i);
      const float dy = OffsetY(i);
      const float difference = SampleBilinear(gray, x + dx, y + dy) - center;
      const float w = expf(-(dx * dx + dy * dy) /
                               (2.f * spatial_sigma * spatial_sigma) -
                           difference * difference /
                               (2.f * kPatchColorSigma * kPatchColorSigma));
      value[i] = difference;
      weight[i] = w;
      sum_weight += w;
      sum += w * difference;
      sum_squares += w * difference * difference;
    }
    const float inverse = 1.f / sum_weight;
    for (int i = 0; i < kPatchSize; ++i) {
      weight[i] *= inverse;
    }
    mean = sum * inverse;
    variance = sum_squares * inverse - mean * mean;
  }

  TSAR_HD float OffsetX(int i) const {
    return static_cast<float>(i % kPatchSide) * step - radius;
  }
  TSAR_HD float OffsetY(int i) const {
    return static_cast<float>(i / kPatchSide) * step - radius;
  }
  TSAR_HD bool HasTexture() const { return variance >= kMinPatchVariance; }
};

// The homography by which a plane of the first camera's frame maps the first
// image to the second: K2 (R - t n^T / d) K1^-1, up to scale.
struct PlaneHomography {
  float h[9];

  TSAR_HD PlaneHomography(const Intrinsics& first,
                          const Intrinsics& second,
                          const RelativePose& pose,
                          const Plane& plane) {
    const Vec3f n = plane.normal * (-1.f / plane.offset);
    const Mat3f& r = pose.rotation;
    const Vec3f& t = pose.translation;
    const Vec3f a = r.row0 + n * t.x;
    const Vec3f b = r.row1 + n * t.y;
    const Vec3f c = r.row2 + n * t.z;
    SetRow(0, second.fx * a + second.cx * c, first);
    SetRow(1, second.fy * b + second.cy * c, first);
    SetRow(2, c, first);
  }

  // Maps (x, y); false where the point lies behind the second camera.
  TSAR_HD bool Map(float x, float y, float* mapped_x, float* mapped_y) const {
    const float z = h[6] * x + h[7] * y + h[8];
    if (!(z > 0.f)) {
      return false;
    }
    const float inverse = 1.f / z;
    *mapped_x = (h[0] * x + h[1] * y + h[2]) * inverse;
    *mapped_y = (h[3] * x + h[4] * y + h[5]) * inverse;
    return true;
  }

 private:
  TSAR_HD void SetRow(int row, const Vec3f& m, const Intrinsics& first) {
    h[3 * row] = m.x / first.fx;
    h[3 * row + 1] = m.y / first.fy;
    h[3 * row + 2] =
        m.z - m.x * first.cx / first.fx - m.y * first.cy / first.fy;
  }
};

// 1 - NCC of the patch and of what the homography maps it to, in [0, 2], or
// kUndefinedCost.
TSAR_HD inline float PatchCost(const ReferencePatch& patch,
                               const PlaneHomography& homography,
                               const ImageView<const float>& other) {
  if (!patch.HasTexture()) {
    return kUndefinedCost;
  }
  float x = 0.f;
  float y = 0.f;
  // Half a pixel of grace: a pixel on the border that is mapped forth and back
  // may come out a rounding error beside itself.
  if (!homography.Map(patch.center_x, patch.center_y, &x, &y) ||
      !(x >= -0.5f) || !(y >= -0.5f) || !(x <= other.width - 0.5f) ||
      !(y <= other.height - 0.5f)) {
    return kUndefinedCost;
  }
  const float center = SampleBilinear(other, x, y);
  float sum = 0.f;
  float sum_squares = 0.f;
  float sum_products = 0.f;
  for (int i = 0; i < kPatchSize; ++i) {
    if (!homography.Map(patch.center_x + patch.OffsetX(i),
                        patch.center_y + patch.OffsetY(i),
                        &x,
                        &y)) {
      return kUndefinedCost;
    }
    const float difference = SampleBilinear(other, x, y) - center;
    const float weighted = patch.weight[i] * difference;
    sum += weighted;
    sum_squares += weighted * difference;
    sum_products += weighted * patch.value[i];
  }
  const float variance = sum_squares - sum * sum;
  if (!(variance >= kMinPatchVariance)) {
    return kUndefinedCost;
  }
  const float covariance = sum_products - sum * patch.mean;
  const float ncc = covariance / sqrtf(variance * patch.variance);
  return fminf(fmaxf(1.f - ncc, 0.f), 2.f);
}

}  // namespace tsar
