// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/device_view_cache.h"

#include <cstdint>
#include <exception>
#include <optional>
#include <utility>

namespace tsar {

DeviceViewCache::DeviceViewCache(size_t max_num_bytes)
    : max_num_bytes_(max_num_bytes) {}

DeviceViewCache::View DeviceViewCache::Get(int image,
                                           const ViewData& view,
                                           Device& device) {
  std::promise<View> promise;
  std::shared_ptr<UploadedView> spare;
  {
    std::unique_lock<std::mutex> lock(mutex_);
    if (const Entry* found = entries_.Use(image)) {
      if (found->view != nullptr) {
        return found->view;
      }
      const std::shared_future<View> upload = found->upload;
      lock.unlock();
      return upload.get();
    }
    const auto num_bytes = static_cast<size_t>(
        UploadedViewBytes(static_cast<int64_t>(view.depth.NumPixels())));
    spare = MakeRoom(num_bytes);
    entries_.Add(image, {nullptr, promise.get_future().share(), num_bytes});
    num_bytes_ += num_bytes;
  }
  View uploaded;
  try {
    uploaded = UploadView(view, device, std::move(spare));
    device.Synchronize();
  } catch (...) {
    Remove(image);
    promise.set_exception(std::current_exception());
    throw;
  }
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    Entry& entry = *entries_.Find(image);
    entry.view = uploaded;
    entry.upload = {};
  }
  promise.set_value(uploaded);
  return uploaded;
}

size_t DeviceViewCache::NumBytes() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return num_bytes_;
}

std::shared_ptr<UploadedView> DeviceViewCache::MakeRoom(size_t num_bytes) {
  std::shared_ptr<UploadedView> dropped;
  while (num_bytes_ + num_bytes > max_num_bytes_) {
    // Only this cache hands views out, so a view that it alone holds can get no
    // other user now.
    const std::optional<Entry> entry = entries_.TakeOldest(
        [](const Entry& held) { return held.view.use_count() == 1; });
    if (!entry) {
      break;
    }
    num_bytes_ -= entry->num_bytes;
    dropped = std::const_pointer_cast<UploadedView>(entry->view);
  }
  return dropped;
}

void DeviceViewCache::Remove(int image) {
  const std::lock_guard<std::mutex> lock(mutex_);
  num_bytes_ -= entries_.Find(image)->num_bytes;
  entries_.Erase(image);
}

}  // namespace tsar
