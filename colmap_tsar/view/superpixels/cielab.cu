// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/cielab.h"

#include "colmap_tsar/device/parallel_for.h"

namespace tsar {
namespace {

// Below this share of the white point, lightness is linear.
constexpr float kLinearPart = 0.008856f;

// The linear light of each of the 256 levels of sRGB. x^2.4 is x^2 times the
// square of the fifth root of x; roots are taken by Newton's iteration, because
// the devices' pow() and cbrt() round differently.
struct LinearizeKernel {
  float* light;

  TSAR_HD void operator()(int64_t level) const {
    const double value = static_cast<double>(level) / 255.0;
    if (value <= 0.04045) {
      light[level] = static_cast<float>(value / 12.92);
      return;
    }
    const double x = (value + 0.055) / 1.055;
    double root = 1.0;
    for (int i = 0; i < 12; ++i) {
      root = (4.0 * root + x / (root * root * root * root)) / 5.0;
    }
    light[level] = static_cast<float>(x * x * root * root);
  }
};

struct LabKernel {
  ImageView<const Rgb> color;
  const float* light;
  ImageView<Vec3f> lab;

  // The cube root of a number in [kLinearPart, 1] by Halley's iteration.
  TSAR_HD static float CubeRoot(float x) {
    float root = (0.04f + 1.1f * x) / (0.22f + x);
    for (int i = 0; i < 2; ++i) {
      const float cube = root * root * root;
      root = root * (cube + 2.f * x) / (2.f * cube + x);
    }
    return root;
  }
  TSAR_HD static float Compress(float x) {
    return x > kLinearPart ? CubeRoot(x) : 7.787f * x + 16.f / 116.f;
  }

  TSAR_HD void operator()(int64_t i) const {
    const Rgb& pixel = color.data[i];
    const float r = light[pixel.r];
    const float g = light[pixel.g];
    const float b = light[pixel.b];
    // X, Y and Z as shares of the white point's.
    const float x =
        (0.412453f * r + 0.357580f * g + 0.180423f * b) * (1.f / 0.950456f);
    const float y = 0.212671f * r + 0.715160f * g + 0.072169f * b;
    const float z =
        (0.019334f * r + 0.119193f * g + 0.950227f * b) * (1.f / 1.088754f);
    const float middle = Compress(y);
    lab.data[i] = {116.f * middle - 16.f,
                   500.f * (Compress(x) - middle),
                   200.f * (middle - Compress(z))};
  }
};

}  // namespace

DeviceImage<Vec3f> ConvertToLab(ImageView<const Rgb> color, Device& device) {
  constexpr int kNumLevels = 256;
  Buffer<float> light(device, kNumLevels);
  ParallelFor(device, kNumLevels, LinearizeKernel{light.Data()});
  DeviceImage<Vec3f> lab(device, color.width, color.height);
  ParallelFor(device,
              static_cast<int64_t>(color.NumPixels()),
              LabKernel{color, light.Data(), lab.View()});
  return lab;
}

}  // namespace tsar
