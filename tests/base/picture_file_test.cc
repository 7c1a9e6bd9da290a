// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/picture_file.h"

#include "colmap_tsar/base/error.h"

#include <cstdint>
#include <filesystem>
#include <new>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;

class PictureFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = fs::path(::testing::TempDir()) /
            ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove(path_);
  }
  void TearDown() override { fs::remove(path_); }

  fs::path path_;
};

TEST_F(PictureFileTest, PixelsAreThoseThatWereGiven) {
  cv::Mat_<uint16_t> pixels(2, 3);
  int value = 0;
  for (uint16_t& pixel : pixels) {
    pixel = static_cast<uint16_t>(value += 9999);
  }
  AtomicFile file(UserPath(path_));
  PutPicture(pixels, ".png", path_, &file);
  file.Commit();
  const cv::Mat read = cv::imread(path_.string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(read.type(), CV_16UC1);
  ASSERT_EQ(read.size(), pixels.size());
  EXPECT_EQ(cv::norm(read, pixels, cv::NORM_INF), 0.);
}

TEST_F(PictureFileTest, NamesTheFileOfAFormatThatIsMissing) {
  AtomicFile file(UserPath(path_));
  try {
    PutPicture(cv::Mat_<uint8_t>(2, 3, uint8_t{7}), ".abc", path_, &file);
    FAIL() << "has written";
  } catch (const Error& error) {
    EXPECT_EQ(error.Code(), ErrorCode::kIo);
    EXPECT_THAT(error.what(), testing::StartsWith(path_.string()));
    EXPECT_THAT(error.what(), testing::HasSubstr("encoded as abc"));
  }
}

// OpenCV reports that an encoder had no memory as an assertion of its own. More
// rows than JPEG can have fail in the encoder in the same way.
TEST_F(PictureFileTest, AnEncoderThatFailsHadNoMemory) {
  AtomicFile file(UserPath(path_));
  EXPECT_THROW(
      PutPicture(cv::Mat_<uint8_t>(70000, 1, uint8_t{7}), ".jpg", path_, &file),
      std::bad_alloc);
}

}  // namespace
}  // namespace tsar
