// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/compose/refine_image.h"
#include "colmap_tsar/run/evidence_store.h"
#include "colmap_tsar/run/image_catalog.h"
#include "colmap_tsar/run/image_tasks.h"
#include "colmap_tsar/run/refine_devices.h"
#include "colmap_tsar/view/refine_observer.h"
#include "colmap_tsar/view/refine_options.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tsar {

// The inputs that the passes of tsar_refine share. All references must outlive
// the tasks.
struct RefineTaskInputs {
  ImageCatalog& images;
  const RefineOptions& options;
  std::vector<RefineWorker>& workers;
  // Receives the intermediate results of the stages; may be null.
  RefineObserver* observer = nullptr;
};

// A pass over the images of tsar_refine.
class RefineTask : public ImageTasks<RefineResult> {
 public:
  explicit RefineTask(const RefineTaskInputs& inputs)
      : images_(inputs.images),
        options_(inputs.options),
        workers_(inputs.workers),
        observer_(inputs.observer) {}

 protected:
  // RefineImage, or MeasureImage.
  using SingleViewStages =
      RefineResult (*)(const ViewData& reference,
                       std::vector<DeviceViewCache::View> sources,
                       uint32_t image_id,
                       const RefineOptions& options,
                       Device& device,
                       StageObserver* observer);

  // Runs the stages with the sources in the worker's memory.
  RefineResult RunSingleView(size_t index,
                             size_t worker,
                             ViewCache::Lease* views,
                             SingleViewStages stages);
  // Null without an observer.
  std::unique_ptr<StageObserver> ObserverOf(size_t index,
                                            const ViewData& view) const;
  // The error with the names of its image and device.
  Error WithPlace(const Error& error,
                  size_t index,
                  const std::string& device) const;

  ImageCatalog& images_;
  const RefineOptions& options_;
  std::vector<RefineWorker>& workers_;
  RefineObserver* const observer_;
};

// A pass that ends with the refined maps of each image. Images that cannot be
// refined keep theirs; those whose mask leaves no depth get empty ones.
class RefineMapsTask : public RefineTask {
 public:
  using RefineTask::RefineTask;

  ImageReport Begin(size_t index) override {
    return images_.BeginRefining(index);
  }
  RefineResult Compute(size_t index,
                       size_t worker,
                       ViewCache::Lease* views,
                       ImageReport* report) override;
  void Write(size_t index, RefineResult result, ImageReport* report) override;

 protected:
  // The result for an image that has depths.
  virtual RefineResult RefineMaps(size_t index,
                                  size_t worker,
                                  ViewCache::Lease* views) = 0;

 private:
  // Empty maps of the size of this map.
  RefinedMaps EmptyMaps(const Image<float>& depth) const;
};

// The first of two passes: writes the evidence of each image to the store.
// Unless everything is to be done anew, it leaves out images with current
// evidence, and images that nobody needs because they and all whose sources
// they are have been refined.
class ObserveTask : public RefineTask {
 public:
  // evidence must outlive this object. has_model: whether the planes of the
  // scene are known already, so that only images that are to be refined and
  // their sources have to be observed.
  ObserveTask(const RefineTaskInputs& inputs,
              EvidenceStore& evidence,
              bool has_model)
      : RefineTask(inputs), evidence_(evidence), has_model_(has_model) {}

  ImageReport Begin(size_t index) override;
  std::vector<int> Views(size_t index) const override {
    return images_.SourcesAndReference(index);
  }
  RefineResult Compute(size_t index,
                       size_t worker,
                       ViewCache::Lease* views,
                       ImageReport* report) override;
  void Write(size_t index, RefineResult result, ImageReport* report) override;

 private:
  EvidenceStore& evidence_;
  const bool has_model_;
};

// Refines each image by itself, in one pass, without planes of the scene.
class SingleViewTask : public RefineMapsTask {
 public:
  using RefineMapsTask::RefineMapsTask;

  ImageReport Begin(size_t index) override;
  std::vector<int> Views(size_t index) const override {
    return images_.SourcesAndReference(index);
  }

 protected:
  RefineResult RefineMaps(size_t index,
                          size_t worker,
                          ViewCache::Lease* views) override;
};

}  // namespace tsar
