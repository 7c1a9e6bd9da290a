// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/export/export_workspace.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/support/test_workspace.h"
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

namespace tsar {

// A drawn workspace of three images of 8 x 6 pixels whose maps have 4 x 3, and
// of cameras that are turned and look past their middle. "a.1.png" and
// "left/b.png" have geometric maps, of which the first was refined; "c.png" has
// none.
class ExportTest : public testing::Test {
 protected:
  static constexpr int kWidth = 4;  // Of the maps; half of the images'.
  static constexpr int kHeight = 3;
  static constexpr double kFx = 10.0;  // Of the images.
  static constexpr double kFy = 12.0;
  static constexpr double kCx = 4.5;
  static constexpr double kCy = 2.75;

  static const std::vector<std::string>& Names();
  // World to camera, of each image.
  static Eigen::Isometry3d Pose(int image);
  // 0 at one pixel.
  static float Depth(int image, int x, int y);
  static Vec3f Normal(int x, int y);
  // The point of a pixel with a depth, where stereo_fusion has it.
  static Eigen::Vector3d Point(int image, int x, int y);

  void SetUp() override;

  ExportSummary Export(ExportFormat format) const;
  nlohmann::json ReadJson(const std::string& name) const;
  // Of the manifest, by the name of the image.
  nlohmann::json ImageEntry(const std::string& name) const;
  // Expects an error, and no file changed.
  void ExpectFailure(ErrorCode code, const std::vector<std::string>& texts);

  // The world point of a pixel as manifest.json tells to compute it.
  static Eigen::Vector3d PointOf(const nlohmann::json& entry,
                                 int x,
                                 int y,
                                 double depth);
  // Calls check(x, y) for each pixel with a depth, and expects that `depth` is
  // 0 elsewhere.
  template <typename DepthAt, typename Check>
  static void ForEachDepth(int image, DepthAt depth, Check check) {
    int num_checked = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (Depth(image, x, y) > 0.f) {
          check(x, y);
          ++num_checked;
        } else {
          EXPECT_EQ(depth(x, y), 0);
        }
      }
    }
    EXPECT_EQ(num_checked, kWidth * kHeight - 1);
  }

  // A mask of the first image alone, from now on.
  void UseMask(int width,
               int height,
               const std::function<bool(int x, int y)>& is_masked);

  TemporaryFolder folder_;
  const std::filesystem::path root_ = folder_.Path() / "dense";
  ExportOptions options_;
};

// An array as NumPy reads it.
struct NumpyArray {
  std::string type;  // Such as "<f4".
  std::vector<int> shape;
  std::string bytes;

  template <typename T>
  T At(size_t index) const {
    T value{};
    bytes.copy(
        reinterpret_cast<char*>(&value), sizeof(T), index * sizeof(value));
    return value;
  }
};

// By the description of the format (version 1.0); fails the test where the file
// breaks it.
NumpyArray ReadNumpyArray(const std::filesystem::path& path);

}  // namespace tsar
