// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>

namespace tsar {

// Held while a program changes a workspace, so that no second one does. The
// system releases the lock also where the program is killed. Throws Error:
// kUnsupported, naming the file, where another program holds it; kNotFound
// where there is no stereo folder; kIo. On file systems without locks it only
// warns.
class WorkspaceLock {
 public:
  // In stereo/tsar.
  static constexpr const char* kFileName = "lock";

  explicit WorkspaceLock(const std::filesystem::path& root);
  ~WorkspaceLock();
  WorkspaceLock(const WorkspaceLock&) = delete;
  WorkspaceLock& operator=(const WorkspaceLock&) = delete;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

}  // namespace tsar
