// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/gray_texture.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/parallel_for_pixels.h"

#include <cmath>
#include <cstddef>

namespace tsar {
namespace {

// What GPUs require of textures in linear memory.
constexpr size_t kTextureAlignment = 512;  // Of the first pixel, in bytes.
constexpr int kPitchUnit = 8;              // In pixels.

// The nearest level that a texture can hold.
TSAR_HD float QuantizeLevel(float gray) {
  constexpr float kSteps = 256.f;
  return static_cast<float>(
             static_cast<int>(fminf(fmaxf(gray, 0.f), 255.f) * kSteps + 0.5f)) /
         kSteps;
}

TSAR_HD float GrayLevel(float gray) { return gray; }

struct GrayKernel {
  ImageView<const Rgb> color;
  TSAR_HD float operator()(int x, int y) const {
    return GrayLevel(color(x, y));
  }
};

template <typename Pixel>
struct TextureKernel {
  ImageView<const Pixel> image;
  ImageView<float> pixels;
  TSAR_HD void operator()(int x, int y) const {
    pixels(x, y) = QuantizeLevel(GrayLevel(image(x, y)));
  }
};

struct HalveKernel {
  GrayView gray;
  ImageView<float> pixels;
  TSAR_HD void operator()(int x, int y) const {
    const int x0 = 2 * x;
    const int x1 = x0 + 1 < gray.width ? x0 + 1 : x0;
    const float* row0 = gray.data + static_cast<int64_t>(2 * y) * gray.pitch;
    const float* row1 = 2 * y + 1 < gray.height ? row0 + gray.pitch : row0;
    pixels(x, y) =
        QuantizeLevel(0.25f * (row0[x0] + row0[x1] + row1[x0] + row1[x1]));
  }
};

template <typename Pixel>
void FillTexture(ImageView<const Pixel> image,
                 GrayTexture* texture,
                 Device& device) {
  ParallelFor(device,
              image.width,
              image.height,
              TextureKernel<Pixel>{image, texture->Pixels()});
}

template <typename Pixel>
GrayTexture MakeTexture(ImageView<const Pixel> image, Device& device) {
  GrayTexture texture(device, image.width, image.height);
  FillTexture(image, &texture, device);
  return texture;
}

}  // namespace

GrayTexture::GrayTexture(Device& device, int width, int height) {
  view_ = {nullptr, width, height, 0, 0};
  if (width == 0 || height == 0) {
    return;
  }
  const int pitch = (width + kPitchUnit - 1) / kPitchUnit * kPitchUnit;
  constexpr size_t kSpare = kTextureAlignment / sizeof(float);
  pixels_ = Buffer<float>(
      device,
      static_cast<size_t>(pitch) * static_cast<size_t>(height) + kSpare);
  const auto address = reinterpret_cast<uintptr_t>(pixels_.Data());
  first_ = pixels_.Data() + (kTextureAlignment - address % kTextureAlignment) %
                                kTextureAlignment / sizeof(float);
  if (width == 1) {
    // The second column is read with weights of zero, and must be finite.
    Fill(device, pixels_.Data(), pixels_.Size(), 0.f);
  }
  view_.data = first_;
  view_.pitch = pitch;
  auto texture = std::make_unique<uint64_t>(0);
  *texture = device.CreateTexture(first_, width, height, pitch);
  view_.texture = *texture;
  texture_ = {texture.release(), {&device}};
}

void GrayTexture::FreeTexture::operator()(const uint64_t* texture) const {
  device->FreeTexture(*texture);
  delete texture;
}

DeviceImage<float> ComputeGray(ImageView<const Rgb> color, Device& device) {
  return MapPixels<float>(device, color.width, color.height, GrayKernel{color});
}

GrayTexture ComputeGrayTexture(ImageView<const Rgb> color, Device& device) {
  return MakeTexture(color, device);
}

GrayTexture ComputeGrayTexture(ImageView<const float> gray, Device& device) {
  return MakeTexture(gray, device);
}

void ComputeGrayTexture(ImageView<const Rgb> color,
                        GrayTexture* texture,
                        Device& device) {
  FillTexture(color, texture, device);
}

GrayTexture HalveGray(const GrayView& gray, Device& device) {
  GrayTexture half(device,
                   gray.width > 1 ? gray.width / 2 : 1,
                   gray.height > 1 ? gray.height / 2 : 1);
  ParallelFor(
      device, half.Width(), half.Height(), HalveKernel{gray, half.Pixels()});
  return half;
}

}  // namespace tsar
