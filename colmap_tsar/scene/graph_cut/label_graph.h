// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <functional>
#include <limits>
#include <vector>

namespace tsar {

// What it costs to give each node of a graph one of a few labels: a sum of one
// term per node and one per edge. Costs may have any sign and unit, but must be
// finite, their sum too.
struct LabelGraph {
  int num_nodes = 0;
  int num_labels = 0;
  // num_nodes x num_labels, row by row: the cost of each label at each node.
  std::vector<float> unary;
  // Pairs of different nodes; the same two may have several edges.
  std::vector<std::array<int, 2>> edges;
  // The cost of an edge whose first node has label a and whose second has label
  // b, equal labels too; the same whenever it is asked for. A function, since a
  // table of all pairs of labels would take hundreds of megabytes.
  std::function<float(int edge, int a, int b)> pairwise;
  // No edge costs less, whatever its labels. The more is known, the fewer edges
  // are asked for their costs; the result is the same.
  float min_pairwise = -std::numeric_limits<float>::infinity();
};

struct ExpansionOptions {
  // Rounds through all labels. Fewer are done where nothing changes any more.
  int max_sweeps = 4;
};

// Labels of low energy (the sum of their costs), one per node, by alpha
// expansion (Boykov, Veksler and Zabih, "Fast Approximate Energy Minimization
// via Graph Cuts", PAMI 2001): label after label is offered to all nodes, and
// those take it that lower the energy most by doing so together. Where the
// costs of an edge are a metric, no single such move can improve the result of
// enough sweeps. With two labels it is the best of all, provided that equal
// labels at both ends of an edge cost no more, the two cases added up, than
// different ones. Other costs are allowed: a move may then not be the best one,
// but none raises the energy. initial: the labels to start from; empty for the
// cheapest of each node. Throws Error(kMismatch) where the graph's parts or the
// initial labels do not fit each other, Error(kUnsupported) where costs are not
// finite.
std::vector<int> MinimizeByExpansion(const LabelGraph& graph,
                                     const ExpansionOptions& options,
                                     std::vector<int> initial = {});

}  // namespace tsar
