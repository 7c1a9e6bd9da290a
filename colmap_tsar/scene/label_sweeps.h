// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/creases/bounding_creases.h"
#include "colmap_tsar/scene/device_pool.h"
#include "colmap_tsar/scene/find_scene.h"
#include "colmap_tsar/scene/labeling/plane_costs.h"
#include "colmap_tsar/scene/model_scene.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tsar {

// Labels all views of a scene, several times (ModelSceneOptions::num_sweeps).
class LabelSweeps {
 public:
  // assignment: the measured plane of the model by view and superpixel, or -1.
  // All must outlive the sweeps.
  LabelSweeps(const ModelSceneInputs& inputs,
              const std::vector<std::vector<int>>& assignment,
              const std::vector<ModelPlane>& planes);

  // Labels a view in the sweep under way. keeps_costs: keep the costs for
  // another sweep. cpu: for steps that do not run on GPUs. May be called from
  // several threads.
  void LabelView(size_t view, bool keeps_costs, Device& cpu);

  // Ends the sweep, in which all views have been labeled.
  void EndSweep();

  // The planes of the last sweep: by superpixel, the index in the model or -1.
  const std::vector<int>& PlanesOf(size_t view) const {
    return labels_[view].labels.planes;
  }

  // The next sweep is a first one, and all respect the creases. The planes that
  // begin there must be in the model.
  void RestartWithin(std::vector<BoundingCrease> creases);

  // The labels of the last sweep, by view.
  std::vector<ViewLabels> TakeLabels();

 private:
  // costs: see LabelInModel.
  LabelsInModel Label(size_t view, Device& cpu, Image<PlaneCost>* costs);
  // Returns whether the costs may be kept.
  bool ReserveMemory(const Image<PlaneCost>& costs);

  const ModelSceneInputs& inputs_;
  const std::vector<std::vector<int>>& assignment_;
  const std::vector<ModelPlane>& planes_;
  DevicePool gpus_;
  std::vector<BoundingCrease> creases_;
  // Labels of the last sweep, empty before the first one, and of the one under
  // way.
  std::vector<LabelsInModel> labels_;
  std::vector<LabelsInModel> next_labels_;
  // Costs by view, constant between sweeps once creases are known; empty
  // without memory for them, in which case they are recomputed.
  std::vector<Image<PlaneCost>> costs_;
  std::atomic<int64_t> kept_bytes_ = 0;
};

}  // namespace tsar
