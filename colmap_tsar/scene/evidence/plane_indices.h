// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <vector>

namespace tsar {

// Planes are named by their indices in a list: the planes of a block of views,
// of the scene (SceneModel::planes), or those that one view may show. kNoPlane
// stands for none. Code that moves planes to another list renumbers their
// references.
constexpr int kNoPlane = -1;

// Replaces indices in one list by those in another. new_indices: by old index;
// kNoPlane for planes that the other list does not hold.
inline std::vector<int> Renumber(std::vector<int> planes,
                                 const std::vector<int>& new_indices) {
  for (int& plane : planes) {
    plane = plane == kNoPlane ? kNoPlane : new_indices[plane];
  }
  return planes;
}

// The new_indices that lead from a list of num_planes planes to the list of
// those with the given indices.
inline std::vector<int> IndicesAmong(const std::vector<int>& indices,
                                     size_t num_planes) {
  std::vector<int> new_indices(num_planes, kNoPlane);
  for (size_t i = 0; i < indices.size(); ++i) {
    new_indices[indices[i]] = static_cast<int>(i);
  }
  return new_indices;
}

}  // namespace tsar
