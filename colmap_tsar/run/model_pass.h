// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/run/evidence_store.h"
#include "colmap_tsar/run/refine_plan.h"
#include "colmap_tsar/run/scene_model_store.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/scene/model_scene.h"
#include "colmap_tsar/view/refine_options.h"

#include <functional>
#include <string>

namespace tsar {

// The inputs of the pass over all views at once. All outlive the call.
struct ModelPassInputs {
  const Workspace& workspace;
  const RefinePlan& plan;
  EvidenceStore& evidence;
  const SceneModelStore& store;
  const RefineOptions& options;
};

// The second pass: finds the planes of the scene in the evidence of all views
// that have any, labels the views, and writes the result. Returns false,
// without writing, where should_stop returned true. pass: see ModelScene.
bool ModelWorkspace(const ModelPassInputs& inputs,
                    const ModelResources& resources,
                    const std::string& pass,
                    Progress& progress,
                    const std::function<bool()>& should_stop);

}  // namespace tsar
