// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <chrono>
#include <cstddef>
#include <exception>
#include <functional>
#include <future>
#include <iterator>
#include <list>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace tsar {

// Values of images, such as their views in the memory of the host or of a GPU,
// which are made once for the many threads that use them. Values in use stay;
// others are kept, the most recently used first, as long as there are at most
// max_num_values in all. Can be used from several threads.
template <typename Value>
class SharedCache {
 public:
  using Pointer = std::shared_ptr<const Value>;
  // spare: a value that was dropped, whose memory the new one may take; null
  // where there is none.
  using Make = std::function<Pointer(Pointer spare)>;

  explicit SharedCache(size_t max_num_values)
      : max_num_values_(max_num_values) {}

  // The value of an image; null where there is none yet.
  Pointer Find(int image) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto entry = Use(image);
    return entry == entries_.end() || !IsMade(*entry) ? nullptr
                                                      : entry->value.get();
  }

  // Keeps the value of an image no longer than others use it.
  void Drop(int image) {
    Pointer value;  // Freed without the mutex.
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto entry = Use(image);
    if (entry != entries_.end() && IsMade(*entry)) {
      value = entry->value.get();
      entries_.erase(entry);
    }
  }

  // Makes the value where there is none. Threads that want the same value wait
  // for one of them to make it. What make() throws reaches all that wait; the
  // next call tries again.
  Pointer Get(int image, const Make& make) {
    std::promise<Pointer> promise;
    std::list<Entry> dropped;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      if (const auto entry = Use(image); entry != entries_.end()) {
        const std::shared_future<Pointer> value = entry->value;
        lock.unlock();
        return value.get();
      }
      entries_.push_front({image, promise.get_future().share()});
      DropUnused(&dropped);
    }
    try {
      Pointer spare = dropped.empty() ? nullptr : dropped.back().value.get();
      dropped.clear();
      if (spare.use_count() > 1) {
        spare = nullptr;  // A thread that has waited for it has yet to take it.
      }
      Pointer value = make(std::move(spare));
      promise.set_value(value);
      return value;
    } catch (...) {
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        entries_.erase(Use(image));
      }
      promise.set_exception(std::current_exception());
      throw;
    }
  }

  // The values of several images. Threads that want the same ones share the
  // work: each makes those that no other thread is making. Stops, with the
  // values that are missing null, once should_stop returns true.
  std::vector<Pointer> GetAll(const std::vector<int>& images,
                              const std::function<Pointer(int image)>& make,
                              const std::function<bool()>& should_stop) {
    std::vector<Pointer> values;
    for (const int image : images) {
      values.push_back(Find(image));
    }
    for (const bool waits : {false, true}) {
      for (size_t i = 0; i < images.size() && !should_stop(); ++i) {
        if (!values[i] && (waits || !Has(images[i]))) {
          values[i] = Get(images[i], [&](Pointer) { return make(images[i]); });
        }
      }
    }
    return values;
  }

 private:
  struct Entry {
    int image = 0;
    std::shared_future<Pointer> value;
  };

  static bool IsMade(const Entry& entry) {
    return entry.value.wait_for(std::chrono::seconds(0)) ==
           std::future_status::ready;
  }

  bool Has(int image) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return Use(image) != entries_.end();
  }

  // These are called with the mutex locked.

  // Makes the image the most recently used one.
  typename std::list<Entry>::iterator Use(int image) {
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
      if (entry->image == image) {
        entries_.splice(entries_.begin(), entries_, entry);
        return entry;
      }
    }
    return entries_.end();
  }

  // Only this cache hands out values, so one without other owners cannot get a
  // new user now. The values are freed without the mutex.
  void DropUnused(std::list<Entry>* dropped) {
    for (auto entry = entries_.end();
         entries_.size() > max_num_values_ && entry != entries_.begin();) {
      --entry;
      if (IsMade(*entry) && entry->value.get().use_count() == 1) {
        const auto next = std::next(entry);
        dropped->splice(dropped->end(), entries_, entry);
        entry = next;
      }
    }
  }

  const size_t max_num_values_;
  std::mutex mutex_;
  std::list<Entry> entries_;  // The most recently used first.
};

}  // namespace tsar
