// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/reprojection.cuh"

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/matching/plane_maps.h"
#include "colmap_tsar/matching/sample_gray.cuh"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "tests/matching/gray_textures.h"
#include "tests/matching/patch_match_fixture.h"
#include "tests/matching/textured_plane.h"
#include "tests/support/for_each_pixel.h"
#include "tests/support/same_bytes.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

class SampleGrayTest : public testing::Test {
 protected:
  GrayTexture Texture(const Image<float>& gray) {
    return TextureOf(gray, *device_);
  }

  const std::unique_ptr<Device> device_ = Device::CreateCpu(2);
};

Image<float> DrawLevels(int width, int height) {
  Image<float> gray(width, height);
  Philox random(7, 0, 0);
  for (float& value : gray) {
    value = 255.f * random.NextFloat();
  }
  return gray;
}

TEST_F(SampleGrayTest, InterpolatesAndRepeatsTheBorder) {
  Image<float> gray(2, 2);
  gray(1, 0) = 10.f;
  gray(0, 1) = 20.f;
  gray(1, 1) = 30.f;
  const GrayTexture texture = Texture(gray);
  const GrayView view = texture.View();
  EXPECT_EQ(SampleGray(view, 1.f, 0.5f), 5.f);
  EXPECT_EQ(SampleGray(view, 1.f, 1.f), 15.f);
  EXPECT_EQ(SampleGray(view, 1.5f, 1.5f), 30.f);
  EXPECT_EQ(SampleGray(view, -3.f, 9.f), 20.f);
}

TEST_F(SampleGrayTest, RoundsPositionsAndWeightsTo256ths) {
  Image<float> gray(2, 2);
  gray(1, 1) = 255.f;
  const GrayTexture texture = Texture(gray);
  const auto sample = [&](float x, float y) {
    return SampleGray(texture.View(), 0.5f + x / 256.f, 0.5f + y / 256.f);
  };
  // Halves are rounded up.
  EXPECT_EQ(sample(99.5f, 256.f), 255.f * 100.f / 256.f);
  EXPECT_EQ(sample(99.375f, 256.f), 255.f * 99.f / 256.f);
  EXPECT_EQ(sample(57.f, 18.f), 255.f * 4.f / 256.f);    // 4.008
  EXPECT_EQ(sample(185.f, 88.f), 255.f * 64.f / 256.f);  // 63.594
  EXPECT_EQ(sample(64.f, 2.f), 255.f * 1.f / 256.f);     // 0.5
}

TEST_F(SampleGrayTest, IsTheMeanOfFourByTheirRoundedWeights) {
  Philox random(7, 0, 0);
  for (const auto& [width, height] :
       {std::pair(1, 1), {1, 7}, {7, 1}, {2, 2}, {40, 30}}) {
    Image<float> gray = DrawLevels(width, height);
    for (float& level : gray) {
      level = std::floor(level);
    }
    const GrayTexture texture = Texture(gray);
    const auto level = [&](int x, int y) -> double {
      return gray(std::clamp(x, 0, gray.Width() - 1),
                  std::clamp(y, 0, gray.Height() - 1));
    };
    for (int i = 0; i < 300; ++i) {
      const float x = random.NextFloat() * (width + 2.f) - 1.f;
      const float y = random.NextFloat() * (height + 2.f) - 1.f;
      const double fixed_x = std::floor(256.0 * x + 0.5) / 256.0 - 0.5;
      const double fixed_y = std::floor(256.0 * y + 0.5) / 256.0 - 0.5;
      const int left = static_cast<int>(std::floor(fixed_x));
      const int top = static_cast<int>(std::floor(fixed_y));
      const double right_share = fixed_x - left;
      const double bottom_share = fixed_y - top;
      const double both =
          std::floor(256.0 * right_share * bottom_share + 0.5) / 256.0;
      ASSERT_EQ(SampleGray(texture.View(), x, y),
                (1.0 - right_share - bottom_share + both) * level(left, top) +
                    (right_share - both) * level(left + 1, top) +
                    (bottom_share - both) * level(left, top + 1) +
                    both * level(left + 1, top + 1))
          << x << ", " << y << " in " << width << " x " << height;
    }
  }
}

TEST_F(SampleGrayTest, TakesAnyNumbers) {
  const GrayTexture texture = Texture(DrawLevels(6, 5));
  const float infinity = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float hostile :
       {nan, -nan, infinity, -infinity, 1e30f, -1e30f, -0.f, 1e-42f}) {
    // The first or the last pixel.
    const float nearest = hostile > 1.f ? 100.f : 0.f;
    EXPECT_EQ(SampleGray(texture.View(), hostile, 3.2f),
              SampleGray(texture.View(), nearest, 3.2f))
        << hostile;
    EXPECT_EQ(SampleGray(texture.View(), 3.2f, hostile),
              SampleGray(texture.View(), 3.2f, nearest))
        << hostile;
  }
}

TEST_F(SampleGrayTest, LevelsAreClampedAndRounded) {
  Image<float> gray(4, 1);
  gray(0, 0) = -3.f;
  gray(1, 0) = 300.f;
  gray(2, 0) = 17.003f;
  gray(3, 0) = std::numeric_limits<float>::quiet_NaN();
  const GrayTexture texture = Texture(gray);
  const auto level = [&](int x) {
    return SampleGray(texture.View(), 0.5f + x, 0.5f);
  };
  EXPECT_EQ(level(0), 0.f);
  EXPECT_EQ(level(1), 255.f);
  EXPECT_EQ(level(2), 17.f + 1.f / 256.f);
  EXPECT_EQ(level(3), 0.f);
}

TEST_F(SampleGrayTest, HalvedPixelsAreMeansOfFour) {
  Image<float> gray(7, 5);
  for (size_t i = 0; i < gray.NumPixels(); ++i) {
    gray.Data()[i] = 7.3f * static_cast<float>(i);
  }
  const GrayTexture halved = HalveGray(Texture(gray).View(), *device_);
  ASSERT_EQ(halved.Width(), 3);
  ASSERT_EQ(halved.Height(), 2);
  ForEachPixel(3, 2, [&](int x, int y) {
    const float mean =
        0.25f * (gray(2 * x, 2 * y) + gray(2 * x + 1, 2 * y) +
                 gray(2 * x, 2 * y + 1) + gray(2 * x + 1, 2 * y + 1));
    EXPECT_NEAR(SampleGray(halved.View(), x + 0.5f, y + 0.5f), mean, 0.005f);
  });
  // The only row and column is its own neighbor.
  const GrayTexture pixel =
      HalveGray(Texture(Image<float>(1, 1, 9.f)).View(), *device_);
  ASSERT_EQ(pixel.Width(), 1);
  EXPECT_EQ(SampleGray(pixel.View(), 0.5f, 0.5f), 9.f);
}

constexpr int kWidth = 64;
constexpr int kHeight = 48;

class LookThroughSourceTest : public testing::Test {
 protected:
  LookThroughSourceTest()
      : camera_(SyntheticCamera(kWidth, kHeight, 100.0)),
        depth_(kWidth, kHeight, 2.f) {}

  bool Look(const Camera& source, const Vec3f& point) {
    return LookThroughSource(camera_.GetIntrinsics(),
                             {source.GetIntrinsics(),
                              ComputeRelativePose(camera_, source),
                              {},
                              std::as_const(depth_).View()},
                             point,
                             &seen_);
  }
  // A source this far to the right of the reference, looking the same way.
  bool LookFrom(double x, const Vec3f& point) {
    return Look(SourceCamera(camera_, {x, 0.0, 0.0}, 0.0), point);
  }

  Camera camera_;
  Image<float> depth_;
  SeenThroughSource seen_;
};

TEST_F(LookThroughSourceTest, ComesBackToThePixelAtTheTruth) {
  const Plane plane = DrawnPlane({0.3f, -0.2f, -1.f}, 3.f);
  const auto device = Device::CreateCpu(1);
  TexturedPlane scene(plane, camera_, *device);
  scene.AddSource(SourceCamera(camera_, {0.4, 0.05, 0.1}, -0.12));
  const Intrinsics intrinsics = camera_.GetIntrinsics();
  const SourceViews sources = scene.Sources();
  int num_seen = 0;
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    const Vec3f ray = intrinsics.Ray(static_cast<float>(x), y);
    if (!LookThroughSource(
            intrinsics, sources.Data()[0], plane.Depth(ray) * ray, &seen_)) {
      return;
    }
    ++num_seen;
    // Depths are those of the nearest pixel's middle.
    ASSERT_NEAR(seen_.x, x, 0.7f);
    ASSERT_NEAR(seen_.y, y, 0.7f);
    ASSERT_NEAR(Dot(plane.normal, seen_.point) + plane.offset, 0.f, 1e-4f);
    float u = 0.f;
    float v = 0.f;
    intrinsics.Project(seen_.point, &u, &v);
    ASSERT_EQ(u, seen_.x);
    ASSERT_EQ(v, seen_.y);
  });
  EXPECT_GT(num_seen, kWidth * kHeight * 3 / 4);
}

TEST_F(LookThroughSourceTest, SeesNothingOutsideOfTheSource) {
  // Columns -0.6, -0.4, 63.4 and 63.6.
  const auto see = [&](float column, float row) {
    return LookFrom(0.0,
                    {0.03f * (column - 0.5f * kWidth),
                     0.03f * (row - 0.5f * kHeight),
                     3.f});
  };
  EXPECT_FALSE(see(-0.6f, 20.f));
  EXPECT_TRUE(see(-0.4f, 20.f));
  EXPECT_TRUE(see(kWidth - 0.6f, 20.f));
  EXPECT_FALSE(see(kWidth - 0.4f, 20.f));
  EXPECT_FALSE(see(20.f, -0.6f));
  EXPECT_TRUE(see(20.f, -0.4f));
  EXPECT_TRUE(see(20.f, kHeight - 0.6f));
  EXPECT_FALSE(see(20.f, kHeight - 0.4f));
  EXPECT_FALSE(see(1e30f, 20.f));
  EXPECT_FALSE(see(NAN, 20.f));
}

TEST_F(LookThroughSourceTest, SeesNothingBehindEitherCamera) {
  EXPECT_FALSE(LookFrom(0.3, {0.f, 0.f, -3.f}));
  // From the far side; what it sees at depth 2 lies in front of the reference,
  // what it sees at depth 5 behind it.
  const Camera opposite = SourceCamera(camera_, {0.0, 0.0, 4.0}, 3.14159265);
  EXPECT_TRUE(Look(opposite, {0.f, 0.f, 3.f}));
  EXPECT_NEAR(seen_.point.z, 2.f, 1e-4f);
  depth_ = Image<float>(kWidth, kHeight, 5.f);
  EXPECT_FALSE(Look(opposite, {0.f, 0.f, 3.f}));
}

TEST_F(PatchMatchTest, MapsComeBackFromPlanes) {
  TexturedPlane scene = BareScene(kTilt);
  Image<float>& depth = scene.Depth();
  depth(3, 4) = 0.f;
  depth(5, 4) = 7.5f;
  const DeviceImage<Plane> planes = TruePlanes(scene);
  EXPECT_FALSE(planes.ToHost()(3, 4).Valid());
  const DepthNormalImages maps =
      MapsFromPlanes(intrinsics_, planes.View(), *device_);
  const Image<float> found_depth = maps.depth.ToHost();
  const Image<Vec3f> found_normal = maps.normal.ToHost();
  const Vec3f normal = Normalized(kTilt);
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    if (x == 3 && y == 4) {
      EXPECT_EQ(found_depth(x, y), 0.f);
      EXPECT_EQ(found_normal(x, y), Vec3f{});
      return;
    }
    ASSERT_NEAR(found_depth(x, y), depth(x, y), 1e-5f * depth(x, y));
    ASSERT_EQ(found_normal(x, y), normal);
  });
}

TEST_F(PatchMatchTest, ResizesPlanesByPlace) {
  const DeviceImage<Plane> drawn = Draw();
  const Image<Plane> planes = drawn.ToHost();
  const auto resize =
      [&](const DeviceImage<Plane>& from, int width, int height) {
        return ResizePlanes(from.View(), width, height, *device_);
      };
  EXPECT_TRUE(SameBytes(resize(drawn, kWidth, kHeight).ToHost(), planes));
  // Every pixel of a larger image of this size has its own there.
  const DeviceImage<Plane> larger = resize(drawn, 2 * kWidth, 3 * kHeight);
  EXPECT_TRUE(SameBytes(resize(larger, kWidth, kHeight).ToHost(), planes));
  const Image<Plane> on_larger = larger.ToHost();
  ForEachPixel(2 * kWidth, 3 * kHeight, [&](int x, int y) {
    ASSERT_EQ(on_larger(x, y).normal, planes(x / 2, y / 3).normal);
  });
  // Sizes without a common divisor: the first and the last stay at the ends.
  const Image<Plane> odd = resize(drawn, 41, 29).ToHost();
  EXPECT_EQ(odd(0, 0).normal, planes(0, 0).normal);
  EXPECT_EQ(odd(40, 28).normal, planes(kWidth - 1, kHeight - 1).normal);
  EXPECT_EQ(odd(20, 14).normal, planes(kWidth / 2, kHeight / 2).normal);
  EXPECT_EQ(resize(drawn, 1, 1).ToHost()(0, 0).normal,
            planes(kWidth / 2, kHeight / 2).normal);
}

}  // namespace
}  // namespace tsar
