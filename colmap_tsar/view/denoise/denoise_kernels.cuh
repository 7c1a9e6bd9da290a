// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Non-local means in two forms that give the same bits: one pixel per thread
// for a GPU, a band of rows, offset by offset, for a CPU. Border pixels are
// repeated outside the image.

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/view/denoise/estimate_noise.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tsar {

struct Denoising {
  // Patches are squares of this radius.
  static constexpr int kPatchRadius = 2;
  // The largest offset, in rows and columns, of the pixels that are averaged
  // with a pixel if the patches around both are similar.
  static constexpr int kSearchRadius = 5;
  // Patches whose mean squared difference exceeds that of noise by this many
  // variances of the noise are not similar: their weight is 0.
  static constexpr float kStrength = 4.f;

  ImageView<const Rgb> color;
  ImageView<const float> gray;
  NoiseCurve noise;
  ImageView<Rgb> denoised;

  TSAR_HD static int Clamp(int i, int size) {
    return i < 0 ? 0 : (i < size ? i : size - 1);
  }
  TSAR_HD int Column(int x) const { return Clamp(x, gray.width); }
  TSAR_HD int Row(int y) const { return Clamp(y, gray.height); }

  // The gray level rounded to an integer number of half levels: sums of squared
  // differences of integers are exact and do not depend on the order.
  TSAR_HD float HalfLevels(int x, int y) const {
    return static_cast<float>(
        static_cast<int>(2.f * gray(Column(x), Row(y)) + 0.5f));
  }
  TSAR_HD static float SquaredDifference(float a, float b) {
    return (a - b) * (a - b);
  }

  // The factor from the summed squared differences of two patches to variances
  // of the noise per pixel, in units of strength.
  TSAR_HD float Scale(int x, int y) const {
    constexpr int kSide = 2 * kPatchRadius + 1;
    return 1.f / (static_cast<float>(4 * kSide * kSide) * kStrength *
                  noise.Variance(gray(x, y)));
  }
  // Two samples of noise differ by twice its variance: patches that differ by
  // no more are alike, those that differ by strength variances more are not.
  // exp() is avoided, since the devices round it differently.
  TSAR_HD static float Weight(float differences, float scale, float expected) {
    const float unlikeness = Positive(differences * scale - expected);
    const float likeness = Positive(1.f - unlikeness);
    return likeness * likeness;
  }
  TSAR_HD float Expected() const { return 2.f / kStrength; }
  // max(value, 0), exactly; from two comparisons in a row, the compiler would
  // make jumps instead of vector instructions.
  TSAR_HD static float Positive(float value) {
    return 0.5f * (value + fabsf(value));
  }

  TSAR_HD static uint8_t Level(float level) {
    return static_cast<uint8_t>(level + 0.5f);
  }
};

struct DenoisePixelKernel : Denoising {
  TSAR_HD void operator()(int x, int y) const {
    const float scale = Scale(x, y);
    const float expected = Expected();
    float r = 0.f;
    float g = 0.f;
    float b = 0.f;
    float sum = 0.f;
    const int reach = kSearchRadius;
    for (int v = -reach; v <= reach; ++v) {
      for (int u = -reach; u <= reach; ++u) {
        const float weight = Weight(Differences(x, y, u, v), scale, expected);
        const Rgb& other = color(Column(x + u), Row(y + v));
        r += weight * static_cast<float>(other.r);
        g += weight * static_cast<float>(other.g);
        b += weight * static_cast<float>(other.b);
        sum += weight;
      }
    }
    denoised(x, y) = {Level(r / sum), Level(g / sum), Level(b / sum)};
  }

  TSAR_HD float Differences(int x, int y, int u, int v) const {
    float sum = 0.f;
    for (int j = y - kPatchRadius; j <= y + kPatchRadius; ++j) {
      for (int i = x - kPatchRadius; i <= x + kPatchRadius; ++i) {
        sum += SquaredDifference(HalfLevels(i, j), HalfLevels(i + u, j + v));
      }
    }
    return sum;
  }
};

// Denoises a band of rows. The compiler vectorizes the loops over a row.
class DenoiseBandKernel : Denoising {
 public:
  // The largest number of rows of a band, so that the data read and written for
  // each offset stay in the cache.
  static constexpr int kMaxRows = 16;

  explicit DenoiseBandKernel(const Denoising& denoising)
      : Denoising(denoising),
        margin_(kSearchRadius + kPatchRadius),
        levels_(PaddedBand()),
        red_(PaddedBand()),
        green_(PaddedBand()),
        blue_(PaddedBand()),
        scale_(Band()),
        columns_(Image<float>::Uninitialized(gray.width + 2 * kPatchRadius, 1)),
        red_sum_(Band()),
        green_sum_(Band()),
        blue_sum_(Band()),
        weight_sum_(Band()) {}

  void operator()(int begin, int end) {
    Load(begin, end);
    const int reach = kSearchRadius;
    for (int v = -reach; v <= reach; ++v) {
      for (int u = -reach; u <= reach; ++u) {
        for (int row = 0; row < end - begin; ++row) {
          SumColumns(row, u, v);
          AddWeighted(row, u, v);
        }
      }
    }
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < gray.width; ++x) {
        const float sum = weight_sum_(x, y - begin);
        denoised(x, y) = {Level(red_sum_(x, y - begin) / sum),
                          Level(green_sum_(x, y - begin) / sum),
                          Level(blue_sum_(x, y - begin) / sum)};
      }
    }
  }

 private:
  Image<float> Band() const {
    return Image<float>::Uninitialized(gray.width, kMaxRows);
  }
  Image<float> PaddedBand() const {
    return Image<float>::Uninitialized(gray.width + 2 * margin_,
                                       kMaxRows + 2 * margin_);
  }

  void Load(int begin, int end) {
    for (int j = 0; j < end - begin + 2 * margin_; ++j) {
      for (int i = 0; i < levels_.Width(); ++i) {
        const int x = i - margin_;
        const int y = begin + j - margin_;
        const Rgb& rgb = color(Column(x), Row(y));
        levels_(i, j) = HalfLevels(x, y);
        red_(i, j) = static_cast<float>(rgb.r);
        green_(i, j) = static_cast<float>(rgb.g);
        blue_(i, j) = static_cast<float>(rgb.b);
      }
    }
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < gray.width; ++x) {
        scale_(x, y - begin) = Scale(x, y);
      }
    }
    for (Image<float>* sum :
         {&red_sum_, &green_sum_, &blue_sum_, &weight_sum_}) {
      std::fill(sum->begin(), sum->end(), 0.f);
    }
  }

  // Sums the squared differences over the height of a patch, by updating the
  // sums of the row above.
  void SumColumns(int row, int u, int v) {
    if (row == 0) {
      std::fill(columns_.begin(), columns_.end(), 0.f);
      for (int j = -kPatchRadius; j <= kPatchRadius; ++j) {
        AddDifferences(At(levels_, j, -kPatchRadius),
                       At(levels_, j + v, u - kPatchRadius),
                       columns_.Width(),
                       columns_.Data());
      }
      return;
    }
    const int entering = row + kPatchRadius;
    const int leaving = row - kPatchRadius - 1;
    ExchangeDifferences(At(levels_, entering, -kPatchRadius),
                        At(levels_, entering + v, u - kPatchRadius),
                        At(levels_, leaving, -kPatchRadius),
                        At(levels_, leaving + v, u - kPatchRadius),
                        columns_.Width(),
                        columns_.Data());
  }

  void AddWeighted(int row, int u, int v) {
    AddWeighted(columns_.Data(),
                &scale_(0, row),
                At(red_, row + v, u),
                At(green_, row + v, u),
                At(blue_, row + v, u),
                Expected(),
                gray.width,
                &red_sum_(0, row),
                &green_sum_(0, row),
                &blue_sum_(0, row),
                &weight_sum_(0, row));
  }

  // The pixel of a padded band at this offset from the band's first pixel.
  const float* At(const Image<float>& padded, int row, int column) const {
    return &padded(margin_ + column, margin_ + row);
  }

  static void AddDifferences(const float* a,
                             const float* b,
                             int count,
                             float* __restrict__ sums) {
    for (int i = 0; i < count; ++i) {
      sums[i] += SquaredDifference(a[i], b[i]);
    }
  }

  static void ExchangeDifferences(const float* entering_a,
                                  const float* entering_b,
                                  const float* leaving_a,
                                  const float* leaving_b,
                                  int count,
                                  float* __restrict__ sums) {
    for (int i = 0; i < count; ++i) {
      sums[i] += SquaredDifference(entering_a[i], entering_b[i]) -
                 SquaredDifference(leaving_a[i], leaving_b[i]);
    }
  }

  static void AddWeighted(const float* columns,
                          const float* scale,
                          const float* red,
                          const float* green,
                          const float* blue,
                          float expected,
                          int count,
                          float* __restrict__ red_sum,
                          float* __restrict__ green_sum,
                          float* __restrict__ blue_sum,
                          float* __restrict__ weight_sum) {
    for (int i = 0; i < count; ++i) {
      float differences = columns[i];
      for (int k = 1; k <= 2 * kPatchRadius; ++k) {
        differences += columns[i + k];
      }
      const float weight = Weight(differences, scale[i], expected);
      red_sum[i] += weight * red[i];
      green_sum[i] += weight * green[i];
      blue_sum[i] += weight * blue[i];
      weight_sum[i] += weight;
    }
  }

  const int margin_;
  // Rasters with a margin around the band.
  Image<float> levels_;
  Image<float> red_;
  Image<float> green_;
  Image<float> blue_;
  // Rasters of the size of the band.
  Image<float> scale_;
  Image<float> columns_;
  Image<float> red_sum_;
  Image<float> green_sum_;
  Image<float> blue_sum_;
  Image<float> weight_sum_;
};

}  // namespace tsar
