// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/view_cache.h"

#include <exception>
#include <utility>

namespace tsar {

ViewCache::ViewCache(size_t max_num_bytes, Loader loader)
    : max_num_bytes_(max_num_bytes), loader_(std::move(loader)) {}

ViewCache::View ViewCache::Get(int image) {
  std::promise<View> promise;
  {
    std::unique_lock<std::mutex> lock(mutex_);
    const auto found = entries_.find(image);
    if (found != entries_.end()) {
      images_.splice(images_.begin(), images_, found->second.position);
      const std::shared_future<View> view = found->second.view;
      lock.unlock();
      return view.get();
    }
    images_.push_front(image);
    entries_[image] = {promise.get_future().share(), 0, images_.begin()};
  }
  View view;
  try {
    view = std::make_shared<const ViewData>(loader_(image));
  } catch (...) {
    promise.set_exception(std::current_exception());
    Remove(image);
    throw;
  }
  promise.set_value(view);
  Book(image, view->NumBytes());
  return view;
}

size_t ViewCache::NumBytes() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return num_bytes_;
}

void ViewCache::Remove(int image) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = entries_.find(image);
  images_.erase(found->second.position);
  entries_.erase(found);
}

void ViewCache::Book(int image, size_t num_bytes) {
  const std::lock_guard<std::mutex> lock(mutex_);
  entries_.at(image).num_bytes = num_bytes;
  num_bytes_ += num_bytes;
  DropOldViews();
}

void ViewCache::DropOldViews() {
  for (auto it = images_.end(); it != images_.begin();) {
    if (num_bytes_ <= max_num_bytes_) {
      return;
    }
    --it;
    const auto entry = entries_.find(*it);
    if (entry->second.num_bytes == 0) {
      continue;
    }
    num_bytes_ -= entry->second.num_bytes;
    entries_.erase(entry);
    it = images_.erase(it);
  }
}

}  // namespace tsar
