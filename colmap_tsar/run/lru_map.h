// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <iterator>
#include <list>
#include <optional>
#include <unordered_map>
#include <utility>

namespace tsar {

// A map that orders its values by their last use, for caches that drop the
// least recently used ones. Pointers to values stay valid until these are
// erased. Not thread-safe.
template <typename Key, typename Value>
class LruMap {
 public:
  size_t Size() const { return entries_.size(); }

  // Null where there is no such key.
  Value* Find(const Key& key) {
    const auto place = places_.find(key);
    return place == places_.end() ? nullptr : &place->second->second;
  }

  // Find(), and makes the value the most recently used one.
  Value* Use(const Key& key) {
    const auto place = places_.find(key);
    if (place == places_.end()) {
      return nullptr;
    }
    entries_.splice(entries_.begin(), entries_, place->second);
    return &place->second->second;
  }

  // Adds the value as the most recently used one. The key must be new. Changes
  // nothing where it throws.
  void Add(const Key& key, Value value) {
    std::list<Entry> entry;
    entry.emplace_front(key, std::move(value));
    places_.emplace(key, entry.begin());
    entries_.splice(entries_.begin(), entry);
  }

  // The key must exist.
  void Erase(const Key& key) {
    const auto place = places_.find(key);
    entries_.erase(place->second);
    places_.erase(place);
  }

  // Removes and returns the least recently used value among those that may go;
  // nothing where none may.
  template <typename Predicate>
  std::optional<Value> TakeOldest(const Predicate& may_go) {
    for (auto entry = entries_.rbegin(); entry != entries_.rend(); ++entry) {
      if (may_go(std::as_const(entry->second))) {
        std::optional<Value> value = std::move(entry->second);
        places_.erase(entry->first);
        entries_.erase(std::prev(entry.base()));
        return value;
      }
    }
    return std::nullopt;
  }

 private:
  using Entry = std::pair<const Key, Value>;

  std::list<Entry> entries_;  // The most recently used first.
  std::unordered_map<Key, typename std::list<Entry>::iterator> places_;
};

}  // namespace tsar
