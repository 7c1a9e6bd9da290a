// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/noise/denoise.h"

#include "colmap_tsar/device/parallel_for.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace tsar {
namespace {

// Both kernels do the same arithmetic in the same order. The image repeats its
// border.
struct Denoising {
  ImageView<const Rgb> color;
  ImageView<const float> gray;
  NoiseCurve noise;
  DenoiseOptions options;
  ImageView<Rgb> denoised;

  TSAR_HD static int Clamp(int i, int size) {
    return i < 0 ? 0 : (i < size ? i : size - 1);
  }
  TSAR_HD int Column(int x) const { return Clamp(x, gray.width); }
  TSAR_HD int Row(int y) const { return Clamp(y, gray.height); }

  // From the mean squared difference of two patches; two samples of noise
  // differ by twice its variance.
  TSAR_HD static float Weight(float difference,
                              float expected,
                              float per_excess) {
    const float excess = difference - expected;
    // Not exp(), which the devices round differently.
    const float likeness = 1.f - (excess > 0.f ? excess : 0.f) * per_excess;
    return likeness > 0.f ? likeness * likeness : 0.f;
  }
  TSAR_HD float Expected(float level) const {
    return 2.f * noise.Variance(level);
  }
  TSAR_HD float PerExcess(float level) const {
    return 1.f / (options.strength * noise.Variance(level));
  }
  TSAR_HD float PerPixelOfPatch() const {
    const int side = 2 * options.patch_radius + 1;
    return 1.f / static_cast<float>(side * side);
  }
  TSAR_HD static uint8_t Level(float level) {
    return static_cast<uint8_t>(level + 0.5f);
  }
};

// The form for a GPU: one pixel.
struct DenoisePixelKernel : Denoising {
  TSAR_HD void operator()(int x, int y) const {
    const float expected = Expected(gray(x, y));
    const float per_excess = PerExcess(gray(x, y));
    const float per_pixel = PerPixelOfPatch();
    float r = 0.f;
    float g = 0.f;
    float b = 0.f;
    float sum = 0.f;
    const int reach = options.search_radius;
    for (int v = -reach; v <= reach; ++v) {
      for (int u = -reach; u <= reach; ++u) {
        const float weight = Weight(
            Difference(x, y, u, v) * per_pixel, expected, per_excess);
        const Rgb& other = color(Column(x + u), Row(y + v));
        r += weight * other.r;
        g += weight * other.g;
        b += weight * other.b;
        sum += weight;
      }
    }
    denoised(x, y) = {Level(r / sum), Level(g / sum), Level(b / sum)};
  }

  TSAR_HD float Difference(int x, int y, int u, int v) const {
    const int radius = options.patch_radius;
    float sum = 0.f;
    for (int i = -radius; i <= radius; ++i) {
      float of_column = 0.f;
      for (int j = -radius; j <= radius; ++j) {
        const float difference = gray(Column(x + i), Row(y + j)) -
                                 gray(Column(x + u + i), Row(y + v + j));
        of_column += difference * difference;
      }
      sum += of_column;
    }
    return sum;
  }
};

// The form for a CPU: one row, offset by offset, so that the compiler makes
// vector instructions of the loops and each difference is computed once.
struct DenoiseRowKernel : Denoising {
  void operator()(int64_t row) const {
    const int y = static_cast<int>(row);
    const int reach = options.search_radius;
    const int radius = options.patch_radius;
    const int margin = reach + radius;
    const auto width = static_cast<size_t>(gray.width);
    // Rows of the image with a margin on either side.
    const size_t padded_width = width + 2 * static_cast<size_t>(margin);
    const int num_rows = 2 * margin + 1;
    std::vector<float> levels(padded_width * static_cast<size_t>(num_rows));
    std::vector<float> channels[3];
    for (std::vector<float>& channel : channels) {
      channel.resize(levels.size());
    }
    for (int j = 0; j < num_rows; ++j) {
      for (size_t i = 0; i < padded_width; ++i) {
        const int u = Column(static_cast<int>(i) - margin);
        const int v = Row(y + j - margin);
        const size_t at = static_cast<size_t>(j) * padded_width + i;
        levels[at] = gray(u, v);
        channels[0][at] = color(u, v).r;
        channels[1][at] = color(u, v).g;
        channels[2][at] = color(u, v).b;
      }
    }
    std::vector<float> expected(width);
    std::vector<float> per_excess(width);
    for (size_t x = 0; x < width; ++x) {
      expected[x] = Expected(gray(static_cast<int>(x), y));
      per_excess[x] = PerExcess(gray(static_cast<int>(x), y));
    }
    const float per_pixel = PerPixelOfPatch();
    const size_t patch_side = 2 * static_cast<size_t>(radius) + 1;
    const size_t num_columns = width + patch_side - 1;
    std::vector<float> columns(num_columns);
    std::vector<float> weights(width);
    std::vector<float> sums[4];
    for (std::vector<float>& sum : sums) {
      sum.resize(width);
    }
    const auto row_at = [&](int j) {
      return static_cast<size_t>(j) * padded_width;
    };
    for (int v = -reach; v <= reach; ++v) {
      for (int u = -reach; u <= reach; ++u) {
        std::fill(columns.begin(), columns.end(), 0.f);
        for (int j = -radius; j <= radius; ++j) {
          const float* own = &levels[row_at(margin + j)] + reach;
          const float* other = &levels[row_at(margin + v + j)] + reach + u;
          for (size_t i = 0; i < num_columns; ++i) {
            const float difference = own[i] - other[i];
            columns[i] += difference * difference;
          }
        }
        std::fill(weights.begin(), weights.end(), 0.f);
        for (size_t i = 0; i < patch_side; ++i) {
          for (size_t x = 0; x < width; ++x) {
            weights[x] += columns[x + i];
          }
        }
        for (size_t x = 0; x < width; ++x) {
          weights[x] =
              Weight(weights[x] * per_pixel, expected[x], per_excess[x]);
        }
        const size_t from = row_at(margin + v) +
                            static_cast<size_t>(margin + u);
        for (int c = 0; c < 3; ++c) {
          const float* channel = &channels[c][from];
          float* sum = sums[c].data();
          for (size_t x = 0; x < width; ++x) {
            sum[x] += weights[x] * channel[x];
          }
        }
        for (size_t x = 0; x < width; ++x) {
          sums[3][x] += weights[x];
        }
      }
    }
    for (size_t x = 0; x < width; ++x) {
      denoised(static_cast<int>(x), y) = {Level(sums[0][x] / sums[3][x]),
                                          Level(sums[1][x] / sums[3][x]),
                                          Level(sums[2][x] / sums[3][x])};
    }
  }
};

}  // namespace

DeviceImage<Rgb> Denoise(ImageView<const Rgb> color,
                         ImageView<const float> gray,
                         const NoiseCurve& noise,
                         const DenoiseOptions& options,
                         Device& device) {
  DeviceImage<Rgb> denoised(device, color.width, color.height);
  const Denoising denoising{color, gray, noise, options, denoised.View()};
  if (device.IsCuda()) {
    ParallelFor(
        device, color.width, color.height, DenoisePixelKernel{denoising});
  } else {
    const DenoiseRowKernel kernel{denoising};
    device.Threads().Run(color.height, [&](int64_t begin, int64_t end) {
      for (int64_t row = begin; row < end; ++row) {
        kernel(row);
      }
    });
  }
  return denoised;
}

}  // namespace tsar
