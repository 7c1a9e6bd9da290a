// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/base/avx2.h"
#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/matching/sample_gray.cuh"

#include <cmath>
#include <cstdint>

namespace tsar {

// Windows have 11 x 11 pixels, of which every second row and column is sampled.
// Windows of another radius have as many samples with another spacing.
constexpr float kPatchRadius = 5.f;
constexpr int kPatchSide = 6;
constexpr int kPatchSize = kPatchSide * kPatchSide;

// Widths of the bilateral weights, those of COLMAP: the window's radius in
// pixels, and 0.2 of the range of gray levels.
constexpr float kPatchSpatialSigma = 5.f;
constexpr float kPatchColorSigma = 51.f;

// The least weighted variance of a textured window, in squared gray levels;
// below it, only 8-bit quantization noise remains.
constexpr float kMinPatchVariance = 0.65f;

// The reference's window with its bilateral weights, gathered once and compared
// with every source. Values are relative to the center, which keeps the sums of
// squares small; values and weights have 16 bits each, so that a GPU keeps a
// sample in one word, which avoids stalls on loads.
class ReferencePatch {
 public:
  // The unit of values, in gray levels.
  static constexpr float kValueUnit = 1.f / 64.f;

  TSAR_HD ReferencePatch(const GrayView& gray,
                         float x,
                         float y,
                         float window_radius = kPatchRadius)
      : center_x(x),
        center_y(y),
        radius(window_radius),
        half_step(window_radius / (kPatchSide - 1)) {
    const float spatial_sigma = kPatchSpatialSigma * radius / kPatchRadius;
    // In texture coordinates.
    const float texture_x = x + 0.5f;
    const float texture_y = y + 0.5f;
    const float center = SampleGray(gray, texture_x, texture_y);
    // On a CPU each step is a separate loop, as in AddUpBySteps.
#ifdef __CUDA_ARCH__
    for (int i = 0; i < kPatchSize; ++i) {
      const float value =
          SampleGray(gray, texture_x + OffsetX(i), texture_y + OffsetY(i)) -
          center;
      samples_[i] = Pack(InUnits(value), Weight(i, value, spatial_sigma));
    }
#else
    float sample_x[kPatchSize];
    float sample_y[kPatchSize];
    for (int i = 0; i < kPatchSize; ++i) {
      sample_x[i] = texture_x + OffsetX(i);
      sample_y[i] = texture_y + OffsetY(i);
    }
    SampleGrayBySteps(gray, sample_x, sample_y, values_);
    for (int i = 0; i < kPatchSize; ++i) {
      values_[i] -= center;
    }
    for (int i = 0; i < kPatchSize; ++i) {
      weights_[i] = Weight(i, values_[i], spatial_sigma);
    }
    for (int i = 0; i < kPatchSize; ++i) {
      values_[i] = InUnits(values_[i]);
    }
#endif
    float sum_weights = 0.f;
    float sum = 0.f;
    float sum_squares = 0.f;
    for (int i = 0; i < kPatchSize; ++i) {
      const Sample sample = At(i);
      const float weighted = sample.weight * sample.value;
      sum_weights += sample.weight;
      sum += weighted;
      sum_squares += weighted * sample.value;
    }
    inverse_sum_weights = 1.f / sum_weights;
    mean = sum * inverse_sum_weights;
    variance = sum_squares * inverse_sum_weights - mean * mean;
  }

  // Offset of a sample from the center, in pixels.
  TSAR_HD float OffsetX(int i) const { return Offset(i % kPatchSide); }
  TSAR_HD float OffsetY(int i) const { return Offset(i / kPatchSide); }
  TSAR_HD float Offset(int column_or_row) const {
    return static_cast<float>(2 * column_or_row - (kPatchSide - 1)) * half_step;
  }

  struct Sample {
    float value;   // In kValueUnit, relative to the center.
    float weight;  // Up to kMaxWeight.
  };
  TSAR_HD Sample At(int i) const {
#ifdef __CUDA_ARCH__
    // The halves become the last bits of 2^23: a permutation and a subtraction
    // are faster than a conversion.
    constexpr float kRaise = 8388608.f;
    constexpr uint32_t kRaiseBits = 0x4B000000u;
    return {
        __uint_as_float(__byte_perm(samples_[i], kRaiseBits, 0x7410)) -
            (kRaise + kValueOffset),
        __uint_as_float(__byte_perm(samples_[i], kRaiseBits, 0x7432)) - kRaise};
#else
    return {values_[i], weights_[i]};
#endif
  }
  TSAR_HD float GrayVariance() const {
    return variance * (kValueUnit * kValueUnit);
  }
  TSAR_HD bool HasTexture() const {
    return GrayVariance() >= kMinPatchVariance;
  }

  float center_x;
  float center_y;
  float radius;
  float half_step;  // Half the spacing of the samples.
  float inverse_sum_weights;
  float mean;      // In kValueUnit.
  float variance;  // In kValueUnit squared.

 private:
  static constexpr float kMaxWeight = 65535.f;
  static constexpr float kMaxValue = 32767.f;
  static constexpr float kValueOffset = 32768.f;

  TSAR_HD static float InUnits(float value) {
    const float rounded = RoundToNearest(value * (1.f / kValueUnit));
    return fminf(fmaxf(rounded, -kMaxValue), kMaxValue);
  }

  // The bilateral weight of a sample.
  TSAR_HD float Weight(int i, float value, float spatial_sigma) const {
    const float dx = OffsetX(i);
    const float dy = OffsetY(i);
    return RoundToNearest(
        kMaxWeight *
        ExpOfNegative(
            -(dx * dx + dy * dy) / (2.f * spatial_sigma * spatial_sigma) -
            value * value / (2.f * kPatchColorSigma * kPatchColorSigma)));
  }

#ifdef __CUDA_ARCH__
  __device__ static uint32_t Pack(float value, float weight) {
    const int value_bits =
        IntegerBesideRounder(value + kValueOffset + kRounder);
    const int weight_bits = IntegerBesideRounder(weight + kRounder);
    return static_cast<uint32_t>(weight_bits) << 16 |
           static_cast<uint32_t>(value_bits);
  }

  uint32_t samples_[kPatchSize];
#else
  float values_[kPatchSize];
  float weights_[kPatchSize];
#endif
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
    const float per_fx = 1.f / first.fx;
    const float per_fy = 1.f / first.fy;
    const auto set_row = [&](int row, const Vec3f& m) {
      h[3 * row] = m.x * per_fx;
      h[3 * row + 1] = m.y * per_fy;
      h[3 * row + 2] = m.z - h[3 * row] * first.cx - h[3 * row + 1] * first.cy;
    };
    set_row(0, second.fx * a + second.cx * c);
    set_row(1, second.fy * b + second.cy * c);
    set_row(2, c);
  }
};

// The homography about the center of a window: it maps the position at (dx, dy)
// from the center to
//   x + (x_dx dx + x_dy dy) / (1 + z_dx dx + z_dy dy), and y likewise,
// where the denominator is the depth in the second camera, relative to that of
// the center.
struct WindowHomography {
  float x = -1.f;
  float y = -1.f;
  float x_dx = 0.f;
  float x_dy = 0.f;
  float y_dx = 0.f;
  float y_dy = 0.f;
  float z_dx = 0.f;
  float z_dy = 0.f;
  // Whether center and window lie before the second camera, the depth changing
  // by less than a half in the window: beyond that, the view is grazing.
  bool is_seen = false;

  TSAR_HD WindowHomography(const PlaneHomography& homography,
                           float center_x,
                           float center_y,
                           float radius) {
    constexpr float kMaxChange = 0.5f;
    const float* h = homography.h;
    const float z = h[6] * center_x + h[7] * center_y + h[8];
    if (!(z > 0.f)) {
      return;
    }
    const float inverse = 1.f / z;
    x = (h[0] * center_x + h[1] * center_y + h[2]) * inverse;
    y = (h[3] * center_x + h[4] * center_y + h[5]) * inverse;
    z_dx = h[6] * inverse;
    z_dy = h[7] * inverse;
    x_dx = h[0] * inverse - x * z_dx;
    x_dy = h[1] * inverse - x * z_dy;
    y_dx = h[3] * inverse - y * z_dx;
    y_dy = h[4] * inverse - y * z_dy;
    is_seen = (fabsf(z_dx) + fabsf(z_dy)) * radius <= kMaxChange;
  }

  // Maps the position at (dx, dy) from the center.
  TSAR_HD void Map(float dx, float dy, float* mapped_x, float* mapped_y) const {
    const float scale = Reciprocal(MultiplyAdd(z_dx, dx, z_dy * dy));
    *mapped_x = MultiplyAdd(MultiplyAdd(x_dx, dx, x_dy * dy), scale, x);
    *mapped_y = MultiplyAdd(MultiplyAdd(y_dx, dx, y_dy * dy), scale, y);
  }

  // The same that maps to texture coordinates, half a pixel further.
  TSAR_HD WindowHomography InTexture() const {
    WindowHomography shifted = *this;
    shifted.x += 0.5f;
    shifted.y += 0.5f;
    return shifted;
  }

  // 1 / (1 + change) by its series, with an error of 4e-4 for planes seen at up
  // to 80 degrees, and 6e-2 at the largest change.
  TSAR_HD static float Reciprocal(float change) {
    return MultiplyAdd(-change, MultiplyAdd(-change, 1.f - change, 1.f), 1.f);
  }
};

// The sums over the samples of a patch in another image, whose values are
// relative to the center there.
struct PatchSums {
  float values = 0.f;
  float squares = 0.f;
  float products = 0.f;  // Products with the patch's values.

  // weighted: the difference from the center times the sample's weight.
  TSAR_HD void Add(float difference, float weighted, float patch_value) {
    values += weighted;
    squares = MultiplyAdd(weighted, difference, squares);
    products = MultiplyAdd(weighted, patch_value, products);
  }
  // Sums of rows are added, since a CPU computes these side by side.
  TSAR_HD PatchSums& operator+=(const PatchSums& row) {
    values += row.values;
    squares += row.squares;
    products += row.products;
    return *this;
  }
};

// Sums sample by sample: the form for a GPU, where each thread has a patch and
// keeps a sample in registers.
TSAR_HD inline PatchSums AddUpBySamples(const ReferencePatch& patch,
                                        const WindowHomography& window,
                                        const GrayView& other) {
  const WindowHomography to_texture = window.InTexture();
  const float center =
      RoundToNearest(SampleGray(other, to_texture.x, to_texture.y));
  PatchSums sums;
  // Rows are not unrolled, since they would exceed a GPU's instruction cache.
#ifdef __CUDA_ARCH__
#pragma unroll 1
#endif
  for (int row = 0; row < kPatchSide; ++row) {
    const float dy = patch.Offset(row);
    PatchSums of_row;
    for (int column = 0; column < kPatchSide; ++column) {
      float x = 0.f;
      float y = 0.f;
      to_texture.Map(patch.Offset(column), dy, &x, &y);
      const float difference = SampleGray(other, x, y) - center;
      const ReferencePatch::Sample sample = patch.At(row * kPatchSide + column);
      of_row.Add(difference, sample.weight * difference, sample.value);
    }
    sums += of_row;
  }
  return sums;
}

// AddUpBySamples() step by step, each for all samples: the form for a CPU,
// whose compiler vectorizes the loops. The arithmetic of each sample and the
// order of the sums are the same, so that results are bit-identical.
inline PatchSums AddUpBySteps(const ReferencePatch& patch,
                              const WindowHomography& window,
                              const GrayView& other) {
  const WindowHomography to_texture = window.InTexture();
  const float center =
      RoundToNearest(SampleGray(other, to_texture.x, to_texture.y));
  float x[kPatchSize];
  float y[kPatchSize];
  for (int i = 0; i < kPatchSize; ++i) {
    to_texture.Map(patch.OffsetX(i), patch.OffsetY(i), &x[i], &y[i]);
  }
  float difference[kPatchSize];
  SampleGrayBySteps(other, x, y, difference);
  float weighted[kPatchSize];
  for (int i = 0; i < kPatchSize; ++i) {
    difference[i] -= center;
    weighted[i] = patch.At(i).weight * difference[i];
  }
  PatchSums sums;
  for (int row = 0; row < kPatchSize; row += kPatchSide) {
    PatchSums of_row;
    for (int i = row; i < row + kPatchSide; ++i) {
      of_row.Add(difference[i], weighted[i], patch.At(i).value);
    }
    sums += of_row;
  }
  return sums;
}

// AddUpBySteps() for AVX2; must be called only if HasAvx2().
TSAR_FOR_AVX2 inline PatchSums AddUpByStepsForAvx2(
    const ReferencePatch& patch,
    const WindowHomography& window,
    const GrayView& other) {
  return AddUpBySteps(patch, window, other);
}

// The form for this machine.
TSAR_HD inline PatchSums AddUp(const ReferencePatch& patch,
                               const WindowHomography& window,
                               const GrayView& other) {
// The sanitizer checks each access to the steps' arrays, which would dominate
// the time of all tests.
#if defined(__CUDA_ARCH__) || defined(__SANITIZE_ADDRESS__)
  return AddUpBySamples(patch, window, other);
#else
  return HasAvx2() ? AddUpByStepsForAvx2(patch, window, other)
                   : AddUpBySteps(patch, window, other);
#endif
}

// 1 - NCC of the patch and its image under the homography, in [0, 2], or
// kUndefinedCost.
TSAR_HD inline float PatchCost(const ReferencePatch& patch,
                               const PlaneHomography& homography,
                               const GrayView& other) {
  if (!patch.HasTexture()) {
    return kUndefinedCost;
  }
  const WindowHomography window(
      homography, patch.center_x, patch.center_y, patch.radius);
  // A tolerance of half a pixel: a pixel on the border that is mapped forth and
  // back may be off by a rounding error.
  if (!window.is_seen || !(window.x >= -0.5f) || !(window.y >= -0.5f) ||
      !(window.x <= other.width - 0.5f) || !(window.y <= other.height - 0.5f)) {
    return kUndefinedCost;
  }
  const PatchSums sums = AddUp(patch, window, other);
  const float mean = sums.values * patch.inverse_sum_weights;
  const float variance = sums.squares * patch.inverse_sum_weights - mean * mean;
  if (!(variance >= kMinPatchVariance)) {
    return kUndefinedCost;
  }
  const float covariance =
      sums.products * patch.inverse_sum_weights - mean * patch.mean;
  const float ncc = covariance / sqrtf(variance * patch.variance);
  return fminf(fmaxf(1.f - ncc, 0.f), 2.f);
}

// The same of a plane of the reference in the image of a source.
TSAR_HD inline float PatchCost(const ReferencePatch& patch,
                               const Intrinsics& reference,
                               const SourceView& source,
                               const Plane& plane) {
  return PatchCost(
      patch,
      PlaneHomography(
          reference, source.intrinsics, source.from_reference, plane),
      source.gray);
}

}  // namespace tsar
