// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/png_pixels.h"

#include "colmap_tsar/workspace/photo_error.h"

#include <algorithm>
#include <new>
#include <vector>

#include <zlib.h>

namespace tsar {
namespace {

constexpr int kGray = 0;
constexpr int kColors = 2;
constexpr int kPalette = 3;
constexpr int kGrayAlpha = 4;
constexpr int kColorsAlpha = 6;

// Of the pixels in an interlaced picture, those that are sent together.
struct Pass {
  uint32_t left;
  uint32_t top;
  uint32_t step_x;
  uint32_t step_y;
};

constexpr Pass kWhole[] = {{0, 0, 1, 1}};
constexpr Pass kInterlaced[] = {{0, 0, 8, 8},
                                {4, 0, 8, 8},
                                {0, 4, 4, 8},
                                {2, 0, 4, 4},
                                {0, 2, 2, 4},
                                {1, 0, 2, 2},
                                {0, 1, 1, 2}};

uint32_t NumSteps(uint32_t begin, uint32_t end, uint32_t step) {
  return end > begin ? (end - begin - 1) / step + 1 : 0;
}

uint64_t BitsPerPixel(const PngHeader& header) {
  const int num_channels = header.color_type == kColors        ? 3
                           : header.color_type == kGrayAlpha   ? 2
                           : header.color_type == kColorsAlpha ? 4
                                                               : 1;
  return static_cast<uint64_t>(num_channels * header.bits_per_channel);
}

class Inflater {
 public:
  explicit Inflater(std::span<const std::span<const uint8_t>> parts)
      : parts_(parts) {
    // As libpng does, with a window of the size that the stream tells.
    if (inflateInit2(&stream_, 0) != Z_OK) {
      throw std::bad_alloc();
    }
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream_); }

  // Whether there are as many bytes.
  bool Fill(std::span<uint8_t> bytes) {
    stream_.next_out = bytes.data();
    stream_.avail_out = static_cast<uInt>(bytes.size());
    while (stream_.avail_out > 0 && !has_ended_) {
      if (stream_.avail_in == 0 && !parts_.empty()) {
        // zlib only reads.
        stream_.next_in = const_cast<uint8_t*>(parts_.front().data());
        stream_.avail_in = static_cast<uInt>(parts_.front().size());
        parts_ = parts_.subspan(1);
      }
      const int result = inflate(&stream_, Z_NO_FLUSH);
      if (result == Z_MEM_ERROR) {
        throw std::bad_alloc();
      }
      has_ended_ = result == Z_STREAM_END;
      // Without any progress, for lack of bytes, it may go on with more.
      if (!has_ended_ && result != Z_OK &&
          (result != Z_BUF_ERROR || parts_.empty())) {
        return false;
      }
    }
    return stream_.avail_out == 0;
  }

  // Whether the stream ends here, with its checksum, and the parts with it.
  bool IsAtEnd() {
    uint8_t more = 0;
    return !Fill({&more, 1}) && has_ended_ && stream_.avail_in == 0 &&
           std::all_of(parts_.begin(), parts_.end(), [](const auto& part) {
             return part.empty();
           });
  }

 private:
  std::span<const std::span<const uint8_t>> parts_;
  z_stream stream_{};
  bool has_ended_ = false;
};

}  // namespace

bool PngHeader::HasPalette() const { return color_type == kPalette; }

bool PngHeader::IsPossible() const {
  constexpr uint32_t kMaxSide = 1000000;
  const int bits = bits_per_channel;
  const bool is_packed = bits == 1 || bits == 2 || bits == 4;
  bool has_possible_bits = bits == 8 || bits == 16;
  if (color_type == kGray) {
    has_possible_bits = has_possible_bits || is_packed;
  } else if (color_type == kPalette) {
    has_possible_bits = bits == 8 || is_packed;
  } else if (color_type != kColors && color_type != kGrayAlpha &&
             color_type != kColorsAlpha) {
    return false;
  }
  return has_possible_bits && compression == 0 && filter == 0 &&
         interlacing <= 1 && width > 0 && width <= kMaxSide && height > 0 &&
         height <= kMaxSide && int64_t{width} * height <= kMaxNumPixels;
}

bool HasAllPngRows(const PngHeader& header,
                   std::span<const std::span<const uint8_t>> parts) {
  constexpr uint8_t kMaxFilter = 4;
  Inflater inflater(parts);
  std::vector<uint8_t> row;
  for (const Pass& pass : header.interlacing == 0
                              ? std::span<const Pass>(kWhole)
                              : std::span<const Pass>(kInterlaced)) {
    const uint32_t width = NumSteps(pass.left, header.width, pass.step_x);
    const uint32_t height = NumSteps(pass.top, header.height, pass.step_y);
    if (width == 0) {
      continue;
    }
    // Behind the number of the filter that the row went through.
    row.resize(1 + (width * BitsPerPixel(header) + 7) / 8);
    for (uint32_t y = 0; y < height; ++y) {
      if (!inflater.Fill(row) || row.front() > kMaxFilter) {
        return false;
      }
    }
  }
  return inflater.IsAtEnd();
}

}  // namespace tsar
