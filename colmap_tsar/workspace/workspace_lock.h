// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>

namespace tsar {

// Held while a program changes a workspace, so that no second one does; or,
// shared, while programs read one that must not change meanwhile. The system
// releases the lock also where the program is killed. Throws Error:
// kUnsupported, naming the file, where another program holds it; kNotFound
// where there is no stereo folder; kIo; for writing also what
// RequireFoldersInside throws. On file systems without locks it only
// warns, and a shared lock also where the file cannot be written.
class WorkspaceLock {
 public:
  // In stereo/tsar.
  static constexpr const char* kFileName = "lock";

  enum class Mode { kExclusive, kShared };

  explicit WorkspaceLock(const std::filesystem::path& root,
                         Mode mode = Mode::kExclusive);
  ~WorkspaceLock();
  WorkspaceLock(const WorkspaceLock&) = delete;
  WorkspaceLock& operator=(const WorkspaceLock&) = delete;

 private:
  std::filesystem::path path_;
  Mode mode_;
  int descriptor_ = -1;
};

}  // namespace tsar
