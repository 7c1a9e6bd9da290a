// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/exponential.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/matching/bilinear.cuh"
#include "colmap_tsar/matching/matching_cost.h"

#include <cmath>

namespace tsar {

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
    // On a CPU each step is a loop of its own, as in AddUpBySteps.
#ifdef __CUDA_ARCH__
    for (int i = 0; i < kPatchSize; ++i) {
      value[i] = SampleBilinear(gray, x + OffsetX(i), y + OffsetY(i)) - center;
      weight[i] = Weight(i, spatial_sigma);
    }
#else
    ReadSamples(gray);
    for (int i = 0; i < kPatchSize; ++i) {
      value[i] -= center;
    }
    for (int i = 0; i < kPatchSize; ++i) {
      weight[i] = Weight(i, spatial_sigma);
    }
#endif
    float sum_weight = 0.f;
    float sum = 0.f;
    float sum_squares = 0.f;
    for (int i = 0; i < kPatchSize; ++i) {
      sum_weight += weight[i];
      sum += weight[i] * value[i];
      sum_squares += weight[i] * value[i] * value[i];
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

 private:
  // Bilateral, not yet normalised.
  TSAR_HD float Weight(int i, float spatial_sigma) const {
    const float dx = OffsetX(i);
    const float dy = OffsetY(i);
    return ExpOfNegative(
        -(dx * dx + dy * dy) / (2.f * spatial_sigma * spatial_sigma) -
        value[i] * value[i] / (2.f * kPatchColorSigma * kPatchColorSigma));
  }

  // Sets the values to grey levels.
  void ReadSamples(const ImageView<const float>& gray) {
    float x[kPatchSize];
    float y[kPatchSize];
    for (int i = 0; i < kPatchSize; ++i) {
      x[i] = center_x + OffsetX(i);
      y[i] = center_y + OffsetY(i);
    }
    SampleBilinearBySteps(gray, x, y, value);
  }
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

// What is added up over the samples of a patch in another image, whose values
// are relative to the centre there.
struct PatchSums {
  float values = 0.f;
  float squares = 0.f;
  float products = 0.f;  // With the patch's own values.

  TSAR_HD void Add(float weighted, float square, float product) {
    values += weighted;
    squares += square;
    products += product;
  }
};

// Adds up one sample after the other: the form for a GPU, where each thread has
// a patch and keeps a sample in registers. False where the plane reaches behind
// the other camera.
TSAR_HD inline bool AddUpBySamples(const ReferencePatch& patch,
                                   const PlaneHomography& homography,
                                   const ImageView<const float>& other,
                                   float center,
                                   PatchSums* sums) {
  for (int i = 0; i < kPatchSize; ++i) {
    float x = 0.f;
    float y = 0.f;
    if (!homography.Map(patch.center_x + patch.OffsetX(i),
                        patch.center_y + patch.OffsetY(i),
                        &x,
                        &y)) {
      return false;
    }
    const float difference = SampleBilinear(other, x, y) - center;
    const float weighted = patch.weight[i] * difference;
    sums->Add(weighted, weighted * difference, weighted * patch.value[i]);
  }
  return true;
}

// The same by one step after the other, each for all samples: the form for a
// CPU, whose compiler makes vector instructions of the loops. The arithmetic of
// each sample and the order of the sums are the same, and so is every bit.
inline bool AddUpBySteps(const ReferencePatch& patch,
                         const PlaneHomography& homography,
                         const ImageView<const float>& other,
                         float center,
                         PatchSums* sums) {
  const float* h = homography.h;
  float x[kPatchSize];
  float y[kPatchSize];
  float z[kPatchSize];
  for (int i = 0; i < kPatchSize; ++i) {
    const float u = patch.center_x + patch.OffsetX(i);
    const float v = patch.center_y + patch.OffsetY(i);
    z[i] = h[6] * u + h[7] * v + h[8];
    const float inverse = 1.f / z[i];
    x[i] = (h[0] * u + h[1] * v + h[2]) * inverse;
    y[i] = (h[3] * u + h[4] * v + h[5]) * inverse;
  }
  // Rounding keeps the order of numbers, so that z is smallest in a corner.
  for (const int corner :
       {0, kPatchSide - 1, kPatchSize - kPatchSide, kPatchSize - 1}) {
    if (!(z[corner] > 0.f)) {
      return false;
    }
  }
  float value[kPatchSize];
  SampleBilinearBySteps(other, x, y, value);
  float weighted[kPatchSize];
  float square[kPatchSize];
  float product[kPatchSize];
  for (int i = 0; i < kPatchSize; ++i) {
    const float difference = value[i] - center;
    weighted[i] = patch.weight[i] * difference;
    square[i] = weighted[i] * difference;
    product[i] = weighted[i] * patch.value[i];
  }
  for (int i = 0; i < kPatchSize; ++i) {
    sums->Add(weighted[i], square[i], product[i]);
  }
  return true;
}

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
  PatchSums sums;
#ifdef __CUDA_ARCH__
  const bool is_seen = AddUpBySamples(patch, homography, other, center, &sums);
#else
  const bool is_seen = AddUpBySteps(patch, homography, other, center, &sums);
#endif
  if (!is_seen) {
    return kUndefinedCost;
  }
  const float variance = sums.squares - sums.values * sums.values;
  if (!(variance >= kMinPatchVariance)) {
    return kUndefinedCost;
  }
  const float covariance = sums.products - sums.values * patch.mean;
  const float ncc = covariance / sqrtf(variance * patch.variance);
  return fminf(fmaxf(1.f - ncc, 0.f), 2.f);
}

}  // namespace tsar
