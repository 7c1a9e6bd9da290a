// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Images and blocks with noise of known strength.

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace tsar {

// Normally distributed numbers of variance 1.
class NormalNoise {
 public:
  explicit NormalNoise(uint32_t seed) : random_(seed, 0, 0) {}

  double Next() {
    const double radius =
        std::sqrt(-2.0 * std::log(1.0 - double{random_.NextFloat()}));
    return radius *
           std::cos(2.0 * std::numbers::pi * double{random_.NextFloat()});
  }

 private:
  Philox random_;
};

// Any colors.
inline Image<Rgb> DrawColors(int width, int height, uint32_t seed) {
  Image<Rgb> color(width, height);
  Philox random(seed, 0, 0);
  for (Rgb& pixel : color) {
    pixel = {static_cast<uint8_t>(random.NextBelow(256)),
             static_cast<uint8_t>(random.NextBelow(256)),
             static_cast<uint8_t>(random.NextBelow(256))};
  }
  return color;
}

inline uint8_t ToLevel(double level) {
  return static_cast<uint8_t>(std::clamp(level + 0.5, 0.0, 255.0));
}

inline Rgb GrayPixel(double level) {
  const uint8_t value = ToLevel(level);
  return {value, value, value};
}

// The gray levels of an image of gray pixels.
inline Image<float> ToGray(const Image<Rgb>& color) {
  Image<float> gray(color.Width(), color.Height());
  std::transform(color.begin(), color.end(), gray.begin(), [](const Rgb& rgb) {
    return static_cast<float>(rgb.g);
  });
  return gray;
}

}  // namespace tsar
