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

class NeighborOrder {
 public:
  explicit NeighborOrder(const Workspace& workspace)
      : neighbors_(FindNeighbors(workspace)),
        is_taken_(neighbors_.size(), false) {
    for (const StereoProblem& problem : workspace.Problems()) {
      names_.push_back(workspace.Name(problem.reference));
    }
  }

  std::vector<size_t> Find() {
    std::vector<size_t> by_name(neighbors_.size());
    std::iota(by_name.begin(), by_name.end(), size_t{0});
    std::ranges::sort(by_name, {}, [&](size_t image) { return names_[image]; });
    std::vector<size_t> order;
    for (const size_t image : by_name) {
      if (!is_taken_[image]) {
        for (const size_t taken : Walk(FindEnd(image))) {
          order.push_back(taken);
          is_taken_[taken] = true;
        }
      }
    }
    return order;
  }

 private:
  // All images that can be reached, in breadth-first order.
  std::vector<size_t> Walk(size_t start) const {
    std::vector<bool> is_seen = is_taken_;
    std::vector<size_t> order = {start};
    is_seen[start] = true;
    for (size_t i = 0; i < order.size(); ++i) {
      const size_t first_new = order.size();
      for (const size_t other : neighbors_[order[i]]) {
        if (!is_seen[other]) {
          is_seen[other] = true;
          order.push_back(other);
        }
      }
      std::ranges::sort(
          std::span(order).subspan(first_new), {}, [&](size_t image) {
            return std::pair(neighbors_[image].size(), names_[image]);
          });
    }
    return order;
  }

  // A peripheral image of all that can be reached: the farthest from the one
  // that is farthest from `image`.
  size_t FindEnd(size_t image) const { return Walk(Walk(image).back()).back(); }

  const std::vector<std::vector<size_t>> neighbors_;
  std::vector<std::string> names_;
  std::vector<bool> is_taken_;
};

}  // namespace

std::vector<size_t> OrderByNeighbors(const Workspace& workspace) {
  return NeighborOrder(workspace).Find();
}

}  // namespace tsar
