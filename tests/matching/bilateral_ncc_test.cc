// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/bilateral_ncc.cuh"

#include "colmap_tsar/base/random.h"

#include <cmath>
#include <limits>
#include <memory>

#include "tests/matching/gray_textures.h"
#include "tests/support/for_each_pixel.h"
#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kSize = 32;

GrayTexture Texture(const Image<float>& gray) {
  static const std::unique_ptr<Device> device = Device::CreateCpu(1);
  return TextureOf(gray, *device);
}

Image<float> DrawNoise(uint32_t seed) {
  Image<float> gray(kSize, kSize);
  Philox random(seed, 0, 0);
  for (float& value : gray) {
    value = 60.f + 100.f * random.NextFloat();
  }
  return gray;
}

// Maps every pixel to one that lies shift to the right.
PlaneHomography Shift(float shift) {
  const Intrinsics intrinsics{50.f, 50.f, 16.f, 16.f};
  RelativePose pose;
  pose.rotation = {{1.f, 0.f, 0.f}, {0.f, 1.f, 0.f}, {0.f, 0.f, 1.f}};
  pose.translation = {shift / 50.f, 0.f, 0.f};
  return PlaneHomography(
      intrinsics, intrinsics, pose, DrawnPlane({0.f, 0.f, -1.f}, 1.f));
}

float CostAt(const Image<float>& first,
             const Image<float>& second,
             int x,
             int y,
             float shift = 0.f) {
  const GrayTexture texture = Texture(second);
  const ReferencePatch patch(Texture(first).View(), x, y);
  return PatchCost(patch, Shift(shift), texture.View());
}

TEST(PatchCost, IsZeroForTheSameWindow) {
  const Image<float> gray = DrawNoise(1);
  for (const int x : {0, 5, 16, 31}) {
    EXPECT_NEAR(CostAt(gray, gray, x, 16), 0.f, 1e-4f) << x;
  }
}

TEST(PatchCost, IgnoresBrightnessAndContrast) {
  const Image<float> gray = DrawNoise(1);
  Image<float> changed = DrawNoise(1);
  for (float& value : changed) {
    value = 0.4f * value + 70.f;
  }
  EXPECT_NEAR(CostAt(gray, changed, 16, 16), 0.f, 1e-4f);
}

TEST(PatchCost, FollowsTheHomography) {
  const Image<float> gray = DrawNoise(1);
  Image<float> shifted(kSize, kSize, 100.f);
  ForEachPixel(3, kSize, 0, kSize, [&](int x, int y) {
    shifted(x, y) = gray(x - 3, y);
  });
  EXPECT_NEAR(CostAt(gray, shifted, 12, 16, 3.f), 0.f, 1e-3f);
  EXPECT_GT(CostAt(gray, shifted, 12, 16, 0.f), 0.3f);
}

TEST(PatchCost, IsUndefinedWithoutTextureOnEitherSide) {
  const Image<float> gray = DrawNoise(1);
  const Image<float> flat(kSize, kSize, 128.f);
  EXPECT_EQ(CostAt(flat, gray, 16, 16), kUndefinedCost);
  EXPECT_EQ(CostAt(gray, flat, 16, 16), kUndefinedCost);
  EXPECT_EQ(CostAt(flat, flat, 16, 16), kUndefinedCost);
}

TEST(PatchCost, TakesQuantisationForNoTexture) {
  Image<float> quantized(kSize, kSize);
  Philox random(5, 0, 0);
  for (float& value : quantized) {
    value = 128.f + random.NextBelow(2);
  }
  EXPECT_EQ(CostAt(quantized, quantized, 16, 16), kUndefinedCost);
}

TEST(PatchCost, IsUndefinedOutsideTheOtherImage) {
  const Image<float> gray = DrawNoise(1);
  EXPECT_NE(CostAt(gray, gray, 16, 16, 15.f), kUndefinedCost);
  EXPECT_EQ(CostAt(gray, gray, 16, 16, 16.f), kUndefinedCost);
  EXPECT_EQ(CostAt(gray, gray, 16, 16, -17.f), kUndefinedCost);
}

// How often the special cases of AddUpBySteps occurred.
struct Met {
  int num_inside = 0;
  int num_on_border = 0;
  int num_unseen = 0;
};

void ExpectSame(const PatchSums& sums, const PatchSums& expected) {
  ASSERT_EQ(sums.values, expected.values);
  ASSERT_EQ(sums.squares, expected.squares);
  ASSERT_EQ(sums.products, expected.products);
}

// All forms of the sum must be bit-identical; that for AVX2 only if the
// processor has it.
void ExpectSameSums(const ReferencePatch& patch,
                    const PlaneHomography& homography,
                    const GrayView& other,
                    Met* met) {
  const WindowHomography window(
      homography, patch.center_x, patch.center_y, patch.radius);
  if (!window.is_seen) {
    ++met->num_unseen;
    EXPECT_EQ(PatchCost(patch, homography, other), kUndefinedCost);
    return;
  }
  const PatchSums by_samples = AddUpBySamples(patch, window, other);
  ASSERT_TRUE(std::isfinite(by_samples.squares));
  ASSERT_NO_FATAL_FAILURE(
      ExpectSame(AddUpBySteps(patch, window, other), by_samples));
  if (HasAvx2()) {
    ASSERT_NO_FATAL_FAILURE(
        ExpectSame(AddUpByStepsForAvx2(patch, window, other), by_samples));
  }
  bool is_inside = true;
  for (int i = 0; i < kPatchSize; ++i) {
    const float dx = patch.OffsetX(i);
    const float dy = patch.OffsetY(i);
    const float z = 1.f + window.z_dx * dx + window.z_dy * dy;
    const float x = window.x + (window.x_dx * dx + window.x_dy * dy) / z;
    const float y = window.y + (window.y_dx * dx + window.y_dy * dy) / z;
    is_inside &=
        x >= 0.f && y >= 0.f && x < other.width - 1.f && y < other.height - 1.f;
  }
  ++(is_inside ? met->num_inside : met->num_on_border);
}

// From planes seen head-on to those seen edge-on, part of which lies behind the
// cameras.
template <typename Function>
void ForHomographies(int count, const Function& function) {
  const Intrinsics intrinsics{50.f, 50.f, 16.f, 16.f};
  Philox random(3, 0, 0);
  const auto draw = [&](float scale) {
    return scale * (2.f * random.NextFloat() - 1.f);
  };
  for (int i = 0; i < count; ++i) {
    const int x = static_cast<int>(random.NextBelow(kSize));
    const int y = static_cast<int>(random.NextBelow(kSize));
    const Vec3f ray = intrinsics.Ray(x, y);
    Vec3f normal = Normalized({draw(1.f), draw(1.f), draw(i % 2)});
    if (Dot(normal, ray) > 0.f) {
      normal = -normal;
    }
    const float angle = draw(0.3f);
    RelativePose pose;
    pose.rotation = {{std::cos(angle), 0.f, -std::sin(angle)},
                     {0.f, 1.f, 0.f},
                     {std::sin(angle), 0.f, std::cos(angle)}};
    pose.translation = {draw(0.3f), draw(0.3f), draw(0.3f)};
    const PlaneHomography homography(
        intrinsics,
        intrinsics,
        pose,
        Plane::FromPoint(ray, 1.5f + draw(0.5f), normal));
    function(x, y, i % 3 == 0 ? 8.f : 5.f, homography);
  }
}

TEST(AddUpBySteps, GivesTheSumsOfAddUpBySamples) {
  const GrayTexture gray = Texture(DrawNoise(1));
  const GrayTexture other = Texture(DrawNoise(2));
  Met met;
  ForHomographies(
      3000, [&](int x, int y, float radius, const PlaneHomography& homography) {
        const ReferencePatch patch(gray.View(), x, y, radius);
        ExpectSameSums(patch, homography, other.View(), &met);
      });
  EXPECT_GT(met.num_inside, 100);
  EXPECT_GT(met.num_on_border, 1000);
  EXPECT_GT(met.num_unseen, 50);
}

TEST(WindowHomography, SeesNoPlaneAlongItsSurfaceNorBehindTheCamera) {
  PlaneHomography homography = Shift(0.f);
  EXPECT_TRUE(WindowHomography(homography, 16.f, 16.f, 5.f).is_seen);
  for (const float slope : {-0.11f, -0.09f, 0.09f, 0.11f}) {
    for (const int element : {6, 7}) {
      PlaneHomography steep = homography;
      steep.h[element] = slope;
      steep.h[8] = 1.f - 16.f * slope;  // The center's depth stays 1.
      // Five pixels away it changes by a half where the slope is 0.1.
      EXPECT_EQ(WindowHomography(steep, 16.f, 16.f, 5.f).is_seen,
                std::abs(slope) < 0.1f)
          << slope << ", " << element;
    }
  }
  homography.h[8] = -1.f;
  EXPECT_FALSE(WindowHomography(homography, 16.f, 16.f, 5.f).is_seen);
  homography.h[8] = 0.f;
  EXPECT_FALSE(WindowHomography(homography, 16.f, 16.f, 5.f).is_seen);
}

TEST(PatchCost, TakesAnyNumbersForAHomography) {
  const GrayTexture gray = Texture(DrawNoise(1));
  const GrayTexture other = Texture(DrawNoise(2));
  const GrayTexture small = Texture(Image<float>(1, 1, 70.f));
  const GrayTexture column = Texture(Image<float>(1, kSize, 70.f));
  const float infinity = std::numeric_limits<float>::infinity();
  const float hostile[] = {0.f,
                           1e-42f,
                           1e30f,
                           -1e30f,
                           infinity,
                           -infinity,
                           std::numeric_limits<float>::quiet_NaN()};
  Met met;
  for (const int x : {0, 16}) {
    const ReferencePatch patch(gray.View(), x, 16);
    for (int element = 0; element < 9; ++element) {
      for (const float value : hostile) {
        PlaneHomography homography = Shift(1.f);
        homography.h[element] = value;
        for (const GrayTexture* image : {&other, &small, &column}) {
          ASSERT_NO_FATAL_FAILURE(
              ExpectSameSums(patch, homography, image->View(), &met))
              << element << ", " << value;
        }
      }
    }
  }
  EXPECT_GT(met.num_inside, 0);
  EXPECT_GT(met.num_on_border, 0);
  EXPECT_GT(met.num_unseen, 0);
}

}  // namespace
}  // namespace tsar
