// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/foreground_fattening.h"

#include "colmap_tsar/base/median.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

// The radius within which texture is a pixel's own, relative to the patch's
// radius.
constexpr float kNearShare = 0.4f;
// The ratio of contrasts from which on the weight is 1.
constexpr float kFullShare = 0.5f;
// The contrast of noise in gray levels, added before contrasts are compared.
constexpr float kNoise = 1.f;

// The result of cv::morphologyEx with the square around each pixel, clipped to
// the image.
Image<float> Filter(const Image<float>& image,
                    int radius,
                    cv::MorphTypes operation) {
  Image<float> result =
      Image<float>::Uninitialized(image.Width(), image.Height());
  const cv::Mat from(
      image.Height(), image.Width(), CV_32F, const_cast<float*>(image.Data()));
  cv::Mat to(image.Height(), image.Width(), CV_32F, result.Data());
  cv::morphologyEx(from,
                   to,
                   operation,
                   cv::Mat::ones(2 * radius + 1, 2 * radius + 1, CV_8U));
  return result;
}

// The median contrast of each pixel's superpixel: most of it lies inside, so
// that the edges along its border do not count.
Image<float> TextureOfSuperpixels(const Image<float>& contrast,
                                  const Image<int>& superpixels,
                                  int num_superpixels) {
  std::vector<std::vector<float>> contrasts(num_superpixels);
  for (size_t i = 0; i < contrast.NumPixels(); ++i) {
    contrasts[superpixels.Data()[i]].push_back(contrast.Data()[i]);
  }
  std::vector<float> medians;
  for (std::vector<float>& of_one : contrasts) {
    medians.push_back(of_one.empty() ? 0.f : UpperMedian(&of_one));
  }
  Image<float> texture(superpixels.Width(), superpixels.Height());
  for (size_t i = 0; i < texture.NumPixels(); ++i) {
    texture.Data()[i] = medians[superpixels.Data()[i]];
  }
  return texture;
}

}  // namespace

Image<float> ComputeFatteningWeight(const Image<float>& gray,
                                    const Image<float>& contrast,
                                    const Image<int>& superpixels,
                                    int num_superpixels,
                                    int patch_radius) {
  if (gray.Empty()) {
    return {};
  }
  const int near_radius =
      std::max(1, static_cast<int>(std::lround(kNearShare * patch_radius)));
  patch_radius = std::max(patch_radius, near_radius + 1);
  // The largest minus the smallest gray level around each pixel.
  const Image<float> near = Filter(gray, near_radius, cv::MORPH_GRADIENT);
  const Image<float> patch = Filter(gray, patch_radius, cv::MORPH_GRADIENT);
  const Image<float> texture =
      TextureOfSuperpixels(contrast, superpixels, num_superpixels);
  const Image<float> most_texture =
      Filter(texture, patch_radius, cv::MORPH_DILATE);
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

}  // namespace tsar
