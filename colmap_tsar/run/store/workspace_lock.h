// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>

namespace tsar {

// A lock (flock) that a program holds while it changes a workspace; or a shared
// one for programs that do not interfere with each other: readers, and the
// shards of a pass, each of which also has a lock of its own. The system
// releases the locks also where the program is killed. Throws Error:
// kUnsupported, naming the file, where another program is at work; kNotFound
// where there is no stereo folder; kIo; for writing also what
// RequireFoldersInside throws. On file systems without locks it only warns, as
// does a reader where the file cannot be written.
class WorkspaceLock {
 public:
  // The name in stereo/tsar.
  static constexpr const char* kFileName = "lock";

  enum class Mode {
    kExclusive,
    kShared,  // Reads.
    kShard,   // Works on a shard; shares the lock with other shards.
  };

  // shard: its index, for kShard: no other program may work on it.
  explicit WorkspaceLock(const std::filesystem::path& root,
                         Mode mode = Mode::kExclusive,
                         int shard = 0);
  ~WorkspaceLock();
  WorkspaceLock(const WorkspaceLock&) = delete;
  WorkspaceLock& operator=(const WorkspaceLock&) = delete;

 private:
  std::filesystem::path root_;
  int shard_;
  // Open files, which hold the locks.
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  File lock_;
  File shard_lock_;
};

// Throws Error kUnsupported where a folder of `stereo`, or `stereo` itself, is
// a link that leads out of the workspace: files there belong to somebody else.
// Folders are opened as folder.h describes, which protects them, but this check
// comes before anything is changed. consistency_graphs, which is never written
// to, may be such a link. Links that are files are replaced, never written
// through. Throws kIo where a folder cannot be listed.
void RequireFoldersInside(const std::filesystem::path& root);

}  // namespace tsar
