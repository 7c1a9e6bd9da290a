// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/scene/device_pool.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"
#include "colmap_tsar/scene/view_blocks.h"
#include "colmap_tsar/view/refine_options.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// Access to the evidence of views by index; called from several threads.
struct SceneEvidence {
  // The parts that neighbors need.
  std::function<std::shared_ptr<const ViewEvidence>(size_t view)> get;
  // All parts.
  std::function<ViewEvidence(size_t view)> read_all;
};

struct ModelSceneOptions {
  std::string progress_prefix;  // Of the progress messages.
  // The largest number of views in which planes are discovered jointly.
  size_t max_block_views = 32;
  // The number of sweeps over all views. In the first sweep each view is
  // labeled on its own; in later sweeps the labels of its sources from the
  // sweep before vote.
  int num_sweeps = 3;
};

// The resources of the pass, as memory allows.
struct ModelResources {
  int num_threads = 1;  // Threads of the host in total.
  int num_blocks = 1;   // Blocks, and
  int num_views = 1;    // views to be labeled, in parallel.
  // Main memory for costs that are kept from one sweep to the next.
  int64_t max_kept_bytes = 0;
  // GPUs that compute the costs of labels, each for one view at a time. The CPU
  // computes those of views that a GPU has too little memory for, and of all
  // views where there are no GPUs.
  std::vector<NamedDevice> gpus;
};

// The inputs of ModelScene, which must outlive the call.
struct ModelSceneInputs {
  // In an order in which views of the same surfaces are close to each other
  // (OrderByNeighbors), since it decides which views share a block.
  const std::vector<SceneView>& views;
  const SceneEvidence& evidence;
  const RefineOptions& refine_options;
  const ModelSceneOptions& options;
  const ModelResources& resources;
  Progress& progress;
};

// Finds the planes of a whole scene and labels its views with them:
// - discovers planes in blocks of views of the same surfaces;
// - joins planes of different blocks that are one surface, and adjusts the
//   planes of several blocks together (adjust_planes);
// - labels all views in sweeps; after the first one it looks for creases at
//   which planes end (bounding_creases), adds the planes that begin there, and,
//   if there are any, repeats the first sweep; in the end, views have those
//   that nothing measured only where at least four views do.
// Time grows with the number of views; memory holds the evidence of the blocks
// and views in progress, samples of the planes, some twenty bytes per
// superpixel of all views, and up to max_kept_bytes of the costs of labels;
// once these are freed, the outlines of all views (CylinderSearch).
//
// Result: the same bits for any resources; nothing where the user asked
// to stop.
std::optional<SceneModel> ModelScene(const ModelSceneInputs& inputs);

}  // namespace tsar
