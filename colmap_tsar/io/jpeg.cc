// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/jpeg.h"

#include "colmap_tsar/io/photo_format.h"

#include <csetjmp>
#include <cstdio>
#include <new>
#include <type_traits>
#include <vector>

#include <jpeglib.h>
// jerror.h requires jpeglib.h.
#include <jerror.h>

namespace tsar {
namespace {

// Whether a warning concerns metadata rather than the compressed data.
bool IsAboutMetadata(int warning) {
  return warning == JWRN_ADOBE_XFORM || warning == JWRN_JFIF_MAJOR ||
         warning == JWRN_NOT_SEQUENTIAL;
}

// Decodes one file. On an error libjpeg jumps back to Guard() over its own
// frames and that of the function that Guard() called, which must therefore
// hold no object with a destructor.
class JpegDecoder {
 public:
  JpegDecoder(std::span<const uint8_t> bytes, const std::string& name)
      : JpegDecoder(name) {
    Guard([&] {
      jpeg_create_decompress(&info_);
      jpeg_mem_src(&info_, bytes.data(), bytes.size());
      jpeg_read_header(&info_, TRUE);
    });
    RequirePossibleSize(name, info_.image_width, info_.image_height);
  }
  ~JpegDecoder() { jpeg_destroy_decompress(&info_); }
  JpegDecoder(const JpegDecoder&) = delete;
  JpegDecoder& operator=(const JpegDecoder&) = delete;

  JpegKind Kind() const {
    return {static_cast<int>(info_.image_width),
            static_cast<int>(info_.image_height),
            info_.num_components == 4};
  }

  // Decodes row by row, each row_step bytes after the previous one; 0 if the
  // file is only checked.
  void Decode(J_COLOR_SPACE color_space, uint8_t* first_row, size_t row_step) {
    Guard([&] {
      info_.out_color_space = color_space;
      jpeg_start_decompress(&info_);
      uint8_t* row = first_row;
      while (info_.output_scanline < info_.output_height) {
        jpeg_read_scanlines(&info_, &row, 1);
        row += row_step;
      }
      // Reads up to the end marker.
      jpeg_finish_decompress(&info_);
    });
  }

 private:
  // The destructor runs if the delegating constructor throws.
  explicit JpegDecoder(const std::string& name) : name_(name) {
    info_.err = jpeg_std_error(&manager_);
    manager_.error_exit = &OnError;
    manager_.emit_message = &OnMessage;
    info_.client_data = this;
  }

  template <typename Function>
  void Guard(const Function& function) {
    if (setjmp(escape_) == 0) {
      function();
    } else {
      ThrowFailure();
    }
  }

  [[noreturn]] void ThrowFailure() {
    if (manager_.msg_code == JERR_OUT_OF_MEMORY) {
      throw std::bad_alloc();
    }
    char text[JMSG_LENGTH_MAX];
    manager_.format_message(reinterpret_cast<j_common_ptr>(&info_), text);
    throw is_damaged_ ? DamagedPhoto(name_, text)
                      : UnreadablePhoto(name_, text);
  }

  static void OnError(j_common_ptr info) {
    std::longjmp(static_cast<JpegDecoder*>(info->client_data)->escape_, 1);
  }

  // Warnings have a negative level.
  static void OnMessage(j_common_ptr info, int level) {
    if (level < 0 && !IsAboutMetadata(info->err->msg_code)) {
      static_cast<JpegDecoder*>(info->client_data)->is_damaged_ = true;
      OnError(info);
    }
  }

  const std::string& name_;
  jpeg_decompress_struct info_ = {};
  jpeg_error_mgr manager_ = {};
  std::jmp_buf escape_;
  bool is_damaged_ = false;
};

}  // namespace

JpegKind ReadJpegKind(std::span<const uint8_t> bytes, const std::string& name) {
  return JpegDecoder(bytes, name).Kind();
}

template <typename T>
Image<T> DecodeJpeg(std::span<const uint8_t> bytes, const std::string& name) {
  JpegDecoder decoder(bytes, name);
  const JpegKind kind = decoder.Kind();
  auto image = Image<T>::Uninitialized(kind.width, kind.height);
  decoder.Decode(std::is_same_v<T, Rgb> ? JCS_RGB : JCS_GRAYSCALE,
                 reinterpret_cast<uint8_t*>(image.Data()),
                 static_cast<size_t>(kind.width) * sizeof(T));
  return image;
}

static_assert(sizeof(Rgb) == 3);
template Image<Rgb> DecodeJpeg(std::span<const uint8_t>, const std::string&);
template Image<uint8_t> DecodeJpeg(std::span<const uint8_t>,
                                   const std::string&);

void CheckJpeg(std::span<const uint8_t> bytes, const std::string& name) {
  JpegDecoder decoder(bytes, name);
  const JpegKind kind = decoder.Kind();
  std::vector<uint8_t> row(size_t{4} * static_cast<size_t>(kind.width));
  decoder.Decode(kind.is_cmyk ? JCS_CMYK : JCS_RGB, row.data(), 0);
}

}  // namespace tsar
