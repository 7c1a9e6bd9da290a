// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <vector>

namespace tsar {

// neighbours[i]: the views, by their numbers, that view i reads or that read
// it.
using ViewGraph = std::vector<std::vector<size_t>>;

// For each view, the number of the connected set of views that it belongs to;
// sets are numbered in the order of their first views.
std::vector<int> FindComponents(const ViewGraph& neighbours);

// Cuts the views, in their order, into blocks of at most max_size, the blocks
// of one connected set about equally large. Views that nothing connects never
// share a block, however few they are: they have no surface in common. Views of
// one set must follow each other, best with neighbours close to each other.
std::vector<std::vector<size_t>> SplitIntoBlocks(const ViewGraph& neighbours,
                                                 size_t max_size);

// For each block, in ascending order, the others that hold a neighbour of one
// of its views.
std::vector<std::vector<int>> FindBlockNeighbours(
    const ViewGraph& neighbours,
    const std::vector<std::vector<size_t>>& blocks);

}  // namespace tsar
