// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/bilinear.cuh"

#include "colmap_tsar/base/random.h"

#include <limits>
#include <utility>

#include "tests/matching/gray_pairs.h"
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
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        ASSERT_EQ(SamplePairs(pairs, x, y), gray(x, y)) << x << ", " << y;
      }
    }
    for (int i = 0; i < 300; ++i) {
      const float x = random.NextFloat() * (width + 2.f) - 1.5f;
      const float y = random.NextFloat() * (height + 2.f) - 1.5f;
      ASSERT_NEAR(
          SamplePairs(pairs, x, y), SampleBilinear(gray.View(), x, y), 1e-3f)
          << x << ", " << y << " in " << width << " x " << height;
    }
  }
}

TEST(PairGray, PairsEachPixelWithItsRightNeighbour) {
  const auto device = Device::CreateCpu(2);
  Image<float> gray(5, 3);
  for (size_t i = 0; i < gray.NumPixels(); ++i) {
    gray.Data()[i] = 17.1f * static_cast<float>(i);
  }
  const DeviceImage<float> on_device(*device, gray);
  const Image<GrayPair> pairs = PairGray(on_device.View(), *device).ToHost();
  const Image<GrayPair> expected = PairsOf(gray);
  for (size_t i = 0; i < gray.NumPixels(); ++i) {
    EXPECT_EQ(pairs.Data()[i].word, expected.Data()[i].word);
  }
}

constexpr int kCount = 10;

// Every one of kCount positions must get what it gets alone.
template <typename Element>
void ExpectSameValues(const Image<Element>& gray,
                      const float (&x)[kCount],
                      const float (&y)[kCount]) {
  float values[kCount];
  SampleBilinearBySteps(gray.View(), x, y, values);
  for (int i = 0; i < kCount; ++i) {
    ASSERT_EQ(values[i], SampleBilinear(gray.View(), x[i], y[i]))
        << x[i] << ", " << y[i] << " in " << gray.Width() << " x "
        << gray.Height();
  }
}

TEST(SampleBilinearBySteps, GivesTheSameBitsAsOneByOne) {
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

TEST(SampleBilinearBySteps, TakesAnyNumbers) {
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

}  // namespace
}  // namespace tsar
