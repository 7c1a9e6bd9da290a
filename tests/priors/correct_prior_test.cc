// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/correct_prior.h"

#include "colmap_tsar/base/random.h"

#include <cmath>
#include <functional>
#include <limits>

#include "tests/priors/drawn_box_room.h"
#include "tests/support/synthetic_observations.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

class CorrectPriorTest : public testing::Test {
 protected:
  // Corrects a prior with these errors of its logarithms by measurements of the
  // given pixels, with errors of 0.1 %.
  PriorCorrection Correct(
      const std::function<float(int x, int y)>& error,
      const std::function<bool(int x, int y)>& is_measured) {
    Philox random(8, 0, 0);
    Image<float> residual(kRoomWidth, kRoomHeight, kNone);
    for (int y = 0; y < kRoomHeight; ++y) {
      for (int x = 0; x < kRoomWidth; ++x) {
        log_depth_(x, y) = std::log(room_.depth(x, y)) + error(x, y);
        const auto noise = static_cast<float>(0.001 * NextNormal(&random));
        if (is_measured(x, y)) {
          residual(x, y) = noise - error(x, y);
        }
      }
    }
    return CorrectPrior(log_depth_, residual);
  }

  const DrawnBoxRoom room_;
  Image<float> log_depth_{kRoomWidth, kRoomHeight};
};

TEST_F(CorrectPriorTest, MovesAnObjectThatIsTooFar) {
  // In an image that is warped as well: the errors of the whole image show how
  // wrong objects may be.
  const auto error = [&](int x, int y) {
    return 0.0004f * static_cast<float>(80 - x) +
           (room_.is_box(x, y) != 0 ? 0.05f : 0.f);
  };
  const PriorCorrection correction = Correct(error, &IsInSparseSquare);
  int num_off = 0;
  for (int y = 0; y < kRoomHeight; ++y) {
    for (int x = 0; x < kRoomWidth; ++x) {
      num_off +=
          std::abs(correction.offset(x, y) + error(x, y)) > 0.01f ? 1 : 0;
    }
  }
  // Some along the border of the box, which has a tenth of the pixels.
  EXPECT_LT(num_off, kRoomWidth * kRoomHeight / 20);
  EXPECT_NEAR(correction.offset(104, 65), -error(104, 65), 0.005f);
  EXPECT_NEAR(correction.offset(40, 30), -error(40, 30), 0.005f);
}

TEST_F(CorrectPriorTest, IsNotPulledByWrongMeasurements) {
  const auto is_measured = [](int x, int y) { return IsInSparseSquare(x, y); };
  const auto error = [](int x, int y) {
    return IsInSparseSquare(x, y) && x / 4 % 2 == 0 && y / 4 % 5 == 0 ? 0.5f
                                                                      : 0.f;
  };
  Image<float> log_depth(kRoomWidth, kRoomHeight);
  Image<float> residual(kRoomWidth, kRoomHeight, kNone);
  Philox random(8, 0, 0);
  for (int y = 0; y < kRoomHeight; ++y) {
    for (int x = 0; x < kRoomWidth; ++x) {
      log_depth(x, y) = std::log(room_.depth(x, y));
      const auto noise = static_cast<float>(0.01 * NextNormal(&random));
      if (is_measured(x, y)) {
        residual(x, y) = error(x, y) + noise;
      }
    }
  }
  const PriorCorrection correction = CorrectPrior(log_depth, residual);
  for (const float offset : correction.offset) {
    EXPECT_LT(std::abs(offset), 0.02f);
  }
}

TEST_F(CorrectPriorTest, SigmaGrowsWithTheDistanceFromMeasurements) {
  // The upper part of the wall is measured on its right.
  const PriorCorrection correction =
      Correct([](int, int) { return 0.f; },
              [](int x, int y) { return y < 40 && x > 120; });
  float last = correction.sigma(140, 20);
  EXPECT_LT(last, 0.005f);
  for (int x = 110; x >= 70; x -= 10) {
    EXPECT_GT(correction.sigma(x, 20), last) << x;
    last = correction.sigma(x, 20);
  }
}

TEST_F(CorrectPriorTest, SaysNothingWhereThereIsNoPrior) {
  Image<float> log_depth(kRoomWidth, kRoomHeight, 1.f);
  for (int y = 0; y < kRoomHeight; ++y) {
    for (int x = 0; x < 30; ++x) {
      log_depth(x, y) = kNone;
    }
  }
  const PriorCorrection correction =
      CorrectPrior(log_depth, Image<float>(kRoomWidth, kRoomHeight, kNone));
  for (int y = 0; y < kRoomHeight; ++y) {
    for (int x = 0; x < kRoomWidth; ++x) {
      EXPECT_EQ(std::isnan(correction.offset(x, y)), x < 30);
      EXPECT_EQ(std::isnan(correction.sigma(x, y)), x < 30);
      // Nothing was measured.
      if (x >= 30) {
        EXPECT_EQ(correction.offset(x, y), 0.f);
        EXPECT_GT(correction.sigma(x, y), 0.f);
      }
    }
  }
}

}  // namespace
}  // namespace tsar
