// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/bilinear.cuh"

#include "colmap_tsar/base/random.h"

#include <limits>
#include <utility>

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

constexpr int kCount = 10;

// Every one of kCount positions must get what it gets alone.
void ExpectSameValues(const Image<float>& gray,
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
  }
}

}  // namespace
}  // namespace tsar
