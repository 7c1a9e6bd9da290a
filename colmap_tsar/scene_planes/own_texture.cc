// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/own_texture.h"

#include "colmap_tsar/device/working_bytes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace tsar {
namespace {

// How near to a pixel pattern is its own, relative to the patch's radius.
constexpr float kNearShare = 0.4f;
// The share of the contrast from which on it is the pixel's own.
constexpr float kFullShare = 0.5f;
// Contrasts are compared with so many grey levels added, which noise causes.
constexpr float kNoise = 1.f;

// Each pixel becomes the one of the square around it that wins by `better`.
template <typename Better>
Image<float> Select(const Image<float>& image, int radius, Better better) {
  const int width = image.Width();
  const int height = image.Height();
  Image<float> rows(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      float best = image(x, y);
      const int end = std::min(x + radius, width - 1);
      for (int u = std::max(x - radius, 0); u <= end; ++u) {
        best = better(best, image(u, y));
      }
      rows(x, y) = best;
    }
  }
  Image<float> result = rows;
  for (int y = 0; y < height; ++y) {
    const int end = std::min(y + radius, height - 1);
    for (int v = std::max(y - radius, 0); v <= end; ++v) {
      for (int x = 0; x < width; ++x) {
        result(x, y) = better(result(x, y), rows(x, v));
      }
    }
  }
  return result;
}

float Lesser(float a, float b) { return std::min(a, b); }
float Greater(float a, float b) { return std::max(a, b); }

// The largest minus the smallest grey level around each pixel.
Image<float> Range(const Image<float>& gray, int radius) {
  Image<float> range = Select(gray, radius, Greater);
  const Image<float> smallest = Select(gray, radius, Lesser);
  for (size_t i = 0; i < range.NumPixels(); ++i) {
    range.Data()[i] -= smallest.Data()[i];
  }
  return range;
}

// The median contrast of each pixel's superpixel: most of it lies inside, so
// that the edges along its border do not count.
Image<float> TextureOfSuperpixels(const Image<float>& contrast,
                                  const Image<int>& superpixels,
                                  int num_superpixels) {
  std::vector<std::vector<float>> contrasts(
      static_cast<size_t>(num_superpixels));
  for (size_t i = 0; i < contrast.NumPixels(); ++i) {
    contrasts[static_cast<size_t>(superpixels.Data()[i])].push_back(
        contrast.Data()[i]);
  }
  std::vector<float> medians;
  for (std::vector<float>& of_one : contrasts) {
    const auto middle =
        of_one.begin() + static_cast<std::ptrdiff_t>(of_one.size() / 2);
    std::nth_element(of_one.begin(), middle, of_one.end());
    medians.push_back(of_one.empty() ? 0.f : *middle);
  }
  Image<float> texture(superpixels.Width(), superpixels.Height());
  for (size_t i = 0; i < texture.NumPixels(); ++i) {
    texture.Data()[i] = medians[static_cast<size_t>(superpixels.Data()[i])];
  }
  return texture;
}

}  // namespace

Image<float> ComputeOwnTexture(const Image<float>& gray,
                               const Image<float>& contrast,
                               const Image<int>& superpixels,
                               int num_superpixels,
                               int patch_radius) {
  const int near_radius =
      std::max(1, static_cast<int>(std::lround(kNearShare * patch_radius)));
  patch_radius = std::max(patch_radius, near_radius + 1);
  const Image<float> near = Range(gray, near_radius);
  const Image<float> patch = Range(gray, patch_radius);
  const Image<float> texture =
      TextureOfSuperpixels(contrast, superpixels, num_superpixels);
  const Image<float> most_texture = Select(texture, patch_radius, Greater);
  Image<float> own(near.Width(), near.Height(), 1.f);
  for (size_t i = 0; i < own.NumPixels(); ++i) {
    if (patch.Data()[i] > 0.f) {
      const float of_contrast = near.Data()[i] / (kFullShare * patch.Data()[i]);
      const float of_texture = (texture.Data()[i] + kNoise) /
                               (kFullShare * (most_texture.Data()[i] + kNoise));
      own.Data()[i] = std::min(of_contrast * std::min(of_texture, 1.f), 1.f);
    }
  }
  return own;
}

int64_t OwnTextureMainBytes(int64_t num_pixels) {
  // The two ranges, two of texture, and the rows and the result of Select().
  constexpr int64_t kNumImages = 6;
  return kNumImages * BytesOf<float>(num_pixels);
}

}  // namespace tsar
