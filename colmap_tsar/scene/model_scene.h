// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/scene/device_pool.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"
#include "colmap_tsar/view/refine_options.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// A view that was observed.
struct SceneView {
  int image = -1;  // The key of its labels.
  Camera camera;   // Of the image, at any size.
  // Other views, by their places among all.
  std::vector<size_t> sources;
};

// The evidence of views, by their places; called from several threads.
struct SceneEvidence {
  // What neighbours need.
  std::function<std::shared_ptr<const ViewEvidence>(size_t view)> get;
  // All of it.
  std::function<ViewEvidence(size_t view)> read_all;
};

struct ModelSceneOptions {
  // Planes are looked for in this many views at a time, at most.
  size_t max_block_views = 32;
  // How often all views are labelled. In the first sweep each view is labelled
  // by itself; in the others it hears what its sources were labelled with in
  // the one before.
  int num_sweeps = 3;
};

// What the pass works with, by what memory allows.
struct ModelResources {
  int num_threads = 1;  // Of the host, all together.
  int num_blocks = 1;   // Blocks, and
  int num_views = 1;    // views to be labelled, at a time.
  // Main memory for what is kept from one sweep to the next.
  int64_t max_kept_bytes = 0;
  // GPUs on which labels are rated, each for one view at a time, and what a
  // view may take of such a one's memory. The CPU rates those of larger views,
  // and of all views where there are no GPUs.
  std::vector<NamedDevice> gpus;
  int64_t max_gpu_bytes = 0;
};

// Finds the planes of a whole scene and labels its views with them:
// - discovers planes in blocks of views that look at the same things;
// - joins planes of different blocks that are one surface, and adjusts the
//   planes of several blocks together (adjust_planes);
// - labels all views in sweeps; after the first one it looks for creases at
//   which planes end (bounding_creases), adds the planes that begin there, and,
//   if there are any, repeats the first sweep.
// Time grows with the number of views; memory holds the evidence of the blocks
// and views at work, samples of the planes, some twenty bytes per superpixel of
// all views, and as many of the costs of labels as max_kept_bytes allows; once
// these are freed, the outlines of all views (FindSceneCylinders).
//
// views: in an order in which those that look at the same things are close to
// each other (OrderByNeighbours): it decides which views share a block. Result:
// the same bits for any resources; nothing once should_stop returned true.
// pass: what the progress begins with.
std::optional<SceneModel> ModelScene(const std::vector<SceneView>& views,
                                     const SceneEvidence& evidence,
                                     const RefineOptions& refine_options,
                                     const ModelSceneOptions& options,
                                     const ModelResources& resources,
                                     const std::string& pass,
                                     Progress& progress,
                                     const std::function<bool()>& should_stop);

}  // namespace tsar
