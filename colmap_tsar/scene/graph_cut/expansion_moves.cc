// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/graph_cut/expansion_moves.h"

#include "colmap_tsar/base/error.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

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

}  // namespace

ExpansionMoves::ExpansionMoves(const LabelGraph& graph, std::vector<int> labels)
    : graph_(graph),
      labels_(std::move(labels)),
      present_(graph.edges.size()),
      saving_(labels_.size()),
      magnitude_(labels_.size()),
      costs_(graph.edges.size()),
      costs_of_(graph.edges.size(), 0),
      bounds_(labels_.size()),
      bounds_of_(labels_.size(), 0),
      positions_(labels_.size()),
      positions_of_(labels_.size(), 0) {
  for (const float cost : graph.unary) {
    RequireFinite(cost);
  }
  for (size_t edge = 0; edge < present_.size(); ++edge) {
    const auto [first, second] = graph.edges[edge];
    present_[edge] =
        graph.pairwise(static_cast<int>(edge), labels_[first], labels_[second]);
    RequireFinite(present_[edge]);
  }
  ListEdgesOfNodes();
  for (int node = 0; node < graph.num_nodes; ++node) {
    SumPresentCosts(node);
  }
}

void ExpansionMoves::ListEdgesOfNodes() {
  first_edge_.assign(labels_.size() + 1, 0);
  for (const auto& [first, second] : graph_.edges) {
    ++first_edge_[static_cast<size_t>(first) + 1];
    ++first_edge_[static_cast<size_t>(second) + 1];
  }
  for (size_t node = 0; node < labels_.size(); ++node) {
    first_edge_[node + 1] += first_edge_[node];
  }
  edges_.resize(2 * graph_.edges.size());
  std::vector<size_t> next = first_edge_;
  for (size_t edge = 0; edge < graph_.edges.size(); ++edge) {
    for (const int node : graph_.edges[edge]) {
      edges_[next[node]++] = static_cast<int>(edge);
    }
  }
}

void ExpansionMoves::SumPresentCosts(int node) {
  saving_[node] = 0.0;
  magnitude_[node] = 0.0;
  for (size_t i = first_edge_[node]; i < first_edge_[node + 1]; ++i) {
    const double cost = present_[edges_[i]];
    saving_[node] += cost - graph_.min_pairwise;
    magnitude_[node] += std::abs(cost);
  }
}

bool ExpansionMoves::Expand(int label) {
  ++move_;
  const std::vector<int> part = FindPart(label);
  if (part.empty()) {
    return false;
  }
  const std::vector<uint8_t> takes = FindCut(part, label);
  bool any = false;
  for (size_t i = 0; i < part.size(); ++i) {
    if (takes[i] != 0) {
      labels_[part[i]] = label;
      any = true;
    }
  }
  if (!any) {
    return false;
  }
  for (size_t i = 0; i < part.size(); ++i) {
    if (takes[i] == 0) {
      continue;
    }
    for (size_t k = first_edge_[part[i]]; k < first_edge_[part[i] + 1]; ++k) {
      const int edge = edges_[k];
      const auto [first, second] = graph_.edges[edge];
      present_[edge] = graph_.pairwise(edge, labels_[first], labels_[second]);
      SumPresentCosts(first);
      SumPresentCosts(second);
    }
    SumPresentCosts(part[i]);
  }
  return true;
}

ExpansionMoves::Bound ExpansionMoves::FirstBound(int node, int label) const {
  const double now = Unary(node, labels_[node]);
  const double then = Unary(node, label);
  return {then - now - saving_[node],
          kRoundingShare * (std::abs(now) + std::abs(then) + magnitude_[node])};
}

ExpansionMoves::Bound ExpansionMoves::TightBound(int node, int label) const {
  const double now = Unary(node, labels_[node]);
  const double then = Unary(node, label);
  Bound bound{then - now, std::abs(now) + std::abs(then)};
  for (size_t i = first_edge_[node]; i < first_edge_[node + 1]; ++i) {
    const int edge = edges_[i];
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

void ExpansionMoves::ReadEdgesOf(int node, int label) {
  for (size_t i = first_edge_[node]; i < first_edge_[node + 1]; ++i) {
    const int edge = edges_[i];
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

std::vector<int> ExpansionMoves::FindPart(int label) {
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
  std::vector<int> part;
  Grow(begin, saved, label, &part);
  return part;
}

void ExpansionMoves::Grow(const std::vector<int>& begin,
                          double saved,
                          int label,
                          std::vector<int>* part) {
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
    positions_[next.node] = static_cast<int>(part->size());
    part->push_back(next.node);
    for (size_t i = first_edge_[next.node]; i < first_edge_[next.node + 1];
         ++i) {
      const auto [first, second] = graph_.edges[edges_[i]];
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
}

double ExpansionMoves::UnitsPerCost(const std::vector<int>& part,
                                    int label) const {
  double sum = 0.0;
  for (const int node : part) {
    sum += std::abs(Unary(node, labels_[node])) + std::abs(Unary(node, label));
    for (size_t i = first_edge_[node]; i < first_edge_[node + 1]; ++i) {
      const EdgeCosts& costs = costs_[edges_[i]];
      sum += std::abs(costs.none_switches) + std::abs(costs.first_switches) +
             std::abs(costs.second_switches) + std::abs(costs.both_switch);
    }
  }
  int exponent = 0;
  std::frexp(sum, &exponent);
  return std::ldexp(1.0, kUnitBits - exponent);
}

// A cut cannot represent pairwise costs that are not submodular: where the
// costs with one node switching have a smaller sum than those with both or
// none. Then the larger one of the former is raised. No cost decreases, and
// that of staying is unchanged, so that any move that the cut finds lowers the
// energy. Lowering the cost of staying is also valid, but hides the gain of a
// node that switches alone, and ends at higher energies.
std::vector<uint8_t> ExpansionMoves::FindCut(const std::vector<int>& part,
                                             int label) {
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
  std::vector<CutEdge> cut_edges;
  for (const int node : part) {
    for (size_t i = first_edge_[node]; i < first_edge_[node + 1]; ++i) {
      const int edge = edges_[i];
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
        cut_edges.push_back(
            {positions_[first], positions_[second], one + other - none - both});
      } else if (has_second) {
        to_switch[positions_[second]] += other - none;
      }
    }
  }
  return FindMinimumCut(to_switch, cut_edges);
}

}  // namespace tsar
