// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/label_graph.h"

#include "colmap_tsar/base/error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>

#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/property_map/property_map.hpp>

namespace tsar {
namespace {

// All costs of one move together are below two to this power, in units of the
// move. Their differences stay far from overflow.
constexpr int kUnitBits = 56;

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

// The moves of one graph. Each is a minimum cut of the same flow network, with
// other capacities: nodes on the source's side keep their label, those on the
// sink's side take the new one.
//
// Capacities are whole numbers: every path then adds at least one unit to the
// flow, so that the search for it ends, sums are exact in any order, and a tie
// is a tie. The unit is a power of two that follows the sum of the move's
// costs: costs of any size will do, and floats lose nothing that matters.
class ExpansionMoves {
 public:
  explicit ExpansionMoves(const LabelGraph& graph)
      : graph_(graph), costs_(graph.edges.size()), to_switch_(graph.num_nodes) {
    BuildNetwork();
  }

  // Gives the label to the nodes that lower the energy by taking it together.
  // False where there are none.
  bool Expand(int label, std::vector<int>* labels) {
    ReadCosts(label, *labels);
    SetCapacities(label, *labels);
    FindCut();
    return TakeLabel(label, labels);
  }

 private:
  // The property of an arc is its number before it was sorted by its origin.
  using Network = boost::
      compressed_sparse_row_graph<boost::directedS, boost::no_property, size_t>;
  using Arc = boost::graph_traits<Network>::edge_descriptor;

  // The costs of an edge for the choices of its first and its second node.
  struct EdgeCosts {
    float none_switches;
    float first_switches;
    float second_switches;
    float both_switch;
  };

  // Numbers of arcs: pairs of an arc and its reverse, first those from the
  // source to each node, then those from each node to the sink, then the edges.
  void BuildNetwork() {
    const size_t source = graph_.num_nodes;
    const size_t sink = source + 1;
    std::vector<std::pair<size_t, size_t>> ends;
    const auto add = [&](size_t from, size_t to) {
      ends.emplace_back(from, to);
      ends.emplace_back(to, from);
    };
    for (size_t node = 0; node < source; ++node) {
      add(source, node);
    }
    for (size_t node = 0; node < source; ++node) {
      add(node, sink);
    }
    for (const auto& [first, second] : graph_.edges) {
      add(first, second);
    }
    std::vector<size_t> numbers(ends.size());
    std::iota(numbers.begin(), numbers.end(), size_t{0});
    network_ = Network(boost::edges_are_unsorted_multi_pass,
                       ends.begin(),
                       ends.end(),
                       numbers.begin(),
                       sink + 1);

    std::vector<Arc> arcs(ends.size());
    positions_.resize(ends.size());
    const auto [begin, end] = boost::edges(network_);
    for (auto arc = begin; arc != end; ++arc) {
      const size_t number = network_[*arc];
      arcs[number] = *arc;
      positions_[number] = boost::get(boost::edge_index, network_, *arc);
    }
    reverses_.resize(ends.size());
    for (size_t i = 0; i < ends.size(); ++i) {
      reverses_[positions_[i]] = arcs[i ^ 1];
    }
    capacities_.assign(ends.size(), 0);
    residuals_.resize(ends.size());
    colors_.resize(sink + 1);
    predecessors_.resize(sink + 1);
    distances_.resize(sink + 1);
  }

  // Sets the costs of all edges and the size of a unit.
  void ReadCosts(int label, const std::vector<int>& labels) {
    double sum = 0.0;
    for (int node = 0; node < graph_.num_nodes; ++node) {
      const float* unary = UnaryOf(graph_, node);
      sum += std::abs(unary[labels[node]]) + std::abs(unary[label]);
    }
    for (size_t edge = 0; edge < costs_.size(); ++edge) {
      const int i = static_cast<int>(edge);
      const int a = labels[graph_.edges[edge][0]];
      const int b = labels[graph_.edges[edge][1]];
      EdgeCosts& cost = costs_[edge];
      cost = {graph_.pairwise(i, a, b),
              graph_.pairwise(i, label, b),
              graph_.pairwise(i, a, label),
              graph_.pairwise(i, label, label)};
      sum += std::abs(cost.none_switches) + std::abs(cost.first_switches) +
             std::abs(cost.second_switches) + std::abs(cost.both_switch);
    }
    if (!std::isfinite(sum)) {
      throw Error(ErrorCode::kUnsupported,
                  "graph of labels: a cost is not finite");
    }
    int exponent = 0;
    std::frexp(sum, &exponent);
    units_per_cost_ = std::ldexp(1.0, kUnitBits - exponent);
  }

  int64_t ToUnits(float cost) const {
    return static_cast<int64_t>(cost * units_per_cost_);
  }

  // A cut cannot express that it costs less, added up, when one node of an edge
  // switches and when the other does than when both do and when none does. Then
  // the dearer one of the first two is raised. Nothing gets cheaper, and
  // staying costs what it did, so that what the cut finds cheaper than staying
  // is so in truth. Lowering the cost of staying would do as well, but hides
  // what a node gains by switching alone: with any tables, it ends at higher
  // energies.
  void SetCapacities(int label, const std::vector<int>& labels) {
    const int num_nodes = graph_.num_nodes;
    for (int node = 0; node < num_nodes; ++node) {
      const float* unary = UnaryOf(graph_, node);
      to_switch_[node] = ToUnits(unary[label]) - ToUnits(unary[labels[node]]);
    }
    for (size_t edge = 0; edge < costs_.size(); ++edge) {
      const auto [first, second] = graph_.edges[edge];
      const int64_t none = ToUnits(costs_[edge].none_switches);
      const int64_t both = ToUnits(costs_[edge].both_switch);
      int64_t one = ToUnits(costs_[edge].first_switches);
      int64_t other = ToUnits(costs_[edge].second_switches);
      (one > other ? one : other) +=
          std::max<int64_t>(none + both - one - other, 0);
      to_switch_[first] += one - none;
      to_switch_[second] += both - one;
      Capacity(2 * num_nodes + edge) = one + other - none - both;
    }
    for (int node = 0; node < num_nodes; ++node) {
      Capacity(node) = std::max<int64_t>(to_switch_[node], 0);
      Capacity(num_nodes + node) = std::max<int64_t>(-to_switch_[node], 0);
    }
  }

  // Of the arc of the given pair; that of its reverse is always 0.
  int64_t& Capacity(size_t pair) { return capacities_[positions_[2 * pair]]; }

  void FindCut() {
    const auto arc_index = boost::get(boost::edge_index, network_);
    const auto node_index = boost::get(boost::vertex_index, network_);
    const size_t source = graph_.num_nodes;
    const auto of_arcs = [&](auto& values) {
      return boost::make_iterator_property_map(values.begin(), arc_index);
    };
    const auto of_nodes = [&](auto& values) {
      return boost::make_iterator_property_map(values.begin(), node_index);
    };
    boost::boykov_kolmogorov_max_flow(network_,
                                      of_arcs(capacities_),
                                      of_arcs(residuals_),
                                      of_arcs(reverses_),
                                      of_nodes(predecessors_),
                                      of_nodes(colors_),
                                      of_nodes(distances_),
                                      node_index,
                                      source,
                                      source + 1);
  }

  // The white nodes are those from which the sink can still be reached: the
  // smallest of all sets that are best. So nodes switch only where that lowers
  // the energy, and sweeps come to an end.
  bool TakeLabel(int label, std::vector<int>* labels) const {
    bool any = false;
    for (int node = 0; node < graph_.num_nodes; ++node) {
      if (colors_[node] == boost::white_color) {
        (*labels)[node] = label;
        any = true;
      }
    }
    return any;
  }

  const LabelGraph& graph_;
  std::vector<EdgeCosts> costs_;  // Of the edges in this move.
  double units_per_cost_ = 0.0;
  std::vector<int64_t> to_switch_;  // Cost of switching less that of keeping.

  Network network_;
  std::vector<size_t> positions_;  // Of arcs in the network, by number.
  std::vector<Arc> reverses_;      // These and the next two by position.
  std::vector<int64_t> capacities_;
  std::vector<int64_t> residuals_;
  std::vector<boost::default_color_type> colors_;  // Of nodes, as the next two.
  std::vector<Arc> predecessors_;
  std::vector<int> distances_;
};

}  // namespace

std::vector<int> MinimizeByExpansion(const LabelGraph& graph,
                                     const ExpansionOptions& options,
                                     std::vector<int> initial) {
  CheckGraph(graph);
  std::vector<int> labels =
      initial.empty() ? CheapestLabels(graph) : std::move(initial);
  CheckLabels(graph, labels);
  ExpansionMoves moves(graph);
  int num_unchanged = 0;  // Labels in a row that no node took.
  for (int sweep = 0; sweep < options.max_sweeps; ++sweep) {
    for (int label = 0; label < graph.num_labels; ++label) {
      num_unchanged = moves.Expand(label, &labels) ? 0 : num_unchanged + 1;
      if (num_unchanged == graph.num_labels) {
        return labels;
      }
    }
  }
  return labels;
}

}  // namespace tsar
