// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/find_scene.h"

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace tsar {

// The planes of a scene that fits into one block of views, and what the first
// view shows of them, after so many sweeps. Each view is a source of all
// others.
inline FoundScene FindSceneOfBlock(const std::vector<ObservedView>& views,
                                   const BlockOfScene& block,
                                   const RefineOptions& options,
                                   Device& device,
                                   int num_sweeps = 2) {
  std::vector<ModelPlane> planes;
  for (const MeasuredScenePlane& plane : block.planes) {
    planes.push_back(ToModelPlane(plane));
  }
  const auto lend_device = [&](const std::function<void(Device&)>& work) {
    work(device);
  };
  std::vector<LabelsInModel> labels;
  for (int sweep = 0; sweep < num_sweeps; ++sweep) {
    std::vector<LabelsInModel> next;
    for (size_t i = 0; i < views.size(); ++i) {
      std::vector<ModeledView> modeled;
      for (size_t j = 0; j < views.size(); ++j) {
        modeled.push_back(
            {views[j], &block.assignment[j], sweep > 0 ? &labels[j] : nullptr});
      }
      std::swap(modeled[0], modeled[i]);
      Image<PlaneCost> costs;
      next.push_back(
          LabelInModel(modeled, planes, {}, options, lend_device, &costs));
    }
    labels = std::move(next);
  }
  std::vector<const ViewLabels*> of_views;
  for (const LabelsInModel& of_view : labels) {
    of_views.push_back(&of_view.labels);
  }
  return FindScene(views, planes, of_views, device);
}

inline FoundScene FindSceneIn(const std::vector<ObservedView>& views,
                              const RefineOptions& options,
                              Device& device) {
  return FindSceneOfBlock(
      views, ModelBlock(views, options, device), options, device);
}

}  // namespace tsar
