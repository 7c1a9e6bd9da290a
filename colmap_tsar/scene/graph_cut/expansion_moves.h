// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/graph_cut/label_graph.h"
#include "colmap_tsar/scene/graph_cut/minimum_cut.h"

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tsar {

// The expansion moves of one graph (MinimizeByExpansion), each from the labels
// that the move before left. A move is restricted to the subgraph of nodes that
// may take the label:
//
// A set of nodes that takes it together changes the energy by at least the sum
// of lower bounds of its nodes: the unary cost of the label, less that of the
// present label and the largest saving of the node's edges. An edge with both
// ends in the set counts by half at each. In a set that lowers the energy, some
// connected component does, so that it has a node whose bound is not above 0,
// and around it only nodes that the bounds below 0 can pay for. Where all
// bounds are above 0, no move lowers the energy. The first bound needs only the
// present costs of edges.
//
// The cut uses integer costs, so that sums are exact in any order, as are ties.
// The unit is a power of two that scales with the sum of the subgraph's costs:
// costs may have any magnitude, and the loss of precision is negligible.
class ExpansionMoves {
 public:
  // The graph must have been checked, and the labels must match it. Keeps a
  // reference to it.
  ExpansionMoves(const LabelGraph& graph, std::vector<int> labels);

  // Gives the label to the nodes that lower the energy by taking it together.
  // Returns false if there are none.
  bool Expand(int label);

  std::vector<int> TakeLabels() { return std::move(labels_); }

 private:
  // The costs of an edge for each combination of its nodes keeping or switching
  // labels.
  struct EdgeCosts {
    float none_switches = 0.f;
    float first_switches = 0.f;
    float second_switches = 0.f;
    float both_switch = 0.f;
  };
  struct Bound {
    double value = 0.0;
    double error = 0.0;  // Upper limit of the rounding error.

    bool IsAbove0() const { return value > error; }
  };
  // A node, and the energy added by the nodes on the path to it.
  struct Reached {
    double raised = 0.0;
    int node = 0;

    bool operator>(const Reached& other) const { return raised > other.raised; }
  };

  void ListEdgesOfNodes();
  // Sums the costs of the node with the present labels.
  void SumPresentCosts(int node);
  Bound FirstBound(int node, int label) const;
  // The bound with the actual costs of the edges, which must have been read.
  Bound TightBound(int node, int label) const;
  void ReadEdgesOf(int node, int label);
  // Nodes that may take the label: a superset of all sets that lower the
  // energy.
  std::vector<int> FindPart(int label);
  // Adds nodes that can be reached from those whose bounds are not above 0.
  void Grow(const std::vector<int>& begin,
            double saved,
            int label,
            std::vector<int>* part);
  // The union of the sets that lower the energy: 1 for its nodes.
  std::vector<uint8_t> FindCut(const std::vector<int>& part, int label);
  double UnitsPerCost(const std::vector<int>& part, int label) const;

  float Unary(int node, int label) const {
    return graph_.unary[static_cast<size_t>(node) *
                            static_cast<size_t>(graph_.num_labels) +
                        static_cast<size_t>(label)];
  }

  const LabelGraph& graph_;
  std::vector<int> labels_;
  // The indices of node k's edges are edges_[first_edge_[k]] to
  // edges_[first_edge_[k + 1]].
  std::vector<size_t> first_edge_;
  std::vector<int> edges_;
  std::vector<float> present_;  // The cost of each edge.
  // By node: the costs of its edges above their lower bounds, and the sum of
  // magnitudes.
  std::vector<double> saving_;
  std::vector<double> magnitude_;

  // Values of the current move, with the index of the move that set each.
  int move_ = 0;
  std::vector<EdgeCosts> costs_;
  std::vector<int> costs_of_;
  std::vector<double> bounds_;
  std::vector<int> bounds_of_;
  std::vector<int> positions_;  // Positions of nodes in the subgraph.
  std::vector<int> positions_of_;
};

}  // namespace tsar
