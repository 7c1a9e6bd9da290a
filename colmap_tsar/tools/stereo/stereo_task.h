// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/image_pipeline.h"
#include "colmap_tsar/run/refine_devices.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/stereo/stereo_image.h"
#include "colmap_tsar/tools/stereo/stereo_options.h"
#include "colmap_tsar/tools/stereo/stereo_passes.h"

#include <cstddef>
#include <vector>

namespace tsar {

// One pass of tsar_stereo over the images of a workspace, by their indices in
// Workspace::Problems(). Images done before and those without sources are
// skipped.
class StereoTask : public ImageTasks<StereoMaps> {
 public:
  // All references must outlive this object.
  StereoTask(const Workspace& workspace,
             const StereoOptions& options,
             const StereoPasses& passes,
             int pass,
             std::vector<RefineWorker>& workers);

  // Loads the image, after the first pass its current maps, and for the pass
  // that fills its depth prior. Maps of images that are not to be matched are
  // of earlier runs and ignored.
  ViewCache::View Load(int image) const;

  ImageReport Begin(size_t index) override;
  std::vector<int> Views(size_t index) const override;
  StereoMaps Compute(size_t index,
                     size_t worker,
                     ViewCache::Lease* views,
                     ImageReport* report) override;
  // Results are still written after an interruption: on a CPU an image takes
  // minutes.
  bool WritesAfterStop() const override { return true; }
  // Clears the maps where the image is masked and writes them.
  void Write(size_t index, StereoMaps maps, ImageReport* report) override;

 private:
  const StereoProblem& Problem(size_t index) const {
    return workspace_.Problems()[index];
  }

  const Workspace& workspace_;
  const StereoOptions& options_;
  const StereoPasses& passes_;
  const int pass_;
  std::vector<RefineWorker>& workers_;
  std::vector<bool> is_matched_;  // By image of the sparse model.
};

}  // namespace tsar
