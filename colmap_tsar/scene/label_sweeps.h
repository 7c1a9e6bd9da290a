// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/creases/bounding_creases.h"
#include "colmap_tsar/scene/device_pool.h"
#include "colmap_tsar/scene/find_scene.h"
#include "colmap_tsar/scene/labeling/plane_costs.h"
#include "colmap_tsar/scene/model_scene.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace tsar {

// The inputs for labeling the views of a scene. All must outlive the sweeps.
struct LabelSweepInputs {
  const std::vector<SceneView>& views;
  const SceneEvidence& evidence;
  // The measured plane of the model by view and superpixel, or -1.
  const std::vector<std::vector<int>>& assignment;
  const std::vector<ModelPlane>& planes;
  const RefineOptions& options;
  const ModelResources& resources;
};

// Labels all views of a scene, several times. In the first sweep each view is
// labeled on its own; in later sweeps the labels of its sources from the sweep
// before vote.
class LabelSweeps {
 public:
  explicit LabelSweeps(const LabelSweepInputs& inputs);

  // Runs one sweep. keeps_costs: keep the costs for another sweep. progress:
  // over the views. Once should_stop returned true, the labels are invalid.
  void Run(bool keeps_costs,
           Progress& progress,
           const std::function<bool()>& should_stop);

  // The planes of the last sweep: by superpixel, the index in the model or -1.
  const std::vector<int>& PlanesOf(size_t view) const {
    return labels_[view].labels.planes;
  }

  // Restarts: the next sweep is a first one, and all respect the creases. The
  // planes that begin there must be in the model.
  void Bound(std::vector<BoundingCrease> creases);

  // The labels of the last sweep, by view.
  std::vector<ViewLabels> TakeLabels();

 private:
  LabelsInModel LabelAndKeepCosts(size_t view, bool keeps_costs, Device& cpu);
  // cpu: for steps that do not run on GPUs. costs: see LabelInModel.
  LabelsInModel Label(size_t view, Device& cpu, Image<PlaneCost>* costs);
  // Returns whether the costs may be kept.
  bool ReserveMemory(const Image<PlaneCost>& costs);

  const LabelSweepInputs inputs_;
  DevicePool gpus_;
  std::vector<BoundingCrease> creases_;
  // Labels of the last sweep; empty before the first one.
  std::vector<LabelsInModel> labels_;
  // Costs by view, constant between sweeps once creases are known; empty
  // without memory for them, in which case they are recomputed.
  std::vector<Image<PlaneCost>> costs_;
  std::atomic<int64_t> kept_bytes_ = 0;
};

}  // namespace tsar
