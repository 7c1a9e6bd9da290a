// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/point_sample.h"

#include "colmap_tsar/base/error.h"

#include <cstring>

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

Camera MakeCamera(int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = 10.0;
  camera.fy = 20.0;
  camera.cx = 1.0;
  camera.cy = 2.0;
  return camera;
}

TEST(GridStep, GivesAtMostTheNumberAndNotFarLess) {
  EXPECT_EQ(GridStep(4, 3, 12), 1);
  EXPECT_EQ(GridStep(4, 3, 11), 2);
  EXPECT_EQ(GridStep(4, 3, 1), 4);
  for (const int64_t wanted : {1, 7, 600, 1000000}) {
    const int step = GridStep(1920, 1080, wanted);
    const auto count = [&](int by) {
      return static_cast<int64_t>((1920 + by - 1) / by) *
             ((1080 + by - 1) / by);
    };
    EXPECT_LE(count(step), wanted);
    EXPECT_TRUE(step == 1 || count(step - 1) > wanted);
  }
}

TEST(SampleMap, PutsPixelsWhereTheCameraSeesThem) {
  Camera camera = MakeCamera(4, 3);
  camera.rotation << 0, 1, 0, -1, 0, 0, 0, 0, 1;
  camera.translation = Eigen::Vector3d(1, 2, 3);
  Image<float> depth(4, 3);
  depth(3, 1) = 5.f;
  Image<Rgb> colors(4, 3);
  colors(3, 1) = {7, 8, 9};
  const Eigen::Vector3d origin(1e6, -1e6, 10);
  const Eigen::Vector3d in_camera(5 * 0.2, 5 * -0.05, 5);
  camera.translation -= camera.rotation * origin;
  const Eigen::Vector3d expected =
      camera.rotation.transpose() *
      (in_camera - (camera.translation + camera.rotation * origin));
  const PointSample sample = SampleMap(depth, colors, camera, origin, 1);
  ASSERT_EQ(sample.NumPoints(), 1u);
  EXPECT_EQ(sample.num_all, 1);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(sample.positions[axis], expected[axis], 1e-6);
  }
  EXPECT_EQ(sample.colors[0].g, 8);
}

TEST(SampleMap, TakesTheSamePixelsOfEveryMapOfTheSize) {
  const Camera camera = MakeCamera(10, 10);
  const Image<Rgb> colors(10, 10);
  const auto count = [&](const Image<float>& depth) {
    return SampleMap(depth, colors, camera, {0, 0, 0}, 3).NumPoints();
  };
  // Columns and rows 1, 4 and 7.
  EXPECT_EQ(count(Image<float>(10, 10, 1.f)), 9u);
  Image<float> one(10, 10);
  one(4, 7) = 1.f;
  EXPECT_EQ(count(one), 1u);
  one(4, 7) = 0.f;
  one(5, 7) = 1.f;
  EXPECT_EQ(count(one), 0u);
  // A map that is smaller than half a step still gives its corner.
  EXPECT_EQ(SampleMap(Image<float>(1, 1, 2.f),
                      Image<Rgb>(1, 1),
                      MakeCamera(1, 1),
                      {0, 0, 0},
                      9)
                .NumPoints(),
            1u);
}

TEST(SampleCloud, TakesColorsAndKeepsFarOriginsExact) {
  const TemporaryFolder folder;
  WriteText(folder.Path() / "a.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\n"
            "property double y\nproperty double z\nproperty uchar red\n"
            "property uchar green\nproperty uchar blue\nend_header\n"
            "5000000.25 1 2 10 20 30\n5000001 1 2 40 50 60\n"
            "5000002 1 2 70 80 90\n");
  const PointSample sample =
      SampleCloud(folder.Path() / "a.ply", {5000000, 0, 0}, 2);
  EXPECT_EQ(sample.num_all, 3);
  ASSERT_EQ(sample.NumPoints(), 2u);
  EXPECT_EQ(sample.positions[0], 0.25f);
  EXPECT_EQ(sample.colors[1].b, 60);
}

TEST(SampleCloud, IsGrayWithoutColors) {
  const TemporaryFolder folder;
  WriteText(folder.Path() / "a.ply",
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
            "property float y\nproperty float z\nend_header\n1 2 3\n");
  const PointSample sample = SampleCloud(folder.Path() / "a.ply", {0, 0, 0}, 9);
  ASSERT_EQ(sample.NumPoints(), 1u);
  EXPECT_EQ(sample.colors[0].r, sample.colors[0].b);
  EXPECT_GT(sample.colors[0].r, 0);
}

TEST(PointScript, EncodesFloatsThenColors) {
  PointSample sample;
  sample.positions = {1.f, 0.f, -2.f};
  sample.colors = {{1, 2, 255}};
  // 00 00 80 3f, 00 00 00 00, 00 00 00 c0, 01 02 ff.
  EXPECT_EQ(PointScript("after", sample),
            "tsarPoints(\"after\", \"AACAPwAAAAAAAADAAQL/\");\n");
  EXPECT_EQ(PointScript("before", {}), "tsarPoints(\"before\", \"\");\n");
}

TEST(PointSample, AppendsAndCounts) {
  PointSample a;
  a.positions = {1.f, 2.f, 3.f};
  a.colors = {{1, 1, 1}};
  a.num_all = 10;
  PointSample b = a;
  b.num_all = 5;
  a.Append(b);
  EXPECT_EQ(a.NumPoints(), 2u);
  EXPECT_EQ(a.positions.size(), 6u);
  EXPECT_EQ(a.num_all, 15);
}

}  // namespace
}  // namespace tsar
