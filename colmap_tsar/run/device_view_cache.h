// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/lru_map.h"
#include "colmap_tsar/view/view_data.h"

#include <cstddef>
#include <future>
#include <memory>
#include <mutex>

namespace tsar {

// The source views in the memory of one GPU, or of the CPU, shared by all
// devices that use this memory: an image is uploaded once for the many images
// it is a source of. Views in use stay; others are kept, the most recently used
// first, as far as max_num_bytes allows. Can be used from several threads;
// those that want the same view wait for one upload.
//
// A caller must have waited for its device (Device::Synchronize) before it
// releases a view: the memory is freed stream-ordered on the device that
// uploaded it, which knows nothing of the others' work. That device must
// outlive the cache and all views.
class DeviceViewCache {
 public:
  using View = std::shared_ptr<const UploadedView>;

  explicit DeviceViewCache(size_t max_num_bytes);

  // Returns the view of the image with index `image`, and uploads it from
  // `view` where it is not cached. The upload is complete. Throws what the
  // device throws to all waiting callers; the next call tries again.
  View Get(int image, const ViewData& view, Device& device);

  // The size of all cached views, in use or not.
  size_t NumBytes() const;

 private:
  struct Entry {
    View view;  // Null while it is being uploaded.
    std::shared_future<View> upload;
    size_t num_bytes = 0;
  };

  // With the mutex locked: drops views that nobody uses until num_bytes more
  // fit, or none is left to drop. Returns the last one dropped, if any, for the
  // next view to take its memory: where long-lived blocks come and go between
  // short-lived ones, they leave holes that nothing fits into.
  std::shared_ptr<UploadedView> MakeRoom(size_t num_bytes);
  void Remove(int image);

  const size_t max_num_bytes_;
  mutable std::mutex mutex_;
  LruMap<int, Entry> entries_;
  size_t num_bytes_ = 0;
};

}  // namespace tsar
