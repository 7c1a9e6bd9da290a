// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/pipeline_outcome.h"
#include "colmap_tsar/run/view_cache.h"

#include <cstddef>
#include <string>
#include <vector>

namespace tsar {

// The work of one pass on each image of a run, as called by an ImagePipeline.
// Images have indices from 0 on. Calls for one image are sequential, those for
// different images come from several threads at once. Result: the data that
// Compute() passes to Write().
template <typename Result>
class ImageTasks {
 public:
  virtual ~ImageTasks() = default;

  // Does the work that needs no maps. The outcome is kNotDone where the image
  // is still to be computed.
  virtual ImageReport Begin(size_t index) = 0;
  // The views that Compute() needs.
  virtual std::vector<int> Views(size_t index) const = 0;
  // Work on the CPU that needs the views but no worker.
  virtual void Prepare(size_t /*index*/, const ViewCache::Lease& /*views*/) {}
  // Computes with one of the workers, each of which is used by one thread.
  // Releases views as early as possible.
  virtual Result Compute(size_t index,
                         size_t worker,
                         ViewCache::Lease* views,
                         ImageReport* report) = 0;
  // Whether images that a worker holds or has computed when the user asks to
  // stop are still written, since computing them took long.
  virtual bool WritesAfterStop() const { return false; }
  // Writes the result and sets the outcome.
  virtual void Write(size_t index, Result result, ImageReport* report) = 0;
};

}  // namespace tsar
