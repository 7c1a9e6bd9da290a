// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/adjustment/adjust_planes.h"
#include "colmap_tsar/scene/discovery/plane_measurement.h"
#include "colmap_tsar/scene/find_scene.h"
#include "colmap_tsar/scene/scene_options.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <iterator>
#include <utility>
#include <vector>

namespace tsar {

// The planes of a scene that fits into one block of views, and what the first
// view shows of them, after this number of sweeps. Each view is a source of all
// others.
inline FoundScene FindSceneOfBlock(const std::vector<ObservedView>& views,
                                   const PlaneBlock& block,
                                   const RefineOptions& options,
                                   Device& device,
                                   int num_sweeps = 2) {
  SceneModel model;
  for (const MeasuredScenePlane& plane : block.planes) {
    model.planes.push_back(ToModelPlane(plane));
  }
  const std::vector<ModelPlane>& planes = model.planes;
  const double tolerance = MakeSceneOptions(options, views).discovery.tolerance;
  AdjustModel(
      [&](const std::vector<ModelPlane>& adjusted) {
        std::vector<PlaneMeasurement> measurements;
        for (size_t i = 0; i < views.size(); ++i) {
          std::ranges::copy(
              MeasureView(views[i], block.assignment[i], adjusted, tolerance),
              std::back_inserter(measurements));
        }
        return measurements;
      },
      std::vector<bool>(planes.size(), false),
      &model);
  const auto lend_device = [&](const std::function<void(Device&)>& work) {
    work(device);
  };
  std::vector<ViewLabels> labels;
  for (int sweep = 0; sweep < num_sweeps; ++sweep) {
    std::vector<ViewLabels> next;
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
  for (const ViewLabels& of_view : labels) {
    of_views.push_back(&of_view);
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
