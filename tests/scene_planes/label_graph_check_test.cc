// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/scene_planes/label_graph.h"

#include <array>
#include <limits>

#include <gtest/gtest.h>

namespace tsar {
namespace {

class BadLabelGraphTest : public testing::Test {
 protected:
  BadLabelGraphTest() {
    graph_.num_nodes = 3;
    graph_.num_labels = 2;
    graph_.unary.assign(6, 1.f);
    graph_.edges = {{0, 1}, {1, 2}};
    graph_.pairwise = [](int, int a, int b) { return a == b ? 0.f : 1.f; };
  }

  void ExpectError(ErrorCode code, const std::vector<int>& labels = {}) const {
    try {
      MinimizeByExpansion(graph_, {}, labels);
      ADD_FAILURE() << "nothing thrown";
    } catch (const Error& error) {
      EXPECT_EQ(error.Code(), code);
    }
  }

  LabelGraph graph_;
};

TEST_F(BadLabelGraphTest, IsGoodAsItIs) {
  EXPECT_NO_THROW(MinimizeByExpansion(graph_, {}, {0, 1, 0}));
}

TEST_F(BadLabelGraphTest, CountsAreNegative) {
  graph_ = {};
  graph_.num_nodes = -1;
  ExpectError(ErrorCode::kMismatch);
  graph_ = {};
  graph_.num_labels = -1;
  ExpectError(ErrorCode::kMismatch);
}

TEST_F(BadLabelGraphTest, NodesHaveNoLabels) {
  graph_.num_labels = 0;
  graph_.unary.clear();
  ExpectError(ErrorCode::kMismatch);
}

TEST_F(BadLabelGraphTest, CostsOfNodesAreTooFewOrTooMany) {
  graph_.unary.resize(5);
  ExpectError(ErrorCode::kMismatch);
  graph_.unary.resize(7);
  ExpectError(ErrorCode::kMismatch);
}

TEST_F(BadLabelGraphTest, EdgesLeadOutOfTheGraph) {
  for (const std::array<int, 2>& edge :
       {std::array{-1, 0}, {3, 0}, {0, -1}, {0, 3}, {2, 2}}) {
    graph_.edges[1] = edge;
    ExpectError(ErrorCode::kMismatch);
  }
}

TEST_F(BadLabelGraphTest, EdgesHaveNoCosts) {
  graph_.pairwise = nullptr;
  ExpectError(ErrorCode::kMismatch);
}

TEST_F(BadLabelGraphTest, LabelsDoNotFit) {
  ExpectError(ErrorCode::kMismatch, {0, 1});
  ExpectError(ErrorCode::kMismatch, {0, 1, 0, 1});
  ExpectError(ErrorCode::kMismatch, {0, 1, 2});
  ExpectError(ErrorCode::kMismatch, {0, 1, -1});
  graph_.unary.pop_back();
  ExpectError(ErrorCode::kMismatch, {0, 1, 0});
}

TEST_F(BadLabelGraphTest, CostsAreNotFinite) {
  for (const float cost : {std::numeric_limits<float>::infinity(),
                           std::numeric_limits<float>::quiet_NaN()}) {
    graph_.unary.assign(6, 1.f);
    graph_.unary[3] = cost;
    ExpectError(ErrorCode::kUnsupported);
    graph_.unary[3] = 1.f;
    graph_.pairwise = [=](int, int a, int b) { return a == b ? 0.f : cost; };
    ExpectError(ErrorCode::kUnsupported);
    graph_.pairwise = [](int, int, int) { return 0.f; };
  }
}

}  // namespace
}  // namespace tsar
