// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/model_pass.h"

#include "colmap_tsar/run/neighbor_order.h"

#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace tsar {
namespace {

// The views with current evidence, in the order of neighbors.
std::vector<SceneView> FindViews(const ModelPassInputs& inputs) {
  std::vector<size_t> indices;
  std::map<int, size_t> places;  // By image: its index in the result.
  for (const size_t index : OrderByNeighbors(inputs.workspace)) {
    const int image = inputs.plan.Reference(index);
    if (inputs.plan.CanRefine(index) && inputs.evidence.IsCurrent(image)) {
      places[image] = indices.size();
      indices.push_back(index);
    }
  }
  std::vector<SceneView> views;
  for (const size_t index : indices) {
    const int image = inputs.plan.Reference(index);
    SceneView view{image, inputs.workspace.CameraOf(image), {}};
    for (const int source : inputs.plan.Sources(index)) {
      if (source != image && places.contains(source)) {
        view.sources.push_back(places[source]);
      }
    }
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace

bool ModelWorkspace(const ModelPassInputs& inputs,
                    const ModelResources& resources,
                    const std::string& pass,
                    Progress& progress,
                    const std::function<bool()>& should_stop) {
  inputs.evidence.RemoveUnlikePriors();
  const std::vector<SceneView> views = FindViews(inputs);
  const SceneEvidence evidence = {
      [&](size_t view) { return inputs.evidence.Get(views[view].image); },
      [&](size_t view) { return inputs.evidence.ReadAll(views[view].image); }};
  ModelSceneOptions options;
  options.progress_prefix = pass;
  const std::optional<SceneModel> model = ModelScene({views,
                                                      evidence,
                                                      inputs.options,
                                                      options,
                                                      resources,
                                                      progress,
                                                      should_stop});
  if (!model) {
    return false;
  }
  inputs.store.Write(*model);
  return true;
}

}  // namespace tsar
