// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/companion_maps.h"

#include <string>

#include "tests/support/png_files.h"
#include "tests/support/test_workspace.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

class GrayPngTest : public testing::Test {
 protected:
  std::filesystem::path Write(const cv::Mat& pixels) const {
    cv::imwrite(path_.string(), pixels);
    return path_;
  }
  void ExpectNeither(ErrorCode code) const {
    ExpectError(code, {path_.string()}, [&] { ReadGrayPng(path_); });
    ExpectError(code, {path_.string()}, [&] { ReadGray16Png(path_); });
  }

  TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.Path() / "map.png";
};

TEST_F(GrayPngTest, KeepsValues) {
  const Image<uint8_t> read8 =
      ReadGrayPng(Write((cv::Mat_<uint8_t>(2, 3) << 0, 1, 2, 3, 4, 255)));
  ASSERT_EQ(read8.Width(), 3);
  ASSERT_EQ(read8.Height(), 2);
  EXPECT_EQ(read8(1, 1), 4);
  EXPECT_EQ(read8(2, 1), 255);
  const Image<uint16_t> read16 = ReadGray16Png(
      Write((cv::Mat_<uint16_t>(2, 3) << 0, 1, 2, 3, 256, 65535)));
  ASSERT_EQ(read16.Width(), 3);
  ASSERT_EQ(read16.Height(), 2);
  EXPECT_EQ(read16(1, 1), 256);
  EXPECT_EQ(read16(2, 1), 65535);
}

TEST_F(GrayPngTest, RefusesOtherNumbersOfBits) {
  Write(cv::Mat(2, 2, CV_16UC1, cv::Scalar(7)));
  ExpectError(ErrorCode::kCorrupt, {path_.string(), "of 8 bits"}, [&] {
    ReadGrayPng(path_);
  });
  Write(cv::Mat(2, 2, CV_8UC1, cv::Scalar(7)));
  ExpectError(ErrorCode::kCorrupt, {path_.string(), "of 16 bits"}, [&] {
    ReadGray16Png(path_);
  });
}

TEST_F(GrayPngTest, RefusesHostileFiles) {
  ExpectNeither(ErrorCode::kNotFound);
  WriteText(path_, "");
  ExpectNeither(ErrorCode::kCorrupt);
  WriteText(path_, "not a picture");
  ExpectNeither(ErrorCode::kCorrupt);
  Write(cv::Mat(4, 4, CV_8UC3, cv::Scalar(1, 2, 3)));
  ExpectNeither(ErrorCode::kCorrupt);
  Write(cv::Mat(4, 4, CV_16UC3, cv::Scalar(1, 2, 3)));
  ExpectNeither(ErrorCode::kCorrupt);
  cv::Mat drawn(64, 64, CV_16UC1);
  cv::randu(drawn, 0, 65536);
  const std::string whole = ReadText(Write(drawn));
  for (const size_t length : {size_t{20}, whole.size() / 2, whole.size() - 1}) {
    WriteText(path_, whole.substr(0, length));
    ExpectNeither(ErrorCode::kCorrupt);
  }
  testing::internal::CaptureStderr();
  for (const int bits : {8, 16}) {
    WriteText(path_, PngWithBrokenStream(64, 64, bits));
    ExpectNeither(ErrorCode::kCorrupt);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  // A width of more than two thousand million pixels.
  std::string absurd = whole;
  absurd[16] = '\x7f';
  WriteText(path_, absurd);
  ExpectNeither(ErrorCode::kCorrupt);
}

}  // namespace
}  // namespace tsar
