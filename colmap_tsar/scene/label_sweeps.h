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

// What the views of a scene are labelled with and by. All outlive the sweeps.
struct LabelSweepInputs {
  const std::vector<SceneView>& views;
  const SceneEvidence& evidence;
  // By view and superpixel, the plane of the model that it measured, or -1.
  const std::vector<std::vector<int>>& assignment;
  const std::vector<ModelPlane>& planes;
  const RefineOptions& options;
  const ModelResources& resources;
};

// Labels all views of a scene, several times. In the first sweep each view is
// labelled by itself; in the others it hears what its sources were labelled
// with in the one before.
class LabelSweeps {
 public:
  explicit LabelSweeps(const LabelSweepInputs& inputs);

  // One sweep. keeps_costs: for another one that follows. progress: of the
  // views. Once should_stop returned true, the labels are of no use.
  void Run(bool keeps_costs,
           Progress& progress,
           const std::function<bool()>& should_stop);

  // Those of the last sweep: by superpixel, the number of the plane or -1.
  const std::vector<int>& PlanesOf(size_t view) const {
    return labels_[view].labels.planes;
  }

  // Begins anew: the next sweep is a first one, and all respect the creases.
  // The planes that begin there are in the model.
  void Bound(std::vector<BoundingCrease> creases);

  // By view, those of the last sweep.
  std::vector<ViewLabels> TakeLabels();

 private:
  LabelsInModel LabelAndKeepCosts(size_t view, bool keeps_costs, Device& cpu);
  // cpu: for what is not for GPUs. costs: see LabelInModel.
  LabelsInModel Label(size_t view, Device& cpu, Image<PlaneCost>* costs);
  // Whether the costs may be kept.
  bool ReserveMemory(const Image<PlaneCost>& costs);

  const LabelSweepInputs inputs_;
  DevicePool gpus_;
  std::vector<BoundingCrease> creases_;
  // Of the last sweep; none before the first one.
  std::vector<LabelsInModel> labels_;
  // Neither planes nor evidence change between the sweeps, once creases are
  // known. Empty where there was no memory for the costs of a view, which are
  // computed again.
  std::vector<Image<PlaneCost>> costs_;
  std::atomic<int64_t> kept_bytes_ = 0;
};

}  // namespace tsar
