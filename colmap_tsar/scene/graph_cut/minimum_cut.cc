// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/graph_cut/minimum_cut.h"

#include <cstddef>
#include <numeric>
#include <utility>

#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/property_map/property_map.hpp>

namespace tsar {
namespace {

// The property of an arc is its index before arcs were sorted by origin.
using Network = boost::
    compressed_sparse_row_graph<boost::directedS, boost::no_property, size_t>;
using Arc = boost::graph_traits<Network>::edge_descriptor;

// Arcs, each followed by its reverse, whose capacity is 0.
struct ArcPairs {
  std::vector<std::pair<size_t, size_t>> ends;
  std::vector<int64_t> capacities;

  void Add(size_t from, size_t to, int64_t capacity) {
    ends.insert(ends.end(), {{from, to}, {to, from}});
    capacities.insert(capacities.end(), {capacity, 0});
  }
};

// Arcs from the source to nodes with a cost of switching, arcs from the others
// to the sink, then the edges.
ArcPairs MakeArcs(const std::vector<int64_t>& to_switch,
                  const std::vector<CutEdge>& edges,
                  size_t source,
                  size_t sink) {
  ArcPairs pairs;
  for (size_t node = 0; node < to_switch.size(); ++node) {
    if (to_switch[node] > 0) {
      pairs.Add(source, node, to_switch[node]);
    } else if (to_switch[node] < 0) {
      pairs.Add(node, sink, -to_switch[node]);
    }
  }
  for (const CutEdge& edge : edges) {
    if (edge.cost > 0) {
      pairs.Add(edge.first, edge.second, edge.cost);
    }
  }
  return pairs;
}

}  // namespace

std::vector<uint8_t> FindMinimumCut(const std::vector<int64_t>& to_switch,
                                    const std::vector<CutEdge>& edges) {
  const size_t source = to_switch.size();
  const size_t sink = source + 1;
  const ArcPairs pairs = MakeArcs(to_switch, edges, source, sink);
  const size_t num_arcs = pairs.ends.size();
  std::vector<size_t> indices(num_arcs);
  std::iota(indices.begin(), indices.end(), size_t{0});
  const Network network(boost::edges_are_unsorted_multi_pass,
                        pairs.ends.begin(),
                        pairs.ends.end(),
                        indices.begin(),
                        sink + 1);
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
    of_arcs(capacities)[arcs[i]] = pairs.capacities[i];
  }
  std::vector<int64_t> residuals(num_arcs);
  std::vector<Arc> predecessors(sink + 1);
  std::vector<boost::default_color_type> colors(sink + 1);
  std::vector<int> distances(sink + 1);
  boost::boykov_kolmogorov_max_flow(network,
                                    of_arcs(capacities),
                                    of_arcs(residuals),
                                    of_arcs(reverses),
                                    of_nodes(predecessors),
                                    of_nodes(colors),
                                    of_nodes(distances),
                                    node_index,
                                    source,
                                    sink);
  // The white nodes are those from which the sink can still be reached: the
  // smallest set of all minimum cuts.
  std::vector<uint8_t> switches(to_switch.size());
  for (size_t node = 0; node < switches.size(); ++node) {
    switches[node] = colors[node] == boost::white_color ? 1 : 0;
  }
  return switches;
}

}  // namespace tsar
