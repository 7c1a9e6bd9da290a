// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/prior_raster.h"

#include "colmap_tsar/base/plane.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 12;
constexpr int kHeight = 9;

// A prior of 12 x 9 pixels on a map that is this many times as large.
class PriorRasterTest : public testing::Test {
 protected:
  PriorRaster On(int factor) const {
    const auto scale = static_cast<float>(factor);
    return {depth_.View(),
            sigma_.View(),
            0.2f,
            Intrinsics{10.f * scale,
                       10.f * scale,
                       6.f * scale - 0.5f,
                       4.5f * scale - 0.5f},
            factor * kWidth,
            factor * kHeight};
  }
  // Such that the depth of each of its pixels is that of the plane.
  void Draw(const Plane& plane) {
    const PriorRaster raster = On(1);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        depth_(x, y) = plane.Depth(raster.intrinsics.Ray(x, y));
      }
    }
  }

  Image<float> depth_{kWidth, kHeight, 4.f};
  Image<float> sigma_{kWidth, kHeight, 0.01f};
};

TEST_F(PriorRasterTest, InterpolatesWithinASurface) {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      depth_(x, y) = 4.f + 0.02f * x + 0.01f * y;
      sigma_(x, y) = 0.01f * (1 + x);
    }
  }
  for (const int factor : {1, 4}) {
    const PriorRaster raster = On(factor);
    for (int y = 0; y < factor * kHeight; ++y) {
      for (int x = 0; x < factor * kWidth; ++x) {
        // There is nothing to interpolate beyond the outermost pixels.
        const float u = std::clamp(
            (x + 0.5f) / factor - 0.5f, 0.f, static_cast<float>(kWidth - 1));
        const float v = std::clamp(
            (y + 0.5f) / factor - 0.5f, 0.f, static_cast<float>(kHeight - 1));
        EXPECT_NEAR(raster.At(x, y).depth, 4.f + 0.02f * u + 0.01f * v, 1e-5f);
        EXPECT_EQ(raster.At(x, y).sigma, sigma_(x / factor, y / factor));
        EXPECT_EQ(raster.At(x, y).outlier_share, 0.2f);
      }
    }
  }
}

TEST_F(PriorRasterTest, DoesNotInterpolateBetweenSurfaces) {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = kWidth / 2; x < kWidth; ++x) {
      depth_(x, y) = 5.f;
    }
  }
  depth_(2, 2) = 0.f;
  const PriorRaster raster = On(4);
  for (int y = 0; y < 4 * kHeight; ++y) {
    for (int x = 0; x < 4 * kWidth; ++x) {
      EXPECT_EQ(raster.At(x, y).depth,
                x / 4 == 2 && y / 4 == 2 ? 0.f
                : x < 2 * kWidth         ? 4.f
                                         : 5.f)
          << x << ", " << y;
    }
  }
}

TEST_F(PriorRasterTest, NormalsAreThoseOfSlantedPlanes) {
  for (const Vec3f& direction : {Vec3f{0.f, 0.f, -1.f},
                                 Vec3f{0.1f, 0.05f, -1.f},
                                 Vec3f{-0.15f, 0.f, -1.f}}) {
    const Plane plane{Normalized(direction), 4.f};
    Draw(plane);
    for (const int factor : {1, 4}) {
      const PriorRaster raster = On(factor);
      for (int y = 0; y < factor * kHeight; ++y) {
        for (int x = 0; x < factor * kWidth; ++x) {
          const Vec3f normal = raster.NormalAt(x, y);
          EXPECT_NEAR(Norm(normal), 1.f, 1e-5f);
          EXPECT_LT(Dot(normal, raster.intrinsics.Ray(x, y)), 0.f);
          // Depths that are interpolated are not quite those of the plane, and
          // constant beyond the outermost pixels.
          const bool is_within = x >= factor && y >= factor &&
                                 x < factor * (kWidth - 1) &&
                                 y < factor * (kHeight - 1);
          if (factor == 1 || is_within) {
            EXPECT_GT(Dot(normal, plane.normal), factor == 1 ? 0.9999f : 0.99f)
                << x << ", " << y;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace tsar
