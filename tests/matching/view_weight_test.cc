// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/view_weight.cuh"

#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

int WeightOf(const std::vector<float>& costs, int iteration = 0) {
  ViewWeight weight(iteration);
  for (const float cost : costs) {
    weight.Add(cost);
  }
  return weight.Get();
}

TEST(ViewWeight, IsZeroWithoutCosts) { EXPECT_EQ(WeightOf({}), 0); }

TEST(ViewWeight, NeedsThreeLowCosts) {
  EXPECT_EQ(WeightOf({0.1f, 0.1f}), 0);
  EXPECT_EQ(WeightOf({0.1f, 0.1f, 1.f, 1.f, 1.f}), 0);
  EXPECT_GT(WeightOf({0.1f, 0.1f, 0.1f}), 0);
  EXPECT_GT(WeightOf({0.1f, 1.f, 0.1f, 1.f, 0.1f}), 0);
}

TEST(ViewWeight, AllowsTwoHighCosts) {
  const std::vector<float> low(6, 0.1f);
  std::vector<float> costs = low;
  costs.insert(costs.end(), {1.3f, 2.f});
  EXPECT_EQ(WeightOf(costs), WeightOf(low));
  costs.push_back(1.21f);
  EXPECT_EQ(WeightOf(costs), 0);
}

TEST(ViewWeight, CountsCostsBetweenLowAndHighForNothing) {
  const std::vector<float> low(3, 0.2f);
  std::vector<float> costs = low;
  costs.insert(costs.end(), 6, 1.1f);
  EXPECT_EQ(WeightOf(costs), WeightOf(low));
}

TEST(ViewWeight, GetsStricterWithTheIterations) {
  // 0.8 exp(-t^2 / 90): 0.8, 0.791, 0.765, 0.724, 0.670, 0.606.
  const float bounds[] = {0.8f, 0.7912f, 0.7652f, 0.7239f, 0.6697f, 0.6060f};
  for (int iteration = 0; iteration < 6; ++iteration) {
    const float bound = bounds[iteration];
    EXPECT_GT(WeightOf(std::vector<float>(9, bound - 1e-3f), iteration), 0)
        << iteration;
    EXPECT_EQ(WeightOf(std::vector<float>(9, bound + 1e-3f), iteration), 0)
        << iteration;
  }
}

TEST(ViewWeight, FallsWithTheCosts) {
  EXPECT_EQ(WeightOf({0.f, 0.f, 0.f}), 255);
  // 255 exp(-1 / 2)
  EXPECT_EQ(WeightOf({0.3f, 0.3f, 0.3f}), 155);
  // Of those that are low it is the mean.
  EXPECT_EQ(WeightOf({0.f, 0.3f, 0.f, 0.3f}), 205);
  int last = 255;
  for (float cost = 0.f; cost < 0.79f; cost += 0.01f) {
    const int weight = WeightOf(std::vector<float>(9, cost));
    EXPECT_LE(weight, last) << cost;
    // However high the low costs are, the view is used.
    EXPECT_GT(weight, 0) << cost;
    last = weight;
  }
  EXPECT_LT(last, 20);
}

}  // namespace
}  // namespace tsar
