// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/view_blocks.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include <boost/pending/disjoint_sets.hpp>

namespace tsar {

ViewGraph MakeViewGraph(const std::vector<SceneView>& views) {
  ViewGraph neighbors(views.size());
  for (size_t i = 0; i < views.size(); ++i) {
    for (const size_t source : views[i].sources) {
      if (source != i) {
        neighbors[i].push_back(source);
        neighbors[source].push_back(i);
      }
    }
  }
  for (std::vector<size_t>& of_view : neighbors) {
    std::sort(of_view.begin(), of_view.end());
    of_view.erase(std::unique(of_view.begin(), of_view.end()), of_view.end());
  }
  return neighbors;
}

std::vector<int> FindComponents(const ViewGraph& neighbors) {
  boost::disjoint_sets_with_storage<> sets(neighbors.size());
  for (size_t i = 0; i < neighbors.size(); ++i) {
    for (const size_t other : neighbors[i]) {
      sets.union_set(i, other);
    }
  }
  std::map<size_t, int> indices;
  std::vector<int> components;
  for (size_t i = 0; i < neighbors.size(); ++i) {
    const auto index = static_cast<int>(indices.size());
    components.push_back(
        indices.try_emplace(sets.find_set(i), index).first->second);
  }
  return components;
}

std::vector<std::vector<size_t>> SplitIntoBlocks(const ViewGraph& neighbors,
                                                 size_t max_size) {
  const std::vector<int> components = FindComponents(neighbors);
  std::vector<std::vector<size_t>> blocks;
  for (size_t begin = 0; begin < components.size();) {
    size_t end = begin;
    while (end < components.size() && components[end] == components[begin]) {
      ++end;
    }
    const size_t count = end - begin;
    const size_t num_blocks = (count + max_size - 1) / max_size;
    for (size_t i = 0; i < num_blocks; ++i) {
      const size_t first = begin + i * count / num_blocks;
      const size_t last = begin + (i + 1) * count / num_blocks;
      std::vector<size_t>& block = blocks.emplace_back(last - first);
      std::iota(block.begin(), block.end(), first);
    }
    begin = end;
  }
  return blocks;
}

std::vector<std::vector<int>> FindBlockNeighbors(
    const ViewGraph& neighbors,
    const std::vector<std::vector<size_t>>& blocks) {
  std::vector<int> block_of(neighbors.size(), -1);
  for (size_t b = 0; b < blocks.size(); ++b) {
    for (const size_t view : blocks[b]) {
      block_of[view] = static_cast<int>(b);
    }
  }
  std::vector<std::vector<int>> result;
  for (size_t b = 0; b < blocks.size(); ++b) {
    std::set<int> others;
    for (const size_t view : blocks[b]) {
      for (const size_t other : neighbors[view]) {
        others.insert(block_of[other]);
      }
    }
    others.erase(static_cast<int>(b));
    result.emplace_back(others.begin(), others.end());
  }
  return result;
}

}  // namespace tsar
