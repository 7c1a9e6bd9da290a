// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"

#include <filesystem>
#include <optional>

namespace tsar {

// A lock that a program holds while it changes a workspace; or a shared lock
// for programs that do not disturb each other: readers of a workspace that must
// not change meanwhile, and the shards of one pass. The system releases the
// lock also where the program is killed. Throws Error: kUnsupported, naming the
// file, where another program holds it; kNotFound where there is no stereo
// folder; kIo; for writing also what RequireFoldersInside throws. On file
// systems without locks it only warns, as does a reader where the file cannot
// be written.
//
// The locks are those of fcntl() on parts of one file, which NFS and other
// cluster file systems pass on to the server, so that they hold between
// machines.
class WorkspaceLock {
 public:
  // The name in stereo/tsar.
  static constexpr const char* kFileName = "lock";

  enum class Mode {
    kExclusive,
    kShared,   // Reads.
    kObserve,  // Works on a shard, in the first pass or
    kCompose,  // in the second.
    // For a workspace that the user did not name, but a file did: creates
    // nothing there, so that without the lock's file there is no lock.
    kSharedIfThere,
  };

  // shard: its index from 0 on, for the modes of shards: no other program may
  // work on it, in either pass.
  explicit WorkspaceLock(const std::filesystem::path& root,
                         Mode mode = Mode::kExclusive,
                         std::optional<int> shard = std::nullopt);
  ~WorkspaceLock();
  WorkspaceLock(const WorkspaceLock&) = delete;
  WorkspaceLock& operator=(const WorkspaceLock&) = delete;

 private:
  // These return whether the lock can be had; where it cannot, a warning says
  // so, unless the mode is kSharedIfThere and there is no file.
  bool Open();
  bool Lock(std::optional<int> shard);
  bool StillHasName();
  void Release();

  ContainedPath path_;
  Mode mode_;
  int descriptor_ = -1;
};

}  // namespace tsar
