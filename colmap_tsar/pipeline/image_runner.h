// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/pipeline/refine_image.h"
#include "colmap_tsar/pipeline/run_summary.h"
#include "colmap_tsar/pipeline/view_cache.h"
#include "colmap_tsar/workspace/workspace.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace tsar {

// Keys the random numbers of an image by its name alone, so that they depend
// neither on the other images nor on their order: 32-bit FNV-1a.
uint32_t HashImageName(const std::string& name);

// Takes images of a workspace from file to file. Run() can be called from
// several threads at once, for different images and with different devices.
class ImageRunner {
 public:
  // All references must outlive this object. has_maps: see WorkspaceOverview.
  // should_stop is asked, from all threads, whether the user wants to end.
  ImageRunner(const Workspace& workspace,
              std::vector<bool> has_maps,
              const RefineOptions& options,
              size_t cache_num_bytes,
              const std::function<bool()>& should_stop);

  // Leaves the image refined, or kept with a record of the reason; or as it was
  // where it had been done before, the user asked to stop, or an Error is
  // thrown.
  ImageReport Run(const StereoProblem& problem, Device& device);

 private:
  ImageReport Keep(int image, ImageReport report, const std::string& reason);
  ImageReport Refine(const StereoProblem& problem,
                     ImageReport report,
                     Device& device);
  bool HasMaps(int image) const;
  const std::string& Name(int image) const;

  const Workspace& workspace_;
  const std::vector<bool> has_maps_;
  const RefineOptions& options_;
  const std::string options_hash_;
  const std::function<bool()>& should_stop_;
  // While one thread gives an image's maps their new names, another that reads
  // the originals of that image could take the refined ones for maps that
  // COLMAP wrote anew.
  std::vector<std::mutex> file_mutexes_;
  ViewCache cache_;
};

}  // namespace tsar
