// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/run/evidence_store.h"
#include "colmap_tsar/run/refine_run.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/scene/find_scene.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace tsar {

// The evidence of an image and its neighbors, and the scene found in it.
struct ImageScene {
  ViewEvidence own;
  std::vector<EvidenceStore::Evidence> others;
  std::vector<ObservedView> views;  // Of the above, the image's own first.
  FoundScene found;
};

// Reads the evidence and finds the scene of the image with this index in the
// run's plan. Throws kMismatch where the model's labels do not fit.
std::unique_ptr<ImageScene> FindImageScene(const RefineRun& run,
                                           const SceneModel& model,
                                           size_t index,
                                           Device& device);

}  // namespace tsar
