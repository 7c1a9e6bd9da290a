// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/outline_edges.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 120;
constexpr int kHeight = 90;

Camera MakeCamera(double roll = 0.0) {
  Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.fx = camera.fy = 110.0;
  camera.cx = 0.5 * (kWidth - 1);
  camera.cy = 0.5 * (kHeight - 1);
  camera.rotation =
      Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return camera;
}

AxisCamera Rectified(const Camera& camera) {
  return *MakeAxisCamera(camera,
                         {Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX()});
}

Image<Rgb> Draw(const std::function<double(int x, int y)>& gray) {
  Image<Rgb> color(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto level = static_cast<uint8_t>(std::lround(gray(x, y)));
      color(x, y) = {level, level, level};
    }
  }
  return color;
}

// The right of a line through the image's center, which is upright in the
// world, is brighter by a step; `shift` moves the line.
Image<Rgb> DrawStep(double step, double roll = 0.0, double shift = 0.0) {
  return Draw([&](int x, int y) {
    const double right = std::cos(roll) * (x - 0.5 * (kWidth - 1)) +
                         std::sin(roll) * (y - 0.5 * (kHeight - 1)) - shift;
    return 100.0 + step * std::clamp(right + 0.5, 0.0, 1.0);
  });
}

TEST(OutlineEdgesTest, FindsAStepToAFractionOfAPixel) {
  for (const double shift : {-0.25, 0.0, 0.25, 10.25}) {
    SCOPED_TRACE(shift);
    const Camera camera = MakeCamera();
    const AxisCamera rectified = Rectified(camera);
    const std::vector<std::vector<AcrossEdge>> edges =
        FindEdgesAcross(DrawStep(60.0, 0.0, shift), rectified);
    ASSERT_EQ(edges.size(), static_cast<size_t>(rectified.height));
    for (int row = 0; row < rectified.height; ++row) {
      const std::vector<AcrossEdge>& of_row = edges[row];
      // Without a margin of four pixels and what is averaged along the axis.
      if (row < 6 || row >= rectified.height - 8) {
        EXPECT_LE(of_row.size(), 1u) << row;
        continue;
      }
      ASSERT_EQ(of_row.size(), 1u) << row;
      EXPECT_NEAR(of_row[0].column, rectified.cx + shift, 0.1) << row;
      EXPECT_GT(of_row[0].strength, 10.f);
      EXPECT_LT(of_row[0].strength, 60.f);
    }
  }
}

TEST(OutlineEdgesTest, ALineAlongTheAxisStaysInItsColumn) {
  const double roll = 0.2;
  const Camera camera = MakeCamera(roll);
  const AxisCamera rectified = Rectified(camera);
  const std::vector<std::vector<AcrossEdge>> edges =
      FindEdgesAcross(DrawStep(60.0, roll), rectified);
  int num_rows = 0;
  for (const std::vector<AcrossEdge>& of_row : edges) {
    for (const AcrossEdge& edge : of_row) {
      EXPECT_NEAR(edge.column, rectified.cx, 0.2);
      ++num_rows;
    }
  }
  EXPECT_GT(num_rows, 70);
}

TEST(OutlineEdgesTest, NeedsAStepOfFourGrayLevels) {
  const Camera camera = MakeCamera();
  const AxisCamera rectified = Rectified(camera);
  const auto find = [&](double step) {
    // Between two columns.
    return FindEdgesAcross(DrawStep(step, 0.0, 0.5), rectified)[kHeight / 2];
  };
  EXPECT_EQ(find(6.0).size(), 1u);
  EXPECT_TRUE(find(3.0).empty());
}

// Changes along the axis are none across it.
TEST(OutlineEdgesTest, FindsNothingInBareAndLevelImages) {
  const Camera camera = MakeCamera();
  const AxisCamera rectified = Rectified(camera);
  for (const Image<Rgb>& color :
       {Draw([](int, int) { return 255.0; }),
        Draw([](int, int y) { return y < 40 ? 20.0 : 220.0; })}) {
    for (const auto& of_row : FindEdgesAcross(color, rectified)) {
      EXPECT_TRUE(of_row.empty());
    }
  }
}

TEST(OutlineEdgesTest, FindsNothingInTheSmallestImages) {
  for (const int size : {1, 2, 5, 9, 12}) {
    Camera camera = MakeCamera();
    camera.width = camera.height = size;
    camera.cx = camera.cy = 0.5 * (size - 1);
    const std::optional<AxisCamera> rectified = MakeAxisCamera(
        camera, {Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX()});
    ASSERT_TRUE(rectified) << size;
    Image<Rgb> color(size, size);
    for (int y = 0; y < size; ++y) {
      color(size / 2, y) = {255, 255, 255};
    }
    for (const auto& of_row : FindEdgesAcross(color, *rectified)) {
      EXPECT_TRUE(of_row.empty()) << size;
    }
  }
}

TEST(OutlineEdgesTest, KnowsWhatTheRasterHolds) {
  const Camera camera = MakeCamera();
  const AxisCamera rectified = Rectified(camera);
  EXPECT_TRUE(IsInRaster(rectified, rectified.cx, rectified.cy));
  for (const auto& [column, row] :
       {std::pair(2.0, 45.0), {60.0, 2.0}, {118.0, 45.0}, {60.0, 88.0}}) {
    EXPECT_FALSE(IsInRaster(rectified, column, row));
  }
}

}  // namespace
}  // namespace tsar
