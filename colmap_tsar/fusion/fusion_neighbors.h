// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"

#include <filesystem>
#include <vector>

namespace tsar {

// The fused images, by their indices in the sparse model, and the sources of
// each image.
struct FusionPlan {
  // Nearby images follow each other, so that few are in memory at a time.
  std::vector<int> order;
  // By image of the sparse model, for those with maps: at most check_num_images
  // sources with maps, first those that share most points, then those that it
  // was matched with.
  std::vector<std::vector<int>> sources;
  // By image: its index in the order; -1 where it is not fused.
  std::vector<int> places;
};

// Plans the fusion of the listed images that have maps; image_list_path: a file
// of image names, see io/image_lists.h; empty: all images. Those that
// stereo/fusion.cfg does not list are neither fused nor sources, if that file
// exists. Throws Error kNotFound where no image to be fused has maps, and what
// ReadImageList throws.
FusionPlan PlanFusion(const Workspace& workspace,
                      const std::filesystem::path& image_list_path,
                      int check_num_images);

}  // namespace tsar
