// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/pipeline_outcome.h"
#include "colmap_tsar/run/view_cache.h"

#include <cstddef>
#include <string>
#include <vector>

namespace tsar {

// What a pass does with each image of a run, for an ImagePipeline to call.
// Images are numbered from 0 on. The calls for one image come one after the
// other, those for different images from several threads at once. Result: what
// computing hands over to writing.
template <typename Result>
class ImageTasks {
 public:
  virtual ~ImageTasks() = default;

  // Does what can be done without reading the image's maps. Where that is all,
  // the outcome tells what it was; otherwise it is kNotDone.
  virtual ImageReport Begin(size_t index) = 0;
  // The views that Compute() needs.
  virtual std::vector<int> Views(size_t index) const = 0;
  // Work on the CPU that needs the views and that the workers are to be spared.
  virtual void Prepare(size_t /*index*/, const ViewCache::Lease& /*views*/) {}
  // With one of the workers, each of which is used by one thread. Gives views
  // back as early as it can.
  virtual Result Compute(size_t index,
                         size_t worker,
                         ViewCache::Lease* views,
                         ImageReport* report) = 0;
  // Whether images that are with a worker or computed when the user asks to
  // stop are still written, since computing them took long.
  virtual bool WritesAfterStop() const { return false; }
  // Sets the outcome.
  virtual void Write(size_t index, Result result, ImageReport* report) = 0;
};

}  // namespace tsar
