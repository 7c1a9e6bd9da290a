// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/controllers/evidence_store.h"
#include "colmap_tsar/controllers/image_pipeline.h"
#include "colmap_tsar/controllers/input_fingerprints.h"
#include "colmap_tsar/controllers/refine_devices.h"
#include "colmap_tsar/controllers/run_summary.h"
#include "colmap_tsar/controllers/view_cache.h"
#include "colmap_tsar/pipeline/refine_image.h"
#include "colmap_tsar/pipeline/refine_scene.h"
#include "colmap_tsar/scene_planes/discover_planes.h"
#include "colmap_tsar/store/workspace.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace tsar {

// Keys the random numbers of an image by its name alone, so that they depend
// neither on the other images nor on their order: 32-bit FNV-1a.
uint32_t HashImageName(const std::string& name);

// The work on the images of a workspace, in the order of its problems. An image
// is left refined, or kept with a record of the reason; or as it was where it
// had been done before or an Error is thrown.
class ImageRunner : public ImageTasks {
 public:
  // All references must outlive this object. has_maps: see WorkspaceOverview.
  // inputs: made for evidence where there is any. evidence: that of all images,
  // made by an ObserveRunner before this runs; null where each image is refined
  // by itself. finds_scenes_ahead: whether
  // threads that read also find the planes of the scene, for workers that would
  // otherwise wait for the CPU meanwhile. observer: may be null; where it is
  // not, all images are refined, also those that were before, since it is to
  // see them.
  ImageRunner(const Workspace& workspace,
              std::vector<bool> has_maps,
              const RefineOptions& options,
              std::vector<RefineWorker>& workers,
              InputFingerprints& inputs,
              EvidenceStore* evidence = nullptr,
              bool finds_scenes_ahead = false,
              RefineObserver* observer = nullptr);

  // Reads a view while nobody renames its files.
  ViewCache::View Load(int image);

  size_t NumImages() const override { return workspace_.Problems().size(); }
  std::string PassName() const override {
    return evidence_ ? "Pass 2 of 2:" : "";
  }
  ImageReport Begin(size_t index) override;
  std::vector<int> Views(size_t index) const override;
  void Prepare(size_t index, const ViewCache::Lease& views) override;
  RefineResult Compute(size_t index,
                       size_t worker,
                       ViewCache::Lease* views,
                       ImageReport* report) override;
  void Write(size_t index, RefineResult result, ImageReport* report) override;

  // Whether what was done before the run counts.
  bool ReusesResults() const { return observer_ == nullptr; }
  // Whether the image had been refined before the run and is not to be refined
  // again; looks at its maps and inputs in the first call.
  bool HasBeenRefined(size_t index);
  // Warns where it is to be refined again because of what it depends on.
  void WarnOfChanges(size_t index);

  // Whether the image, of the workspace, has maps.
  bool HasMaps(int image) const;

  // For the pass that observes.
  int Reference(size_t index) const { return Problem(index).reference; }
  // The views that single-view stages need.
  std::vector<int> SourcesAndReference(size_t index) const;
  // Whether the image and one of its sources have maps.
  bool CanCompute(size_t index) const;
  // Whether the image, or one whose source it is, has yet to be refined and can
  // be.
  bool IsNeeded(size_t index);
  // What MeasureImage() returns; without anything measured where the image has
  // no depth at all.
  RefineResult Observe(size_t index, size_t worker, ViewCache::Lease* views);
  // Of what was measured. Needs no worker.
  void MakeEvidenceOf(size_t index, RefineResult* result) const;
  // Books the time that observing took.
  void AddSeconds(size_t index, const std::map<std::string, double>& seconds);

 private:
  // An image and its neighbours, and what was found in their evidence.
  struct Scene {
    ViewEvidence own;
    std::vector<EvidenceStore::Evidence> others;
    std::vector<ObservedView> views;
    FoundScene found;
  };

  // Calls function(sources) with the sources in the worker's memory.
  template <typename Function>
  RefineResult WithSources(size_t index,
                           RefineWorker& worker,
                           ViewCache::Lease* views,
                           const Function& function);
  std::unique_ptr<Scene> FindSceneOf(size_t index, Device& device);
  // Its camera for the raster of its evidence.
  ObservedView Observed(int image, const ViewEvidence& evidence) const;
  void Keep(int image, const std::string& reason, ImageReport* report);
  const StereoProblem& Problem(size_t index) const {
    return workspace_.Problems()[index];
  }
  // The sources that have maps.
  std::vector<int> Sources(const StereoProblem& problem) const;
  const std::string& Name(int image) const;
  // Null where nobody observes.
  std::unique_ptr<StageObserver> ObserverOf(int image,
                                            const ViewData& view) const;

  const Workspace& workspace_;
  const std::vector<bool> has_maps_;
  const RefineOptions& options_;
  const std::string options_hash_;
  std::vector<RefineWorker>& workers_;
  InputFingerprints& inputs_;
  EvidenceStore* const evidence_;
  const bool finds_scenes_ahead_;
  RefineObserver* const observer_;
  // By image of the run: whether it had been refined before the run, once the
  // flag is set.
  std::vector<std::once_flag> is_done_flags_;
  std::vector<uint8_t> is_done_;
  // By image of the workspace, the images of the run that it serves, as their
  // reference or as a source.
  std::vector<std::vector<size_t>> served_;
  // By image of the run, what Prepare() found for Compute().
  std::vector<std::unique_ptr<Scene>> scenes_;
  // By image of the run, what was booked by AddSeconds.
  std::vector<std::map<std::string, double>> seconds_;
  // While one thread gives an image's maps their new names, another that reads
  // the originals of that image could take the refined ones for maps that
  // COLMAP wrote anew.
  std::vector<std::mutex> file_mutexes_;
};

}  // namespace tsar
