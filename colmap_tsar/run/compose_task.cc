// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/compose_task.h"

#include "colmap_tsar/compose/compose_image.h"
#include "colmap_tsar/compose/photometric_detail.h"
#include "colmap_tsar/device/scoped_synchronization.h"
#include "colmap_tsar/run/store/scene_model_file.h"
#include "colmap_tsar/view/reduce_view.h"
#include "colmap_tsar/view/stage_timer.h"

#include <algorithm>
#include <utility>

namespace tsar {

ComposeTask::ComposeTask(const RefineTaskInputs& inputs,
                         const Workspace& workspace,
                         EvidenceStore& evidence,
                         SceneModel model,
                         std::vector<int> map_sides,
                         bool finds_scenes_ahead)
    : RefineMapsTask(inputs),
      workspace_(workspace),
      evidence_(evidence),
      model_(std::move(model)),
      map_sides_(std::move(map_sides)),
      finds_scenes_ahead_(finds_scenes_ahead),
      scenes_(inputs.images.NumImages()) {}

void ComposeTask::Prepare(size_t index, const ViewCache::Lease& views) {
  if (!finds_scenes_ahead_ ||
      !WasObserved(views.Get(images_.Reference(index)))) {
    return;
  }
  try {
    scenes_[index] = FindSceneOf(index, *Device::CreateCpu(1));
  } catch (const Error& error) {
    throw WithPlace(error, index, "the CPU");
  }
}

RefineResult ComposeTask::RefineMaps(size_t index,
                                     size_t worker_index,
                                     ViewCache::Lease* views) {
  const int image = images_.Reference(index);
  const ViewData& reference = views->Get(image);
  if (!WasObserved(reference)) {
    RefineResult result;
    result.reason_to_keep = kNothingReliable;
    return result;
  }
  RefineWorker& worker = workers_[worker_index];
  const std::unique_ptr<StageObserver> observer = ObserverOf(index, reference);
  try {
    std::unique_ptr<Scene> scene = std::move(scenes_[index]);
    if (!scene) {
      scene = FindSceneOf(index, *worker.device);
    }
    std::vector<DeviceViewCache::View> sources;
    for (const int source : ComparedSources(index)) {
      sources.push_back(
          worker.views->Get(source, views->Get(source), *worker.device));
      views->Release(source);
    }
    // The views belong to other devices, too, which may free them.
    const ScopedSynchronization synchronization(*worker.device);
    return ComposeImage(reference,
                        sources,
                        scene->views,
                        scene->found,
                        options_,
                        *worker.device,
                        observer.get());
  } catch (const Error& error) {
    throw WithPlace(error, index, worker.name);
  }
}

std::vector<int> ComposeTask::ComparedSources(size_t index) const {
  std::vector<int> sources;
  const int reference = images_.Reference(index);
  if (!options_.photometric || !IsJudgedAsItIs(reference)) {
    return sources;
  }
  for (const int source : images_.Sources(index)) {
    if (source != reference && IsJudgedAsItIs(source) &&
        sources.size() < kMaxPhotometricSources) {
      sources.push_back(source);
    }
  }
  // A fixed order gives the same result for the same sources in any ranking.
  std::sort(sources.begin(), sources.end());
  return sources;
}

bool ComposeTask::IsJudgedAsItIs(int image) const {
  const int side = map_sides_[static_cast<size_t>(image)];
  return ReductionFactor(side, side) == 1;
}

bool ComposeTask::WasObserved(const ViewData& view) {
  return HasReducedDepth(
      view, ReductionFactor(view.depth.Width(), view.depth.Height()));
}

std::unique_ptr<ComposeTask::Scene> ComposeTask::FindSceneOf(size_t index,
                                                             Device& device) {
  const int reference = images_.Reference(index);
  auto scene = std::make_unique<Scene>();
  scene->own = evidence_.ReadAll(reference);
  scene->views = {Observed(reference, scene->own)};
  std::vector<const ViewLabels*> labels = {&LabelsOf(reference, scene->own)};
  for (const int source : images_.Sources(index)) {
    if (source == reference) {
      continue;
    }
    if (EvidenceStore::Evidence evidence = evidence_.Get(source)) {
      scene->views.push_back(Observed(source, *evidence));
      labels.push_back(&LabelsOf(source, *evidence));
      scene->others.push_back(std::move(evidence));
    }
  }
  scene->found =
      FindScene(scene->views, model_.planes, labels, options_, device);
  StageTimer timer(device, &scene->found.seconds);
  scene->found.cylinders = FindSeenCylinders(scene->views[0], model_.cylinders);
  timer.Finish("columns and pipes");
  return scene;
}

const ViewLabels& ComposeTask::LabelsOf(int image,
                                        const ViewEvidence& evidence) const {
  const auto labels = model_.views.find(image);
  if (labels == model_.views.end() ||
      labels->second.planes.size() != evidence.weights.size()) {
    throw Error::File(ErrorCode::kMismatch,
                      GetSceneModelPath(workspace_.Root()).string(),
                      "the planes of the scene were not found in this image as "
                      "it was observed",
                      "remove the file and run the same command again");
  }
  return labels->second;
}

ObservedView ComposeTask::Observed(int image,
                                   const ViewEvidence& evidence) const {
  return MakeObservedView(
      evidence, workspace_.Model().images[static_cast<size_t>(image)].camera);
}

}  // namespace tsar
