// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/png.h"

#include "colmap_tsar/base/error.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;

class PngTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_;
};

TEST_F(PngTest, WrittenColorsAreReadByOthers) {
  Image<Rgb> image(2, 1);
  image(0, 0) = {255, 10, 20};
  image(1, 0) = {30, 40, 250};
  const fs::path path = folder_ / "colors.png";
  WritePng(UserPath(path), image);
  const cv::Mat read = cv::imread(path.string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(read.type(), CV_8UC3);
  ASSERT_EQ(read.size(), cv::Size(2, 1));
  EXPECT_EQ(read.at<cv::Vec3b>(0, 0), cv::Vec3b(20, 10, 255));
  EXPECT_EQ(read.at<cv::Vec3b>(0, 1), cv::Vec3b(250, 40, 30));
}

TEST_F(PngTest, WritingIntoAMissingFolderIsAnError) {
  EXPECT_THROW(WritePng(UserPath(folder_ / "none" / "a.png"), Image<Rgb>(1, 1)),
               Error);
}

}  // namespace
}  // namespace tsar
