// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/gray_pair.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/parallel_for_pixels.h"

namespace tsar {
namespace {

TSAR_HD float GrayLevel(float gray) { return gray; }
TSAR_HD float GrayLevel(const GrayPair& pair) {
  return static_cast<float>(pair.word & 0xFFFFu) * kGrayUnit<GrayPair>;
}

struct GrayKernel {
  ImageView<const Rgb> color;
  TSAR_HD float operator()(int x, int y) const {
    return GrayLevel(color(x, y));
  }
};

template <typename Pixel>
struct PairKernel {
  ImageView<const Pixel> image;
  ImageView<GrayPair> pairs;
  TSAR_HD void operator()(int x, int y) const {
    const int right = x + 1 < image.width ? x + 1 : x;
    pairs(x, y) =
        MakeGrayPair(GrayLevel(image(x, y)), GrayLevel(image(right, y)));
  }
};

template <typename Pixel>
struct HalveKernel {
  ImageView<const Pixel> gray;
  TSAR_HD float operator()(int x, int y) const {
    const int x0 = 2 * x;
    const int y0 = 2 * y;
    const int x1 = x0 + 1 < gray.width ? x0 + 1 : x0;
    const int y1 = y0 + 1 < gray.height ? y0 + 1 : y0;
    return 0.25f * (GrayLevel(gray(x0, y0)) + GrayLevel(gray(x1, y0)) +
                    GrayLevel(gray(x0, y1)) + GrayLevel(gray(x1, y1)));
  }
};

template <typename Pixel>
DeviceImage<float> Halve(ImageView<const Pixel> gray, Device& device) {
  return MapPixels<float>(device,
                          gray.width > 1 ? gray.width / 2 : 1,
                          gray.height > 1 ? gray.height / 2 : 1,
                          HalveKernel<Pixel>{gray});
}

}  // namespace

DeviceImage<GrayPair> PairGray(ImageView<const float> gray, Device& device) {
  DeviceImage<GrayPair> pairs(device, gray.width, gray.height);
  ParallelFor(
      device, gray.width, gray.height, PairKernel<float>{gray, pairs.View()});
  return pairs;
}

DeviceImage<float> ComputeGray(ImageView<const Rgb> color, Device& device) {
  return MapPixels<float>(device, color.width, color.height, GrayKernel{color});
}

void ComputeGrayPairs(ImageView<const Rgb> color,
                      ImageView<GrayPair> pairs,
                      Device& device) {
  ParallelFor(device, color.width, color.height, PairKernel<Rgb>{color, pairs});
}

DeviceImage<float> HalveGray(ImageView<const float> gray, Device& device) {
  return Halve(gray, device);
}

DeviceImage<GrayPair> HalveGray(ImageView<const GrayPair> gray,
                                Device& device) {
  return PairGray(Halve(gray, device).View(), device);
}

}  // namespace tsar
