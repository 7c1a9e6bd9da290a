// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/controllers/refine_task.h"

#include <cstddef>
#include <vector>

namespace tsar {

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
