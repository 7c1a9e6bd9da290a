// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/pipeline/view_data.h"

#include <cstddef>
#include <functional>
#include <future>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>

namespace tsar {

// Keeps the views that were used last, up to a number of bytes: each image of a
// workspace is needed once as the reference and many times as a source. Can be
// used from several threads; those that want the same view wait for one load.
class ViewCache {
 public:
  using View = std::shared_ptr<const ViewData>;
  using Loader = std::function<ViewData(int image)>;

  // The loader is called from the threads that ask, for different images at
  // once.
  ViewCache(size_t max_num_bytes, Loader loader);

  // Rethrows what the loader throws, to all who waited for it; the next call
  // tries again.
  View Get(int image);

  // The views that are held, without those that are used but dropped here.
  size_t NumBytes() const;

 private:
  struct Entry {
    std::shared_future<View> view;
    size_t num_bytes = 0;  // 0 while it is being loaded.
    std::list<int>::iterator position;
  };

  void Remove(int image);
  // Counts a view that has been loaded, and makes room for it.
  void Book(int image, size_t num_bytes);
  void DropOldViews();

  const size_t max_num_bytes_;
  const Loader loader_;
  mutable std::mutex mutex_;
  std::unordered_map<int, Entry> entries_;
  std::list<int> images_;  // The latest used first.
  size_t num_bytes_ = 0;
};

}  // namespace tsar
