// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/outline_edges.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tsar {
namespace {

using Edges = std::vector<std::vector<AcrossEdge>>;

// The same edges in each of so many rows.
Edges Rows(size_t count, const std::vector<AcrossEdge>& of_row) {
  return Edges(count, of_row);
}

TEST(OutlinePairsTest, FindsTwoEdgesThatStay) {
  Edges edges = Rows(30, {{50.25f, 20.f}, {90.5f, 30.f}});
  // What stands before it, and edges elsewhere in single rows.
  edges[10].clear();
  edges[20] = {{50.25f, 20.f}, {70.f, 40.f}, {90.5f, 30.f}};
  edges.insert(edges.begin(), {{20.f, 9.f}});
  const std::vector<OutlinePair> pairs = FindOutlinePairs(edges);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_FLOAT_EQ(pairs[0].left, 50.25f);
  EXPECT_FLOAT_EQ(pairs[0].right, 90.5f);
  EXPECT_EQ(pairs[0].rows.size(), 28u);
  EXPECT_EQ(pairs[0].rows.front(), 1);
  EXPECT_EQ(pairs[0].rows.back(), 30);
  EXPECT_THAT(pairs[0].rows, testing::Not(testing::Contains(11)));
  EXPECT_THAT(pairs[0].rows, testing::Not(testing::Contains(21)));
}

TEST(OutlinePairsTest, FollowsEdgesOverABorderOfBins) {
  Edges edges;
  for (int row = 0; row < 40; ++row) {
    const float shift = row % 2 == 0 ? -0.4f : 0.4f;
    edges.push_back({{51.f + shift, 20.f}, {91.f + shift, 20.f}});
  }
  const std::vector<OutlinePair> pairs = FindOutlinePairs(edges);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].rows.size(), 40u);
  EXPECT_NEAR(pairs[0].left, 51.f, 1e-4f);
  EXPECT_NEAR(pairs[0].right, 91.f, 1e-4f);
}

// An edge with a weaker one beside it makes two pairs in a row, in two bins.
TEST(OutlinePairsTest, CountsARowOnce) {
  const std::vector<AcrossEdge> doubled = {
      {50.9f, 20.f}, {90.f, 11.f}, {91.2f, 20.f}};
  const std::vector<AcrossEdge> single = {{50.9f, 20.f}, {91.2f, 20.f}};
  Edges edges = Rows(12, single);
  edges.insert(edges.end(), 12, doubled);
  std::vector<OutlinePair> pairs = FindOutlinePairs(edges);
  ASSERT_EQ(pairs.size(), 1u);
  std::vector<int> all(24);
  for (int row = 0; row < 24; ++row) {
    all[row] = row;
  }
  EXPECT_EQ(pairs[0].rows, all);
  // The one nearer to where most are.
  EXPECT_FLOAT_EQ(pairs[0].right, 91.2f);
  // Twelve rows twice are not twenty.
  EXPECT_TRUE(FindOutlinePairs(Rows(12, doubled)).empty());
}

TEST(OutlinePairsTest, NeedsEnoughRowsAndAWidthWithinBounds) {
  EXPECT_EQ(FindOutlinePairs(Rows(20, {{50.f, 20.f}, {60.f, 20.f}})).size(),
            1u);
  EXPECT_TRUE(FindOutlinePairs(Rows(19, {{50.f, 20.f}, {60.f, 20.f}})).empty());
  EXPECT_TRUE(FindOutlinePairs(Rows(20, {{50.f, 20.f}, {59.f, 20.f}})).empty());
  EXPECT_EQ(FindOutlinePairs(Rows(20, {{50.f, 20.f}, {450.f, 20.f}})).size(),
            1u);
  EXPECT_TRUE(
      FindOutlinePairs(Rows(20, {{50.f, 20.f}, {451.f, 20.f}})).empty());
}

TEST(OutlinePairsTest, AllowsNothingAsStrongBetweenThem) {
  const auto with_edge = [](float strength) {
    return FindOutlinePairs(
        Rows(20, {{50.f, 20.f}, {55.f, strength}, {60.f, 30.f}}));
  };
  EXPECT_EQ(with_edge(11.9f).size(), 1u);
  EXPECT_TRUE(with_edge(12.f).empty());
}

TEST(OutlinePairsTest, FindsNothingInNothing) {
  EXPECT_TRUE(FindOutlinePairs({}).empty());
  EXPECT_TRUE(FindOutlinePairs(Rows(30, {})).empty());
  EXPECT_TRUE(FindOutlinePairs(Rows(30, {{50.f, 20.f}})).empty());
  EXPECT_TRUE(FindOutlinePairs(Rows(30, {{50.f, 20.f}, {50.f, 20.f}})).empty());
}

}  // namespace
}  // namespace tsar
