// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/refine_workspace.h"
#include "colmap_tsar/run/store/workspace.h"

#include <cstdint>
#include <vector>

namespace tsar {

// The results of checking a workspace's files before any work is done.
struct WorkspaceOverview {
  // For each image of the sparse model, whether it has maps of the type.
  std::vector<bool> has_maps;
  int64_t max_num_pixels = 0;        // Of the largest map.
  int64_t max_num_image_pixels = 0;  // Of the largest image that has a map.
  int max_num_sources = 0;  // Of the image that uses most views with maps.
  bool has_priors = false;  // Whether some image has a depth prior.
};

// Checks the files of all images that refinement will read, without reading
// their pixels, so that a run does not fail halfway for a reason that can be
// found at its start. Images without maps are no error. Throws Error: kNotFound
// (no image in patch-match.cfg has maps; an image file is missing; one of depth
// and normal map is missing), kCorrupt (a map is cut off, an image file is
// empty, cut off or of no known format), kMismatch (sizes differ, or a map is
// not of its image's shape), and what FindOriginals, Workspace::CheckMask and
// ReadPrior throw. Depth priors are read. num_threads: images checked at a
// time.
WorkspaceOverview CheckWorkspace(const Workspace& workspace, int num_threads);

// Opens the workspace with the requested type of maps, or the type that it has.
Workspace OpenWorkspace(const WorkspaceRefineOptions& options);

}  // namespace tsar
