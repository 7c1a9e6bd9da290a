// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/align_prior.h"

#include "colmap_tsar/base/random.h"

#include <cmath>
#include <functional>
#include <limits>

#include "tests/priors/drawn_box_room.h"
#include "tests/support/synthetic_observations.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tsar {
namespace {

using testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

class AlignPriorTest : public testing::Test {
 protected:
  // A prior of the room's own size, where all depths are known.
  DepthPrior Draw(PriorType type,
                  const std::function<float(float depth)>& value_of) const {
    DepthPrior prior;
    prior.type = type;
    prior.values = room_.depth;
    for (float& value : prior.values) {
      value = value_of(value);
    }
    return prior;
  }
  DepthPrior DrawMetric() const {
    return Draw(PriorType::kMetric, [](float depth) { return depth / 2.f; });
  }

  // The share of pixels whose depth errs by more than this.
  float ShareBeyond(const AlignedPrior& aligned, float error) const {
    int count = 0;
    for (size_t i = 0; i < room_.depth.NumPixels(); ++i) {
      const float off =
          std::abs(aligned.depth.Data()[i] / room_.depth.Data()[i] - 1.f);
      count += off <= error ? 0 : 1;
    }
    return static_cast<float>(count) /
           static_cast<float>(room_.depth.NumPixels());
  }

  void ExpectRoom(const DepthPrior& prior) const {
    const AlignedPrior aligned = AlignPrior(prior, samples_);
    ASSERT_EQ(aligned.assessment.verdict, PriorVerdict::kUsed)
        << Describe(aligned.assessment);
    ASSERT_FALSE(aligned.Empty());
    EXPECT_LT(ShareBeyond(aligned, 0.01f), 0.01f);
    EXPECT_GT(aligned.outlier_share, 0.f);
    EXPECT_LT(aligned.outlier_share, 0.1f);
    for (const float sigma : aligned.sigma) {
      EXPECT_GT(sigma, 0.f);
      EXPECT_LT(sigma, 0.5f);
    }
  }
  void ExpectDropped(const DepthPrior& prior, const std::string& reason) const {
    ExpectDropped(prior, samples_, reason);
  }
  static void ExpectDropped(const DepthPrior& prior,
                            const Image<RayDepth>& samples,
                            const std::string& reason) {
    const AlignedPrior aligned = AlignPrior(prior, samples);
    EXPECT_THAT(Describe(aligned.assessment), HasSubstr(reason));
    EXPECT_TRUE(aligned.Empty());
    EXPECT_TRUE(aligned.sigma.Empty());
  }

  const DrawnBoxRoom room_;
  const Image<RayDepth> samples_ = room_.Measure(&IsInSparseSquare, 0.002);
};

float Metric(float depth) { return depth / 2.f; }
float Relative(float depth) { return (depth - 1.f) / 3.f; }
float Inverse(float depth) { return (1.f / depth - 0.05f) / 0.4f; }

TEST_F(AlignPriorTest, FindsTheRoomFromEachType) {
  for (const bool is_given : {true, false}) {
    for (const auto& [type, value_of] :
         {std::pair(PriorType::kMetric, &Metric),
          std::pair(PriorType::kRelative, &Relative),
          std::pair(PriorType::kInverse, &Inverse)}) {
      ExpectRoom(Draw(is_given ? type : PriorType::kAuto, value_of));
    }
  }
}

TEST_F(AlignPriorTest, DropsPriorsThatExplainNothing) {
  ExpectDropped(Draw(PriorType::kAuto, [](float) { return 2.f; }),
                "explains only");
  Philox random(4, 0, 0);
  ExpectDropped(Draw(PriorType::kAuto,
                     [&](float) { return 1.f + 4.f * random.NextFloat(); }),
                "explains only");
  // Depth that is declared as inverse depth.
  ExpectDropped(Draw(PriorType::kInverse, &Metric), "explains only 0 %");
  ExpectDropped(Draw(PriorType::kMetric, &Inverse), "explains only 0 %");
}

TEST_F(AlignPriorTest, DropsPriorsThatTooLittleMeasures) {
  // 10 x 20 pixels are just enough.
  const auto measure = [&](int height) {
    return room_.Measure([&](int x, int y) {
      return x >= 90 && x < 100 && y >= 80 && y < 80 + height;
    });
  };
  ExpectDropped(
      DrawMetric(), measure(19), "too few of its pixels were measured");
  EXPECT_EQ(AlignPrior(DrawMetric(), measure(20)).assessment.verdict,
            PriorVerdict::kUsed);
  for (const float value : {0.f, kNan, kInfinity}) {
    ExpectDropped(Draw(PriorType::kAuto, [&](float) { return value; }),
                  "too few of its pixels were measured");
  }
}

// Correlated and independent errors, and samples on one side of the image only:
// the typical use of priors.
TEST_F(AlignPriorTest, TwoThirdsOfTheErrorsAreWithinSigma) {
  constexpr int kSpacing = 10;
  Philox random(9, 0, 0);
  Image<float> knots(kRoomWidth / kSpacing + 1, kRoomHeight / kSpacing + 1);
  for (float& knot : knots) {
    knot = static_cast<float>(0.02 * NextNormal(&random));
  }
  DepthPrior prior = DrawMetric();
  for (int y = 0; y < kRoomHeight; ++y) {
    for (int x = 0; x < kRoomWidth; ++x) {
      const int i = x / kSpacing;
      const int j = y / kSpacing;
      const float s = static_cast<float>(x % kSpacing) / kSpacing;
      const float t = static_cast<float>(y % kSpacing) / kSpacing;
      const float shared =
          (1.f - t) * ((1.f - s) * knots(i, j) + s * knots(i + 1, j)) +
          t * ((1.f - s) * knots(i, j + 1) + s * knots(i + 1, j + 1));
      const auto own = static_cast<float>(0.003 * NextNormal(&random));
      prior.values(x, y) *= std::exp(shared + own);
    }
  }
  const AlignedPrior aligned =
      AlignPrior(prior,
                 room_.Measure(
                     [](int x, int y) {
                       return IsInSparseSquare(x, y) && (x < 70 || y > 80);
                     },
                     0.002));
  ASSERT_FALSE(aligned.Empty());
  int num_within = 0;
  int num_far = 0;
  for (size_t i = 0; i < room_.depth.NumPixels(); ++i) {
    const float error =
        std::abs(std::log(aligned.depth.Data()[i] / room_.depth.Data()[i]));
    num_within += error <= aligned.sigma.Data()[i] ? 1 : 0;
    num_far += error > 3.f * aligned.sigma.Data()[i] ? 1 : 0;
  }
  constexpr int kNumPixels = kRoomWidth * kRoomHeight;
  EXPECT_GT(num_within, 0.58 * kNumPixels);
  EXPECT_LT(num_within, 0.85 * kNumPixels);
  EXPECT_LT(num_far, 0.03 * kNumPixels);
}

TEST_F(AlignPriorTest, HolesStayHoles) {
  for (const float none : {0.f, -1.f, kNan, kInfinity}) {
    DepthPrior prior = DrawMetric();
    for (int y = 20; y < 40; ++y) {
      for (int x = 10; x < 50; ++x) {
        prior.values(x, y) = none;
      }
    }
    const AlignedPrior aligned = AlignPrior(prior, samples_);
    ASSERT_FALSE(aligned.Empty());
    for (int y = 0; y < kRoomHeight; ++y) {
      for (int x = 0; x < kRoomWidth; ++x) {
        const bool is_hole = y >= 20 && y < 40 && x >= 10 && x < 50;
        EXPECT_EQ(aligned.depth(x, y) == 0.f, is_hole);
        EXPECT_EQ(aligned.sigma(x, y) == 0.f, is_hole);
        if (!is_hole) {
          EXPECT_NEAR(aligned.depth(x, y) / room_.depth(x, y), 1.f, 0.02f);
        }
      }
    }
  }
}

TEST_F(AlignPriorTest, TakesPriorsOfOtherSizes) {
  const DepthPrior full = DrawMetric();
  for (const double scale : {0.25, 0.5, 2.0}) {
    DepthPrior prior;
    prior.type = PriorType::kMetric;
    prior.values = Image<float>(static_cast<int>(kRoomWidth * scale),
                                static_cast<int>(kRoomHeight * scale));
    for (int y = 0; y < prior.values.Height(); ++y) {
      for (int x = 0; x < prior.values.Width(); ++x) {
        prior.values(x, y) = full.values(static_cast<int>((x + 0.5) / scale),
                                         static_cast<int>((y + 0.5) / scale));
      }
    }
    const AlignedPrior aligned = AlignPrior(prior, samples_);
    ASSERT_FALSE(aligned.Empty());
    EXPECT_TRUE(aligned.depth.HasSizeOf(room_.depth));
    EXPECT_TRUE(aligned.sigma.HasSizeOf(room_.depth));
    // All but the borders of the box.
    EXPECT_LT(ShareBeyond(aligned, 0.02f), 0.03 / scale);
  }
}

}  // namespace
}  // namespace tsar
