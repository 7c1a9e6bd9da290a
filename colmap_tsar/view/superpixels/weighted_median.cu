// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/weighted_median.h"

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/view/superpixels/bilateral_kernel.cuh"

#include <cfloat>
#include <cmath>

namespace tsar {
namespace {

// Taps whose depth is within this fraction of the median share its surface.
constexpr float kSameSurface = 0.01f;

struct WeightedMedianKernel {
  DepthNormalViews input;
  ImageView<const Rgb> color;
  ImageView<const uint8_t> where;
  Intrinsics intrinsics;
  float min_support;
  BilateralKernel taps;
  ImageView<float> depth;
  ImageView<Vec3f> normal;

  TSAR_HD void operator()(int x, int y) const {
    depth(x, y) = 0.f;
    normal(x, y) = {};
    if (where.data != nullptr && where(x, y) == 0) {
      return;
    }
    // This test alone rejects most holes that are too wide.
    if (!IsSupported(x, y)) {
      return;
    }
    float depths[kNumTaps];
    float weights[kNumTaps];
    uint8_t indices[kNumTaps];
    int count = 0;
    float total = 0.f;
    const Vec3f ray = intrinsics.Ray(x, y);
    const Rgb center = color(x, y);
    for (int tap = 0; tap < kNumTaps; ++tap) {
      const int column = x + Column(tap) * taps.stride;
      const int row = y + Row(tap) * taps.stride;
      const float tap_depth =
          depth.Contains(column, row) ? input.depth(column, row) : 0.f;
      if (!(tap_depth > 0.f)) {
        continue;
      }
      const float weight =
          taps.Weight(Column(tap), Row(tap), center, color(column, row));
      if (weight == 0.f) {
        continue;
      }
      const Plane plane = Plane::FromPoint(
          intrinsics.Ray(column, row), tap_depth, input.normal(column, row));
      const float depth_here = plane.Valid() ? plane.Depth(ray) : 0.f;
      if (!(depth_here > 0.f && depth_here <= FLT_MAX)) {
        continue;
      }
      depths[count] = depth_here;
      weights[count] = weight;
      indices[count] = static_cast<uint8_t>(tap);
      total += weight;
      ++count;
    }
    if (count == 0) {
      return;
    }
    const float median = WeightedMedian(depths, weights, indices, count, total);
    Vec3f sum;
    for (int i = 0; i < count; ++i) {
      if (fabsf(depths[i] - median) <= kSameSurface * median) {
        sum = sum + input.normal(x + Column(indices[i]) * taps.stride,
                                 y + Row(indices[i]) * taps.stride) *
                        weights[i];
      }
    }
    depth(x, y) = median;
    normal(x, y) = Normalized(sum);
  }

  // Whether enough of the taps inside the image hold a depth.
  TSAR_HD bool IsSupported(int x, int y) const {
    int num_inside = 0;
    int num_supported = 0;
    for (int tap = 0; tap < kNumTaps; ++tap) {
      const int column = x + Column(tap) * taps.stride;
      const int row = y + Row(tap) * taps.stride;
      if (depth.Contains(column, row)) {
        ++num_inside;
        num_supported += input.depth(column, row) > 0.f ? 1 : 0;
      }
    }
    return num_supported >= min_support * num_inside;
  }

  TSAR_HD static int Column(int tap) { return tap % kTapSide - kTapRadius; }
  TSAR_HD static int Row(int tap) { return tap / kTapSide - kTapRadius; }

  // Quickselect: partitions around the middle one of three and goes on in the
  // part that holds half of the weight.
  TSAR_HD static float WeightedMedian(
      float* depths, float* weights, uint8_t* indices, int count, float total) {
    int low = 0;
    int high = count - 1;
    float below = 0.f;  // Weight of the elements before low.
    while (low < high) {
      const float a = depths[low];
      const float b = depths[(low + high) / 2];
      const float c = depths[high];
      const float pivot = fmaxf(fminf(a, b), fminf(fmaxf(a, b), c));
      int i = low;
      int j = high;
      while (i <= j) {
        while (depths[i] < pivot) {
          ++i;
        }
        while (depths[j] > pivot) {
          --j;
        }
        if (i <= j) {
          Swap(depths, i, j);
          Swap(weights, i, j);
          Swap(indices, i, j);
          ++i;
          --j;
        }
      }
      // Now [low, j] <= pivot <= [i, high], and elements between equal it.
      float left = below;
      for (int k = low; k <= j; ++k) {
        left += weights[k];
      }
      float middle = left;
      for (int k = j + 1; k < i; ++k) {
        middle += weights[k];
      }
      if (left >= 0.5f * total) {
        high = j;
      } else if (middle >= 0.5f * total) {
        return pivot;
      } else {
        below = middle;
        low = i;
      }
    }
    return depths[low];
  }

  template <typename T>
  TSAR_HD static void Swap(T* values, int i, int j) {
    const T value = values[i];
    values[i] = values[j];
    values[j] = value;
  }
};

}  // namespace

DepthNormalImages WeightedMedianFilter(const DepthNormalViews& input,
                                       ImageView<const Rgb> color,
                                       ImageView<const uint8_t> where,
                                       const Intrinsics& intrinsics,
                                       const WeightedMedianOptions& options,
                                       Device& device) {
  DepthNormalImages output(device, input.depth.width, input.depth.height);
  const BilateralKernelTable table(options, device);
  ParallelFor(device,
              input.depth.width,
              input.depth.height,
              WeightedMedianKernel{input,
                                   color,
                                   where,
                                   intrinsics,
                                   options.min_support,
                                   table.Taps(),
                                   output.depth.View(),
                                   output.normal.View()});
  return output;
}

}  // namespace tsar
