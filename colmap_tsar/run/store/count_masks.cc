// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/count_masks.h"

#include <algorithm>

namespace tsar {

std::optional<int64_t> CountMasks(const Workspace& workspace,
                                  const std::vector<int>& images) {
  // A folder of masks is refused if it holds none of the images'.
  const int num_images = static_cast<int>(workspace.Model().images.size());
  bool uses_masks = false;
  for (int image = 0; image < num_images && !uses_masks; ++image) {
    uses_masks = workspace.HasMask(image);
  }
  if (!uses_masks) {
    return std::nullopt;
  }
  return std::count_if(images.begin(), images.end(), [&](int image) {
    return workspace.HasMask(image);
  });
}

std::vector<int> ReferencesOf(const Workspace& workspace,
                              const std::vector<size_t>& problems) {
  std::vector<int> references;
  for (const size_t place : problems) {
    references.push_back(workspace.Problems()[place].reference);
  }
  return references;
}

}  // namespace tsar
