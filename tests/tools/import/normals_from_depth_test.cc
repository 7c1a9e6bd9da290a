// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/external_maps.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr Intrinsics kIntrinsics = {50.f, 40.f, 15.5f, 12.f};

// The depth of the plane normal . x = offset.
Image<float> DrawPlane(const Vec3f& normal, float offset) {
  Image<float> depth(32, 24);
  for (int y = 0; y < depth.Height(); ++y) {
    for (int x = 0; x < depth.Width(); ++x) {
      const Vec3f ray =
          kIntrinsics.Ray(static_cast<float>(x), static_cast<float>(y));
      depth(x, y) = offset / Dot(normal, ray);
    }
  }
  return depth;
}

TEST(NormalsFromDepth, AreExactOnPlanesUpToTheBorder) {
  for (const Vec3f& direction : {Vec3f{0.f, 0.f, -1.f},
                                 Vec3f{0.6f, 0.f, -0.8f},
                                 Vec3f{-0.3f, 0.5f, -0.9f}}) {
    const Vec3f normal = Normalized(direction);
    const Image<Vec3f> normals =
        NormalsFromDepth(DrawPlane(normal, -3.f), kIntrinsics);
    for (const Vec3f& n : normals) {
      EXPECT_LT(Norm(n - normal), 1e-4f);
    }
  }
}

TEST(NormalsFromDepth, ScaleDoesNotMatter) {
  const Vec3f normal = Normalized(Vec3f{0.2f, 0.4f, -0.7f});
  for (const float offset : {-3e-6f, -3e6f}) {
    const Image<Vec3f> normals =
        NormalsFromDepth(DrawPlane(normal, offset), kIntrinsics);
    EXPECT_LT(Norm(normals(7, 9) - normal), 1e-4f);
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

}  // namespace
}  // namespace tsar
