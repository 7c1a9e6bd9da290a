// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/refinement/weighted_median.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <vector>

namespace tsar {
namespace {

constexpr int kTapRadius = 5;
constexpr int kMaxTaps = (2 * kTapRadius + 1) * (2 * kTapRadius + 1);
// Taps that weigh less than this change no median.
constexpr float kMinWeight = 1e-3f;
// Taps whose depth is within this fraction of the median share its surface.
constexpr float kSameSurface = 0.01f;

// exp(-|difference| / beta^2) by the squared colour difference, up to where it
// falls under kMinWeight.
std::vector<float> MakeColorTable(float sigma) {
  const float limit = -std::log(kMinWeight) * sigma * sigma;
  const int size =
      static_cast<int>(std::min(limit * limit, 3.f * 255.f * 255.f)) + 1;
  std::vector<float> table(size);
  for (int i = 0; i < size; ++i) {
    table[i] = std::exp(-std::sqrt(static_cast<float>(i)) / (sigma * sigma));
  }
  return table;
}

struct WeightedMedianKernel {
  DepthNormalViews input;
  ImageView<const Rgb> color;
  ImageView<const uint8_t> where;
  Intrinsics intrinsics;
  WeightedMedianOptions options;
  int stride;
  const float* color_weights;
  int num_color_weights;
  ImageView<float> depth;
  ImageView<Vec3f> normal;

  TSAR_HD void operator()(int x, int y) const {
    depth(x, y) = 0.f;
    normal(x, y) = {};
    if (where.data != nullptr && where(x, y) == 0) {
      return;
    }
    float depths[kMaxTaps];
    float weights[kMaxTaps];
    uint8_t taps[kMaxTaps];
    int count = 0;
    int num_inside = 0;
    int num_supported = 0;
    float total = 0.f;
    const Vec3f ray = intrinsics.Ray(x, y);
    const Rgb center = color(x, y);
    for (int tap = 0; tap < kMaxTaps; ++tap) {
      const int column = x + Offset(tap % (2 * kTapRadius + 1));
      const int row = y + Offset(tap / (2 * kTapRadius + 1));
      if (!depth.Contains(column, row)) {
        continue;
      }
      ++num_inside;
      const float tap_depth = input.depth(column, row);
      if (!(tap_depth > 0.f)) {
        continue;
      }
      ++num_supported;
      const float weight = Weight(tap, center, color(column, row));
      if (weight < kMinWeight) {
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
      taps[count] = static_cast<uint8_t>(tap);
      total += weight;
      ++count;
    }
    if (count == 0 || num_supported < options.min_support * num_inside) {
      return;
    }
    const float median = WeightedMedian(depths, weights, taps, count, total);
    Vec3f sum;
    for (int i = 0; i < count; ++i) {
      if (fabsf(depths[i] - median) <= kSameSurface * median) {
        const int column = x + Offset(taps[i] % (2 * kTapRadius + 1));
        const int row = y + Offset(taps[i] / (2 * kTapRadius + 1));
        sum = sum + input.normal(column, row) * weights[i];
      }
    }
    depth(x, y) = median;
    normal(x, y) = Normalized(sum);
  }

  TSAR_HD int Offset(int i) const { return (i - kTapRadius) * stride; }

  TSAR_HD float Weight(int tap, const Rgb& a, const Rgb& b) const {
    const int dr = a.r - b.r;
    const int dg = a.g - b.g;
    const int db = a.b - b.b;
    const int squared = dr * dr + dg * dg + db * db;
    if (squared >= num_color_weights) {
      return 0.f;
    }
    const float dx =
        static_cast<float>(tap % (2 * kTapRadius + 1) - kTapRadius);
    const float dy =
        static_cast<float>(tap / (2 * kTapRadius + 1) - kTapRadius);
    return color_weights[squared] *
           expf(-sqrtf(dx * dx + dy * dy) /
                (options.spatial_sigma * options.spatial_sigma));
  }

  // Quickselect: partitions around the middle one of three and goes on in the
  // part that holds half of the weight.
  TSAR_HD static float WeightedMedian(
      float* depths, float* weights, uint8_t* taps, int count, float total) {
    int low = 0;
    int high = count - 1;
    float below = 0.f;  // Weight of what lies before low.
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
          Swap(taps, i, j);
          ++i;
          --j;
        }
      }
      // Now [low, j] <= pivot <= [i, high], and what is between equals it.
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
  const Buffer<float> color_weights(device,
                                    MakeColorTable(options.color_sigma));
  const int stride =
      std::max(1, static_cast<int>(std::lround(options.radius / kTapRadius)));
  ParallelFor(device,
              input.depth.width,
              input.depth.height,
              WeightedMedianKernel{input,
                                   color,
                                   where,
                                   intrinsics,
                                   options,
                                   stride,
                                   color_weights.Data(),
                                   static_cast<int>(color_weights.Size()),
                                   output.depth.View(),
                                   output.normal.View()});
  return output;
}

}  // namespace tsar
