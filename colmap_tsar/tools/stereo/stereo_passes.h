// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/run/image_pipeline.h"
#include "colmap_tsar/run/refine_devices.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/stereo/stereo_image.h"
#include "colmap_tsar/tools/stereo/stereo_options.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace tsar {

// The files that one pass makes of one image.
struct StereoMapFiles {
  ContainedPath depth;
  ContainedPath normal;
  std::optional<ContainedPath> cost;  // Some passes have none.

  bool Exist() const;
};

// Writes each file atomically, the depth map last; creates the folders.
void WriteStereoMaps(const StereoMapFiles& files, const StereoMaps& maps);

// The passes over all images: the photometric one (index 0) and the geometric
// ones.
class StereoPasses {
 public:
  // workspace must outlive this object.
  StereoPasses(const Workspace& workspace, const StereoOptions& options);

  int NumPasses() const { return 1 + num_geometric_; }
  StereoMapFiles Files(int pass, int image) const;
  // Whether the image has all final maps of the run.
  bool IsDone(int image) const;
  // Removes the intermediate files after the last pass.
  void RemoveFilesBetween() const;

 private:
  const Workspace& workspace_;
  const int num_geometric_;
};

// One pass of tsar_stereo over images by their indices in Problems(). Those
// done before and those without sources are skipped.
class StereoTask : public ImageTasks<StereoMaps> {
 public:
  // All references must outlive this object.
  StereoTask(const Workspace& workspace,
             const StereoOptions& options,
             const StereoPasses& passes,
             int pass,
             std::vector<RefineWorker>& workers);

  // Loads the image and, after the first pass, its current maps. Maps of
  // unmatched images are older and ignored.
  std::shared_ptr<const ViewData> Load(int image) const override;

  ImageReport Begin(size_t index) override;
  std::vector<int> Views(size_t index) const override;
  StereoMaps Compute(size_t index,
                     size_t worker,
                     LoadedViews* views,
                     ImageReport* report) override;
  // An interruption loses no result: on a CPU an image takes minutes.
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
