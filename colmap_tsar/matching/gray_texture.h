// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"

#include <cstdint>
#include <memory>

namespace tsar {

// A gray image as kernels read it, see SampleGray().
struct GrayView {
  const float* data = nullptr;  // Levels, 0-255, in steps of 1/256.
  int width = 0;
  int height = 0;
  int pitch = 0;         // From a row to the next, in pixels.
  uint64_t texture = 0;  // The GPU's; 0 on a CPU.
};

// A gray image in a device's memory that is sampled between its pixels: on a
// GPU by its texture units. The device must outlive it.
class GrayTexture {
 public:
  GrayTexture() = default;
  // Of undefined pixels. Throws kDevice if the image is larger than the GPU's
  // textures (131072 x 65000 pixels), and as Device::Allocate.
  GrayTexture(Device& device, int width, int height);

  int Width() const { return view_.width; }
  int Height() const { return view_.height; }
  GrayView View() const { return view_; }
  // The pixels to be written. Its width is the pitch; columns from Width() on
  // do not count.
  ImageView<float> Pixels() { return {first_, view_.pitch, view_.height}; }

 private:
  struct FreeTexture {
    Device* device;
    void operator()(const uint64_t* texture) const;
  };

  Buffer<float> pixels_;
  float* first_ = nullptr;  // Aligned for textures.
  std::unique_ptr<const uint64_t, FreeTexture> texture_;
  GrayView view_;
};

DeviceImage<float> ComputeGray(ImageView<const Rgb> color, Device& device);

// Textures of images; levels are clamped to 0-255, NaN becomes 0.
GrayTexture ComputeGrayTexture(ImageView<const Rgb> color, Device& device);
GrayTexture ComputeGrayTexture(ImageView<const float> gray, Device& device);
// texture: of the image's size.
void ComputeGrayTexture(ImageView<const Rgb> color,
                        GrayTexture* texture,
                        Device& device);

// The image at half the width and height, rounded down, but at least one pixel:
// each pixel is the mean of four.
GrayTexture HalveGray(const GrayView& gray, Device& device);

}  // namespace tsar
