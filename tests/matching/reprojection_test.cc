// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/reprojection.cuh"

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/matching/bilinear.cuh"
#include "colmap_tsar/matching/plane_maps.h"

#include <cmath>
#include <limits>
#include <utility>

#include "tests/matching/gray_pairs.h"
#include "tests/matching/patch_match_fixture.h"
#include "tests/matching/textured_plane.h"
#include "tests/support/for_each_pixel.h"
#include "tests/support/same_bytes.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(SampleBilinear, InterpolatesAndRepeatsTheBorder) {
  Image<float> gray(2, 2);
  gray(1, 0) = 10.f;
  gray(0, 1) = 20.f;
  gray(1, 1) = 30.f;
  const ImageView<const float> view = std::as_const(gray).View();
  EXPECT_FLOAT_EQ(SampleBilinear(view, 0.5f, 0.f), 5.f);
  EXPECT_FLOAT_EQ(SampleBilinear(view, 0.5f, 0.5f), 15.f);
  EXPECT_FLOAT_EQ(SampleBilinear(view, 1.f, 1.f), 30.f);
  EXPECT_FLOAT_EQ(SampleBilinear(view, -3.f, 9.f), 20.f);
}

float SamplePairs(const Image<GrayPair>& pairs, float x, float y) {
  return SampleBilinear(pairs.View(), x, y) * kGrayUnit<GrayPair>;
}

TEST(SampleBilinear, OfPairsIsThatOfTheirGrayLevels) {
  Philox random(7, 0, 0);
  for (const auto& [width, height] :
       {std::pair(1, 1), {1, 7}, {7, 1}, {2, 2}, {40, 30}}) {
    Image<float> drawn(width, height);
    for (float& value : drawn) {
      value = 255.f * random.NextFloat();
    }
    const Image<GrayPair> pairs = PairsOf(drawn);
    const Image<float> gray = LevelsOf(pairs);
    for (size_t i = 0; i < gray.NumPixels(); ++i) {
      ASSERT_NEAR(gray.Data()[i], drawn.Data()[i], 0.002f);
    }
    ForEachPixel(width, height, [&](int x, int y) {
      // The last row is sampled from just above.
      ASSERT_NEAR(SamplePairs(pairs, x, y), gray(x, y), 1e-3f)
          << x << ", " << y;
    });
    for (int i = 0; i < 300; ++i) {
      const float x = random.NextFloat() * (width + 2.f) - 1.5f;
      const float y = random.NextFloat() * (height + 2.f) - 1.5f;
      ASSERT_NEAR(
          SamplePairs(pairs, x, y), SampleBilinear(gray.View(), x, y), 1e-3f)
          << x << ", " << y << " in " << width << " x " << height;
    }
  }
}

TEST(PairGray, PairsEachPixelWithItsRightNeighbor) {
  const auto device = Device::CreateCpu(2);
  Image<float> gray(5, 3);
  for (size_t i = 0; i < gray.NumPixels(); ++i) {
    gray.Data()[i] = 17.1f * static_cast<float>(i);
  }
  const DeviceImage<float> on_device(*device, gray);
  const Image<GrayPair> pairs = PairGray(on_device.View(), *device).ToHost();
  const Image<GrayPair> expected = PairsOf(gray);
  EXPECT_TRUE(SameBytes(pairs, expected));
}

TEST(HalveGray, GivesPairsTheLevelsOfTheHalvedImage) {
  const auto device = Device::CreateCpu(2);
  Image<float> gray(7, 5);
  for (size_t i = 0; i < gray.NumPixels(); ++i) {
    gray.Data()[i] = 7.3f * static_cast<float>(i);
  }
  const DeviceImage<float> on_device(*device, gray);
  const Image<float> halved = HalveGray(on_device.View(), *device).ToHost();
  const DeviceImage<GrayPair> pairs = PairGray(on_device.View(), *device);
  const Image<GrayPair> halved_pairs =
      HalveGray(pairs.View(), *device).ToHost();
  ASSERT_EQ(halved_pairs.Width(), 3);
  ASSERT_EQ(halved_pairs.Height(), 2);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 3; ++x) {
      const Halves levels = SplitWord(halved_pairs(x, y).word);
      EXPECT_NEAR(levels.low, 256.f * halved(x, y), 1.f);
      EXPECT_NEAR(levels.low + levels.high_minus_low,
                  256.f * halved(std::min(x + 1, 2), y),
                  1.f);
    }
  }
}

constexpr int kCount = 10;

// Every one of kCount positions must get what it gets alone.
template <typename Element>
void ExpectSameValues(const Image<Element>& gray,
                      const float (&x)[kCount],
                      const float (&y)[kCount]) {
  float values[kCount];
  constexpr float kOrigin = 7.f;
  SampleAboutBySteps(gray.View(), x, y, kOrigin, values);
  for (int i = 0; i < kCount; ++i) {
    ASSERT_EQ(values[i], SampleAbout(gray.View(), x[i], y[i], kOrigin))
        << x[i] << ", " << y[i] << " in " << gray.Width() << " x "
        << gray.Height();
  }
}

TEST(SampleAboutBySteps, GivesTheSameBitsAsOneByOne) {
  Philox random(1, 0, 0);
  for (const auto& [width, height] :
       {std::pair(1, 1), {1, 7}, {7, 1}, {2, 2}, {40, 30}}) {
    Image<float> gray(width, height);
    for (float& value : gray) {
      value = 255.f * random.NextFloat();
    }
    // Inside, as far as the last pixels, and all around.
    for (const float margin : {-1.5f, 0.f, 1.f, 100.f}) {
      for (int repetition = 0; repetition < 20; ++repetition) {
        float x[kCount];
        float y[kCount];
        for (int i = 0; i < kCount; ++i) {
          x[i] = random.NextFloat() * (width - 1 + 2.f * margin) - margin;
          y[i] = random.NextFloat() * (height - 1 + 2.f * margin) - margin;
        }
        ASSERT_NO_FATAL_FAILURE(ExpectSameValues(gray, x, y));
        ASSERT_NO_FATAL_FAILURE(ExpectSameValues(PairsOf(gray), x, y));
      }
    }
  }
}

TEST(SampleAboutBySteps, TakesAnyNumbers) {
  Image<float> gray(6, 5);
  Philox random(1, 0, 0);
  for (float& value : gray) {
    value = 255.f * random.NextFloat();
  }
  const float infinity = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float all[kCount] = {
      nan, -nan, infinity, -infinity, 1e30f, -1e30f, -0.f, 1e-42f, 5.f, 4.f};
  for (const float other : all) {
    float others[kCount];
    for (float& value : others) {
      value = other;
    }
    ASSERT_NO_FATAL_FAILURE(ExpectSameValues(gray, all, others));
    ASSERT_NO_FATAL_FAILURE(ExpectSameValues(gray, others, all));
    ASSERT_NO_FATAL_FAILURE(ExpectSameValues(PairsOf(gray), all, others));
    ASSERT_NO_FATAL_FAILURE(ExpectSameValues(PairsOf(gray), others, all));
  }
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
  const Buffer<SourceView> sources = scene.Sources();
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
