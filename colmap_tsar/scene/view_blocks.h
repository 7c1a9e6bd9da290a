// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"

#include <cstddef>
#include <vector>

namespace tsar {

// An observed view.
struct SceneView {
  int image = -1;  // The key of its labels.
  Camera camera;   // Camera of the image, at any size.
  // Indices of its source views.
  std::vector<size_t> sources;
};

// neighbors[i]: the indices of the views that view i reads or that read it.
using ViewGraph = std::vector<std::vector<size_t>>;

ViewGraph MakeViewGraph(const std::vector<SceneView>& views);

// For each view, the index of its connected component of views; components are
// in the order of their first views.
std::vector<int> FindComponents(const ViewGraph& neighbors);

// Splits the views, in their order, into blocks of at most max_size, the blocks
// of one component about equally large. Views of different components never
// share a block, however few they are, since they have no surface in common.
// Views of one component must be contiguous, best with neighbors close to each
// other.
std::vector<std::vector<size_t>> SplitIntoBlocks(const ViewGraph& neighbors,
                                                 size_t max_size);

// For each block, in ascending order, the others that hold a neighbor of one
// of its views.
std::vector<std::vector<int>> FindBlockNeighbors(
    const ViewGraph& neighbors, const std::vector<std::vector<size_t>>& blocks);

}  // namespace tsar
