// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"

#include <filesystem>
#include <vector>

namespace tsar {

// The chosen images, by image of the sparse model.
struct ChosenImages {
  std::vector<bool> used;
  std::vector<bool> fused;  // A subset of the used ones.
};

// Images that stereo/fusion.cfg does not list are not used, if that file
// exists, and only those in a list of names are fused; see io/image_lists.h.
// list: empty: all.
ChosenImages ChooseImages(const Workspace& workspace,
                          const std::filesystem::path& list = {});

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
  // Whether the maps are read as they were before refinement.
  bool originals = false;
};

// Plans the fusion of the chosen images that have maps. Throws Error kNotFound
// where no image to be fused has maps.
FusionPlan PlanFusion(const Workspace& workspace,
                      const ChosenImages& chosen,
                      int check_num_images);

}  // namespace tsar
