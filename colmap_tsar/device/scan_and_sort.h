// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/device/buffer.h"

#include <cstddef>
#include <cstdint>

namespace tsar {

// The exclusive prefix sums: element i of the result is values[0] + ... +
// values[i - 1]. It has count + 1 elements, the last of which is the total.
// values: count elements in the device's memory.
Buffer<int> ExclusiveSum(const int* values, size_t count, Device& device);

// A view of PixelGroups for kernels.
struct PixelGroupsView {
  const int* begin = nullptr;
  const int* pixels = nullptr;

  TSAR_HD int Count(int64_t group) const {
    return begin[group + 1] - begin[group];
  }
  TSAR_HD int Pixel(int64_t group, int i) const {
    return pixels[begin[group] + i];
  }
};

// The pixels of a raster sorted by label, such as that of a superpixel: those
// of label k are pixels[begin[k]] ... pixels[begin[k + 1] - 1], in raster
// order.
struct PixelGroups {
  Buffer<int> begin;  // num_labels + 1 offsets
  // The indices of all pixels of the raster; those of no group are the last.
  Buffer<int> pixels;

  int NumGroups() const { return static_cast<int>(begin.Size()) - 1; }
  PixelGroupsView View() const { return {begin.Data(), pixels.Data()}; }
};

// labels: in [0, num_labels), or negative for pixels of no group.
PixelGroups GroupPixels(ImageView<const int> labels,
                        int num_labels,
                        Device& device);

}  // namespace tsar
