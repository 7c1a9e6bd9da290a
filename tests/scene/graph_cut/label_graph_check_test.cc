// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/scene/graph_cut/label_graph.h"

#include <functional>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

LabelGraph GoodGraph() {
  LabelGraph graph;
  graph.num_nodes = 3;
  graph.num_labels = 2;
  graph.unary.assign(6, 1.f);
  graph.edges = {{0, 1}, {1, 2}};
  graph.pairwise = [](int, int a, int b) { return a == b ? 0.f : 1.f; };
  return graph;
}

void ExpectError(ErrorCode code,
                 const std::function<void(LabelGraph*)>& spoil,
                 const std::vector<int>& labels = {}) {
  LabelGraph graph = GoodGraph();
  spoil(&graph);
  try {
    MinimizeByExpansion(graph, {}, labels);
    ADD_FAILURE() << "nothing thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.Code(), code);
  }
}

TEST(BadLabelGraphTest, IsRefused) {
  EXPECT_NO_THROW(MinimizeByExpansion(GoodGraph(), {}, {0, 1, 0}));
  const std::vector<std::function<void(LabelGraph*)>> defects = {
      [](LabelGraph* graph) {
        *graph = {};
        graph->num_nodes = -1;
      },
      [](LabelGraph* graph) {
        *graph = {};
        graph->num_labels = -1;
      },
      [](LabelGraph* graph) {
        graph->num_labels = 0;
        graph->unary.clear();
      },
      [](LabelGraph* graph) { graph->unary.resize(5); },
      [](LabelGraph* graph) { graph->unary.resize(7); },
      [](LabelGraph* graph) {
        graph->edges[1] = {-1, 0};
      },
      [](LabelGraph* graph) {
        graph->edges[1] = {3, 0};
      },
      [](LabelGraph* graph) {
        graph->edges[1] = {0, -1};
      },
      [](LabelGraph* graph) {
        graph->edges[1] = {0, 3};
      },
      [](LabelGraph* graph) {
        graph->edges[1] = {2, 2};
      },
      [](LabelGraph* graph) { graph->pairwise = nullptr; },
  };
  for (size_t i = 0; i < defects.size(); ++i) {
    SCOPED_TRACE(i);
    ExpectError(ErrorCode::kMismatch, defects[i]);
  }
  const std::vector<std::vector<int>> bad_labels = {
      {0, 1}, {0, 1, 0, 1}, {0, 1, 2}, {0, 1, -1}};
  for (const std::vector<int>& labels : bad_labels) {
    ExpectError(
        ErrorCode::kMismatch, [](LabelGraph*) {}, labels);
  }
  for (const float cost : {std::numeric_limits<float>::infinity(),
                           std::numeric_limits<float>::quiet_NaN()}) {
    ExpectError(ErrorCode::kUnsupported,
                [&](LabelGraph* graph) { graph->unary[3] = cost; });
    ExpectError(ErrorCode::kUnsupported, [&](LabelGraph* graph) {
      graph->pairwise = [=](int, int a, int b) { return a == b ? 0.f : cost; };
    });
  }
}

}  // namespace
}  // namespace tsar
