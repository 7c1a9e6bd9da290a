// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/view_blocks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tsar {
namespace {

using testing::ElementsAre;

// Views in a row, each a neighbor of the next.
ViewGraph Chain(size_t count) {
  ViewGraph graph(count);
  for (size_t i = 0; i + 1 < count; ++i) {
    graph[i].push_back(i + 1);
    graph[i + 1].push_back(i);
  }
  return graph;
}

TEST(SplitIntoBlocks, BlocksOfOneSetAreAboutEquallyLarge) {
  const auto blocks = SplitIntoBlocks(Chain(10), 4);
  EXPECT_THAT(
      blocks,
      ElementsAre(
          ElementsAre(0, 1, 2), ElementsAre(3, 4, 5), ElementsAre(6, 7, 8, 9)));
  EXPECT_THAT(FindBlockNeighbors(Chain(10), blocks),
              ElementsAre(ElementsAre(1), ElementsAre(0, 2), ElementsAre(1)));
  EXPECT_EQ(SplitIntoBlocks(Chain(10), 10).size(), 1u);
  EXPECT_EQ(SplitIntoBlocks(Chain(10), 1).size(), 10u);
  EXPECT_TRUE(SplitIntoBlocks({}, 4).empty());
}

TEST(SplitIntoBlocks, WhatNothingConnectsIsApart) {
  ViewGraph graph = Chain(5);
  graph[1].pop_back();
  graph[2].erase(graph[2].begin());
  EXPECT_THAT(FindComponents(graph), ElementsAre(0, 0, 1, 1, 1));
  const auto blocks = SplitIntoBlocks(graph, 32);
  EXPECT_THAT(blocks, ElementsAre(ElementsAre(0, 1), ElementsAre(2, 3, 4)));
  EXPECT_THAT(FindBlockNeighbors(graph, blocks),
              ElementsAre(ElementsAre(), ElementsAre()));
}

}  // namespace
}  // namespace tsar
