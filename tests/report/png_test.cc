// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/png.h"

#include "colmap_tsar/base/error.h"

#include <filesystem>
#include <fstream>
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

TEST_F(PngTest, GrayValuesAreKept) {
  const fs::path path = folder_ / "gray.png";
  const cv::Mat values = (cv::Mat_<uint8_t>(2, 3) << 0, 1, 2, 3, 4, 5);
  cv::imwrite(path.string(), values);
  const Image<uint8_t> image = ReadGrayPng(path);
  ASSERT_EQ(image.Width(), 3);
  ASSERT_EQ(image.Height(), 2);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(image(i % 3, i / 3), i);
  }
}

ErrorCode CodeOf(const fs::path& path) {
  try {
    ReadGrayPng(path);
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(path.filename().string()),
              std::string::npos);
    return error.Code();
  }
  ADD_FAILURE() << path << " was read";
  return ErrorCode::kIo;
}

TEST_F(PngTest, HostileFilesAreErrors) {
  EXPECT_EQ(CodeOf(folder_ / "missing.png"), ErrorCode::kNotFound);

  const fs::path empty = folder_ / "empty.png";
  std::ofstream(empty).close();
  EXPECT_EQ(CodeOf(empty), ErrorCode::kCorrupt);

  const fs::path text = folder_ / "text.png";
  std::ofstream(text) << "not a picture";
  EXPECT_EQ(CodeOf(text), ErrorCode::kCorrupt);

  const fs::path color = folder_ / "color.png";
  WritePng(UserPath(color), Image<Rgb>(4, 4));
  EXPECT_EQ(CodeOf(color), ErrorCode::kCorrupt);
}

}  // namespace
}  // namespace tsar
