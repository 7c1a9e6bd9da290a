// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/graph_cut/minimum_cut.h"

#include "colmap_tsar/base/random.h"

#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

int64_t CostOf(uint32_t set,
               const std::vector<int64_t>& to_switch,
               const std::vector<CutEdge>& edges) {
  int64_t sum = 0;
  for (size_t node = 0; node < to_switch.size(); ++node) {
    sum += set >> node & 1u ? to_switch[node] : 0;
  }
  for (const CutEdge& edge : edges) {
    sum +=
        (set >> edge.second & 1u) && !(set >> edge.first & 1u) ? edge.cost : 0;
  }
  return sum;
}

// The nodes of all best sets: the smallest one, which is unique.
uint32_t SmallestBestSet(const std::vector<int64_t>& to_switch,
                         const std::vector<CutEdge>& edges) {
  uint32_t best = 0;
  int64_t least = 0;
  for (uint32_t set = 1; set < 1u << to_switch.size(); ++set) {
    const int64_t cost = CostOf(set, to_switch, edges);
    if (cost < least) {
      least = cost;
      best = set;
    } else if (cost == least) {
      best &= set;
    }
  }
  return best;
}

TEST(MinimumCutTest, FindsTheSmallestOfTheBestSets) {
  Philox random(1, 0, 0);
  int num_switching = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const int num_nodes = 1 + random.NextBelow(9);
    std::vector<int64_t> to_switch;
    for (int node = 0; node < num_nodes; ++node) {
      to_switch.push_back(int64_t{random.NextBelow(9)} - 4);
    }
    std::vector<CutEdge> edges;
    for (int i = random.NextBelow(20); i > 0 && num_nodes > 1; --i) {
      const int first = random.NextBelow(num_nodes);
      const int step = 1 + random.NextBelow(num_nodes - 1);
      edges.push_back(
          {first, (first + step) % num_nodes, int64_t{random.NextBelow(4)}});
    }
    const std::vector<uint8_t> found = FindMinimumCut(to_switch, edges);
    ASSERT_EQ(found.size(), to_switch.size());
    uint32_t set = 0;
    for (size_t node = 0; node < found.size(); ++node) {
      set |= static_cast<uint32_t>(found[node]) << node;
      num_switching += found[node];
    }
    ASSERT_EQ(set, SmallestBestSet(to_switch, edges)) << "trial " << trial;
  }
  EXPECT_GT(num_switching, 500);
}

TEST(MinimumCutTest, NothingSwitchesForNothing) {
  EXPECT_TRUE(FindMinimumCut({}, {}).empty());
  EXPECT_EQ(FindMinimumCut({0, 0}, {{0, 1, 3}}), (std::vector<uint8_t>{0, 0}));
}

}  // namespace
}  // namespace tsar
