// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/png_chunks.h"

#include "colmap_tsar/base/picture_file.h"

#include <string>
#include <utility>
#include <vector>

#include "tests/support/png_files.h"
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

constexpr uint32_t kWidth = 11;
constexpr uint32_t kHeight = 7;

std::vector<uint8_t> AsBytes(const std::string& text) {
  return {text.begin(), text.end()};
}

std::string Defect(const std::string& file) {
  return FindPngDefect(AsBytes(file));
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

TEST(PngChunks, AllKindsOfPixelsAreWhole) {
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
        const std::string whole = file(rows);
        EXPECT_EQ(Defect(whole), "");
        EXPECT_EQ(Defect(file(rows.substr(1))),
                  "its pixels cannot be decompressed");
        EXPECT_EQ(Defect(file(rows + '\0')),
                  "its pixels cannot be decompressed");
        testing::internal::CaptureStderr();
        const cv::Mat pixels =
            DecodePicture(AsBytes(whole), cv::IMREAD_UNCHANGED);
        const cv::Mat kept = DecodePicture(KeepCriticalChunks(AsBytes(whole)),
                                           cv::IMREAD_UNCHANGED);
        EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
        ASSERT_FALSE(pixels.empty());
        EXPECT_EQ(cv::norm(pixels, kept, cv::NORM_INF), 0.0);
      }
    }
  }
}

TEST(PngChunks, ChecksumsDoNotMakeAStreamOfPixels) {
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
    EXPECT_EQ(Defect(GrayFile(broken)), "its pixels cannot be decompressed");
  }
  EXPECT_EQ(Defect(PngFile(kGrayHeader, "")),
            "its pixels cannot be decompressed");
}

TEST(PngChunks, HeadersOfNoPictureAreRefused) {
  const std::string pixels = PngChunk("IDAT", Deflated(GrayRows()));
  const auto expect_refused = [&](const std::string& header) {
    EXPECT_EQ(Defect(PngFile(header, Palette(2) + pixels)),
              "its header makes no sense");
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

TEST(PngChunks, PalettesAreCheckedWhereTheyAreUsed) {
  const std::string header = PngHeaderContent(kWidth, kHeight, 4, 3);
  const std::string pixels = PngChunk("IDAT", Deflated(DrawRows(4, 3, false)));
  EXPECT_EQ(Defect(PngFile(header, Palette(16) + pixels)), "");
  for (const std::string& palette :
       {std::string(), Palette(0), Palette(257), PngChunk("PLTE", "1234")}) {
    EXPECT_EQ(Defect(PngFile(header, palette + pixels)),
              "its palette makes no sense");
  }
  for (const std::string& chunks :
       {Palette(16) + Palette(16) + pixels,
        pixels + Palette(16),
        Palette(16) + pixels + PngChunk("NEED", "")}) {
    EXPECT_EQ(Defect(PngFile(header, chunks)),
              "it has chunks that make no sense");
  }
  // Of no use to others, of which libpng warns.
  const std::string gray = PngFile(
      kGrayHeader,
      PngChunk("PLTE", "1234") + PngChunk("IDAT", Deflated(GrayRows())));
  ASSERT_EQ(Defect(gray), "");
  EXPECT_EQ(KeepCriticalChunks(AsBytes(gray)),
            AsBytes(GrayFile(Deflated(GrayRows()))));
}

TEST(PngChunks, ALastChunkWithContentIsNone) {
  std::string file = GrayFile(Deflated(GrayRows()));
  file.replace(file.size() - 12, 12, PngChunk("IEND", "more"));
  EXPECT_EQ(Defect(file), "it has chunks that make no sense");
}

// Whatever stands where, as long as the checksums are right: what is found
// without defects OpenCV decodes, and prints nothing.
TEST(PngChunks, WhatHasNoDefectIsDecodedInSilence) {
  uint32_t random = 11;
  const auto draw = [&](size_t below) {
    random = 1664525u * random + 1013904223u;
    return (random >> 8) % below;
  };
  int num_decoded = 0;
  testing::internal::CaptureStderr();
  for (int round = 0; round < 6000; ++round) {
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
    const std::vector<uint8_t> file = AsBytes(PngFile(
        header, (draw(4) > 0 ? palette : "") + PngChunk("IDAT", stream)));
    if (FindPngDefect(file).empty()) {
      ++num_decoded;
      EXPECT_FALSE(
          DecodePicture(KeepCriticalChunks(file), cv::IMREAD_COLOR).empty());
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_GT(num_decoded, 500);
}

}  // namespace
}  // namespace tsar
