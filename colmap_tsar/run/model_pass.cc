// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/model_pass.h"

#include "colmap_tsar/run/neighbor_order.h"
#include "colmap_tsar/run/store/scene_model_file.h"
#include "colmap_tsar/scene/model_scene.h"

#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace tsar {
namespace {

// The views with current evidence, in the order of neighbors.
std::vector<SceneView> FindViews(const RefineRun& run) {
  std::vector<size_t> indices;
  std::map<int, size_t> places;  // By image: its index in the result.
  for (const size_t index : OrderByNeighbors(run.workspace)) {
    const int image = run.selection.Reference(index);
    if (run.selection.CanRefine(index) && run.evidence.IsCurrent(image)) {
      places[image] = indices.size();
      indices.push_back(index);
    }
  }
  std::vector<SceneView> views;
  for (const size_t index : indices) {
    const int image = run.selection.Reference(index);
    SceneView view{image, run.workspace.CameraOf(image), {}};
    for (const int source : run.selection.Sources(index)) {
      if (source != image && places.contains(source)) {
        view.sources.push_back(places[source]);
      }
    }
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace

bool RefineRun::HasCurrentPlanes() const {
  return ReadStateFileKey(GetSceneModelPath(workspace.Root()),
                          kSceneModelFile) == evidence.Key();
}

bool ModelWorkspace(const RefineRun& run) {
  run.evidence.RemoveUnlikePriors();
  const std::vector<SceneView> views = FindViews(run);
  const SceneEvidence evidence = {
      [&](size_t view) { return run.evidence.Get(views[view].image); },
      [&](size_t view) { return run.evidence.ReadAll(views[view].image); }};
  ModelSceneOptions options;
  options.progress_prefix = run.options.pass == RefinePass::kModel
                                ? "Scene model,"
                                : "Pass 2 of 3, scene model,";
  const std::optional<SceneModel> model = ModelScene({views,
                                                      evidence,
                                                      run.refine_options,
                                                      options,
                                                      run.devices.model,
                                                      run.progress});
  if (!model) {
    return false;
  }
  WriteSceneModel(
      GetSceneModelPath(run.workspace.Root()), run.evidence.Key(), *model);
  return true;
}

}  // namespace tsar
