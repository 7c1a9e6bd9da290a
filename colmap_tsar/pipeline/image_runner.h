// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/pipeline/image_pipeline.h"
#include "colmap_tsar/pipeline/refine_devices.h"
#include "colmap_tsar/pipeline/refine_image.h"
#include "colmap_tsar/pipeline/run_summary.h"
#include "colmap_tsar/pipeline/view_cache.h"
#include "colmap_tsar/workspace/workspace.h"

#include <cstddef>
#include <cstdint>
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
  ImageRunner(const Workspace& workspace,
              std::vector<bool> has_maps,
              const RefineOptions& options,
              std::vector<RefineWorker>& workers);

  // Reads a view while nobody renames its files.
  ViewCache::View Load(int image);

  size_t NumImages() const override { return workspace_.Problems().size(); }
  ImageReport Begin(size_t index) override;
  std::vector<int> Views(size_t index) const override;
  RefineResult Compute(size_t index,
                       size_t worker,
                       ViewCache::Lease* views,
                       ImageReport* report) override;
  void Write(size_t index, RefineResult result, ImageReport* report) override;

 private:
  RefineResult ComputeOnDevice(size_t index,
                               RefineWorker& worker,
                               ViewCache::Lease* views);
  void Keep(int image, const std::string& reason, ImageReport* report);
  const StereoProblem& Problem(size_t index) const {
    return workspace_.Problems()[index];
  }
  // The sources that have maps.
  std::vector<int> Sources(const StereoProblem& problem) const;
  bool HasMaps(int image) const;
  const std::string& Name(int image) const;

  const Workspace& workspace_;
  const std::vector<bool> has_maps_;
  const RefineOptions& options_;
  const std::string options_hash_;
  std::vector<RefineWorker>& workers_;
  // While one thread gives an image's maps their new names, another that reads
  // the originals of that image could take the refined ones for maps that
  // COLMAP wrote anew.
  std::vector<std::mutex> file_mutexes_;
};

}  // namespace tsar
