// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/photo.h"

#include <cmath>

#include "tests/support/test_workspace.h"
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sys/stat.h>

namespace tsar {
namespace {

struct Sample {
  std::string name;  // Such as "progressive.jpg".
  std::string bytes;
};

std::string Encoded(const std::string& extension,
                    const cv::Mat& pixels,
                    const std::vector<int>& options = {}) {
  std::vector<uchar> bytes;
  EXPECT_TRUE(cv::imencode(extension, pixels, bytes, options)) << extension;
  return std::string(bytes.begin(), bytes.end());
}

// One of every kind; all show the same picture, waves with noise, so that every
// compressed row has data.
std::vector<Sample> MakeSamples() {
  cv::Mat color(96, 128, CV_8UC3);
  uint32_t noise = 1;
  color.forEach<cv::Vec3b>([](cv::Vec3b& pixel, const int* at) {
    for (int c = 0; c < 3; ++c) {
      pixel[c] = cv::saturate_cast<uchar>(
          120 + 60 * std::sin(0.2 * at[c % 2] + 0.05 * at[1]));
    }
  });
  for (auto pixel = color.begin<cv::Vec3b>(); pixel != color.end<cv::Vec3b>();
       ++pixel) {
    noise = 1664525u * noise + 1013904223u;
    (*pixel)[noise % 3] ^= static_cast<uchar>(noise >> 28);
  }
  cv::Mat gray;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  cv::Mat deep;
  color.convertTo(deep, CV_16U, 257);
  cv::Mat with_alpha;
  cv::cvtColor(color, with_alpha, cv::COLOR_BGR2BGRA);
  return {
      {"color.jpg", Encoded(".jpg", color)},
      {"progressive.jpg",
       Encoded(".jpg", color, {cv::IMWRITE_JPEG_PROGRESSIVE, 1})},
      {"restarts.jpg",
       Encoded(".jpg", color, {cv::IMWRITE_JPEG_RST_INTERVAL, 4})},
      {"gray.jpg", Encoded(".jpg", gray)},
      {"color.png", Encoded(".png", color)},
      {"gray.png", Encoded(".png", gray)},
      {"deep.png", Encoded(".png", deep)},
      {"alpha.png", Encoded(".png", with_alpha)},
      {"color.tiff", Encoded(".tiff", color)},
      {"raw.tiff", Encoded(".tiff", gray, {cv::IMWRITE_TIFF_COMPRESSION, 1})},
      {"lossless.webp", Encoded(".webp", color)},
      {"color.bmp", Encoded(".bmp", color)},
      {"color.ppm", Encoded(".ppm", color)},
      {"color.jp2", Encoded(".jp2", color)},
  };
}

Sample FindSample(const std::string& name) {
  std::vector<Sample> samples = MakeSamples();
  return *std::ranges::find(samples, name, &Sample::name);
}

cv::Mat ReadByOpenCv(const std::filesystem::path& path, int mode) {
  return cv::imread(path.string(), mode | cv::IMREAD_IGNORE_ORIENTATION);
}

bool IsSame(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         cv::norm(a, b, cv::NORM_INF) == 0.0;
}

cv::Mat ReadAsBgr(const std::filesystem::path& path) {
  Image<Rgb> image = ReadPhoto(path);
  cv::Mat bgr;
  cv::cvtColor(cv::Mat(image.Height(), image.Width(), CV_8UC3, image.Data()),
               bgr,
               cv::COLOR_RGB2BGR);
  return bgr;
}

class PhotoTest : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& name,
                              const std::string& bytes) const {
    const std::filesystem::path path = folder_.Path() / name;
    WriteText(path, bytes);
    return path;
  }

  TemporaryFolder folder_;
};

TEST_F(PhotoTest, PixelsAreThoseOfOpenCv) {
  for (const Sample& sample : MakeSamples()) {
    SCOPED_TRACE(sample.name);
    const std::filesystem::path path = Write(sample.name, sample.bytes);
    CheckPhotoFile(path);
    EXPECT_TRUE(IsSame(ReadAsBgr(path), ReadByOpenCv(path, cv::IMREAD_COLOR)));
    Image<uint8_t> gray = ReadGrayPhoto(path);
    EXPECT_TRUE(
        IsSame(cv::Mat(gray.Height(), gray.Width(), CV_8UC1, gray.Data()),
               ReadByOpenCv(path, cv::IMREAD_GRAYSCALE)));
  }
}

TEST_F(PhotoTest, WhatIsCutOffIsRefusedOrWhole) {
  for (const Sample& sample : MakeSamples()) {
    SCOPED_TRACE(sample.name);
    const cv::Mat whole = ReadAsBgr(Write(sample.name, sample.bytes));
    const size_t size = sample.bytes.size();
    for (size_t left = 1; left < size;
         left += left < 60 || left + 40 > size ? 1 : 487) {
      const auto path = Write(sample.name, sample.bytes.substr(0, left));
      try {
        EXPECT_TRUE(IsSame(ReadAsBgr(path), whole)) << left << " of " << size;
      } catch (const Error& error) {
        EXPECT_EQ(error.Code(), ErrorCode::kCorrupt);
        EXPECT_THAT(error.what(), testing::StartsWith(path.string() + ": "));
      }
    }
    const auto path = Write(sample.name, sample.bytes.substr(0, size / 3));
    ExpectError(ErrorCode::kCorrupt,
                {path.string(), "the image is damaged"},
                [&] { ReadPhoto(path); });
    if (sample.name.ends_with(".jpg") || sample.name.ends_with(".png")) {
      EXPECT_THROW(CheckPhotoFile(path), Error);
    }
  }
}

// Appended data, padded markers, an orientation, and a thumbnail with its own
// end marker.
TEST_F(PhotoTest, WhatIsNotThePictureDoesNotMatter) {
  const std::string exif(
      "\xff\xff\xe1\0\x24"
      "Exif\0\0II*\0\x08\0\0\0\x01\0"
      "\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0\xff\xd9",
      39);
  for (const char* name : {"color.jpg", "progressive.jpg", "color.png"}) {
    const Sample sample = FindSample(name);
    const cv::Mat whole = ReadAsBgr(Write(name, sample.bytes));
    std::string bytes = sample.bytes + std::string(5000, '\0') + "motion";
    if (sample.name.ends_with(".jpg")) {
      bytes.insert(2, exif);
      const auto cut =
          Write("cut.jpg", bytes.substr(0, sample.bytes.size() / 2));
      EXPECT_THROW(ReadPhoto(cut), Error);
    }
    const std::filesystem::path path = Write(name, bytes);
    CheckPhotoFile(path);
    EXPECT_TRUE(IsSame(ReadAsBgr(path), whole)) << name;
  }
}

TEST_F(PhotoTest, RefusesWhatIsNoPhoto) {
  const std::filesystem::path path = folder_.Path() / "photo.jpg";
  ExpectError(ErrorCode::kNotFound, {path.string(), "no such image"}, [&] {
    CheckPhotoFile(path);
  });
  for (const auto& [bytes, text] :
       {std::pair(std::string("no picture"), "not a readable image"),
        std::pair(std::string("\0\0\0", 3), "not a readable image"),
        std::pair(std::string(), "the file is empty")}) {
    WriteText(path, bytes);
    ExpectError(
        ErrorCode::kCorrupt, {path.string(), text}, [&] { ReadPhoto(path); });
    EXPECT_THROW(CheckPhotoFile(path), Error);
  }
  std::filesystem::remove(path);
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  for (const std::filesystem::path& special :
       {path, folder_.Path(), std::filesystem::path("/dev/zero")}) {
    ExpectError(ErrorCode::kIo,
                {special.string(), "cannot be read (it is a"},
                [&] { CheckPhotoFile(special); });
  }
}

TEST(HasBlackBorderTest, IsExactlyBlackAndAtARim) {
  constexpr Rgb kGray = {1, 0, 0};
  EXPECT_FALSE(HasBlackBorder({}));
  EXPECT_TRUE(HasBlackBorder(Image<Rgb>(20, 10)));
  Image<Rgb> photo(20, 10, kGray);
  photo(10, 5) = photo(11, 5) = {};
  photo(0, 5) = {};
  EXPECT_FALSE(HasBlackBorder(photo));
  photo(19, 6) = {};
  EXPECT_TRUE(HasBlackBorder(photo));
}

}  // namespace
}  // namespace tsar
