// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/masks_and_labels.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/test_workspace.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;

constexpr RasterSize kImage = {8, 6};

class LabelImageTest : public testing::Test {
 protected:
  std::vector<fs::path> Find(const std::vector<std::string>& names) const {
    return FindLabelImages(folder_.Path(), names, "--region_path");
  }
  void Write(const cv::Mat& pixels) const {
    ASSERT_TRUE(cv::imwrite(path_.string(), pixels));
  }
  void ExpectRefused(ErrorCode code, const std::string& text) const {
    for (const auto& look :
         {+[](const fs::path& path) { ReadLabelImage(path, kImage); },
          +[](const fs::path& path) { CheckLabelImage(path, kImage); }}) {
      ExpectError(code, {path_.string() + ": " + text}, [&] { look(path_); });
    }
  }

  TemporaryFolder folder_;
  const fs::path path_ = folder_.Path() / "a.jpg.png";
};

TEST_F(LabelImageTest, IsFoundByTheNameOfTheImageWithOrWithoutItsExtension) {
  for (const char* name : {"a.jpg.png",
                           "a.png",
                           "b.png",
                           "left/b.c.png",
                           "d.png",
                           "e.png.png",
                           "e.png",
                           "right.png"}) {
    WriteText(folder_.Path() / name, "");
  }
  const std::vector<std::pair<std::string, std::string>> expected = {
      {"a.jpg", "a.jpg.png"},
      {"b.JPG", "b.png"},
      {"left/b.c.tif", "left/b.c.png"},
      {"d.png", "d.png"},
      {"e.png", "e.png.png"},
      {"right", "right.png"},
      {"left/a.jpg", ""},
      {"b.c.tif", ""}};
  std::vector<std::string> names;
  for (const auto& [name, file] : expected) {
    names.push_back(name);
  }
  const std::vector<fs::path> found = Find(names);
  ASSERT_EQ(found.size(), expected.size());
  for (size_t i = 0; i < found.size(); ++i) {
    const std::string& file = expected[i].second;
    EXPECT_EQ(found[i], file.empty() ? fs::path() : folder_.Path() / file);
  }
}

TEST_F(LabelImageTest, HoldsNumbersOfUpTo16Bits) {
  cv::Mat_<ushort> wide(6, 8, ushort{0});
  wide(0, 0) = 65535;
  wide(2, 3) = 256;
  wide(5, 7) = 1;
  Write(wide);
  EXPECT_EQ(CheckLabelImage(path_, kImage), 48);
  Image<uint16_t> labels = ReadLabelImage(path_, kImage);
  ASSERT_EQ(labels.Width(), 8);
  ASSERT_EQ(labels.Height(), 6);
  EXPECT_EQ(labels(0, 0), 65535);
  EXPECT_EQ(labels(3, 2), 256);
  EXPECT_EQ(labels(7, 5), 1);
  EXPECT_EQ(std::count(labels.begin(), labels.end(), 0), 45);

  cv::Mat_<uchar> narrow(6, 8, uchar{0});
  narrow(4, 1) = 255;
  narrow(4, 2) = 7;
  Write(narrow);
  labels = ReadLabelImage(path_, kImage);
  EXPECT_EQ(labels(1, 4), 255);
  EXPECT_EQ(labels(2, 4), 7);
  EXPECT_EQ(std::count(labels.begin(), labels.end(), 0), 46);

  ASSERT_TRUE(
      cv::imwrite(path_.string(), narrow, {cv::IMWRITE_PNG_BILEVEL, 1}));
  ASSERT_EQ(ReadText(path_)[24], 1);
  labels = ReadLabelImage(path_, kImage);
  EXPECT_NE(labels(1, 4), 0);
  EXPECT_EQ(labels(0, 0), 0);
}

TEST_F(LabelImageTest, MayHaveAnySizeOfTheImagesShape) {
  for (const auto& [width, height] : {std::pair(4, 3),
                                      std::pair(3, 2),  // 4:3, rounded.
                                      std::pair(80, 60),
                                      std::pair(81, 60),
                                      std::pair(80, 61)}) {
    Write(cv::Mat(height, width, CV_16UC1, cv::Scalar(3)));
    EXPECT_EQ(CheckLabelImage(path_, kImage), width * height);
    EXPECT_EQ(ReadLabelImage(path_, kImage).Width(), width);
  }
  for (const auto& [width, height] :
       {std::pair(60, 80), std::pair(83, 60), std::pair(80, 64)}) {
    Write(cv::Mat(height, width, CV_16UC1, cv::Scalar(3)));
    ExpectRefused(ErrorCode::kMismatch,
                  "the label image has " + std::to_string(width) + " x " +
                      std::to_string(height) +
                      " pixels, which is not the shape of its undistorted "
                      "image of 8 x 6; segment the undistorted images");
  }
}

TEST_F(LabelImageTest, ALargeOneIsReducedWithoutMixingItsNumbers) {
  cv::Mat_<ushort> pixels(1536, 2048);
  for (int y = 0; y < pixels.rows; ++y) {
    for (int x = 0; x < pixels.cols; ++x) {
      pixels(y, x) = x < 1000 ? 10 : y < 500 ? 20 : 40000;
    }
  }
  Write(pixels);
  const Image<uint16_t> labels = ReadLabelImage(path_, kImage);
  ASSERT_EQ(labels.Width(), kMaxLabelImageSide);
  ASSERT_EQ(labels.Height(), 768);
  for (int y = 0; y < labels.Height(); ++y) {
    for (int x = 0; x < labels.Width(); ++x) {
      ASSERT_EQ(labels(x, y), x < 500 ? 10 : y < 250 ? 20 : 40000);
    }
  }
}

TEST_F(LabelImageTest, OtherFilesAreRefused) {
  for (const int type : {CV_8UC3, CV_8UC4}) {
    Write(cv::Mat(6, 8, type, cv::Scalar::all(9)));
    ExpectRefused(ErrorCode::kUnsupported,
                  "the label image has colors or transparency, which are no "
                  "numbers of segments; write it as a PNG file of one channel");
  }
  WriteText(path_, std::string("\xff\xd8\xff\xe0 "));
  ExpectRefused(ErrorCode::kCorrupt,
                "the label image is no PNG file; write it as");
  Write(cv::Mat(6, 8, CV_16UC1, cv::Scalar(9)));
  const std::string png = ReadText(path_);
  WriteText(path_, png.substr(0, png.size() - 9));
  ExpectRefused(ErrorCode::kCorrupt, "the label image is damaged");
}

}  // namespace
}  // namespace tsar
