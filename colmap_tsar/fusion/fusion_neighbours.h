// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"

#include <filesystem>
#include <vector>

namespace tsar {

// By image of the sparse model.
struct ChosenImages {
  std::vector<bool> used;
  std::vector<bool> fused;  // Of those that are used.
};

// Images that stereo/fusion.cfg does not list are not used, where there is such
// a file, and only those in a list of names are fused; see
// io/image_list.h. list: empty: all.
ChosenImages ChooseImages(const Workspace& workspace,
                          const std::filesystem::path& list = {});

// Which images are fused, by their places in the sparse model, and which other
// ones each is compared with.
struct FusionPlan {
  // Near images follow each other, so that few are in memory at a time.
  std::vector<int> order;
  // By image of the sparse model, of those that have maps: others that have, at
  // most check_num_images; first those that share most points, then those that
  // it was matched with.
  std::vector<std::vector<int>> sources;
  // By image: its place in the order; -1 where it is not fused.
  std::vector<int> places;
};

// Of the chosen images, those that have maps. Throws Error kNotFound where none
// that is to be fused has.
FusionPlan PlanFusion(const Workspace& workspace,
                      const ChosenImages& chosen,
                      int check_num_images);

}  // namespace tsar
