// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/filtering/confidence.h"

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/matching/matching_cost.h"

#include <gtest/gtest.h>

namespace tsar {
namespace {

class ConfidenceTest : public testing::Test {
 protected:
  ConfidenceTest() : device_(Device::CreateCpu(1)) {}

  float Confidence(float min,
                   float second,
                   float difference,
                   RatioTerm ratio_term,
                   bool use_difference) const {
    const MatchingCosts costs{
        DeviceImage<float>(*device_, Image<float>(1, 1, min)),
        DeviceImage<float>(*device_, Image<float>(1, 1, second)),
        DeviceImage<float>(*device_, Image<float>(1, 1, difference))};
    ConfidenceOptions options;
    options.ratio_term = ratio_term;
    options.use_left_right_difference = use_difference;
    return ComputeConfidence(costs, options, *device_).ToHost()(0, 0);
  }

  std::unique_ptr<Device> device_;
};

TEST_F(ConfidenceTest, IsTheMeanOfItsTerms) {
  // (2 - 0.2) / 2 = 0.9, 0.2 / 0.5 = 0.4, 1 - 0.3 = 0.7.
  const auto confidence = [&](RatioTerm ratio_term, bool use_difference) {
    return Confidence(0.2f, 0.5f, 0.3f, ratio_term, use_difference);
  };
  EXPECT_FLOAT_EQ(confidence(RatioTerm::kSimilarity, true), 2.f / 3.f);
  EXPECT_FLOAT_EQ(confidence(RatioTerm::kAmbiguity, true), 2.2f / 3.f);
  EXPECT_FLOAT_EQ(confidence(RatioTerm::kNone, true), 0.8f);
  EXPECT_FLOAT_EQ(confidence(RatioTerm::kSimilarity, false), 0.65f);
  EXPECT_FLOAT_EQ(confidence(RatioTerm::kAmbiguity, false), 0.75f);
  EXPECT_FLOAT_EQ(confidence(RatioTerm::kNone, false), 0.9f);
}

TEST_F(ConfidenceTest, LeavesOutTheRatioWithoutASecondView) {
  for (const RatioTerm ratio_term :
       {RatioTerm::kNone, RatioTerm::kSimilarity, RatioTerm::kAmbiguity}) {
    EXPECT_FLOAT_EQ(Confidence(0.2f, kUndefinedCost, 0.3f, ratio_term, true),
                    0.8f);
  }
}

// Costs that come with the maps may be defined where ours are not.
TEST_F(ConfidenceTest, LeavesOutTheDifferenceWhereThereIsNone) {
  EXPECT_FLOAT_EQ(
      Confidence(0.2f, 0.5f, kUndefinedCost, RatioTerm::kNone, true), 0.9f);
  EXPECT_FLOAT_EQ(
      Confidence(0.2f, 0.5f, kUndefinedCost, RatioTerm::kSimilarity, true),
      0.65f);
}

TEST_F(ConfidenceTest, IsZeroWithoutEvidence) {
  EXPECT_EQ(Confidence(kUndefinedCost,
                       kUndefinedCost,
                       kUndefinedCost,
                       RatioTerm::kSimilarity,
                       true),
            0.f);
}

TEST_F(ConfidenceTest, IsOneForTwoPerfectViewsThatAgree) {
  EXPECT_FLOAT_EQ(Confidence(0.f, 0.f, 0.f, RatioTerm::kSimilarity, true), 1.f);
  EXPECT_FLOAT_EQ(Confidence(0.f, 0.f, 0.f, RatioTerm::kNone, true), 1.f);
}

TEST_F(ConfidenceTest, LiesBetweenZeroAndOne) {
  Philox random(1, 0, 0);
  for (int i = 0; i < 1000; ++i) {
    const float second = 2.f * random.NextFloat();
    const float min = second * random.NextFloat();
    const float difference = random.NextFloat();
    for (const RatioTerm ratio_term :
         {RatioTerm::kNone, RatioTerm::kSimilarity, RatioTerm::kAmbiguity}) {
      const float confidence =
          Confidence(min, second, difference, ratio_term, i % 2 == 0);
      ASSERT_GE(confidence, 0.f);
      ASSERT_LE(confidence, 1.f);
    }
  }
  EXPECT_FLOAT_EQ(Confidence(2.f, 2.f, 1.f, RatioTerm::kNone, true), 0.f);
}

}  // namespace
}  // namespace tsar
