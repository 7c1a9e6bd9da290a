// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/external_maps.h"

#include <cmath>
#include <limits>

#include "tests/support/external_writers.h"
#include <Eigen/Geometry>
#include <gmock/gmock.h>

namespace tsar {
namespace {

using testing::ElementsAre;

Camera TurnedCamera() {
  Camera camera;
  camera.width = 8;
  camera.height = 6;
  camera.fx = 10.0;
  camera.fy = 10.0;
  camera.cx = 4.0;
  camera.cy = 3.0;
  camera.rotation =
      Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, -1, 2).normalized())
          .toRotationMatrix();
  return camera;
}

TEST(ConvertMaps, TurnsWorldNormalsIntoTheCamerasFrame) {
  const Camera camera = TurnedCamera();
  const Eigen::Vector3d expected = Eigen::Vector3d(0.2, 0.3, -1).normalized();
  const Eigen::Vector3f world =
      (camera.rotation.transpose() * expected).cast<float>();
  ExternalMaps external;
  external.depth = Image<float>(8, 6, 2.f);
  external.normal = Image<Vec3f>(8, 6, Vec3f{world.x(), world.y(), world.z()});
  // Of another length, and the other way around.
  external.normal(1, 1) = external.normal(1, 1) * -7.f;
  ConvertOptions options;
  options.normals_in_world = true;
  const ImportedMaps maps = ConvertMaps(external, camera, options);
  for (const Vec3f& n : maps.normal) {
    EXPECT_NEAR(n.x, expected.x(), 1e-6);
    EXPECT_NEAR(n.y, expected.y(), 1e-6);
    EXPECT_NEAR(n.z, expected.z(), 1e-6);
  }
  EXPECT_TRUE(maps.cost.values.empty());
}

TEST(ConvertMaps, KeepsUnitNormalsInTheCamerasFrameBitByBit) {
  ExternalMaps external;
  external.depth = Image<float>(8, 6, 2.f);
  const Vec3f normal = {0.36000001f, 0.48f, -0.8f};
  external.normal = Image<Vec3f>(8, 6, normal);
  external.normal(2, 2) = {0.f, 0.f, -3.f};
  external.depth(3, 3) = 0.f;
  const ImportedMaps maps = ConvertMaps(external, TurnedCamera(), {});
  EXPECT_EQ(maps.normal(0, 0), normal);
  EXPECT_EQ(maps.normal(2, 2), (Vec3f{0.f, 0.f, -1.f}));
  EXPECT_EQ(maps.normal(3, 3), Vec3f());
}

TEST(ConvertMaps, ComputesNormalsWhereNoneCame) {
  ExternalMaps external;
  external.depth = Image<float>(8, 6, 2.f);
  external.normal = Image<Vec3f>(8, 6, Vec3f{0.6f, 0.f, -0.8f});
  external.normal(5, 1) = {};
  const ImportedMaps maps = ConvertMaps(external, TurnedCamera(), {});
  EXPECT_EQ(maps.normal(5, 1), (Vec3f{0.f, 0.f, -1.f}));
  EXPECT_EQ(maps.normal(5, 2), (Vec3f{0.6f, 0.f, -0.8f}));
}

TEST(ConvertMaps, UsesTheIntrinsicsOfTheMapsSize) {
  // A slanted plane in a map of half the image's size.
  const Camera camera = TurnedCamera();
  const Intrinsics half = camera.Resized(4, 3).GetIntrinsics();
  const Vec3f normal = Normalized(Vec3f{0.1f, 0.05f, -1.f});
  ExternalMaps external;
  external.depth = Image<float>(4, 3);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 4; ++x) {
      external.depth(x, y) =
          -2.f /
          Dot(normal, half.Ray(static_cast<float>(x), static_cast<float>(y)));
    }
  }
  const ImportedMaps maps = ConvertMaps(external, camera, {});
  EXPECT_LT(Norm(maps.normal(1, 1) - normal), 1e-5f);
}

TEST(ConvertMaps, MakesTwoChannelsOfCosts) {
  ExternalMaps external;
  external.depth = Image<float>(6, 1, 1.f);
  external.cost = Image<float>(6, 1);
  const std::vector<float> costs = {
      0.f, 1.5f, 2.f, 3.f, -0.5f, std::numeric_limits<float>::quiet_NaN()};
  std::copy(costs.begin(), costs.end(), external.cost.begin());
  ConvertOptions options;
  options.use_costs = true;
  const PlanarMap cost = ConvertMaps(external, TurnedCamera(), options).cost;
  EXPECT_EQ(cost.width, 6);
  EXPECT_EQ(cost.height, 1);
  EXPECT_EQ(cost.channels, 2);
  EXPECT_THAT(cost.values,
              ElementsAre(0.f, 1.5f, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2));
}

TEST(ScaledDepth, DropsWhatLeavesTheRangeOfNumbers) {
  Image<float> depth(3, 1);
  depth(0, 0) = 2.f;
  depth(1, 0) = 1e38f;
  EXPECT_THAT(ValuesOf(ScaledDepth(depth, 10.0)), ElementsAre(20, 0, 0));
  depth(1, 0) = 1e-44f;
  EXPECT_THAT(ValuesOf(ScaledDepth(depth, 0.01)),
              ElementsAre(testing::FloatEq(0.02f), 0, 0));
  EXPECT_EQ(ScaledDepth(depth, 1.0)(1, 0), 1e-44f);
}

TEST(CountFacing, TellsTheFrames) {
  const Camera camera = TurnedCamera();
  ExternalMaps external;
  external.depth = Image<float>(8, 6, 2.f);
  external.depth(0, 0) = 0.f;
  EXPECT_EQ(CountFacing(external, camera).num_normals, 0);
  external.normal = Image<Vec3f>(8, 6, Vec3f{0.f, 0.f, -1.f});
  external.normal(1, 0) = {};
  const NormalFacing facing = CountFacing(external, camera);
  EXPECT_EQ(facing.num_normals, 46);
  EXPECT_EQ(facing.num_facing_in_camera, 46);
  const Eigen::Vector3d axis = camera.rotation * Eigen::Vector3d(0, 0, -1);
  // In the world's frame it is another direction, seen by some or none.
  int64_t expected = 0;
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 8; ++x) {
      const Vec3f ray = camera.GetIntrinsics().Ray(static_cast<float>(x),
                                                   static_cast<float>(y));
      const bool is_facing =
          axis.dot(Eigen::Vector3d(ray.x, ray.y, ray.z)) < 0.0;
      expected += is_facing && (y > 0 || x > 1) ? 1 : 0;
    }
  }
  EXPECT_EQ(facing.num_facing_in_world, expected);
}

}  // namespace
}  // namespace tsar
