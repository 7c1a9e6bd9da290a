// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <functional>
#include <limits>
#include <vector>

namespace tsar {

// The energy of a labeling of a graph's nodes: a sum of unary costs of nodes
// and pairwise costs of edges. Costs may have any sign and unit; they and their
// sum must be finite.
struct LabelGraph {
  int num_nodes = 0;
  int num_labels = 0;  // At least 1 where there are nodes.
  // num_nodes x num_labels, row by row: the cost of each label at each node.
  std::vector<float> unary;
  // Pairs of different nodes; the same two may have several edges.
  std::vector<std::array<int, 2>> edges;
  // The cost of an edge whose first node has label a and whose second has label
  // b, also for equal labels; it must be deterministic. A function, since a
  // table of all pairs of labels would take hundreds of megabytes.
  std::function<float(int edge, int a, int b)> pairwise;
  // A lower bound of all pairwise costs. A tighter bound saves evaluations of
  // edges; the result is the same.
  float min_pairwise = -std::numeric_limits<float>::infinity();
};

// Labels of low energy, one per node, by alpha expansion (Boykov, Veksler and
// Zabih, "Fast Approximate Energy Minimization via Graph Cuts", PAMI 2001):
// each move offers one label to all nodes, and the set that lowers the energy
// most takes it. Where the pairwise costs are a metric, no single move can
// improve the result of enough sweeps. With two labels and submodular costs it
// is the global minimum. Other costs are allowed: a move may then not be
// optimal, but none raises the energy. max_sweeps: the largest number of rounds
// through all labels, which begin with the cheapest of each node; they end
// early at convergence. Throws Error(kUnsupported) where costs are not finite.
std::vector<int> MinimizeByExpansion(const LabelGraph& graph,
                                     int max_sweeps = 4);

}  // namespace tsar
