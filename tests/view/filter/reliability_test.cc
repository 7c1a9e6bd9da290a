// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/filter/reliability.h"

#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

class ReliabilityTest : public testing::Test {
 protected:
  ReliabilityTest() : device_(CreateTestDevice(1)) {}

  // The score of one pixel; a negative argument stands for a missing map.
  float Score(float depth,
              float confidence,
              float discontinuity,
              int agreement) {
    const Image<float> depths(1, 1, depth);
    const Image<float> confidences(1, 1, confidence);
    const Image<float> discontinuities(1, 1, discontinuity);
    const Image<uint8_t> agreements(1, 1, static_cast<uint8_t>(agreement));
    return AggregateScores(on_device_(depths),
                           confidence < 0.f ? ImageView<const float>()
                                            : on_device_(confidences),
                           discontinuity < 0.f ? ImageView<const float>()
                                               : on_device_(discontinuities),
                           agreement < 0 ? ImageView<const uint8_t>()
                                         : on_device_(agreements),
                           {},
                           *device_)
        .ToHost()(0, 0);
  }

  std::unique_ptr<Device> device_;
  DeviceCopies on_device_{*device_};
};

TEST_F(ReliabilityTest, WeighsConfidenceAgainstDiscontinuity) {
  EXPECT_FLOAT_EQ(Score(1.f, 0.5f, 1.5f, -1), 0.7f * 0.5f + 0.3f * 1.5f);
}

// The share of agreeing sources counts twice.
TEST_F(ReliabilityTest, IsTheMeanWithTheShareOfAgreeingSources) {
  const float paper = 0.7f * 0.5f + 0.3f * 1.5f;
  EXPECT_FLOAT_EQ(Score(1.f, 0.5f, 1.5f, 0), paper / 3.f);
  EXPECT_FLOAT_EQ(Score(1.f, 0.5f, 1.5f, 2), (paper + 1.f) / 3.f);
  EXPECT_FLOAT_EQ(Score(1.f, 0.5f, 1.5f, 4), (paper + 2.f) / 3.f);
  EXPECT_FLOAT_EQ(Score(1.f, 0.5f, 1.5f, 255), (paper + 2.f) / 3.f);
}

TEST_F(ReliabilityTest, GivesAMissingTermsWeightToTheOther) {
  EXPECT_FLOAT_EQ(Score(1.f, 0.5f, -1.f, -1), 0.5f);
  EXPECT_FLOAT_EQ(Score(1.f, -1.f, 1.5f, -1), 1.5f);
}

TEST_F(ReliabilityTest, SelectsWhatIsAboveTheThreshold) {
  Image<float> score(3, 1);
  score(0, 0) = 0.5f;
  score(1, 0) = 0.75f;
  score(2, 0) = 0.76f;
  const Image<uint8_t> reliable =
      SelectReliable(on_device_(score), 0.75f, *device_).ToHost();
  EXPECT_EQ(reliable(0, 0), 0);
  EXPECT_EQ(reliable(1, 0), 0);
  EXPECT_EQ(reliable(2, 0), 1);
}

TEST(ComputeConfidence, IsTheMeanOfTheTermsThatAreDefined) {
  const struct {
    float cost;
    float difference;
    float expected;
  } cases[] = {
      {0.2f, 0.3f, 0.8f},  // (2 - 0.2) / 2 = 0.9, 1 - 0.3 = 0.7.
      {0.f, 0.f, 1.f},
      {2.f, 1.f, 0.f},
      // Costs that come with the maps may be defined where ours are not.
      {0.2f, kUndefinedCost, 0.9f},
      {kUndefinedCost, kUndefinedCost, 0.f},
      {kUndefinedCost, 0.f, 0.f},
  };
  const auto device = CreateTestDevice(1);
  for (const auto& [cost, difference, expected] : cases) {
    const MatchingCosts costs{
        DeviceImage<float>(*device, Image<float>(1, 1, cost)),
        DeviceImage<float>(*device, Image<float>(1, 1, cost)),
        DeviceImage<float>(*device, Image<float>(1, 1, difference))};
    EXPECT_FLOAT_EQ(ComputeConfidence(costs, *device).ToHost()(0, 0), expected)
        << cost << ", " << difference;
  }
}

}  // namespace
}  // namespace tsar
