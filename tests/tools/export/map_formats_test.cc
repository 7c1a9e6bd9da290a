// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Reads back what is exported as those read it who know the manifest alone.

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/io/float_map.h"
#include "colmap_tsar/io/map_files.h"

#include <cstdlib>

#include "tests/tools/export/export_fixture.h"
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

class MapFormatsTest : public ExportTest {
 protected:
  // The picture that the manifest names for a kind of map of an image.
  cv::Mat ReadPicture(const nlohmann::json& entry, const char* kind) const {
    return cv::imread(
        (options_.output_path / entry["files"][kind].get<std::string>())
            .string(),
        cv::IMREAD_UNCHANGED);
  }
};

TEST_F(MapFormatsTest, ArraysHoldThePointsOfTheWorkspace) {
  Export(ExportFormat::kNpy);
  for (int image = 0; image < 2; ++image) {
    const std::string& name = Names()[image];
    const nlohmann::json entry = ImageEntry(name);
    EXPECT_EQ(entry["files"]["depth"], "depth/" + name + ".npy");
    const NumpyArray depth = ReadNumpyArray(
        options_.output_path / entry["files"]["depth"].get<std::string>());
    const NumpyArray normals = ReadNumpyArray(
        options_.output_path / entry["files"]["normals"].get<std::string>());
    EXPECT_EQ(depth.type, "<f4");
    EXPECT_EQ(depth.shape, (std::vector<int>{kHeight, kWidth}));
    EXPECT_EQ(normals.type, "<f4");
    EXPECT_EQ(normals.shape, (std::vector<int>{kHeight, kWidth, 3}));
    const auto depth_at = [&](int x, int y) {
      return depth.At<float>(static_cast<size_t>(y * kWidth + x));
    };
    ForEachDepth(image, depth_at, [&](int x, int y) {
      const Eigen::Vector3d point = PointOf(entry, x, y, depth_at(x, y));
      EXPECT_LT((point - Point(image, x, y)).norm(), 1e-9);
      const auto first = static_cast<size_t>(3 * (y * kWidth + x));
      EXPECT_EQ((Vec3f{normals.At<float>(first),
                       normals.At<float>(first + 1),
                       normals.At<float>(first + 2)}),
                Normal(x, y));
    });
  }
}

TEST_F(MapFormatsTest, ArraysHoldWhatRefinementWrote) {
  Export(ExportFormat::kNpy);
  const nlohmann::json files = ImageEntry("a.1.png")["files"];
  const auto read = [&](const char* kind) {
    return ReadNumpyArray(options_.output_path /
                          files[kind].get<std::string>());
  };
  EXPECT_EQ(read("confidence").type, "<f4");
  EXPECT_NEAR(read("confidence").At<float>(5), 0.5, 0.002);
  EXPECT_EQ(read("sigma").type, "<f4");
  EXPECT_EQ(read("sigma").At<float>(5), 0.0625f);
  EXPECT_EQ(read("provenance").type, "|u1");
  EXPECT_EQ(read("provenance").At<uint8_t>(5), 4);
  EXPECT_EQ(read("planes").type, "<u2");
  EXPECT_EQ(read("planes").At<uint16_t>(5), 700);
  const nlohmann::json manifest = ReadJson("manifest.json");
  EXPECT_EQ(manifest["maps"]["provenance"]["values"][4], "region plane");
  EXPECT_EQ(manifest["maps"]["provenance"]["values"][7], "prior");
  // Of the other image, only what is there.
  EXPECT_EQ(ImageEntry("left/b.png")["files"].size(), 2u);
  EXPECT_FALSE(std::filesystem::exists(options_.output_path / "sigma/left"));
}

TEST_F(MapFormatsTest, ExrHoldsThePointsOfTheWorkspace) {
  // As users of OpenCV have to.
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 0);
  if (!cv::haveImageWriter("a.exr")) {
    options_.format = ExportFormat::kExr;
    ExpectFailure(ErrorCode::kUnsupported, {"OpenCV", "npy"});
    return;
  }
  Export(ExportFormat::kExr);
  for (int image = 0; image < 2; ++image) {
    const nlohmann::json entry = ImageEntry(Names()[image]);
    const cv::Mat depth = ReadPicture(entry, "depth");
    const cv::Mat normals = ReadPicture(entry, "normals");
    ASSERT_EQ(depth.type(), CV_32FC1);
    ASSERT_EQ(normals.type(), CV_32FC3);
    const auto depth_at = [&](int x, int y) { return depth.at<float>(y, x); };
    ForEachDepth(image, depth_at, [&](int x, int y) {
      const Eigen::Vector3d point = PointOf(entry, x, y, depth_at(x, y));
      EXPECT_LT((point - Point(image, x, y)).norm(), 1e-9);
      // Blue first.
      const auto normal = normals.at<cv::Vec3f>(y, x);
      EXPECT_EQ((Vec3f{normal[2], normal[1], normal[0]}), Normal(x, y));
    });
  }
}

// What tsar_import reads is what was exported: channels have their order.
TEST_F(MapFormatsTest, ExrComesBackByTheImport) {
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 0);
  if (!cv::haveImageWriter("a.exr")) {
    GTEST_SKIP() << "OpenCV without OpenEXR";
  }
  Export(ExportFormat::kExr);
  const auto path = options_.output_path / "normals/left/b.png.exr";
  const DepthImage image = ParseDepthImage(ReadFileBytes(path), path);
  ASSERT_EQ(image.map.channels, 3);
  const size_t first = 3 * (1 * kWidth + 3);
  EXPECT_EQ((Vec3f{image.map.values[first],
                   image.map.values[first + 1],
                   image.map.values[first + 2]}),
            Normal(3, 1));
}

TEST_F(MapFormatsTest, PicturesOf16BitsHoldThePointsToHalfAStep) {
  Export(ExportFormat::kPng16);
  const nlohmann::json maps = ReadJson("manifest.json")["maps"];
  EXPECT_EQ(maps["depth"]["scale"], 0.001);
  const auto value = [&](const char* kind, double stored) {
    return stored * maps[kind]["scale"].get<double>() +
           maps[kind]["offset"].get<double>();
  };
  const nlohmann::json entry = ImageEntry("a.1.png");
  const cv::Mat depth = ReadPicture(entry, "depth");
  const cv::Mat normals = ReadPicture(entry, "normals");
  ASSERT_EQ(depth.type(), CV_16UC1);
  ASSERT_EQ(normals.type(), CV_16UC3);
  const auto depth_at = [&](int x, int y) { return depth.at<uint16_t>(y, x); };
  ForEachDepth(0, depth_at, [&](int x, int y) {
    const double z = value("depth", depth_at(x, y));
    EXPECT_NEAR(z, Depth(0, x, y), 0.00051);
    EXPECT_LT((PointOf(entry, x, y, z) - Point(0, x, y)).norm(), 0.001);
    const auto normal = normals.at<cv::Vec<uint16_t, 3>>(y, x);
    EXPECT_NEAR(value("normals", normal[2]), Normal(x, y).x, 2e-5);
    EXPECT_NEAR(value("normals", normal[1]), Normal(x, y).y, 2e-5);
    EXPECT_NEAR(value("normals", normal[0]), Normal(x, y).z, 2e-5);
  });
  // No normal is (0, 0, 0), exactly.
  EXPECT_NEAR(
      value("normals", normals.at<cv::Vec<uint16_t, 3>>(2, 1)[0]), 0.0, 1e-12);
  EXPECT_NEAR(
      value("confidence", ReadPicture(entry, "confidence").at<uint8_t>(1, 1)),
      0.5,
      0.002);
  EXPECT_NEAR(value("sigma", ReadPicture(entry, "sigma").at<uint16_t>(1, 1)),
              0.0625,
              5e-6);
  EXPECT_EQ(ReadPicture(entry, "provenance").at<uint8_t>(1, 1), 4);
  EXPECT_EQ(ReadPicture(entry, "planes").at<uint16_t>(1, 1), 700);
}

TEST_F(MapFormatsTest, LeavesOutDepthsThat16BitsDoNotHold) {
  // The depths are between 2 and 3.41.
  options_.depth_scale = 2.5 / 65535.0;
  testing::internal::CaptureStderr();
  Export(ExportFormat::kPng16);
  const std::string warning = testing::internal::GetCapturedStderr();
  EXPECT_THAT(warning, testing::HasSubstr("were left out"));
  EXPECT_THAT(warning, testing::HasSubstr("depth_scale 6e-05"));
  const nlohmann::json entry = ImageEntry("a.1.png");
  const cv::Mat depth =
      cv::imread((options_.output_path / "depth/a.1.png.png").string(),
                 cv::IMREAD_UNCHANGED);
  int num_left_out = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float z = Depth(0, x, y);
      EXPECT_EQ(depth.at<uint16_t>(y, x) > 0, z > 0.f && z < 2.5f);
      num_left_out += z >= 2.5f ? 1 : 0;
    }
  }
  EXPECT_EQ(entry["num_out_of_range"], num_left_out);
  EXPECT_GT(num_left_out, 0);
}

TEST_F(MapFormatsTest, WarnsOfCoarseSteps) {
  options_.depth_scale = 0.1;
  testing::internal::CaptureStderr();
  Export(ExportFormat::kPng16);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              testing::HasSubstr("rounded to steps of 0.1"));
}

// As if they had no depth.
TEST_F(MapFormatsTest, MaskedPixelsHaveNothing) {
  // Of the image's size; one of its pixels masks that of the map.
  UseMask(8, 6, [](int x, int y) { return x == 5 && y == 3; });
  const ExportSummary summary = Export(ExportFormat::kNpy);
  EXPECT_EQ(summary.num_masks, 1);
  EXPECT_EQ(summary.num_depths, 2 * (kWidth * kHeight - 1) - 1);
  const nlohmann::json files = ImageEntry("a.1.png")["files"];
  EXPECT_EQ(ImageEntry("a.1.png")["num_depths"], kWidth * kHeight - 2);
  const auto read = [&](const char* kind) {
    return ReadNumpyArray(options_.output_path /
                          files[kind].get<std::string>());
  };
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto pixel = static_cast<size_t>(y * kWidth + x);
      const bool is_masked = x == 2 && y == 1;
      EXPECT_EQ(read("depth").At<float>(pixel),
                is_masked ? 0.f : Depth(0, x, y));
      EXPECT_EQ(read("normals").At<float>(3 * pixel + 2) == 0.f,
                is_masked || Depth(0, x, y) == 0.f);
      EXPECT_EQ(read("confidence").At<float>(pixel) == 0.f, is_masked);
      EXPECT_EQ(read("sigma").At<float>(pixel) == 0.f, is_masked);
      EXPECT_EQ(read("provenance").At<uint8_t>(pixel) == 0, is_masked);
      EXPECT_EQ(read("planes").At<uint16_t>(pixel) == 0, is_masked);
    }
  }
}

}  // namespace
}  // namespace tsar
