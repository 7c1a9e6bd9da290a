// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/jpeg.h"
#include "colmap_tsar/io/photo_format.h"
#include "colmap_tsar/io/picture_checks.h"
#include "colmap_tsar/io/png.h"

#include "tests/fuzz/fuzz_target.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

// A header may ask for a photo of any size; that is no mistake, but takes time.
constexpr int kMaxPixels = 1 << 16;

void ReadJpeg(std::span<const uint8_t> input) {
  Accepts([&] {
    const JpegKind kind = ReadJpegKind(input, "photo.jpg");
    if (kind.width > kMaxPixels / kind.height) {
      return;
    }
    CheckJpeg(input, "photo.jpg");
    if (!kind.is_cmyk) {
      DecodeJpeg<uint8_t>(input, "photo.jpg");
      DecodeJpeg<Rgb>(input, "photo.jpg");
    }
  });
}

// What is looked at before OpenCV decodes a photo, and PNG.
void ReadFrame(std::span<const uint8_t> input) {
  const std::optional<PhotoFormat> format = FormatOf(input);
  if (!format) {
    return;
  }
  DeclaredSize(*format, input);
  EndsInMarker(*format, input);
  if (*format == PhotoFormat::kPnm) {
    HasAllNumbers(input);
  } else if (*format == PhotoFormat::kJpeg2000) {
    HasJpeg2000End(input);
  } else if (*format == PhotoFormat::kTiff) {
    FindTiffDefect(input);
  } else if (*format == PhotoFormat::kPng) {
    const auto damaged = [](const std::string& defect) {
      return DamagedPhoto("photo.png", defect);
    };
    Accepts([&] { DecodePng<Rgb>(input, damaged); });
    Accepts([&] { DecodePng<uint8_t>(input, damaged); });
  }
}

std::string Encoded(const std::string& extension,
                    const cv::Mat& pixels,
                    const std::vector<int>& options = {}) {
  std::vector<uchar> bytes;
  cv::imencode(extension, pixels, bytes, options);
  return std::string(bytes.begin(), bytes.end());
}

cv::Mat Ramp(int type, int side = 20) {
  cv::Mat pixels(side, side, type);
  for (int i = 0; i < side * side; ++i) {
    pixels.row(i / side).col(i % side) =
        cv::Scalar(i % 251, 5 * i % 255, i % 7);
  }
  return pixels;
}

std::vector<std::string> MakeJpegSeeds() {
  return {Encoded(".jpg", Ramp(CV_8UC3)),
          Encoded(".jpg", Ramp(CV_8UC3), {cv::IMWRITE_JPEG_PROGRESSIVE, 1}),
          Encoded(".jpg", Ramp(CV_8UC3), {cv::IMWRITE_JPEG_RST_INTERVAL, 1}),
          Encoded(".jpg", Ramp(CV_8UC1))};
}

std::vector<std::string> MakePhotoSeeds() {
  std::vector<std::string> seeds;
  for (const char* extension : {".png", ".bmp", ".ppm", ".webp"}) {
    seeds.push_back(Encoded(extension, Ramp(CV_8UC3)));
  }
  // Smaller ones OpenJPEG does not write.
  seeds.push_back(Encoded(".jp2", Ramp(CV_8UC3, 64)));
  seeds.push_back(Encoded(".pgm", Ramp(CV_8UC1), {cv::IMWRITE_PXM_BINARY, 0}));
  // None, LZW, Deflate, PackBits.
  for (const int compression : {1, 5, 8, 32773}) {
    seeds.push_back(Encoded(
        ".tiff", Ramp(CV_8UC3), {cv::IMWRITE_TIFF_COMPRESSION, compression}));
  }
  return seeds;
}

}  // namespace

const FuzzTarget kJpegTarget = {"jpeg", &ReadJpeg, &MakeJpegSeeds};
const FuzzTarget kPhotoTarget = {"photo", &ReadFrame, &MakePhotoSeeds};

}  // namespace tsar
