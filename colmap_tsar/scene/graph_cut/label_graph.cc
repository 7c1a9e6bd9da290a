// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/graph_cut/label_graph.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/scene/graph_cut/expansion_moves.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

namespace tsar {
namespace {

void Require(bool condition, const std::string& what) {
  if (!condition) {
    throw Error(ErrorCode::kMismatch, "graph of labels: " + what);
  }
}

void CheckGraph(const LabelGraph& graph) {
  Require(graph.num_nodes >= 0 && graph.num_labels >= 0, "a count is negative");
  Require(graph.num_nodes == 0 || graph.num_labels > 0,
          "there are nodes but no labels");
  Require(graph.unary.size() ==
              static_cast<size_t>(graph.num_nodes) * graph.num_labels,
          "the costs are not as many as nodes times labels");
  Require(graph.edges.empty() || graph.pairwise,
          "there are edges but no costs of them");
  for (const auto& [first, second] : graph.edges) {
    Require(first >= 0 && first < graph.num_nodes && second >= 0 &&
                second < graph.num_nodes,
            "an edge leads to a node that does not exist");
    Require(first != second, "an edge leads from a node to itself");
  }
}

void CheckLabels(const LabelGraph& graph, const std::vector<int>& labels) {
  Require(labels.size() == static_cast<size_t>(graph.num_nodes),
          "the labels are not as many as the nodes");
  for (const int label : labels) {
    Require(label >= 0 && label < graph.num_labels,
            "a node has a label that does not exist");
  }
}

const float* UnaryOf(const LabelGraph& graph, int node) {
  return &graph.unary[static_cast<size_t>(node) * graph.num_labels];
}

std::vector<int> CheapestLabels(const LabelGraph& graph) {
  std::vector<int> labels(graph.num_nodes);
  for (int node = 0; node < graph.num_nodes; ++node) {
    const float* unary = UnaryOf(graph, node);
    labels[node] = static_cast<int>(
        std::min_element(unary, unary + graph.num_labels) - unary);
  }
  return labels;
}

}  // namespace

std::vector<int> MinimizeByExpansion(const LabelGraph& graph,
                                     const ExpansionOptions& options,
                                     std::vector<int> initial) {
  CheckGraph(graph);
  std::vector<int> labels =
      initial.empty() ? CheapestLabels(graph) : std::move(initial);
  CheckLabels(graph, labels);
  ExpansionMoves moves(graph, std::move(labels));
  int num_unchanged = 0;  // Consecutive labels that no node took.
  for (int sweep = 0; sweep < options.max_sweeps; ++sweep) {
    for (int label = 0; label < graph.num_labels; ++label) {
      num_unchanged = moves.Expand(label) ? 0 : num_unchanged + 1;
      if (num_unchanged == graph.num_labels) {
        return moves.TakeLabels();
      }
    }
  }
  return moves.TakeLabels();
}

}  // namespace tsar
