// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/lru_map.h"
#include "colmap_tsar/view/uploaded_view.h"

#include <cstddef>
#include <future>
#include <memory>
#include <mutex>

namespace tsar {

// The source views in one GPU's memory, or in that of the CPU, for all devices
// that share it: an image is uploaded once for the many images it is a source
// of. Views in use stay; beside them, as many of those used last as the number
// of bytes allows. Can be used from several threads; those that want the same
// view wait for one upload.
//
// Whoever gets a view must have waited for his device (Device::Synchronize)
// before he lets go of it: its memory is freed stream-ordered on the device
// that uploaded it, which knows nothing of the others' work. That device must
// outlive the cache and all views.
class DeviceViewCache {
 public:
  using View = std::shared_ptr<const UploadedView>;

  explicit DeviceViewCache(size_t max_num_bytes);

  // The view of image number `image`, from `view` where it is not there yet.
  // Its upload is complete. Throws what the device throws, to all who waited;
  // the next call tries again.
  View Get(int image, const ViewData& view, Device& device);

  // The views that are held here, in use or not.
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
