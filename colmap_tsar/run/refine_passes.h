// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/compose/refine_image.h"
#include "colmap_tsar/run/evidence_store.h"
#include "colmap_tsar/run/image_pipeline.h"
#include "colmap_tsar/run/refine_run.h"
#include "colmap_tsar/run/store/record.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/scene/find_scene.h"

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace tsar {

// The evidence of an image and its neighbors, and the scene found in it.
struct ImageScene {
  ViewEvidence own;
  std::vector<EvidenceStore::Evidence> others;
  std::vector<ObservedView> views;  // Of the above, the image's own first.
  FoundScene found;
};

using StageSeconds = std::map<std::string, double>;

// Pass 1 of 3: writes the evidence of each image to the store. Unless
// everything is recomputed, it skips images with current evidence and those
// that are not needed: if the planes of the scene are known, only images to be
// refined and their sources are needed.
class ObservePass : public ImagePass<RefineResult> {
 public:
  // Both must outlive this object. seconds: by image of the run, receives the
  // times.
  ObservePass(const RefineRun& run, std::vector<StageSeconds>& seconds);

  ImageReport Begin(size_t index) override;
  std::vector<int> Views(size_t index) const override {
    return run_.selection.SourcesAndReference(index);
  }
  // The view reduced to the size at which depths are judged.
  std::shared_ptr<const ViewData> Load(int image) const override;
  RefineResult Compute(size_t index,
                       size_t worker,
                       LoadedViews* views,
                       ImageReport* report) override;
  void Write(size_t index, RefineResult result, ImageReport* report) override;

 private:
  const RefineRun& run_;
  std::vector<StageSeconds>& seconds_;
  const bool has_model_;
};

// Pass 3 of 3: composes the maps of each image from its own evidence, that of
// its sources, and the planes of the scene. Without these, it is the only pass
// and refines each image by itself. Images that cannot be refined keep their
// maps; those whose mask leaves no depth get empty ones.
class ComposePass : public ImagePass<RefineResult> {
 public:
  // run must outlive this object. seconds: by image of the run, the times of
  // observing.
  ComposePass(const RefineRun& run, std::vector<StageSeconds> seconds);

  ImageReport Begin(size_t index) override;
  std::vector<int> Views(size_t index) const override;
  std::shared_ptr<const ViewData> Load(int image) const override;
  // Finds the scene of the image where the workers are GPUs, which would
  // otherwise wait for the CPU meanwhile.
  void Prepare(size_t index) override;
  RefineResult Compute(size_t index,
                       size_t worker,
                       LoadedViews* views,
                       ImageReport* report) override;
  void Write(size_t index, RefineResult result, ImageReport* report) override;

 private:
  RefineResult Compose(size_t index,
                       const PipelineWorker& worker,
                       const ViewData& reference);
  // Keeps the original maps, and records the reason in the report.
  void Keep(size_t index, ImageReport* report) const;

  const RefineRun& run_;
  const std::vector<StageSeconds> seconds_;
  const ImageRecord record_;  // See CurrentRecord.
  const SceneModel model_;
  // The scenes that Prepare() found for Compute(), by image of the run.
  std::vector<std::unique_ptr<ImageScene>> scenes_;
};

}  // namespace tsar
