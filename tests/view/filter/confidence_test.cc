// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/view/filter/reliability.h"

#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

class ConfidenceTest : public testing::Test {
 protected:
  ConfidenceTest() : device_(CreateTestDevice(1)) {}

  float Confidence(float min,
                   float second,
                   float difference,
                   bool use_ratio,
                   bool use_difference) const {
    const MatchingCosts costs{
        DeviceImage<float>(*device_, Image<float>(1, 1, min)),
        DeviceImage<float>(*device_, Image<float>(1, 1, second)),
        DeviceImage<float>(*device_, Image<float>(1, 1, difference))};
    ConfidenceOptions options;
    options.use_ratio = use_ratio;
    options.use_left_right_difference = use_difference;
    return ComputeConfidence(costs, options, *device_).ToHost()(0, 0);
  }

  std::unique_ptr<Device> device_;
};

TEST_F(ConfidenceTest, IsTheMeanOfItsTerms) {
  // (2 - 0.2) / 2 = 0.9, 0.2 / 0.5 = 0.4, 1 - 0.3 = 0.7.
  const auto confidence = [&](bool use_ratio, bool use_difference) {
    return Confidence(0.2f, 0.5f, 0.3f, use_ratio, use_difference);
  };
  EXPECT_FLOAT_EQ(confidence(true, true), 2.f / 3.f);
  EXPECT_FLOAT_EQ(confidence(false, true), 0.8f);
  EXPECT_FLOAT_EQ(confidence(true, false), 0.65f);
  EXPECT_FLOAT_EQ(confidence(false, false), 0.9f);
}

TEST_F(ConfidenceTest, LeavesOutTheRatioWithoutASecondView) {
  for (const bool use_ratio : {false, true}) {
    EXPECT_FLOAT_EQ(Confidence(0.2f, kUndefinedCost, 0.3f, use_ratio, true),
                    0.8f);
  }
}

// Costs that come with the maps may be defined where ours are not.
TEST_F(ConfidenceTest, LeavesOutTheDifferenceWhereThereIsNone) {
  EXPECT_FLOAT_EQ(Confidence(0.2f, 0.5f, kUndefinedCost, false, true), 0.9f);
  EXPECT_FLOAT_EQ(Confidence(0.2f, 0.5f, kUndefinedCost, true, true), 0.65f);
}

TEST_F(ConfidenceTest, LiesBetweenZeroAndOne) {
  Philox random(1, 0, 0);
  for (int i = 0; i < 1000; ++i) {
    const float second = 2.f * random.NextFloat();
    const float min = second * random.NextFloat();
    const float difference = random.NextFloat();
    for (const bool use_ratio : {false, true}) {
      const float confidence =
          Confidence(min, second, difference, use_ratio, i % 2 == 0);
      ASSERT_GE(confidence, 0.f);
      ASSERT_LE(confidence, 1.f);
    }
  }
  EXPECT_FLOAT_EQ(Confidence(2.f, 2.f, 1.f, false, true), 0.f);
}

}  // namespace
}  // namespace tsar
