// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/prior_folder.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/external_writers.h"
#include "tests/support/test_workspace.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;

using testing::ElementsAre;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr RasterSize kPhoto = {30, 20};

std::string NpyOf(int width,
                  int height,
                  int channels,
                  const std::vector<float>& values) {
  return NpyBytes("<f4",
                  "(" + std::to_string(height) + ", " + std::to_string(width) +
                      (channels == 1 ? ")" : ", 3)"),
                  FloatData(values));
}

void ExpectNormal(const Vec3f& normal, float x, float y, float z) {
  EXPECT_NEAR(normal.x, x, 1e-6f);
  EXPECT_NEAR(normal.y, y, 1e-6f);
  EXPECT_NEAR(normal.z, z, 1e-6f);
}

class ReadPriorTest : public testing::Test {
 protected:
  fs::path Write(const std::string& name, const std::string& bytes) const {
    WriteText(folder_.Path() / name, bytes);
    return folder_.Path() / name;
  }
  // Without loss, which OpenCV's own compression of floats as TIFF is not.
  fs::path WritePicture(const std::string& name, const cv::Mat& pixels) const {
    const bool is_tiff = name.find(".tif") != std::string::npos;
    EXPECT_TRUE(
        cv::imwrite((folder_.Path() / name).string(),
                    pixels,
                    is_tiff ? std::vector<int>{cv::IMWRITE_TIFF_COMPRESSION, 1}
                            : std::vector<int>{}));
    return folder_.Path() / name;
  }
  static Image<float> ReadDepth(const fs::path& path,
                                const RasterSize& photo = kPhoto) {
    return ReadPrior({path, {}}, PriorType::kAuto, photo).values;
  }
  static Image<Vec3f> ReadNormals(const fs::path& path,
                                  const RasterSize& photo = kPhoto) {
    return ReadPrior({{}, path}, PriorType::kAuto, photo).normals;
  }
  static void ExpectRefused(const PriorFiles& files,
                            ErrorCode code,
                            std::vector<std::string> texts) {
    texts.push_back(
        (files.depth.empty() ? files.normals : files.depth).string());
    ExpectError(
        code, texts, [&] { ReadPrior(files, PriorType::kAuto, kPhoto); });
  }

  TemporaryFolder folder_;
};

TEST_F(ReadPriorTest, ReadsDepthOfEachFormat) {
  const std::vector<float> values = {1, 2, 3, 4, 5, 6};
  cv::Mat floats(2, 3, CV_32FC1);
  std::copy(values.begin(), values.end(), floats.begin<float>());
  std::vector<fs::path> files = {
      Write("a.npy", NpyOf(3, 2, 1, values)),
      Write("a.PFM", PfmBytes(3, 2, 1, values, true)),
      Write("a.png", PngBytes(3, 2, {1, 2, 3, 4, 5, 6})),
      WritePicture("a.tif", floats),
      WritePicture("a.tiff", floats)};
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 0);
  if (cv::haveImageWriter("a.exr")) {
    files.push_back(WritePicture("a.exr", floats));
  }
  for (const fs::path& file : files) {
    const Image<float> depth = ReadDepth(file);
    ASSERT_EQ(depth.Width(), 3) << file;
    EXPECT_THAT(ValuesOf(depth), ElementsAre(1, 2, 3, 4, 5, 6)) << file;
  }
}

TEST_F(ReadPriorTest, ValuesWithoutMeaningAreNone) {
  const fs::path file = Write(
      "a.npy", NpyOf(3, 2, 1, {kNan, kInfinity, -kInfinity, -1.f, 0.f, 2.f}));
  EXPECT_THAT(ValuesOf(ReadDepth(file)), ElementsAre(0, 0, 0, 0, 0, 2));
}

TEST_F(ReadPriorTest, ReadsNormalsOfEachFormat) {
  // OpenCV's own order is blue, green, red.
  const cv::Mat floats(2, 3, CV_32FC3, cv::Scalar(-0.8, 0.6, 0.0));
  std::vector<float> values;
  for (int i = 0; i < 6; ++i) {
    values.insert(values.end(), {0.f, 0.6f, -0.8f});
  }
  std::vector<fs::path> files = {
      Write("a.npy", NpyOf(3, 2, 3, values)),
      Write("a.pfm", PfmBytes(3, 2, 3, values, false)),
      WritePicture("a.tiff", floats)};
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 0);
  if (cv::haveImageWriter("a.exr")) {
    files.push_back(WritePicture("a.exr", floats));
  }
  for (const fs::path& file : files) {
    const Image<Vec3f> normals = ReadNormals(file);
    ASSERT_EQ(normals.Width(), 3) << file;
    for (const Vec3f& normal : normals) {
      ExpectNormal(normal, 0.f, 0.6f, -0.8f);
    }
  }
}

TEST_F(ReadPriorTest, NormalsInPicturesOfIntegersAreEncoded) {
  for (const char* name : {"a.png", "a.tif"}) {
    for (const int type : {CV_8UC3, CV_16UC3}) {
      const double max = type == CV_8UC3 ? 255 : 65535;
      const cv::Scalar towards(0, std::floor(max / 2), std::floor(max / 2));
      const cv::Mat pixels(2, 3, type, towards);
      for (const Vec3f& normal : ReadNormals(WritePicture(name, pixels))) {
        EXPECT_NEAR(normal.x, 0.f, 0.005f);
        EXPECT_NEAR(normal.y, 0.f, 0.005f);
        EXPECT_NEAR(normal.z, -1.f, 1e-4f);
      }
      // Black, gray and white are no directions.
      for (const double gray : {0.0, std::floor(max / 2), max}) {
        const cv::Mat none(2, 3, type, cv::Scalar::all(gray));
        for (const Vec3f& normal : ReadNormals(WritePicture(name, none))) {
          EXPECT_TRUE(normal == Vec3f{}) << name << " " << gray;
        }
      }
    }
  }
}

TEST_F(ReadPriorTest, NormalsGetUnitLength) {
  const Image<Vec3f> normals = ReadNormals(Write("a.npy",
                                                 NpyOf(3,
                                                       2,
                                                       3,
                                                       {0,
                                                        0,
                                                        -9,  // Too long.
                                                        0,
                                                        0.3,
                                                        -0.4,  // Too short.
                                                        0,
                                                        0,
                                                        0,  //
                                                        kNan,
                                                        0,
                                                        -1,  //
                                                        kInfinity,
                                                        0,
                                                        -1,  //
                                                        1e30,
                                                        0,
                                                        -1})));
  ExpectNormal(normals(0, 0), 0.f, 0.f, -1.f);
  ExpectNormal(normals(1, 0), 0.f, 0.6f, -0.8f);
  EXPECT_TRUE(normals(2, 0) == Vec3f{});
  for (int x = 0; x < 3; ++x) {
    EXPECT_TRUE(normals(x, 1) == Vec3f{});
  }
}

TEST_F(ReadPriorTest, ReadsBothWithSizesOfTheirOwn) {
  const fs::path depth = Write("a.npy", NpyOf(3, 2, 1, {1, 2, 3, 4, 5, 6}));
  std::vector<float> values(3 * 6 * 4);
  const fs::path normals = Write("a.normal.npy", NpyOf(6, 4, 3, values));
  const DepthPrior prior =
      ReadPrior({depth, normals}, PriorType::kInverse, kPhoto);
  EXPECT_EQ(prior.type, PriorType::kInverse);
  EXPECT_EQ(prior.values.Width(), 3);
  EXPECT_EQ(prior.normals.Width(), 6);
}

TEST_F(ReadPriorTest, TakesTheNearestPixelsOfLargeRasters) {
  constexpr int kWidth = 2 * kMaxPriorSide;
  constexpr int kHeight = 30;
  std::vector<float> values;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      values.push_back(static_cast<float>(1 + x + kWidth * y));
    }
  }
  const Image<float> depth =
      ReadDepth(Write("a.npy", NpyOf(kWidth, kHeight, 1, values)),
                {10 * kWidth, 10 * kHeight});
  ASSERT_EQ(depth.Width(), kMaxPriorSide);
  ASSERT_EQ(depth.Height(), kHeight / 2);
  for (int y = 0; y < depth.Height(); ++y) {
    for (int x = 0; x < depth.Width(); ++x) {
      ASSERT_EQ(depth(x, y), 1 + (2 * x + 1) + kWidth * (2 * y + 1));
    }
  }
  // Of a raster as high as wide is not a pixel less is left.
  const Image<float> narrow = ReadDepth(
      Write("a.npy",
            NpyOf(1, kMaxPriorSide + 1, 1, std::vector<float>(1025, 1.f))),
      {1, kMaxPriorSide + 1});
  EXPECT_EQ(narrow.Width(), 1);
  EXPECT_EQ(narrow.Height(), kMaxPriorSide);
}

TEST_F(ReadPriorTest, AnySizeFitsThatHasThePhotosShape) {
  const auto fits = [&](int width, int height, const RasterSize& photo) {
    const fs::path file =
        Write("a.npy",
              NpyOf(width,
                    height,
                    1,
                    std::vector<float>(static_cast<size_t>(width * height))));
    try {
      ReadDepth(file, photo);
      return true;
    } catch (const Error& error) {
      EXPECT_EQ(error.Code(), ErrorCode::kMismatch);
      return false;
    }
  };
  EXPECT_TRUE(fits(256, 192, {4032, 3024}));
  EXPECT_TRUE(fits(518, 392, {4032, 3024}));  // Multiples of 14.
  EXPECT_TRUE(fits(8, 6, {4, 3}));
  EXPECT_TRUE(fits(256, 192, {4032, 2970}));   // 1.8 % off.
  EXPECT_FALSE(fits(256, 192, {4032, 2950}));  // 2.5 % off.
  EXPECT_FALSE(fits(256, 192, {3024, 4032}));
  EXPECT_TRUE(fits(4, 2, {40, 30}));  // A pixel off.
  EXPECT_FALSE(fits(8, 4, {40, 30}));
  EXPECT_TRUE(fits(1, 1, {40, 30}));
}

TEST_F(ReadPriorTest, RefusesOtherShapes) {
  const fs::path file = Write("a.npy", NpyOf(2, 8, 1, std::vector<float>(16)));
  for (const PriorFiles& files :
       {PriorFiles{file, {}},
        PriorFiles{
            {},
            Write("a.normal.npy", NpyOf(2, 8, 3, std::vector<float>(48)))}}) {
    ExpectRefused(
        files,
        ErrorCode::kMismatch,
        {"has 2 x 8 pixels", "undistorted image of 30 x 20", "folder images"});
  }
}

TEST_F(ReadPriorTest, RefusesFilesThatCannotBeReadAsPriors) {
  const auto depth = [](const fs::path& path) { return PriorFiles{path, {}}; };
  const auto normals = [](const fs::path& path) {
    return PriorFiles{{}, path};
  };
  const cv::Mat gray(2, 3, CV_8UC1, cv::Scalar(9));
  const cv::Mat colors(2, 3, CV_8UC3, cv::Scalar(9, 8, 7));
  ExpectRefused(depth(WritePicture("a.png", gray)),
                ErrorCode::kUnsupported,
                {"8 bits", "PNG of 16 bits"});
  ExpectRefused(depth(WritePicture("a.png", colors)),
                ErrorCode::kUnsupported,
                {"8 bits", "PNG of 16 bits"});
  ExpectRefused(depth(WritePicture("a.tif", gray)),
                ErrorCode::kUnsupported,
                {"not a depth map"});
  ExpectRefused(depth(Write("a.npy", NpyOf(3, 2, 3, std::vector<float>(18)))),
                ErrorCode::kUnsupported,
                {"3 channels", ".normal.npy"});
  ExpectRefused(normals(Write("a.npy", NpyOf(3, 2, 1, std::vector<float>(6)))),
                ErrorCode::kUnsupported,
                {"three channels"});
  for (const cv::Mat& pixels : {gray, cv::Mat(2, 3, CV_16UC1, cv::Scalar(9))}) {
    for (const char* name : {"a.png", "a.tiff"}) {
      ExpectRefused(normals(WritePicture(name, pixels)),
                    ErrorCode::kUnsupported,
                    {"three channels"});
    }
  }
  for (const char* name : {"a.npy", "a.pfm", "a.png", "a.tif", "a.exr"}) {
    ExpectRefused(
        depth(Write(name, "")), ErrorCode::kCorrupt, {"the file is empty"});
    ExpectRefused(normals(Write(name, "some text")), ErrorCode::kCorrupt, {});
  }
  const fs::path missing = folder_.Path() / "b.npy";
  ExpectRefused(depth(missing), ErrorCode::kNotFound, {"no such file"});
  fs::create_directories(missing);
  ExpectRefused(depth(missing), ErrorCode::kIo, {"cannot be read"});
}

TEST_F(ReadPriorTest, RefusesTruncatedFiles) {
  const std::vector<float> values(18, 0.5f);
  const cv::Mat colors(2, 3, CV_16UC3, cv::Scalar(9, 8, 7));
  for (const auto& [name, bytes] :
       {std::pair("a.npy", NpyOf(3, 2, 3, values)),
        std::pair("a.pfm", PfmBytes(3, 2, 3, values, true)),
        std::pair("a.png", ReadText(WritePicture("b.png", colors))),
        std::pair("a.tif", ReadText(WritePicture("b.tif", colors)))}) {
    for (const size_t length : {bytes.size() - 1, bytes.size() / 2}) {
      ExpectRefused(
          {{}, Write(name, bytes.substr(0, length))}, ErrorCode::kCorrupt, {});
    }
  }
}

}  // namespace
}  // namespace tsar
