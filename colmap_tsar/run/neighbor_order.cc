// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/neighbor_order.h"

#include <algorithm>
#include <string>
#include <utility>

namespace tsar {
namespace {

class NeighborOrder {
 public:
  explicit NeighborOrder(const Workspace& workspace)
      : neighbors_(FindNeighbors(workspace)),
        is_taken_(neighbors_.size(), false) {
    for (const StereoProblem& problem : workspace.Problems()) {
      names_.push_back(workspace.Model()
                           .images[static_cast<size_t>(problem.reference)]
                           .name);
    }
  }

  std::vector<size_t> Find() {
    std::vector<size_t> by_name(neighbors_.size());
    for (size_t i = 0; i < by_name.size(); ++i) {
      by_name[i] = i;
    }
    std::sort(by_name.begin(), by_name.end(), [&](size_t a, size_t b) {
      return names_[a] < names_[b];
    });
    std::vector<size_t> order;
    for (const size_t image : by_name) {
      if (!is_taken_[image]) {
        const std::vector<size_t> component = Walk(FindEnd(image));
        order.insert(order.end(), component.begin(), component.end());
        for (const size_t taken : component) {
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
      std::sort(order.begin() + static_cast<std::ptrdiff_t>(first_new),
                order.end(),
                [&](size_t a, size_t b) {
                  return std::pair(neighbors_[a].size(), names_[a]) <
                         std::pair(neighbors_[b].size(), names_[b]);
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

std::vector<std::vector<size_t>> FindNeighbors(const Workspace& workspace) {
  const std::vector<StereoProblem>& problems = workspace.Problems();
  std::vector<int> index_of(workspace.Model().images.size(), -1);
  for (size_t i = 0; i < problems.size(); ++i) {
    index_of[static_cast<size_t>(problems[i].reference)] = static_cast<int>(i);
  }
  std::vector<std::vector<size_t>> neighbors(problems.size());
  for (size_t i = 0; i < problems.size(); ++i) {
    for (const int source : problems[i].sources) {
      const int other = index_of[static_cast<size_t>(source)];
      if (other >= 0 && other != static_cast<int>(i)) {
        neighbors[i].push_back(static_cast<size_t>(other));
        neighbors[static_cast<size_t>(other)].push_back(i);
      }
    }
  }
  for (std::vector<size_t>& images : neighbors) {
    std::sort(images.begin(), images.end());
    images.erase(std::unique(images.begin(), images.end()), images.end());
  }
  return neighbors;
}

std::vector<size_t> OrderByNeighbors(const Workspace& workspace) {
  return NeighborOrder(workspace).Find();
}

}  // namespace tsar
