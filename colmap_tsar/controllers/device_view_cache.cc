// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/device_view_cache.h"

#include <exception>
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
    const auto found = entries_.find(image);
    if (found != entries_.end()) {
      images_.splice(images_.begin(), images_, found->second.position);
      if (found->second.view != nullptr) {
        return found->second.view;
      }
      const std::shared_future<View> upload = found->second.upload;
      lock.unlock();
      return upload.get();
    }
    const size_t num_bytes = 2 * sizeof(float) * view.depth.NumPixels();
    spare = MakeRoom(num_bytes);
    // All that may fail comes first.
    std::list<int> position = {image};
    entries_.emplace(image,
                     Entry{nullptr,
                           promise.get_future().share(),
                           num_bytes,
                           position.begin()});
    images_.splice(images_.begin(), position);
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
    Entry& entry = entries_.at(image);
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
  for (auto it = images_.end(); it != images_.begin();) {
    if (num_bytes_ + num_bytes <= max_num_bytes_) {
      break;
    }
    --it;
    const auto entry = entries_.find(*it);
    // Only this cache hands views out, so none that it alone holds can get
    // another user now.
    if (entry->second.view.use_count() != 1) {
      continue;
    }
    dropped = std::const_pointer_cast<UploadedView>(entry->second.view);
    num_bytes_ -= entry->second.num_bytes;
    entries_.erase(entry);
    it = images_.erase(it);
  }
  return dropped;
}

void DeviceViewCache::Remove(int image) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = entries_.find(image);
  num_bytes_ -= found->second.num_bytes;
  images_.erase(found->second.position);
  entries_.erase(found);
}

}  // namespace tsar
