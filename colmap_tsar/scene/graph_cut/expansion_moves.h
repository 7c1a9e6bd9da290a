// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/graph_cut/label_graph.h"
#include "colmap_tsar/scene/graph_cut/smallest_cut.h"

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tsar {

// The moves of one graph (MinimizeByExpansion), each for the labels that those
// before left. Of a move only the part is looked at in which nodes may take
// the label:
//
// A set of nodes that takes it together changes the energy by at least the sum
// of a bound of each of its nodes: what the label costs there, less what the
// present one does and what the edges of the node can save. Where an edge has
// both ends in the set, each counts for half of it. A set that lowers the
// energy has connected parts each of which does, so that each part holds a node
// whose bound is not above 0, and around it no others than what the bounds
// below 0 can pay for. Where all bounds are above 0, nothing can change. The
// first bound needs none of the edges' costs but the present ones.
//
// In the cut, costs are whole numbers: sums are then exact in any order, and a
// tie is a tie. The unit is a power of two that follows the sum of the part's
// costs: costs of any size will do, and floats lose nothing that matters.
class ExpansionMoves {
 public:
  // The graph was checked, and the labels fit it. Keeps a reference to it.
  ExpansionMoves(const LabelGraph& graph, std::vector<int> labels);

  // Gives the label to the nodes that lower the energy by taking it together.
  // False where there are none.
  bool Expand(int label);

  std::vector<int> TakeLabels() { return std::move(labels_); }

 private:
  // The costs of an edge for the choices of its first and its second node.
  struct EdgeCosts {
    float none_switches = 0.f;
    float first_switches = 0.f;
    float second_switches = 0.f;
    float both_switch = 0.f;
  };
  struct Bound {
    double value = 0.0;
    double error = 0.0;  // More than rounding can have made of it.

    bool IsAbove0() const { return value > error; }
  };
  // A node, and by how much those on the way to it raise the energy.
  struct Reached {
    double raised = 0.0;
    int node = 0;

    bool operator>(const Reached& other) const { return raised > other.raised; }
  };

  void ListEdgesOfNodes();
  // Of the node with its present label and those of its neighbours.
  void SumPresentCosts(int node);
  Bound FirstBound(int node, int label) const;
  // By the costs of the edges, which must have been read.
  Bound TightBound(int node, int label) const;
  void ReadEdgesOf(int node, int label);
  // Nodes that may take the label: all of the sets that lower the energy.
  std::vector<int> FindPart(int label);
  // Adds what those can reach whose bounds are not above 0.
  void Grow(const std::vector<int>& begin,
            double saved,
            int label,
            std::vector<int>* part);
  // The sets that lower the energy, as one: 1 for its nodes.
  std::vector<uint8_t> FindCut(const std::vector<int>& part, int label);
  double UnitsPerCost(const std::vector<int>& part, int label) const;

  float Unary(int node, int label) const {
    return graph_.unary[static_cast<size_t>(node) *
                            static_cast<size_t>(graph_.num_labels) +
                        static_cast<size_t>(label)];
  }

  const LabelGraph& graph_;
  std::vector<int> labels_;
  // The numbers of node k's edges are edges_[first_edge_[k]] to
  // edges_[first_edge_[k + 1]].
  std::vector<size_t> first_edge_;
  std::vector<int> edges_;
  std::vector<float> present_;  // The cost of each edge.
  // By node: what its edges cost over the least that they can, and the sum of
  // the magnitudes.
  std::vector<double> saving_;
  std::vector<double> magnitude_;

  // Of this move, which has a number, and by which move each was set.
  int move_ = 0;
  std::vector<EdgeCosts> costs_;
  std::vector<int> costs_of_;
  std::vector<double> bounds_;
  std::vector<int> bounds_of_;
  std::vector<int> places_;  // Of nodes in the part.
  std::vector<int> places_of_;
};

}  // namespace tsar
