// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/view/filter/reliability.h"

#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

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
