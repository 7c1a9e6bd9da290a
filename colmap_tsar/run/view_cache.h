// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/view/view_data.h"

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <unordered_map>
#include <vector>

namespace tsar {

// A cache of the most recently used views: each image of a workspace is needed
// once as the reference and many times as a source. A user reserves its views
// first, and waits until they fit into memory beside those that others have
// reserved; all views together, in use or not, never take more than
// max_num_bytes, or than one single reservation needs where that is more. Can
// be used from several threads.
class ViewCache {
 public:
  using View = std::shared_ptr<const ViewData>;
  using Loader = std::function<View(int image)>;

  // The right to use some views, until they are released or it is destroyed.
  class Lease {
   public:
    Lease() = default;
    Lease(Lease&& other) noexcept;
    Lease& operator=(Lease&& other) noexcept;
    ~Lease();

    // Returns when all views are loaded. Threads that want the same views share
    // the work; each loads those that no other thread is loading. Returns false
    // as soon as should_stop returns true. Throws what the loader throws.
    bool Load(const std::function<bool()>& should_stop);

    // Valid after Load(), as long as the view is reserved here.
    const ViewData& Get(int image) const;

    // Releases one view.
    void Release(int image);

   private:
    friend class ViewCache;
    Lease(ViewCache* cache, std::vector<int> images);

    ViewCache* cache_ = nullptr;
    std::vector<int> images_;
  };

  // num_view_bytes: the size of the largest view. The loader is called from the
  // calling threads, for different images at once.
  ViewCache(size_t max_num_bytes, size_t num_view_bytes, Loader loader);

  // An image may be named more than once. Waits for room; since a reservation
  // is made as a whole, those that are held never wait for each other. The
  // cache must outlive the lease.
  Lease Reserve(std::vector<int> images);

  // The size of all views, in use or not; views that are reserved, but not yet
  // loaded, count with the size of the largest.
  size_t NumBytes() const;

 private:
  // The position of an image in the order of use.
  struct Place {
    int image = 0;
    View dropped;  // Only where the image has left the cache.
  };
  struct Entry {
    View view;  // Null until it has been loaded.
    bool is_loading = false;
    int num_leases = 0;
    size_t num_bytes = 0;
    std::list<Place>::iterator position;
  };

  // These are called with the mutex locked.
  size_t NumBytesNotInUse(const std::vector<int>& images) const;
  // Changes nothing where it throws.
  void Claim(int image);
  // Unlocks the mutex while memory is freed. Allocates none itself, so that it
  // can be called when memory has run out.
  void FreeUnused(std::unique_lock<std::mutex>* lock) noexcept;

  bool LoadAll(const std::vector<int>& images,
               const std::function<bool()>& should_stop);
  void LoadOne(int image, std::unique_lock<std::mutex>* lock);
  const ViewData& Get(int image) const;
  void Release(std::span<const int> images) noexcept;

  const size_t max_num_bytes_;
  const size_t num_view_bytes_;
  const Loader loader_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::unordered_map<int, Entry> entries_;
  std::list<Place> places_;  // The most recently reserved first.
  size_t num_bytes_ = 0;
  size_t num_bytes_in_use_ = 0;
  size_t num_bytes_being_freed_ = 0;
};

}  // namespace tsar
