// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/neighbor_order.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <string>
#include <utility>

namespace tsar {
namespace {

// For each image, in ascending order, its sources and the images that use it.
std::vector<std::vector<size_t>> FindNeighbors(const Workspace& workspace) {
  const std::vector<StereoProblem>& problems = workspace.Problems();
  std::vector<int> index_of(workspace.Model().images.size(), -1);
  for (size_t i = 0; i < problems.size(); ++i) {
    index_of[problems[i].reference] = static_cast<int>(i);
  }
  std::vector<std::vector<size_t>> neighbors(problems.size());
  for (size_t i = 0; i < problems.size(); ++i) {
    for (const int source : problems[i].sources) {
      const int other = index_of[source];
      if (other >= 0 && other != static_cast<int>(i)) {
        neighbors[i].push_back(static_cast<size_t>(other));
        neighbors[other].push_back(i);
      }
    }
  }
  for (std::vector<size_t>& images : neighbors) {
    std::ranges::sort(images);
    images.erase(std::unique(images.begin(), images.end()), images.end());
  }
  return neighbors;
}

}  // namespace

std::vector<size_t> OrderByNeighbors(const Workspace& workspace) {
  const std::vector<std::vector<size_t>> neighbors = FindNeighbors(workspace);
  const auto name = [&](size_t image) -> const std::string& {
    return workspace.Name(workspace.Problems()[image].reference);
  };
  std::vector<bool> is_taken(neighbors.size(), false);
  // All images that can be reached, in breadth-first order.
  const auto walk = [&](size_t start) {
    std::vector<bool> is_seen = is_taken;
    std::vector<size_t> order = {start};
    is_seen[start] = true;
    for (size_t i = 0; i < order.size(); ++i) {
      const size_t first_new = order.size();
      for (const size_t other : neighbors[order[i]]) {
        if (!is_seen[other]) {
          is_seen[other] = true;
          order.push_back(other);
        }
      }
      std::ranges::sort(
          std::span(order).subspan(first_new), {}, [&](size_t image) {
            return std::pair(neighbors[image].size(), name(image));
          });
    }
    return order;
  };
  std::vector<size_t> by_name(neighbors.size());
  std::iota(by_name.begin(), by_name.end(), size_t{0});
  std::ranges::sort(by_name, {}, name);
  std::vector<size_t> order;
  for (const size_t image : by_name) {
    if (is_taken[image]) {
      continue;
    }
    // A peripheral image of all that can be reached: the farthest from the one
    // that is farthest from this one.
    const size_t end = walk(walk(image).back()).back();
    for (const size_t taken : walk(end)) {
      order.push_back(taken);
      is_taken[taken] = true;
    }
  }
  return order;
}

}  // namespace tsar
