// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/priors/depth_prior.h"
#include "colmap_tsar/run/device_options.h"
#include "colmap_tsar/run/run_summary.h"
#include "colmap_tsar/run/shard.h"
#include "colmap_tsar/view/refine_options.h"

#include <filesystem>
#include <optional>

namespace tsar {

// The inputs and settings of a run. Only input_type, the masks and the depth
// priors change a result.
struct WorkspaceRefineOptions {
  std::filesystem::path workspace_path;
  // The path of a second workspace to make with the results; empty: in place.
  std::filesystem::path output_path;
  // The maps to refine; nothing: the geometric ones, or the photometric ones
  // where there are no others.
  std::optional<MapType> input_type;
  // A text file with the names of the images to refine; empty: all.
  std::filesystem::path image_list_path;
  // The folder with the masks of images, see io/image_masks.h; empty: none.
  // Masked pixels are ignored and get no depth.
  std::filesystem::path mask_path;
  // The folder with the depth priors of images, see priors/prior_folder.h;
  // empty: none. prior_type: the meaning of their values.
  std::filesystem::path prior_path;
  PriorType prior_type = PriorType::kAuto;
  DeviceOptions devices;
  // For several machines: the part of the images and the pass over them.
  Shard shard;
  RefinePass pass = RefinePass::kAll;

  // Throws kBadOption, naming the option.
  void Check() const;
};

// Refines all images of stereo/patch-match.cfg, or only the listed ones, whose
// results are the same, and writes the result, the manifest of the run
// (stereo/tsar/manifest.json) and progress. Images that were done before with
// the same options and unchanged inputs are skipped; those that cannot be
// refined keep their maps.
//
// Before the first file is changed, everything is checked that can be seen
// without reading the pixels. Throws Error: what CheckWorkspace,
// Workspace::UseMasks and UsePriors, CreateOutputWorkspace, WorkspaceLock and
// the options' Check throw; kDevice; kInterrupted where the user asked to
// stop; and what reading and writing an image throw. After any error, images
// that were done stay done, and the same call resumes from there.
//
// kObserve, kModel and kCompose write no manifest. Before kModel, all images
// must have been observed with these options, before kCompose, the images of
// the shard and their sources, and the planes of the scene must have been
// found, else kNotFound. kMerge: see MergeShards.
RunSummary RefineWorkspace(const WorkspaceRefineOptions& workspace_options,
                           const RefineOptions& refine_options,
                           Progress& progress);

}  // namespace tsar
