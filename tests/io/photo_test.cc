// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/photo.h"

#include <algorithm>
#include <optional>

#include "tests/support/photo_files.h"
#include "tests/support/png_files.h"
#include "tests/support/test_workspace.h"
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sys/stat.h>

namespace tsar {
namespace {

cv::Mat ReadByOpenCv(const std::filesystem::path& path, int mode) {
  return cv::imread(path.string(), mode | cv::IMREAD_IGNORE_ORIENTATION);
}

bool IsSame(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         cv::norm(a, b, cv::NORM_INF) == 0.0;
}

cv::Mat AsBgr(Image<Rgb> image) {
  cv::Mat bgr;
  cv::cvtColor(cv::Mat(image.Height(), image.Width(), CV_8UC3, image.Data()),
               bgr,
               cv::COLOR_RGB2BGR);
  return bgr;
}

cv::Mat AsGray(Image<uint8_t> image) {
  return cv::Mat(image.Height(), image.Width(), CV_8UC1, image.Data()).clone();
}

class PhotoTest : public testing::Test {
 protected:
  // A new file of the sample's name with other content.
  std::filesystem::path Write(const PhotoSample& sample,
                              const std::string& bytes) const {
    const std::filesystem::path path = folder_.Path() / sample.name;
    WriteText(path, bytes);
    return path;
  }

  // The pixels, or nothing where the photo is refused in the right words.
  std::optional<cv::Mat> Read(const PhotoSample& sample,
                              const std::string& bytes) const {
    const std::filesystem::path path = Write(sample, bytes);
    try {
      return AsBgr(ReadPhoto(path));
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(path.string() + ": "));
      EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
      return std::nullopt;
    }
  }

  void ExpectRefused(const PhotoSample& sample,
                     const std::string& bytes,
                     const std::string& text) const {
    const std::filesystem::path path = Write(sample, bytes);
    ExpectError(
        ErrorCode::kCorrupt, {path.string(), text}, [&] { ReadPhoto(path); });
  }

  // That the photo is read as if it had not been changed, in silence.
  void ExpectUnchanged(const PhotoSample& sample,
                       const std::string& bytes) const {
    SCOPED_TRACE(sample.name);
    const std::optional<cv::Mat> whole = Read(sample, sample.bytes);
    testing::internal::CaptureStderr();
    const std::optional<cv::Mat> read = Read(sample, bytes);
    CheckPhotoFile(folder_.Path() / sample.name);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    ASSERT_TRUE(read && whole);
    EXPECT_TRUE(IsSame(*read, *whole));
  }

  TemporaryFolder folder_;
};

TEST_F(PhotoTest, PixelsAreThoseOfOpenCv) {
  for (const PhotoSample& sample : MakePhotoSamples()) {
    SCOPED_TRACE(sample.name);
    const std::filesystem::path path = Write(sample, sample.bytes);
    EXPECT_TRUE(
        IsSame(AsBgr(ReadPhoto(path)), ReadByOpenCv(path, cv::IMREAD_COLOR)));
    EXPECT_TRUE(IsSame(AsGray(ReadGrayPhoto(path)),
                       ReadByOpenCv(path, cv::IMREAD_GRAYSCALE)));
    CheckPhotoFile(path);
  }
}

TEST_F(PhotoTest, WhatIsCutOffIsRefusedOrWhole) {
  for (const PhotoSample& sample : MakePhotoSamples()) {
    SCOPED_TRACE(sample.name);
    const cv::Mat whole = Read(sample, sample.bytes).value();
    testing::internal::CaptureStderr();
    const size_t size = sample.bytes.size();
    int num_refused = 0;
    for (size_t left = 0; left < size;
         left += left < 200 || left + 100 > size ? 1 : 487) {
      const auto read = Read(sample, sample.bytes.substr(0, left));
      num_refused += read ? 0 : 1;
      ASSERT_TRUE(!read || IsSame(*read, whole)) << left << " of " << size;
    }
    EXPECT_GT(num_refused, 200);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    // What most formats tell at their end is seen without the pixels.
    const auto path = Write(sample, sample.bytes.substr(0, size / 10));
    if (sample.name != "first.tiff" && sample.name != "text.ppm") {
      ExpectError(ErrorCode::kCorrupt, {path.string(), "damaged"}, [&] {
        CheckPhotoFile(path);
      });
    }
    EXPECT_THROW(ReadGrayPhoto(path), Error);
  }
}

// A stretch from the first third to the second.
TEST_F(PhotoTest, ZerosInTheMiddleAreRefused) {
  for (const PhotoSample& sample : MakePhotoSamples()) {
    if (!sample.shows_zeros) {
      continue;
    }
    SCOPED_TRACE(sample.name);
    testing::internal::CaptureStderr();
    for (size_t third = 3; third < 6; ++third) {
      std::string bytes = sample.bytes;
      const auto begin =
          bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / third);
      std::fill(begin, begin + 700, '\0');
      ExpectRefused(sample, bytes, "the image is damaged: ");
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  }
}

// Of JPEG within TIFF libtiff only warns.
TEST_F(PhotoTest, ShorterZerosAreRefusedInTilesOfJpeg) {
  const PhotoSample sample = FindPhotoSample("jpeg.tiff");
  for (size_t begin = sample.bytes.size() / 4;
       begin < sample.bytes.size() * 3 / 4;
       begin += 131) {
    std::string bytes = sample.bytes;
    bytes.replace(begin, 100, 100, '\0');
    ExpectRefused(sample, bytes, "the image is damaged: ");
  }
}

TEST_F(PhotoTest, ChecksumsShowEveryBit) {
  for (const PhotoSample& sample : MakePhotoSamples()) {
    if (!sample.shows_flips) {
      continue;
    }
    SCOPED_TRACE(sample.name);
    testing::internal::CaptureStderr();
    const size_t size = sample.bytes.size();
    for (size_t i = size / 8; i < size / 8 * 7; i += 97) {
      std::string bytes = sample.bytes;
      bytes[i] = static_cast<char>(bytes[i] ^ (1 << (i % 8)));
      ExpectRefused(sample, bytes, "the image is damaged: ");
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  }
}

TEST_F(PhotoTest, ChecksumsOfPngDoNotVouchForItsPixels) {
  testing::internal::CaptureStderr();
  ExpectRefused({"photo.png", "", false, false},
                PngWithBrokenStream(64, 48),
                "the image is damaged: ");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// Whatever is damaged, it is a line or a picture, and no crash.
TEST_F(PhotoTest, AnyDamageIsAnErrorOrAPicture) {
  uint32_t random = 7;
  const auto draw = [&](size_t below) {
    random = 1664525u * random + 1013904223u;
    return (random >> 8) % below;
  };
  // OpenCV prints where it is at a loss.
  testing::internal::CaptureStderr();
  for (const PhotoSample& sample : MakePhotoSamples()) {
    for (int i = 0; i < 100; ++i) {
      std::string bytes = sample.bytes;
      for (size_t n = draw(4) + 1; n > 0; --n) {
        const size_t limit = i % 2 == 0 ? 64 : bytes.size();
        bytes[draw(limit)] = static_cast<char>(draw(256));
      }
      Read(sample, bytes);
    }
  }
  testing::internal::GetCapturedStderr();
}

TEST_F(PhotoTest, WhatStandsBehindTheEndIsNotLookedAt) {
  for (const char* name : {"color.jpg",
                           "progressive.jpg",
                           "cmyk.jpg",
                           "color.png",
                           "color.bmp",
                           "color.ppm",
                           "color.webp"}) {
    const PhotoSample sample = FindPhotoSample(name);
    ExpectUnchanged(sample, sample.bytes + std::string(5000, '\0') + "motion");
  }
}

TEST_F(PhotoTest, OddMetadataDoNotMatter) {
  const PhotoSample jpeg = FindPhotoSample("color.jpg");
  ASSERT_EQ(jpeg.bytes.substr(6, 5), std::string("JFIF\0", 5));
  std::string other_version = jpeg.bytes;
  other_version[11] = 9;
  ExpectUnchanged(jpeg, other_version);
  // A transform of Adobe's that does not exist; an orientation.
  std::string adobe = jpeg.bytes;
  adobe.replace(2,
                18,
                std::string("\xff\xee\0\x0e"
                            "Adobe\0\x64\0\0\0\0\x07",
                            16));
  ExpectUnchanged(jpeg, adobe);
  std::string turned = jpeg.bytes;
  turned.insert(2,
                std::string("\xff\xe1\0\x22"
                            "Exif\0\0II*\0\x08\0\0\0\x01\0"
                            "\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0",
                            36));
  ExpectUnchanged(jpeg, turned);
  // Text with a wrong checksum, and a color profile that makes no sense.
  const PhotoSample png = FindPhotoSample("color.png");
  constexpr size_t kFirstChunk = 8 + 12 + 13;
  std::string annotated = png.bytes;
  annotated.insert(kFirstChunk, std::string("\0\0\0\4iCCPicc\0\1\2\3\4", 16));
  annotated.insert(kFirstChunk, std::string("\0\0\0\4tEXta\0bc\0\0\0\0", 16));
  ExpectUnchanged(png, annotated);
}

TEST_F(PhotoTest, KnowsPngFilesWithAlpha) {
  const std::filesystem::path png = folder_.Path() / "alpha.png";
  const std::filesystem::path jpeg = folder_.Path() / "alpha.jpg";
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4}) {
    const cv::Mat pixels(5, 7, type, cv::Scalar::all(90));
    cv::imwrite(png.string(), pixels);
    EXPECT_EQ(HasAlpha(png), type == CV_8UC4);
  }
  cv::imwrite(jpeg.string(), cv::Mat(5, 7, CV_8UC3, cv::Scalar::all(90)));
  EXPECT_FALSE(HasAlpha(jpeg));
}

TEST_F(PhotoTest, RefusesWhatIsNoPhoto) {
  const PhotoSample sample = {"photo.jpg", "", false, false};
  const std::filesystem::path path = folder_.Path() / sample.name;
  ExpectError(ErrorCode::kNotFound, {path.string(), "no such image"}, [&] {
    CheckPhotoFile(path);
  });
  const std::string exotic[] = {"no picture",
                                std::string("\0\0\0", 3),
                                "GIF89a\1\0\1\0",
                                "#?RADIANCE\n",
                                "P6",
                                "P4\n8 1\n1",
                                "Pf\n1 1\n-1.0\n1234"};
  for (const std::string& bytes : exotic) {
    ExpectRefused(sample, bytes, "not a readable image: it is none of JPEG");
    EXPECT_THROW(CheckPhotoFile(path), Error);
  }
  ExpectRefused(sample, "", "the file is empty");
  std::filesystem::remove(path);
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  for (const std::filesystem::path& special :
       {path, folder_.Path(), std::filesystem::path("/dev/zero")}) {
    ExpectError(ErrorCode::kIo,
                {special.string(), "cannot be read: it is a"},
                [&] { ReadPhoto(special); });
    ExpectError(
        ErrorCode::kIo, {special.string()}, [&] { CheckPhotoFile(special); });
  }
}

TEST_F(PhotoTest, FollowsLinks) {
  const PhotoSample sample = FindPhotoSample("gray.jpg");
  const std::filesystem::path path = Write(sample, sample.bytes);
  const std::filesystem::path link = folder_.Path() / "link.png";
  std::filesystem::create_symlink(path, link);
  CheckPhotoFile(link);
  EXPECT_TRUE(IsSame(AsBgr(ReadPhoto(link)), AsBgr(ReadPhoto(path))));
}

// Headers that say more than memory can hold.
TEST_F(PhotoTest, RefusesTooManyPixels) {
  PhotoSample jpeg = FindPhotoSample("color.jpg");
  const size_t frame = jpeg.bytes.find("\xff\xc0");
  ASSERT_NE(frame, std::string::npos);
  jpeg.bytes.replace(frame + 5, 4, "\xff\x00\xff\x00", 4);
  const std::filesystem::path path = Write(jpeg, jpeg.bytes);
  ExpectError(ErrorCode::kUnsupported,
              {path.string(), "65280 x 65280", "2^30"},
              [&] { ReadPhoto(path); });
  PhotoSample ppm = {"huge.ppm", "P6\n4000000000 4000000000\n255\n", {}, {}};
  ExpectRefused(ppm, ppm.bytes + std::string(100, 'x'), "it breaks off");
  PhotoSample tiff = FindPhotoSample("first.tiff");
  tiff.bytes.replace(18, 4, "\0\0\0\x40", 4);
  ExpectRefused(tiff, tiff.bytes, "its header says more");
}

}  // namespace
}  // namespace tsar
