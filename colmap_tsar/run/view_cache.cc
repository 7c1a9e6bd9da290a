// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/view_cache.h"

#include <algorithm>
#include <utility>

namespace tsar {

ViewCache::Lease::Lease(ViewCache* cache, std::vector<int> images)
    : cache_(cache), images_(std::move(images)) {}

ViewCache::Lease::Lease(Lease&& other) noexcept
    : cache_(other.cache_), images_(std::exchange(other.images_, {})) {}

ViewCache::Lease& ViewCache::Lease::operator=(Lease&& other) noexcept {
  std::swap(cache_, other.cache_);
  std::swap(images_, other.images_);
  return *this;
}

ViewCache::Lease::~Lease() {
  if (!images_.empty()) {
    cache_->Release(images_);
  }
}

bool ViewCache::Lease::Load(const std::function<bool()>& should_stop) {
  return images_.empty() || cache_->LoadAll(images_, should_stop);
}

const ViewData& ViewCache::Lease::Get(int image) const {
  return cache_->Get(image);
}

void ViewCache::Lease::Release(int image) {
  if (std::erase(images_, image) > 0) {
    cache_->Release({&image, 1});
  }
}

ViewCache::ViewCache(size_t max_num_bytes, size_t num_view_bytes, Loader loader)
    : max_num_bytes_(max_num_bytes),
      num_view_bytes_(num_view_bytes),
      loader_(std::move(loader)) {}

ViewCache::Lease ViewCache::Reserve(std::vector<int> images) {
  std::ranges::sort(images);
  images.erase(std::unique(images.begin(), images.end()), images.end());
  // The lease releases its views where claiming the rest fails.
  Lease lease(this, {});
  lease.images_.reserve(images.size());
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [&] {
    return num_bytes_in_use_ == 0 ||
           num_bytes_in_use_ + NumBytesNotInUse(images) <= max_num_bytes_;
  });
  for (const int image : images) {
    Claim(image);
    lease.images_.push_back(image);
  }
  FreeUnused(&lock);
  changed_.wait(lock, [&] {
    return num_bytes_ <= max_num_bytes_ || num_bytes_being_freed_ == 0;
  });
  lock.unlock();
  return lease;
}

size_t ViewCache::NumBytes() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return num_bytes_;
}

size_t ViewCache::NumBytesNotInUse(const std::vector<int>& images) const {
  size_t num_bytes = 0;
  for (const int image : images) {
    const auto found = entries_.find(image);
    if (found == entries_.end()) {
      num_bytes += num_view_bytes_;
    } else if (found->second.num_leases == 0) {
      num_bytes += found->second.num_bytes;
    }
  }
  return num_bytes;
}

void ViewCache::Claim(int image) {
  const auto found = entries_.find(image);
  if (found == entries_.end()) {
    std::list<Place> place = {{image, nullptr}};
    entries_.emplace(image,
                     Entry{nullptr, false, 0, num_view_bytes_, place.begin()});
    places_.splice(places_.begin(), place);
    num_bytes_ += num_view_bytes_;
  } else {
    places_.splice(places_.begin(), places_, found->second.position);
  }
  Entry& entry = entries_.at(image);
  if (entry.num_leases++ == 0) {
    num_bytes_in_use_ += entry.num_bytes;
  }
}

void ViewCache::FreeUnused(std::unique_lock<std::mutex>* lock) noexcept {
  std::list<Place> dropped;
  size_t num_bytes = 0;
  for (auto it = places_.end(); it != places_.begin();) {
    --it;
    const auto entry = entries_.find(it->image);
    // A view that was reserved but never loaded is worth nothing.
    const bool is_needed =
        entry->second.num_leases > 0 ||
        (entry->second.view != nullptr &&
         num_bytes_ - num_bytes_being_freed_ <= max_num_bytes_);
    if (is_needed) {
      continue;
    }
    num_bytes += entry->second.num_bytes;
    num_bytes_being_freed_ += entry->second.num_bytes;
    it->dropped = std::move(entry->second.view);
    entries_.erase(entry);
    const auto place = it++;
    dropped.splice(dropped.end(), places_, place);
  }
  // The system takes time to free memory, which counts until then.
  lock->unlock();
  dropped.clear();
  lock->lock();
  num_bytes_ -= num_bytes;
  num_bytes_being_freed_ -= num_bytes;
  changed_.notify_all();
}

bool ViewCache::LoadAll(const std::vector<int>& images,
                        const std::function<bool()>& should_stop) {
  while (!should_stop()) {
    std::unique_lock<std::mutex> lock(mutex_);
    const auto is_missing = [&](int image) {
      return entries_.at(image).view == nullptr;
    };
    const auto is_free = [&](int image) {
      return is_missing(image) && !entries_.at(image).is_loading;
    };
    const auto next = std::ranges::find_if(images, is_free);
    if (next != images.end()) {
      LoadOne(*next, &lock);
    } else if (std::ranges::any_of(images, is_missing)) {
      changed_.wait(lock);
    } else {
      return true;
    }
  }
  return false;
}

void ViewCache::LoadOne(int image, std::unique_lock<std::mutex>* lock) {
  entries_.at(image).is_loading = true;
  lock->unlock();
  View view;
  try {
    view = loader_(image);
  } catch (...) {
    lock->lock();
    entries_.at(image).is_loading = false;
    changed_.notify_all();
    throw;
  }
  const size_t num_bytes = view->NumBytes();
  lock->lock();
  Entry& entry = entries_.at(image);
  entry.is_loading = false;
  entry.view = std::move(view);
  num_bytes_ += num_bytes - entry.num_bytes;
  num_bytes_in_use_ += num_bytes - entry.num_bytes;
  entry.num_bytes = num_bytes;
  changed_.notify_all();
}

const ViewData& ViewCache::Get(int image) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return *entries_.at(image).view;
}

void ViewCache::Release(std::span<const int> images) noexcept {
  std::unique_lock<std::mutex> lock(mutex_);
  for (const int image : images) {
    Entry& entry = entries_.at(image);
    if (--entry.num_leases == 0) {
      num_bytes_in_use_ -= entry.num_bytes;
    }
  }
  FreeUnused(&lock);
}

}  // namespace tsar
