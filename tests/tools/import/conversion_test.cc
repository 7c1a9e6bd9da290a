// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/external_maps.h"

#include <cmath>

#include "tests/support/external_writers.h"
#include <Eigen/Geometry>
#include <gmock/gmock.h>

namespace tsar {
namespace {

constexpr Intrinsics kIntrinsics = {50.f, 40.f, 15.5f, 12.f};

// The depth of the plane normal . x = offset.
Image<float> DrawPlane(const Vec3f& normal,
                       float offset,
                       const Intrinsics& intrinsics = kIntrinsics,
                       int width = 32,
                       int height = 24) {
  Image<float> depth(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      depth(x, y) = offset / Dot(normal,
                                 intrinsics.Ray(static_cast<float>(x),
                                                static_cast<float>(y)));
    }
  }
  return depth;
}

TEST(NormalsFromDepth, AreExactOnPlanesOfAnyScale) {
  for (const Vec3f& direction : {Vec3f{0.f, 0.f, -1.f},
                                 Vec3f{0.6f, 0.f, -0.8f},
                                 Vec3f{-0.3f, 0.5f, -0.9f}}) {
    const Vec3f normal = Normalized(direction);
    for (const float offset : {-3e-6f, -3.f, -3e6f}) {
      for (const Vec3f& n :
           NormalsFromDepth(DrawPlane(normal, offset), kIntrinsics)) {
        EXPECT_LT(Norm(n - normal), 1e-4f);
      }
    }
  }
}

TEST(NormalsFromDepth, JumpsDoNotBendThem) {
  const Vec3f near = Normalized(Vec3f{0.5f, 0.f, -0.8f});
  const Vec3f far = Normalized(Vec3f{-0.4f, 0.1f, -0.9f});
  for (const float distance : {-4.f, -2.08f}) {
    Image<float> depth = DrawPlane(far, distance);
    const Image<float> front = DrawPlane(near, -1.5f);
    for (int y = 0; y < depth.Height(); ++y) {
      for (int x = 0; x < 16; ++x) {
        depth(x, y) = front(x, y);
      }
    }
    const Image<Vec3f> normals = NormalsFromDepth(depth, kIntrinsics);
    for (int x = 0; x < depth.Width(); ++x) {
      EXPECT_LT(Norm(normals(x, 12) - (x < 16 ? near : far)), 1e-3f) << x;
    }
  }
}

TEST(NormalsFromDepth, NoiseIsAveraged) {
  Image<float> depth(32, 24, 2.f);
  depth(10, 10) = 2.001f;
  const Image<Vec3f> normals = NormalsFromDepth(depth, kIntrinsics);
  EXPECT_LT(Norm(normals(10, 10) - Vec3f{0.f, 0.f, -1.f}), 0.02f);
}

TEST(NormalsFromDepth, AreMissingWithoutSupport) {
  Image<float> depth(32, 24);
  // Alone, a row, and a pixel of a full block.
  depth(3, 3) = 1.f;
  for (int x = 8; x < 12; ++x) {
    depth(x, 8) = 1.f;
  }
  for (int y = 14; y < 17; ++y) {
    for (int x = 14; x < 17; ++x) {
      depth(x, y) = 1.f;
    }
  }
  const Image<Vec3f> normals = NormalsFromDepth(depth, kIntrinsics);
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 32; ++x) {
      const bool is_in_block = x >= 14 && x < 17 && y >= 14 && y < 17;
      EXPECT_EQ(Norm(normals(x, y)) > 0.5f, is_in_block) << x << " " << y;
    }
  }
}

TEST(NormalsFromDepth, StandExtremeDepthsAndSmallMaps) {
  for (const float depth : {1e-45f, 1e-30f, 1e30f, 3e38f}) {
    for (const Vec3f& n :
         NormalsFromDepth(Image<float>(4, 4, depth), kIntrinsics)) {
      EXPECT_TRUE(std::isfinite(n.x + n.y + n.z));
    }
  }
  EXPECT_EQ(NormalsFromDepth(Image<float>(1, 1, 1.f), kIntrinsics)(0, 0),
            Vec3f());
  EXPECT_TRUE(NormalsFromDepth(Image<float>(), kIntrinsics).Empty());
}

Camera TurnedCamera() {
  Camera camera = {8, 6, 10.0, 10.0, 4.0, 3.0};
  camera.rotation =
      Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, -1, 2).normalized())
          .toRotationMatrix();
  return camera;
}

TEST(ConvertMaps, TurnsWorldNormalsIntoTheCamerasFrame) {
  const Camera camera = TurnedCamera();
  const Eigen::Vector3d expected = Eigen::Vector3d(0.2, 0.3, -1).normalized();
  ExternalMaps external;
  external.depth = Image<float>(8, 6, 2.f);
  external.normal =
      Image<Vec3f>(8, 6, ToVec3f(camera.rotation.transpose() * expected));
  // Of another length, and reversed.
  external.normal(1, 1) = external.normal(1, 1) * -7.f;
  for (const Vec3f& n :
       ConvertMaps(external, camera, 1.0, NormalFrame::kWorld).normal) {
    EXPECT_LT(Norm(n - ToVec3f(expected)), 1e-6f);
  }
}

TEST(ConvertMaps, KeepsUnitNormalsBitByBitAndComputesMissingOnes) {
  ExternalMaps external;
  external.depth = Image<float>(8, 6, 2.f);
  const Vec3f normal = {0.36000001f, 0.48f, -0.8f};
  external.normal = Image<Vec3f>(8, 6, normal);
  external.normal(2, 2) = {0.f, 0.f, -3.f};
  external.normal(5, 1) = {};
  external.depth(3, 3) = 0.f;
  const Image<Vec3f> normals =
      ConvertMaps(external, TurnedCamera(), 1.0, NormalFrame::kCamera).normal;
  EXPECT_EQ(normals(0, 0), normal);
  EXPECT_EQ(normals(2, 2), (Vec3f{0.f, 0.f, -1.f}));
  EXPECT_EQ(normals(5, 1), (Vec3f{0.f, 0.f, -1.f}));
  EXPECT_EQ(normals(3, 3), Vec3f());
}

TEST(ConvertMaps, UsesTheIntrinsicsOfTheMapsSize) {
  // A slanted plane in a map of half the image's size.
  const Camera camera = TurnedCamera();
  const Vec3f normal = Normalized(Vec3f{0.1f, 0.05f, -1.f});
  ExternalMaps external;
  external.depth =
      DrawPlane(normal, -2.f, camera.Resized(4, 3).GetIntrinsics(), 4, 3);
  const ImportedMaps maps =
      ConvertMaps(external, camera, 1.0, NormalFrame::kCamera);
  EXPECT_LT(Norm(maps.normal(1, 1) - normal), 1e-5f);
}

TEST(ScaledDepth, DropsWhatLeavesTheRangeOfNumbers) {
  Image<float> depth(3, 1);
  depth(0, 0) = 2.f;
  depth(1, 0) = 1e38f;
  EXPECT_THAT(ValuesOf(ScaledDepth(depth, 10.0)),
              testing::ElementsAre(20, 0, 0));
  depth(1, 0) = 1e-44f;
  EXPECT_THAT(ValuesOf(ScaledDepth(depth, 0.01)),
              testing::ElementsAre(testing::FloatEq(0.02f), 0, 0));
}

}  // namespace
}  // namespace tsar
