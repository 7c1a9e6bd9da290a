// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/graph_cut/label_graph.h"

#include <vector>

namespace tsar {

// The sum of the costs of these labels, one per node.
inline double Energy(const LabelGraph& graph, const std::vector<int>& labels) {
  double energy = 0.0;
  for (int node = 0; node < graph.num_nodes; ++node) {
    energy +=
        graph
            .unary[static_cast<size_t>(node * graph.num_labels + labels[node])];
  }
  for (size_t edge = 0; edge < graph.edges.size(); ++edge) {
    const auto [first, second] = graph.edges[edge];
    energy +=
        graph.pairwise(static_cast<int>(edge), labels[first], labels[second]);
  }
  return energy;
}

}  // namespace tsar
