// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <vector>

namespace tsar {

// An edge of the cut: the cost of the first node staying while the second one
// switches.
struct CutEdge {
  int first = 0;
  int second = 0;
  int64_t cost = 0;  // Not below 0.
};

// A minimum cut: for each node 1 where it switches and 0 where it stays, so
// that the sum of to_switch of the switching nodes and of the costs of cut
// edges is minimal; among minimum cuts, that with the smallest switching set.
// (Boykov and Kolmogorov, "An Experimental Comparison of Min-Cut/Max-Flow
// Algorithms for Energy Minimization in Vision", PAMI 2004). No sum may
// overflow.
std::vector<uint8_t> FindMinimumCut(const std::vector<int64_t>& to_switch,
                                    const std::vector<CutEdge>& edges);

}  // namespace tsar
