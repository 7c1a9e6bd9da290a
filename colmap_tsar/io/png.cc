// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/png.h"

#include "colmap_tsar/io/photo_format.h"

#include <algorithm>
#include <array>
#include <bit>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <new>
#include <string_view>

#include <png.h>
#include <zlib.h>

namespace tsar {
namespace {

static_assert(std::endian::native == std::endian::little,
              "numbers of 16 bits are turned around");

// An upper bound of the compression ratio: Deflate attains at most 1032.
constexpr uint64_t kMaxRatio = 1100;

uint32_t ReadBigEndian(std::span<const uint8_t> bytes) {
  return png_get_uint_32(bytes.data());
}

// Decodes one file. On an error libpng jumps back to Guard() over its own
// frames and that of the function that Guard() called, which must therefore
// hold no object with a destructor.
class PngDecoder {
 public:
  PngDecoder(std::span<const uint8_t> bytes, const PngError& error)
      : PngDecoder(error, bytes) {
    Guard([&] {
      png_set_benign_errors(png_, 1);
      png_set_read_fn(png_, this, &Read);
      // No chunk is kept, so that their sizes do not matter.
      png_set_chunk_malloc_max(png_, 0);
      png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
      png_set_keep_unknown_chunks(
          png_, PNG_HANDLE_CHUNK_NEVER, png_const_bytep("tRNS"), 1);
      png_read_info(png_, info_);
    });
    const uint64_t width = png_get_image_width(png_, info_);
    const uint64_t height = png_get_image_height(png_, info_);
    if (width * height > uint64_t{kMaxNumPixels} ||
        png_get_rowbytes(png_, info_) * height > kMaxRatio * bytes.size()) {
      throw error("the header says " + std::to_string(width) + " x " +
                  std::to_string(height) +
                  " pixels, which the file cannot hold");
    }
  }
  ~PngDecoder() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngDecoder(const PngDecoder&) = delete;
  PngDecoder& operator=(const PngDecoder&) = delete;

  // T: the pixel type of the result.
  template <typename T>
  Image<T> Decode() {
    constexpr bool kIsRgb = std::is_same_v<T, Rgb> || std::is_same_v<T, Rgb16>;
    auto image = Image<T>::Uninitialized(
        static_cast<int>(png_get_image_width(png_, info_)),
        static_cast<int>(png_get_image_height(png_, info_)));
    Guard([&] {
      if constexpr (std::is_same_v<T, Rgb16>) {
        png_set_swap(png_);
        png_set_expand_16(png_);
      } else if constexpr (sizeof(T) == 2) {
        png_set_swap(png_);
      } else {
        png_set_strip_16(png_);
      }
      png_set_strip_alpha(png_);
      png_set_palette_to_rgb(png_);
      const bool has_colors =
          (png_get_color_type(png_, info_) & PNG_COLOR_MASK_COLOR) != 0;
      if (!has_colors) {
        png_set_expand_gray_1_2_4_to_8(png_);
      }
      if (kIsRgb && !has_colors) {
        png_set_gray_to_rgb(png_);
      } else if (!kIsRgb && has_colors) {
        // The weights of Rec. 601.
        png_set_rgb_to_gray(png_, PNG_ERROR_ACTION_NONE, 0.299, 0.587);
      }
      const int num_passes = png_set_interlace_handling(png_);
      png_read_update_info(png_, info_);
      if (png_get_rowbytes(png_, info_) !=
          static_cast<size_t>(image.Width()) * sizeof(T)) {
        png_error(png_, "it has pixels of another kind");
      }
      for (int pass = 0; pass < num_passes; ++pass) {
        for (int y = 0; y < image.Height(); ++y) {
          png_read_row(
              png_, reinterpret_cast<png_bytep>(&image(0, y)), nullptr);
        }
      }
      // Reads up to the last chunk.
      png_read_end(png_, info_);
    });
    return image;
  }

 private:
  // The destructor runs if the delegating constructor throws.
  PngDecoder(const PngError& error, std::span<const uint8_t> bytes)
      : error_(error), left_(bytes) {
    png_ = png_create_read_struct(
        PNG_LIBPNG_VER_STRING, this, &OnError, &OnWarning);
    info_ = png_ != nullptr ? png_create_info_struct(png_) : nullptr;
    if (info_ == nullptr) {
      png_destroy_read_struct(&png_, nullptr, nullptr);
      throw std::bad_alloc();
    }
  }

  template <typename Function>
  void Guard(const Function& function) {
    if (setjmp(escape_) == 0) {
      function();
      return;
    }
    // The words of libpng and zlib for exhausted memory.
    const std::string defect = defect_.data();
    if (defect.find("memory") != std::string::npos) {
      throw std::bad_alloc();
    }
    throw error_(defect);
  }

  static void Read(png_structp png, png_bytep target, size_t num_bytes) {
    auto& left = static_cast<PngDecoder*>(png_get_io_ptr(png))->left_;
    if (num_bytes > left.size()) {
      png_error(png, "it breaks off");
    }
    std::memcpy(target, left.data(), num_bytes);
    left = left.subspan(num_bytes);
  }

  [[noreturn]] static void OnError(png_structp png, const char* message) {
    auto* decoder = static_cast<PngDecoder*>(png_get_error_ptr(png));
    std::snprintf(
        decoder->defect_.data(), decoder->defect_.size(), "%s", message);
    std::longjmp(decoder->escape_, 1);
  }

  // Messages begin with the name of the chunk.
  static void OnWarning(png_structp png, const char* message) {
    const std::string_view text = message;
    if (text.starts_with("IHDR:") || text.starts_with("IDAT:") ||
        text.starts_with("IEND:")) {
      OnError(png, message);
    }
  }

  const PngError& error_;
  std::span<const uint8_t> left_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::jmp_buf escape_;
  std::array<char, 200> defect_{};
};

}  // namespace

std::optional<PngHeader> ReadPngHeader(std::span<const uint8_t> head) {
  constexpr std::string_view kBegin("\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR", 16);
  if (head.size() < kPngHeadSize ||
      std::memcmp(head.data(), kBegin.data(), kBegin.size()) != 0 ||
      crc32(0, head.data() + 12, 17) != ReadBigEndian(head.subspan(29))) {
    return std::nullopt;
  }
  return PngHeader{ReadBigEndian(head.subspan(16)),
                   ReadBigEndian(head.subspan(20)),
                   head[24],
                   head[25] == PNG_COLOR_TYPE_GRAY,
                   (head[25] & PNG_COLOR_MASK_COLOR) != 0,
                   (head[25] & PNG_COLOR_MASK_ALPHA) != 0};
}

template <typename T>
Image<T> DecodePng(std::span<const uint8_t> bytes, const PngError& error) {
  return PngDecoder(bytes, error).Decode<T>();
}

static_assert(sizeof(Rgb) == 3 && sizeof(Rgb16) == 6);
template Image<Rgb> DecodePng(std::span<const uint8_t>, const PngError&);
template Image<uint8_t> DecodePng(std::span<const uint8_t>, const PngError&);
template Image<Rgb16> DecodePng(std::span<const uint8_t>, const PngError&);
template Image<uint16_t> DecodePng(std::span<const uint8_t>, const PngError&);

}  // namespace tsar
