// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/graph_cut/alpha_expansion.h"

#include "colmap_tsar/base/error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <queue>
#include <span>
#include <utility>

#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/property_map/property_map.hpp>

namespace tsar {
namespace {

// The sum of all costs of one move is below two to this power, in units of the
// move. Their differences stay far from overflow.
constexpr int kUnitBits = 56;
// Upper limit of the rounding error of a sum of costs, relative to the sum of
// their magnitudes.
constexpr double kRoundingShare = 1e-9;

void RequireFinite(double cost) {
  if (!std::isfinite(cost)) {
    throw Error(ErrorCode::kUnsupported,
                "graph of labels: a cost is not finite");
  }
}

// A minimum cut (Boykov and Kolmogorov, "An Experimental Comparison of
// Min-Cut/Max-Flow Algorithms for Energy Minimization in Vision", PAMI 2004)
// between nodes that stay and nodes that switch. No sum of costs may overflow.
class MinimumCut {
 public:
  explicit MinimumCut(size_t num_nodes)
      : source_(num_nodes), sink_(num_nodes + 1) {}

  void AddCostOfSwitching(size_t node, int64_t cost) {
    if (cost > 0) {
      AddArc(source_, node, cost);
    } else if (cost < 0) {
      AddArc(node, sink_, -cost);
    }
  }

  // The cost of the first node staying while the second one switches; not below
  // 0.
  void AddEdge(size_t first, size_t second, int64_t cost) {
    if (cost > 0) {
      AddArc(first, second, cost);
    }
  }

  // Whether each node switches, so that the sum of costs is minimal; among
  // minimum cuts, that with the smallest switching set.
  std::vector<bool> Find() const {
    const size_t num_arcs = ends_.size();
    std::vector<size_t> indices(num_arcs);
    std::iota(indices.begin(), indices.end(), size_t{0});
    const Network network(boost::edges_are_unsorted_multi_pass,
                          ends_.begin(),
                          ends_.end(),
                          indices.begin(),
                          sink_ + 1);
    const auto node_index = boost::get(boost::vertex_index, network);
    const auto of_arcs = [&](auto& values) {
      return boost::make_iterator_property_map(
          values.begin(), boost::get(boost::edge_index, network));
    };
    const auto of_nodes = [&](auto& values) {
      return boost::make_iterator_property_map(values.begin(), node_index);
    };
    std::vector<Arc> arcs(num_arcs);
    const auto [begin, end] = boost::edges(network);
    for (auto arc = begin; arc != end; ++arc) {
      arcs[network[*arc]] = *arc;
    }
    std::vector<Arc> reverses(num_arcs);
    std::vector<int64_t> capacities(num_arcs);
    for (size_t i = 0; i < num_arcs; ++i) {
      of_arcs(reverses)[arcs[i]] = arcs[i ^ 1];
      of_arcs(capacities)[arcs[i]] = capacities_[i];
    }
    std::vector<int64_t> residuals(num_arcs);
    std::vector<Arc> predecessors(sink_ + 1);
    std::vector<boost::default_color_type> colors(sink_ + 1);
    std::vector<int> distances(sink_ + 1);
    boost::boykov_kolmogorov_max_flow(network,
                                      of_arcs(capacities),
                                      of_arcs(residuals),
                                      of_arcs(reverses),
                                      of_nodes(predecessors),
                                      of_nodes(colors),
                                      of_nodes(distances),
                                      node_index,
                                      source_,
                                      sink_);
    // The white nodes are those from which the sink can still be reached: the
    // smallest set of all minimum cuts.
    std::vector<bool> switches;
    for (size_t node = 0; node < source_; ++node) {
      switches.push_back(colors[node] == boost::white_color);
    }
    return switches;
  }

 private:
  // The property of an arc is its index before arcs were sorted by origin.
  using Network = boost::
      compressed_sparse_row_graph<boost::directedS, boost::no_property, size_t>;
  using Arc = boost::graph_traits<Network>::edge_descriptor;

  void AddArc(size_t from, size_t to, int64_t capacity) {
    ends_.insert(ends_.end(), {{from, to}, {to, from}});
    capacities_.insert(capacities_.end(), {capacity, 0});
  }

  size_t source_;
  size_t sink_;
  // Arcs, each followed by its reverse, whose capacity is 0.
  std::vector<std::pair<size_t, size_t>> ends_;
  std::vector<int64_t> capacities_;
};

// The expansion moves of one graph, each from the labels that the move before
// left. A move is restricted to the subgraph of nodes that may take the label:
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
  // Keeps a reference to the graph.
  explicit ExpansionMoves(const LabelGraph& graph)
      : graph_(graph),
        labels_(graph.num_nodes),
        edges_of_(labels_.size()),
        present_(graph.edges.size()),
        saving_(labels_.size()),
        magnitude_(labels_.size()),
        costs_(graph.edges.size()),
        costs_of_(graph.edges.size(), 0),
        bounds_(labels_.size()),
        bounds_of_(labels_.size(), 0),
        positions_(labels_.size()),
        positions_of_(labels_.size(), 0) {
    std::ranges::for_each(graph.unary, RequireFinite);
    for (int node = 0; node < graph.num_nodes; ++node) {
      const std::span<const float> unary = UnaryOf(node);
      labels_[node] =
          static_cast<int>(std::ranges::min_element(unary) - unary.begin());
    }
    for (size_t i = 0; i < present_.size(); ++i) {
      const auto edge = static_cast<int>(i);
      const auto [first, second] = graph.edges[i];
      present_[i] = graph.pairwise(edge, labels_[first], labels_[second]);
      RequireFinite(present_[i]);
      edges_of_[first].push_back(edge);
      edges_of_[second].push_back(edge);
    }
    for (int node = 0; node < graph.num_nodes; ++node) {
      SumPresentCosts(node);
    }
  }

  // Gives the label to the nodes that lower the energy by taking it together.
  // Returns false if there are none.
  bool Expand(int label) {
    ++move_;
    const std::vector<int> part = FindPart(label);
    if (part.empty()) {
      return false;
    }
    const std::vector<int> switching = FindCut(part, label);
    for (const int node : switching) {
      labels_[node] = label;
    }
    for (const int node : switching) {
      for (const int edge : edges_of_[node]) {
        const auto [first, second] = graph_.edges[edge];
        present_[edge] = graph_.pairwise(edge, labels_[first], labels_[second]);
        SumPresentCosts(first);
        SumPresentCosts(second);
      }
    }
    return !switching.empty();
  }

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

  std::span<const float> UnaryOf(int node) const {
    const auto num_labels = static_cast<size_t>(graph_.num_labels);
    return {&graph_.unary[node * num_labels], num_labels};
  }

  float Unary(int node, int label) const { return UnaryOf(node)[label]; }

  // Sums the costs of the node's edges with the present labels.
  void SumPresentCosts(int node) {
    saving_[node] = 0.0;
    magnitude_[node] = 0.0;
    for (const int edge : edges_of_[node]) {
      const double cost = present_[edge];
      saving_[node] += cost - graph_.min_pairwise;
      magnitude_[node] += std::abs(cost);
    }
  }

  Bound FirstBound(int node, int label) const {
    const double now = Unary(node, labels_[node]);
    const double then = Unary(node, label);
    return {
        then - now - saving_[node],
        kRoundingShare * (std::abs(now) + std::abs(then) + magnitude_[node])};
  }

  // The bound with the actual costs of the edges, which must have been read.
  Bound TightBound(int node, int label) const {
    const double now = Unary(node, labels_[node]);
    const double then = Unary(node, label);
    Bound bound{then - now, std::abs(now) + std::abs(then)};
    for (const int edge : edges_of_[node]) {
      const auto [first, second] = graph_.edges[edge];
      const EdgeCosts& costs = costs_[edge];
      const double none = costs.none_switches;
      const double alone =
          (first == node ? costs.first_switches : costs.second_switches) - none;
      const double together = costs.both_switch - none;
      const int other = first == node ? second : first;
      bound.value +=
          labels_[other] == label ? alone : std::min(alone, together / 2.0);
      bound.error += std::abs(none) + std::abs(alone) + std::abs(together);
    }
    bound.error *= kRoundingShare;
    return bound;
  }

  void ReadEdgesOf(int node, int label) {
    for (const int edge : edges_of_[node]) {
      if (costs_of_[edge] == move_) {
        continue;
      }
      costs_of_[edge] = move_;
      const int a = labels_[graph_.edges[edge][0]];
      const int b = labels_[graph_.edges[edge][1]];
      EdgeCosts& costs = costs_[edge];
      costs = {present_[edge],
               graph_.pairwise(edge, label, b),
               graph_.pairwise(edge, a, label),
               graph_.pairwise(edge, label, label)};
      RequireFinite(double{costs.first_switches} + costs.second_switches +
                    costs.both_switch);
    }
  }

  // Nodes that may take the label: a superset of all sets that lower the
  // energy.
  std::vector<int> FindPart(int label) {
    std::vector<int> begin;
    double saved = 0.0;
    for (int node = 0; node < graph_.num_nodes; ++node) {
      if (labels_[node] == label || FirstBound(node, label).IsAbove0()) {
        continue;
      }
      ReadEdgesOf(node, label);
      const Bound bound = TightBound(node, label);
      bounds_of_[node] = move_;
      bounds_[node] = bound.value;
      if (!bound.IsAbove0()) {
        begin.push_back(node);
        saved += bound.error - bound.value;
      }
    }
    return Grow(begin, saved, label);
  }

  // The nodes that can be reached from those whose bounds are not above 0.
  std::vector<int> Grow(const std::vector<int>& begin,
                        double saved,
                        int label) {
    std::vector<int> part;
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> reached;
    for (const int node : begin) {
      reached.push({0.0, node});
    }
    while (!reached.empty()) {
      const Reached next = reached.top();
      reached.pop();
      if (positions_of_[next.node] == move_) {
        continue;
      }
      positions_of_[next.node] = move_;
      positions_[next.node] = static_cast<int>(part.size());
      part.push_back(next.node);
      for (const int edge : edges_of_[next.node]) {
        const auto [first, second] = graph_.edges[edge];
        const int node = first == next.node ? second : first;
        if (labels_[node] == label || positions_of_[node] == move_) {
          continue;
        }
        const double bound = bounds_of_[node] == move_
                                 ? bounds_[node]
                                 : FirstBound(node, label).value;
        const double raised = next.raised + std::max(bound, 0.0);
        if (raised <= saved) {
          reached.push({raised, node});
        }
      }
    }
    return part;
  }

  double UnitsPerCost(const std::vector<int>& part, int label) const {
    double sum = 0.0;
    for (const int node : part) {
      sum +=
          std::abs(Unary(node, labels_[node])) + std::abs(Unary(node, label));
      for (const int edge : edges_of_[node]) {
        const EdgeCosts& costs = costs_[edge];
        sum += std::abs(costs.none_switches) + std::abs(costs.first_switches) +
               std::abs(costs.second_switches) + std::abs(costs.both_switch);
      }
    }
    int exponent = 0;
    std::frexp(sum, &exponent);
    return std::ldexp(1.0, kUnitBits - exponent);
  }

  // The union of the sets that lower the energy.
  //
  // A cut cannot represent pairwise costs that are not submodular: where the
  // costs with one node switching have a smaller sum than those with both or
  // none. Then the larger one of the former is raised. No cost decreases, and
  // that of staying is unchanged, so that any move that the cut finds lowers
  // the energy. Lowering the cost of staying is also valid, but hides the gain
  // of a node that switches alone, and ends at higher energies.
  std::vector<int> FindCut(const std::vector<int>& part, int label) {
    for (const int node : part) {
      ReadEdgesOf(node, label);
    }
    const double units_per_cost = UnitsPerCost(part, label);
    const auto to_units = [&](float cost) {
      return static_cast<int64_t>(cost * units_per_cost);
    };
    std::vector<int64_t> to_switch;
    for (const int node : part) {
      to_switch.push_back(to_units(Unary(node, label)) -
                          to_units(Unary(node, labels_[node])));
    }
    MinimumCut cut(part.size());
    for (const int node : part) {
      for (const int edge : edges_of_[node]) {
        const auto [first, second] = graph_.edges[edge];
        const bool has_first = positions_of_[first] == move_;
        const bool has_second = positions_of_[second] == move_;
        if (has_first && has_second && node == second) {
          continue;  // Its first node adds it.
        }
        const int64_t none = to_units(costs_[edge].none_switches);
        const int64_t both = to_units(costs_[edge].both_switch);
        int64_t one = to_units(costs_[edge].first_switches);
        int64_t other = to_units(costs_[edge].second_switches);
        (one > other ? one : other) +=
            std::max<int64_t>(none + both - one - other, 0);
        if (has_first) {
          to_switch[positions_[first]] += one - none;
        }
        if (has_first && has_second) {
          to_switch[positions_[second]] += both - one;
          cut.AddEdge(
              positions_[first], positions_[second], one + other - none - both);
        } else if (has_second) {
          to_switch[positions_[second]] += other - none;
        }
      }
    }
    for (size_t i = 0; i < to_switch.size(); ++i) {
      cut.AddCostOfSwitching(i, to_switch[i]);
    }
    const std::vector<bool> switches = cut.Find();
    std::vector<int> switching;
    std::ranges::copy_if(part, std::back_inserter(switching), [&](int node) {
      return switches[positions_[node]];
    });
    return switching;
  }

  const LabelGraph& graph_;
  std::vector<int> labels_;
  std::vector<std::vector<int>> edges_of_;  // The edges of each node.
  std::vector<float> present_;              // The cost of each edge.
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

}  // namespace

std::vector<int> MinimizeByExpansion(const LabelGraph& graph, int max_sweeps) {
  ExpansionMoves moves(graph);
  int num_unchanged = 0;  // Consecutive labels that no node took.
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
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
