// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/graph_cut/alpha_expansion.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "tests/support/test_workspace.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

using Labels = std::vector<int>;

// A table of num_labels x num_labels costs.
using Table = std::vector<float>;

// The sum of the costs of these labels, one per node.
double Energy(const LabelGraph& graph, const std::vector<int>& labels) {
  double energy = 0.0;
  for (int node = 0; node < graph.num_nodes; ++node) {
    energy += graph.unary[node * graph.num_labels + labels[node]];
  }
  for (size_t edge = 0; edge < graph.edges.size(); ++edge) {
    const auto [first, second] = graph.edges[edge];
    energy +=
        graph.pairwise(static_cast<int>(edge), labels[first], labels[second]);
  }
  return energy;
}

// Enough for every graph here to converge.
constexpr int kUntilRest = 100;

// A number in [0, 4) of which sums are exact.
float DrawCost(Philox* random) { return random->NextBelow(64) / 16.f; }

// Nodes with drawn costs of their labels, and no edges.
LabelGraph DrawNodes(int num_nodes, int num_labels, Philox* random) {
  LabelGraph graph;
  graph.num_nodes = num_nodes;
  graph.num_labels = num_labels;
  graph.unary.resize(static_cast<size_t>(num_nodes) * num_labels);
  for (float& cost : graph.unary) {
    cost = DrawCost(random);
  }
  return graph;
}

void SetTables(std::vector<Table> tables, LabelGraph* graph) {
  graph->pairwise = [tables = std::move(tables), n = graph->num_labels](
                        int edge, int a, int b) {
    return tables[edge][a * n + b];
  };
}

// Edges between nodes as drawn, some of them twice, each with its own table.
template <typename DrawTable>
void AddEdges(int num_edges,
              const DrawTable& draw_table,
              Philox* random,
              LabelGraph* graph) {
  std::vector<Table> tables;
  for (int i = 0; i < num_edges && graph->num_nodes > 1; ++i) {
    const int first = random->NextBelow(graph->num_nodes);
    const int step = 1 + random->NextBelow(graph->num_nodes - 1);
    graph->edges.push_back({first, (first + step) % graph->num_nodes});
    tables.push_back(draw_table());
  }
  SetTables(std::move(tables), graph);
}

// Random costs of two labels; equal labels together cost no more than unequal.
Table DrawSubmodularTable(Philox* random) {
  const float both_first = DrawCost(random) - 2.f;
  const float both_second = DrawCost(random) - 2.f;
  const float first_second = DrawCost(random) - 2.f;
  return {both_first,
          first_second,
          both_first + both_second - first_second + DrawCost(random),
          both_second};
}

// A weight times the distance of positions on a line, up to a limit.
Table DrawMetricTable(int num_labels, Philox* random) {
  const float weight = (1 + random->NextBelow(16)) / 16.f;
  Table table(num_labels * num_labels);
  for (int a = 0; a < num_labels; ++a) {
    for (int b = 0; b < num_labels; ++b) {
      table[a * num_labels + b] = weight * std::min(std::abs(a - b), 2);
    }
  }
  return table;
}

Table DrawAnyTable(int num_labels, Philox* random) {
  Table table(num_labels * num_labels);
  for (float& cost : table) {
    cost = DrawCost(random) - 2.f;
  }
  return table;
}

// The least energy of all labelings, by trying them all.
double LeastEnergy(const LabelGraph& graph) {
  Labels labels(graph.num_nodes, 0);
  double least = Energy(graph, labels);
  for (int node = 0; node < graph.num_nodes;) {
    if (++labels[node] < graph.num_labels) {
      least = std::min(least, Energy(graph, labels));
      node = 0;
    } else {
      labels[node++] = 0;
    }
  }
  return least;
}

// The least energy that giving one label to any set of nodes can lead to.
double LeastEnergyOfMoves(const LabelGraph& graph, const Labels& labels) {
  double least = Energy(graph, labels);
  for (int label = 0; label < graph.num_labels; ++label) {
    for (uint32_t set = 0; set < 1u << graph.num_nodes; ++set) {
      Labels moved = labels;
      for (int node = 0; node < graph.num_nodes; ++node) {
        if (set >> node & 1u) {
          moved[node] = label;
        }
      }
      least = std::min(least, Energy(graph, moved));
    }
  }
  return least;
}

TEST(AlphaExpansionTest, FindsTheBestOfTwoLabels) {
  Philox random(1, 0, 0);
  for (int trial = 0; trial < 300; ++trial) {
    LabelGraph graph = DrawNodes(1 + random.NextBelow(8), 2, &random);
    AddEdges(
        random.NextBelow(16),
        [&] { return DrawSubmodularTable(&random); },
        &random,
        &graph);
    const double least = LeastEnergy(graph);
    EXPECT_EQ(Energy(graph, MinimizeByExpansion(graph)), least);
  }
}

// Dynamic programming finds the best labels of a chain of any length.
TEST(AlphaExpansionTest, FindsTheBestOfTwoLabelsOnALongChain) {
  Philox random(2, 0, 0);
  LabelGraph graph = DrawNodes(3000, 2, &random);
  std::vector<Table> tables;
  std::array<double, 2> least = {graph.unary[0], graph.unary[1]};
  for (int node = 1; node < graph.num_nodes; ++node) {
    graph.edges.push_back({node - 1, node});
    tables.push_back(DrawSubmodularTable(&random));
    std::array<double, 2> next;
    for (int b = 0; b < 2; ++b) {
      next[b] =
          graph.unary[2 * node + b] + std::min(least[0] + tables.back()[b],
                                               least[1] + tables.back()[2 + b]);
    }
    least = next;
  }
  SetTables(std::move(tables), &graph);
  EXPECT_EQ(Energy(graph, MinimizeByExpansion(graph)),
            std::min(least[0], least[1]));
}

TEST(AlphaExpansionTest, LeavesNoMoveThatImprovesAMetric) {
  Philox random(3, 0, 0);
  for (int trial = 0; trial < 100; ++trial) {
    LabelGraph graph = DrawNodes(2 + random.NextBelow(5), 3, &random);
    AddEdges(
        3 + random.NextBelow(9),
        [&] { return DrawMetricTable(3, &random); },
        &random,
        &graph);
    const Labels labels = MinimizeByExpansion(graph, kUntilRest);
    const double energy = Energy(graph, labels);
    EXPECT_EQ(energy, LeastEnergyOfMoves(graph, labels));
    // Twice the ratio of the largest to the smallest cost of unequal labels.
    EXPECT_LE(energy, 2.0 * 2.0 * LeastEnergy(graph));
  }
}

TEST(AlphaExpansionTest, NoSweepRaisesTheEnergyWhateverTheCosts) {
  Philox random(4, 0, 0);
  int num_lowered = 0;
  for (int trial = 0; trial < 200; ++trial) {
    LabelGraph graph = DrawNodes(20, 4, &random);
    AddEdges(
        50, [&] { return DrawAnyTable(4, &random); }, &random, &graph);
    for (int num_sweeps = 0; num_sweeps < 4; ++num_sweeps) {
      const Labels before = MinimizeByExpansion(graph, num_sweeps);
      const Labels after = MinimizeByExpansion(graph, num_sweeps + 1);
      if (after != before) {
        ASSERT_LT(Energy(graph, after), Energy(graph, before));
        ++num_lowered;
      }
    }
  }
  EXPECT_GT(num_lowered, 200);
}

// Numbers of which few sums are equal.
TEST(AlphaExpansionTest, LooksAtFewerEdgesWhereTheirLeastCostIsKnown) {
  Philox random(11, 0, 0);
  int64_t num_asked = 0;
  std::array<int64_t, 2> num_asked_by = {0, 0};
  for (int trial = 0; trial < 100; ++trial) {
    LabelGraph graph = DrawNodes(60, 12, &random);
    for (float& cost : graph.unary) {
      cost = 100.f * random.NextFloat();
    }
    AddEdges(
        150,
        [&] {
          Table table = trial % 2 == 0 ? DrawMetricTable(12, &random)
                                       : DrawAnyTable(12, &random);
          for (float& cost : table) {
            cost *= 0.5f + random.NextFloat();
          }
          return table;
        },
        &random,
        &graph);
    graph.pairwise = [&, costs = graph.pairwise](int edge, int a, int b) {
      ++num_asked;
      return costs(edge, a, b);
    };
    const Labels labels = MinimizeByExpansion(graph, kUntilRest);
    num_asked_by[0] += std::exchange(num_asked, 0);
    graph.min_pairwise = trial % 2 == 0 ? 0.f : -3.f;
    EXPECT_EQ(MinimizeByExpansion(graph, kUntilRest), labels);
    num_asked_by[1] += std::exchange(num_asked, 0);
  }
  EXPECT_LT(3 * num_asked_by[1], 2 * num_asked_by[0]);
}

// The smallest set of nodes takes a label.
TEST(AlphaExpansionTest, KeepsLabelsThatAreAsGood) {
  LabelGraph graph;
  graph.num_nodes = 4;
  graph.num_labels = 2;
  graph.unary = {0.f, 1.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f};
  graph.edges = {{0, 1}, {2, 3}};
  graph.pairwise = [](int, int a, int b) { return a == b ? 0.f : 1.f; };
  EXPECT_EQ(MinimizeByExpansion(graph), (Labels{0, 1, 0, 1}));
}

TEST(AlphaExpansionTest, WorksOnTheSmallestGraphs) {
  EXPECT_EQ(MinimizeByExpansion({}), Labels{});
  EXPECT_EQ(Energy({}, {}), 0.0);

  LabelGraph one_node;
  one_node.num_nodes = 1;
  one_node.num_labels = 3;
  one_node.unary = {0.f, -2.f, 1.f};
  EXPECT_EQ(MinimizeByExpansion(one_node), Labels{1});

  LabelGraph one_label;
  one_label.num_nodes = 2;
  one_label.num_labels = 1;
  one_label.unary = {1.f, 2.f};
  one_label.edges = {{0, 1}};
  one_label.pairwise = [](int, int, int) { return 4.f; };
  EXPECT_EQ(MinimizeByExpansion(one_label), (Labels{0, 0}));
  EXPECT_EQ(Energy(one_label, {0, 0}), 7.0);
}

TEST(AlphaExpansionTest, DependsOnRatiosOfCostsOnly) {
  Philox random(9, 0, 0);
  LabelGraph graph = DrawNodes(300, 6, &random);
  AddEdges(
      900, [&] { return DrawAnyTable(6, &random); }, &random, &graph);
  const Labels labels = MinimizeByExpansion(graph);
  EXPECT_EQ(MinimizeByExpansion(graph), labels);
  for (const float scale : {0x1p-100f, 0x1p100f}) {
    LabelGraph scaled = graph;
    for (float& cost : scaled.unary) {
      cost *= scale;
    }
    scaled.pairwise = [&](int edge, int a, int b) {
      return scale * graph.pairwise(edge, a, b);
    };
    EXPECT_EQ(MinimizeByExpansion(scaled), labels);
  }
}

TEST(AlphaExpansionTest, RefusesCostsThatAreNotFinite) {
  const auto expect_error = [](const LabelGraph& graph) {
    ExpectError(ErrorCode::kUnsupported, {"a cost is not finite"}, [&] {
      MinimizeByExpansion(graph);
    });
  };
  LabelGraph good;
  good.num_nodes = 3;
  good.num_labels = 2;
  good.unary.assign(6, 1.f);
  good.edges = {{0, 1}, {1, 2}};
  good.pairwise = [](int, int a, int b) { return a == b ? 0.f : 1.f; };
  EXPECT_NO_THROW(MinimizeByExpansion(good));
  for (const float cost : {std::numeric_limits<float>::infinity(),
                           std::numeric_limits<float>::quiet_NaN()}) {
    LabelGraph graph = good;
    graph.unary[3] = cost;
    expect_error(graph);
    graph = good;
    // The costs of the cheapest labels, and those of a move, are not finite.
    graph.pairwise = [=](int, int a, int b) { return a == b ? cost : 1.f; };
    expect_error(graph);
    graph.pairwise = [=](int, int a, int b) { return a == b ? 0.f : cost; };
    expect_error(graph);
  }
}

}  // namespace
}  // namespace tsar
