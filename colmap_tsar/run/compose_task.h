// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/evidence_store.h"
#include "colmap_tsar/run/refine_task.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/scene/find_scene.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace tsar {

// The last pass: composes the maps of each image from its own evidence, that of
// its sources, which an ObserveTask wrote before, and the planes of the scene.
class ComposeTask : public RefineMapsTask {
 public:
  // workspace and evidence must outlive this object. map_sides: see
  // WorkspaceOverview. finds_scenes_ahead: whether threads that read also find
  // the curved surfaces of the scene, for workers that would otherwise wait for
  // the CPU meanwhile.
  ComposeTask(const RefineTaskInputs& inputs,
              const Workspace& workspace,
              EvidenceStore& evidence,
              SceneModel model,
              std::vector<int> map_sides,
              bool finds_scenes_ahead);

  std::vector<int> Views(size_t index) const override {
    std::vector<int> views = ComparedSources(index);
    views.push_back(images_.Reference(index));
    return views;
  }
  void Prepare(size_t index, const ViewCache::Lease& views) override;

 protected:
  RefineResult RefineMaps(size_t index,
                          size_t worker,
                          ViewCache::Lease* views) override;

 private:
  // The evidence of an image and its neighbors, and the scene found in it.
  struct Scene {
    ViewEvidence own;
    std::vector<EvidenceStore::Evidence> others;
    std::vector<ObservedView> views;
    FoundScene found;
  };

  // The sources that the composed map is compared with: those whose maps are
  // judged at full size; none where the reference's is not.
  std::vector<int> ComparedSources(size_t index) const;
  bool IsJudgedAsItIs(int image) const;
  // Whether the image was observed, that is, has depths at the size at which it
  // is judged.
  static bool WasObserved(const ViewData& view);
  std::unique_ptr<Scene> FindSceneOf(size_t index, Device& device);
  // The model's labels of the image. Throws kMismatch where none fit.
  const ViewLabels& LabelsOf(int image, const ViewEvidence& evidence) const;
  ObservedView Observed(int image, const ViewEvidence& evidence) const;

  const Workspace& workspace_;
  EvidenceStore& evidence_;
  const SceneModel model_;
  const std::vector<int> map_sides_;
  const bool finds_scenes_ahead_;
  // The scenes that Prepare() found for RefineMaps(), by image of the run.
  std::vector<std::unique_ptr<Scene>> scenes_;
};

}  // namespace tsar
