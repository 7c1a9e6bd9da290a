// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/connected_components.h"
#include "colmap_tsar/refinement/fragments.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <vector>

namespace tsar {
namespace {

struct SameLabel {
  const int* labels;
  TSAR_HD bool Contains(int /*i*/) const { return true; }
  TSAR_HD bool Connected(int i, int j) const { return labels[i] == labels[j]; }
};

// The borders between fragments, and who has joined whom.
class FragmentGraph {
 public:
  explicit FragmentGraph(const Image<int>& components)
      : parents_(components.NumPixels()), sizes_(components.NumPixels(), 0) {
    std::iota(parents_.begin(), parents_.end(), 0);
    for (const int root : components) {
      ++sizes_[root];
    }
  }

  int Size(int root) const { return sizes_[root]; }

  int Find(int i) {
    while (parents_[i] != i) {
      parents_[i] = parents_[parents_[i]];
      i = parents_[i];
    }
    return i;
  }

  void AddBorder(int a, int b) {
    ++borders_[a][b];
    ++borders_[b][a];
  }

  // Joins a fragment with the neighbour of the longest border, the first one
  // among equals.
  void JoinLongestNeighbour(int fragment) {
    int best = -1;
    int best_length = 0;
    std::map<int, int> merged;
    for (const auto& [neighbour, length] : borders_[fragment]) {
      const int root = Find(neighbour);
      if (root != fragment) {
        merged[root] += length;
      }
    }
    for (const auto& [root, length] : merged) {
      if (length > best_length) {
        best = root;
        best_length = length;
      }
    }
    if (best < 0) {
      return;
    }
    parents_[fragment] = best;
    sizes_[best] += sizes_[fragment];
    for (const auto& [root, length] : merged) {
      if (root != best) {
        // The other direction is there already: Find() turns the neighbour's
        // entry for the fragment into one for what it joined.
        borders_[best][root] += length;
      }
    }
    borders_.erase(fragment);
  }

 private:
  std::vector<int> parents_;
  std::vector<int> sizes_;
  std::map<int, std::map<int, int>> borders_;
};

}  // namespace

int MergeFragments(DeviceImage<int>& labels, int min_size, Device& device) {
  DeviceImage<int> component_image(device, labels.Width(), labels.Height());
  LabelComponents(device,
                  SameLabel{labels.View().data},
                  Connectivity::kFour,
                  component_image.View());
  const Image<int> components = component_image.ToHost();

  FragmentGraph graph(components);
  for (int y = 0; y < components.Height(); ++y) {
    for (int x = 0; x < components.Width(); ++x) {
      const int a = components(x, y);
      if (x + 1 < components.Width() && components(x + 1, y) != a) {
        graph.AddBorder(a, components(x + 1, y));
      }
      if (y + 1 < components.Height() && components(x, y + 1) != a) {
        graph.AddBorder(a, components(x, y + 1));
      }
    }
  }
  std::vector<int> fragments;
  for (size_t i = 0; i < components.NumPixels(); ++i) {
    const int root = static_cast<int>(i);
    if (components.Data()[i] == root && graph.Size(root) < min_size) {
      fragments.push_back(root);
    }
  }
  // The smallest first: what joins them may no longer be a fragment.
  std::stable_sort(fragments.begin(), fragments.end(), [&](int a, int b) {
    return graph.Size(a) < graph.Size(b);
  });
  for (const int fragment : fragments) {
    if (graph.Find(fragment) == fragment && graph.Size(fragment) < min_size) {
      graph.JoinLongestNeighbour(fragment);
    }
  }

  std::vector<int> names(components.NumPixels(), -1);
  int count = 0;
  Image<int> merged(components.Width(), components.Height());
  for (size_t i = 0; i < components.NumPixels(); ++i) {
    const int root = graph.Find(components.Data()[i]);
    if (names[root] < 0) {
      names[root] = count++;
    }
    merged.Data()[i] = names[root];
  }
  labels = DeviceImage<int>(device, merged);
  return count;
}

}  // namespace tsar
