// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/png.h"

#include "colmap_tsar/base/picture_file.h"

#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/png_files.h"
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

constexpr uint32_t kWidth = 11;
constexpr uint32_t kHeight = 7;

std::vector<uint8_t> AsBytes(const std::string& text) {
  return {text.begin(), text.end()};
}

Image<Rgb> Decode(const std::string& file) {
  return DecodePng<Rgb>(AsBytes(file), [](const std::string& defect) {
    return Error::File(ErrorCode::kCorrupt, "a.png", defect, "");
  });
}

// What is wrong with a file, or nothing.
std::string Defect(const std::string& file) {
  try {
    Decode(file);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

int NumChannels(int color_type) {
  return color_type == 2 ? 3 : color_type == 4 ? 2 : color_type == 6 ? 4 : 1;
}

// Bytes of all values; every filter in turn. Sizes as the specification has
// them: pixel by pixel, in each pass those whose place is in the pattern.
std::string DrawRows(int bits, int color_type, bool is_interlaced) {
  constexpr char kPattern[8][9] = {"16462646",
                                   "77777777",
                                   "56565656",
                                   "77777777",
                                   "36463646",
                                   "77777777",
                                   "56565656",
                                   "77777777"};
  std::string rows;
  uint32_t random = 5;
  for (int pass = 1; pass <= (is_interlaced ? 7 : 1); ++pass) {
    for (uint32_t y = 0; y < kHeight; ++y) {
      int num_bits = 0;
      for (uint32_t x = 0; x < kWidth; ++x) {
        if (!is_interlaced || kPattern[y % 8][x % 8] == '0' + pass) {
          num_bits += bits * NumChannels(color_type);
        }
      }
      if (num_bits == 0) {
        continue;
      }
      rows += static_cast<char>(y % 5);
      for (int i = 0; i < (num_bits + 7) / 8; ++i) {
        random = 1664525u * random + 1013904223u;
        rows += static_cast<char>(random >> 24);
      }
    }
  }
  return rows;
}

std::string Palette(int num_colors) {
  std::string colors;
  for (int i = 0; i < 3 * num_colors; ++i) {
    colors += static_cast<char>(5 * i);
  }
  return PngChunk("PLTE", colors);
}

// The content of the first chunk and the pixels of a small gray picture.
const std::string kGrayHeader = PngHeaderContent(kWidth, kHeight, 8, 0);
std::string GrayRows() { return DrawRows(8, 0, false); }

std::string GrayFile(const std::string& stream) {
  return PngFile(kGrayHeader, PngChunk("IDAT", stream));
}

// That a file without defects has them, and that nothing is printed.
void ExpectPixelsOfOpenCv(const std::string& file) {
  const std::vector<uint8_t> bytes = AsBytes(file);
  const PngError error = [](const std::string& defect) {
    return Error::File(ErrorCode::kCorrupt, "a.png", defect, "");
  };
  testing::internal::CaptureStderr();
  Image<Rgb> rgb = DecodePng<Rgb>(bytes, error);
  Image<uint8_t> gray = DecodePng<uint8_t>(bytes, error);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  cv::Mat bgr;
  cv::cvtColor(cv::Mat(rgb.Height(), rgb.Width(), CV_8UC3, rgb.Data()),
               bgr,
               cv::COLOR_RGB2BGR);
  // OpenCV may print.
  testing::internal::CaptureStderr();
  const cv::Mat expected = DecodePicture(bytes, cv::IMREAD_COLOR);
  const cv::Mat expected_gray = DecodePicture(bytes, cv::IMREAD_GRAYSCALE);
  testing::internal::GetCapturedStderr();
  ASSERT_EQ(bgr.size(), expected.size());
  EXPECT_EQ(cv::norm(bgr, expected, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(cv::Mat(gray.Height(), gray.Width(), CV_8UC1, gray.Data()),
                     expected_gray,
                     cv::NORM_INF),
            0.0);
}

TEST(Png, AllKindsOfPixelsAreThoseOfOpenCv) {
  for (const auto& [color_type, all_bits] :
       {std::pair(0, std::vector<int>{1, 2, 4, 8, 16}),
        std::pair(2, std::vector<int>{8, 16}),
        std::pair(3, std::vector<int>{1, 2, 4, 8}),
        std::pair(4, std::vector<int>{8, 16}),
        std::pair(6, std::vector<int>{8, 16})}) {
    for (const int bits : all_bits) {
      for (const bool is_interlaced : {false, true}) {
        SCOPED_TRACE(testing::Message()
                     << color_type << " " << bits << " " << is_interlaced);
        const std::string rows = DrawRows(bits, color_type, is_interlaced);
        const auto file = [&](const std::string& content) {
          const std::string stream = Deflated(content);
          // Over several chunks, one of which is empty.
          return PngFile(PngHeaderContent(
                             kWidth, kHeight, bits, color_type, is_interlaced),
                         (color_type == 3 ? Palette(1 << bits) : "") +
                             PngChunk("IDAT", stream.substr(0, 5)) +
                             PngChunk("IDAT", "") +
                             PngChunk("IDAT", stream.substr(5)));
        };
        testing::internal::CaptureStderr();
        EXPECT_NE(Defect(file(rows.substr(1))), "");
        EXPECT_NE(Defect(file(rows + '\0')), "");
        EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
        ExpectPixelsOfOpenCv(file(rows));
      }
    }
  }
}

TEST(Png, ChecksumsDoNotMakeAStreamOfPixels) {
  const std::string rows = GrayRows();
  const std::string stream = Deflated(rows);
  ASSERT_EQ(Defect(GrayFile(stream)), "");
  std::string unknown_filter = rows;
  unknown_filter[kWidth + 1] = 5;
  std::string zeros = stream;
  zeros.replace(stream.size() / 2, 8, 8, '\0');
  std::string other_method = stream;
  other_method[0] = 0x79;
  std::string other_sum = stream;
  other_sum.back() = static_cast<char>(other_sum.back() ^ 1);
  for (const std::string& broken : {std::string(),
                                    stream.substr(0, 1),
                                    stream.substr(0, stream.size() / 2),
                                    stream.substr(0, stream.size() - 1),
                                    stream + '\0',
                                    stream + stream,
                                    zeros,
                                    other_method,
                                    other_sum,
                                    Deflated(unknown_filter)}) {
    EXPECT_NE(Defect(GrayFile(broken)), "");
  }
  EXPECT_NE(Defect(PngFile(kGrayHeader, "")), "");
}

TEST(Png, HeadersOfNoPictureAreRefused) {
  const std::string pixels = PngChunk("IDAT", Deflated(GrayRows()));
  const auto expect_refused = [&](const std::string& header) {
    EXPECT_NE(Defect(PngFile(header, Palette(2) + pixels)), "");
  };
  for (const auto& [bits, color_type] : {std::pair(0, 0),
                                         std::pair(3, 0),
                                         std::pair(32, 0),
                                         std::pair(8, 1),
                                         std::pair(4, 2),
                                         std::pair(16, 3),
                                         std::pair(4, 4),
                                         std::pair(8, 5),
                                         std::pair(1, 6),
                                         std::pair(8, 7)}) {
    expect_refused(PngHeaderContent(kWidth, kHeight, bits, color_type));
  }
  for (const auto& [width, height] : {std::pair(0u, 1u),
                                      std::pair(1u, 0u),
                                      std::pair(1000001u, 1u),
                                      std::pair(1u, 0xffffffffu),
                                      std::pair(40000u, 40000u)}) {
    expect_refused(PngHeaderContent(width, height, 8, 0));
  }
  for (const size_t field : {10, 11, 12}) {  // How it is packed.
    std::string header = kGrayHeader;
    header[field] = 2;
    expect_refused(header);
  }
}

TEST(Png, PalettesAreCheckedWhereTheyAreUsed) {
  const std::string header = PngHeaderContent(kWidth, kHeight, 4, 3);
  const std::string pixels = PngChunk("IDAT", Deflated(DrawRows(4, 3, false)));
  EXPECT_EQ(Defect(PngFile(header, Palette(16) + pixels)), "");
  for (const std::string& palette :
       {std::string(), Palette(0), Palette(257), PngChunk("PLTE", "1234")}) {
    EXPECT_NE(Defect(PngFile(header, palette + pixels)), "");
  }
  for (const std::string& chunks :
       {Palette(16) + Palette(16) + pixels,
        pixels + Palette(16),
        Palette(16) + pixels + PngChunk("NEED", "")}) {
    EXPECT_NE(Defect(PngFile(header, chunks)), "");
  }
}

// Text with a wrong checksum, a color profile and transparency that make no
// sense, a palette that nothing refers to.
TEST(Png, WhatIsNotNeededForThePixelsIsSkipped) {
  const std::string pixels = PngChunk("IDAT", Deflated(GrayRows()));
  std::string text = PngChunk("tEXt", "a text");
  text.back() = static_cast<char>(text.back() ^ 1);
  testing::internal::CaptureStderr();
  const Image<Rgb> image = Decode(PngFile(kGrayHeader, pixels));
  for (const std::string& chunk : {text,
                                   PngChunk("iCCP", "icc"),
                                   PngChunk("tRNS", "1"),
                                   PngChunk("tRNS", std::string("\0\7", 2)),
                                   PngChunk("gAMA", std::string(4, '\1')),
                                   PngChunk("PLTE", "1234")}) {
    const Image<Rgb> annotated = Decode(PngFile(kGrayHeader, chunk + pixels));
    EXPECT_EQ(std::memcmp(annotated.Data(), image.Data(), 3 * kWidth * kHeight),
              0);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Png, ALastChunkWithContentIsNone) {
  std::string file = GrayFile(Deflated(GrayRows()));
  file.replace(file.size() - 12, 12, PngChunk("IEND", "more"));
  EXPECT_NE(Defect(file), "");
}

// Whatever stands where, as long as the checksums are right.
TEST(Png, AnyContentIsAnErrorOrThePixelsOfOpenCvInSilence) {
  uint32_t random = 11;
  const auto draw = [&](size_t below) {
    random = 1664525u * random + 1013904223u;
    return (random >> 8) % below;
  };
  int num_decoded = 0;
  for (int round = 0; round < 3000; ++round) {
    const int color_type = static_cast<int>(round % 7);
    const int bits = 1 << draw(5);
    std::string header = PngHeaderContent(
        kWidth, kHeight, bits, color_type, /*is_interlaced=*/draw(2) == 0);
    std::string rows = DrawRows(bits, color_type, header.back() == 1);
    std::string stream = Deflated(rows);
    std::string palette = Palette(1 + static_cast<int>(draw(300)));
    std::string* const parts[] = {&header, &rows, &stream};
    if (std::string& part = *parts[round % 3]; draw(4) > 0) {
      part[draw(part.size())] = static_cast<char>(draw(256));
    }
    if (round % 3 == 1) {
      stream = Deflated(rows);
    }
    const std::string file = PngFile(
        header, (draw(4) > 0 ? palette : "") + PngChunk("IDAT", stream));
    testing::internal::CaptureStderr();
    const std::string defect = Defect(file);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    if (defect.empty()) {
      ++num_decoded;
      ExpectPixelsOfOpenCv(file);
    }
  }
  EXPECT_GT(num_decoded, 250);
}

}  // namespace
}  // namespace tsar
