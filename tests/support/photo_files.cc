// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/support/photo_files.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "tests/support/test_workspace.h"
#include <jpeglib.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <tiffio.h>

namespace tsar {
namespace {

constexpr int kWidth = 128;
constexpr int kHeight = 96;

// Waves under noise, so that no compression makes a row of it nothing.
cv::Mat DrawPicture() {
  cv::Mat picture(kHeight, kWidth, CV_8UC3);
  uint32_t noise = 1;
  const auto level = [&](double wave) {
    noise = 1664525u * noise + 1013904223u;
    return cv::saturate_cast<uchar>(120 + 60 * wave + (noise >> 28));
  };
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      picture.at<cv::Vec3b>(y, x) = {level(std::sin(0.20 * x)),
                                     level(std::sin(0.13 * y + 0.05 * x)),
                                     level(std::cos(0.08 * x - 0.11 * y))};
    }
  }
  return picture;
}

std::string Encoded(const std::string& extension,
                    const cv::Mat& pixels,
                    const std::vector<int>& options = {}) {
  std::vector<uchar> bytes;
  if (!cv::imencode(extension, pixels, bytes, options)) {
    throw std::runtime_error("OpenCV cannot write " + extension);
  }
  return std::string(bytes.begin(), bytes.end());
}

// In four inks, or in YCCK, as Adobe's programs write it.
std::string EncodedCmyk(J_COLOR_SPACE color_space) {
  const cv::Mat picture = DrawPicture();
  jpeg_compress_struct info = {};
  jpeg_error_mgr manager = {};
  info.err = jpeg_std_error(&manager);
  jpeg_create_compress(&info);
  unsigned char* buffer = nullptr;
  unsigned long num_bytes = 0;
  jpeg_mem_dest(&info, &buffer, &num_bytes);
  info.image_width = kWidth;
  info.image_height = kHeight;
  info.input_components = 4;
  info.in_color_space = JCS_CMYK;
  jpeg_set_defaults(&info);
  jpeg_set_colorspace(&info, color_space);
  jpeg_start_compress(&info, TRUE);
  for (int y = 0; y < kHeight; ++y) {
    uint8_t row[4 * kWidth];
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 3; ++c) {
        row[4 * x + c] = picture.at<cv::Vec3b>(y, x)[2 - c];
      }
      row[4 * x + 3] = static_cast<uint8_t>(255 - x);
    }
    JSAMPROW rows[] = {row};
    jpeg_write_scanlines(&info, rows, 1);
  }
  jpeg_finish_compress(&info);
  const std::string bytes(reinterpret_cast<char*>(buffer), num_bytes);
  jpeg_destroy_compress(&info);
  std::free(buffer);
  return bytes;
}

// Its directory stands before the pixels, as some programs write it.
std::string TiffWithDirectoryFirst(const cv::Mat& gray) {
  struct Tag {
    uint16_t id;
    uint16_t type;  // 3: of 16 bits, 4: of 32.
    uint32_t value;
  };
  constexpr uint32_t kNumTags = 9;
  constexpr uint32_t kBegin = 8 + 2 + 12 * kNumTags + 4;
  const Tag tags[kNumTags] = {{256, 4, kWidth},
                              {257, 4, kHeight},
                              {258, 3, 8},
                              {259, 3, 1},
                              {262, 3, 1},
                              {273, 4, kBegin},
                              {277, 3, 1},
                              {278, 4, kHeight},
                              {279, 4, kWidth * kHeight}};
  std::string bytes("II*\0\x08\0\0\0", 8);
  Append(static_cast<uint16_t>(kNumTags), &bytes);
  for (const Tag& tag : tags) {
    Append(tag.id, &bytes);
    Append(tag.type, &bytes);
    Append(uint32_t{1}, &bytes);
    Append(tag.value, &bytes);
  }
  Append(uint32_t{0}, &bytes);
  return bytes.append(reinterpret_cast<const char*>(gray.data),
                      kWidth * kHeight);
}

// By libtiff itself: tiles, or a compression that OpenCV does not write.
std::string TiledTiff(uint16_t compression) {
  cv::Mat picture;
  cv::cvtColor(DrawPicture(), picture, cv::COLOR_BGR2RGB);
  const TemporaryFolder folder;
  const std::string path = (folder.Path() / "tiles.tiff").string();
  TIFF* tiff = TIFFOpen(path.c_str(), "w");
  constexpr int kSide = 32;
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, kWidth);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, kHeight);
  TIFFSetField(tiff, TIFFTAG_TILEWIDTH, kSide);
  TIFFSetField(tiff, TIFFTAG_TILELENGTH, kSide);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 3);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, compression);
  for (int y = 0; y < kHeight; y += kSide) {
    for (int x = 0; x < kWidth; x += kSide) {
      cv::Mat tile = picture(cv::Rect(x, y, kSide, kSide)).clone();
      TIFFWriteTile(tiff,
                    tile.data,
                    static_cast<uint32_t>(x),
                    static_cast<uint32_t>(y),
                    0,
                    0);
    }
  }
  TIFFClose(tiff);
  return ReadText(path);
}

}  // namespace

std::vector<PhotoSample> MakePhotoSamples() {
  const cv::Mat color = DrawPicture();
  cv::Mat gray;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  cv::Mat deep;
  color.convertTo(deep, CV_16U, 257);
  cv::Mat with_alpha;
  cv::cvtColor(color, with_alpha, cv::COLOR_BGR2BGRA);
  const auto tiff = [&](int compression) {
    return Encoded(".tiff", color, {cv::IMWRITE_TIFF_COMPRESSION, compression});
  };
  return {
      {"color.jpg", Encoded(".jpg", color), true},
      {"best.jpg",
       Encoded(".jpg", color, {cv::IMWRITE_JPEG_QUALITY, 100}),
       true},
      {"progressive.jpg",
       Encoded(".jpg", color, {cv::IMWRITE_JPEG_PROGRESSIVE, 1}),
       true},
      {"restarts.jpg",
       Encoded(".jpg", color, {cv::IMWRITE_JPEG_RST_INTERVAL, 4}),
       true},
      {"gray.jpg", Encoded(".jpg", gray), true},
      {"cmyk.jpg", EncodedCmyk(JCS_CMYK), true},
      {"ycck.jpg", EncodedCmyk(JCS_YCCK), true},
      {"color.png", Encoded(".png", color), true, true},
      {"gray.png", Encoded(".png", gray), true, true},
      {"deep.png", Encoded(".png", deep), true, true},
      {"alpha.png", Encoded(".png", with_alpha), true, true},
      {"raw.tiff", tiff(COMPRESSION_NONE)},
      {"lzw.tiff", tiff(COMPRESSION_LZW), true},
      {"packbits.tiff", tiff(COMPRESSION_PACKBITS)},
      {"deflate.tiff", tiff(COMPRESSION_ADOBE_DEFLATE), true, true},
      {"deep.tiff", Encoded(".tiff", deep)},
      {"gray.tiff", Encoded(".tiff", gray)},
      {"first.tiff", TiffWithDirectoryFirst(gray)},
      {"tiles.tiff", TiledTiff(COMPRESSION_ADOBE_DEFLATE), true, true},
      {"jpeg.tiff", TiledTiff(COMPRESSION_JPEG), true},
      {"color.webp", Encoded(".webp", color, {cv::IMWRITE_WEBP_QUALITY, 90})},
      {"lossless.webp", Encoded(".webp", color)},
      {"color.bmp", Encoded(".bmp", color)},
      {"gray.bmp", Encoded(".bmp", gray)},
      {"color.ppm", Encoded(".ppm", color)},
      {"deep.ppm", Encoded(".ppm", deep)},
      {"gray.pgm", Encoded(".pgm", gray)},
      {"text.ppm", Encoded(".ppm", color, {cv::IMWRITE_PXM_BINARY, 0}), true},
      {"color.jp2", Encoded(".jp2", color)},
  };
}

PhotoSample FindPhotoSample(const std::string& name) {
  for (PhotoSample& sample : MakePhotoSamples()) {
    if (sample.name == name) {
      return std::move(sample);
    }
  }
  throw std::runtime_error("no sample of this name: " + name);
}

}  // namespace tsar
