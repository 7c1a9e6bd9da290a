// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/image_scene.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/run/store/scene_model_file.h"
#include "colmap_tsar/view/stage_timer.h"

#include <utility>

namespace tsar {
namespace {

// The model's labels of the image. Throws kMismatch where none fit.
const ViewLabels& LabelsOf(const RefineRun& run,
                           const SceneModel& model,
                           int image,
                           const ViewEvidence& evidence) {
  const auto labels = model.views.find(image);
  if (labels == model.views.end() ||
      labels->second.planes.size() != evidence.weights.size()) {
    throw Error::File(ErrorCode::kMismatch,
                      GetSceneModelPath(run.workspace.Root()).string(),
                      "the planes of the scene were not found in this image as "
                      "it was observed",
                      "remove the file and run the same command again");
  }
  return labels->second;
}

}  // namespace

std::unique_ptr<ImageScene> FindImageScene(const RefineRun& run,
                                           const SceneModel& model,
                                           size_t index,
                                           Device& device) {
  const int reference = run.plan.Reference(index);
  auto scene = std::make_unique<ImageScene>();
  std::vector<const ViewLabels*> labels;
  const auto add = [&](int image, const ViewEvidence& evidence) {
    scene->views.push_back(MakeObservedView(
        evidence,
        run.workspace.Model().images[static_cast<size_t>(image)].camera));
    labels.push_back(&LabelsOf(run, model, image, evidence));
  };
  scene->own = run.evidence.ReadAll(reference);
  add(reference, scene->own);
  for (const int source : run.plan.Sources(index)) {
    if (source == reference) {
      continue;
    }
    if (EvidenceStore::Evidence evidence = run.evidence.Get(source)) {
      add(source, *evidence);
      scene->others.push_back(std::move(evidence));
    }
  }
  scene->found =
      FindScene(scene->views, model.planes, labels, run.refine_options, device);
  StageTimer timer(device, &scene->found.seconds);
  scene->found.cylinders = FindSeenCylinders(scene->views[0], model.cylinders);
  timer.Finish("columns and pipes");
  return scene;
}

}  // namespace tsar
