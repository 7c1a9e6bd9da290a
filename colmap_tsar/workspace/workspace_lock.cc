// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/workspace_lock.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/workspace/atomic_file.h"
#include "colmap_tsar/workspace/links.h"
#include "colmap_tsar/workspace/map_paths.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <glog/logging.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tsar {
namespace {

// Whether the open file still has the name: the holder before may have removed
// it between our open() and flock().
bool HasName(int descriptor, const std::filesystem::path& path) {
  struct stat opened;
  struct stat named;
  return fstat(descriptor, &opened) == 0 && stat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

// Returns 0 or the system's error number.
int Lock(int descriptor, WorkspaceLock::Mode mode) {
  if (mode == WorkspaceLock::Mode::kExclusive) {
    return flock(descriptor, LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
  }
  // A reader that leaves holds the lock alone for a moment.
  constexpr int kMaxAttempts = 20;
  for (int i = 1; flock(descriptor, LOCK_SH | LOCK_NB) != 0; ++i) {
    if (errno != EWOULDBLOCK || i == kMaxAttempts) {
      return errno;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return 0;
}

}  // namespace

WorkspaceLock::WorkspaceLock(const std::filesystem::path& root, Mode mode)
    : path_(GetTsarFolder(root) / kFileName), mode_(mode) {
  std::error_code error;
  if (!std::filesystem::is_directory(root / "stereo", error)) {
    throw Error::File(ErrorCode::kNotFound,
                      (root / "stereo").string(),
                      "no such folder, so this is not a dense workspace",
                      "check --workspace_path");
  }
  if (mode == Mode::kExclusive) {
    RequireFoldersInside(root);
  }
  // Some folders can never be made.
  constexpr int kMaxMissing = 100;
  int num_missing = 0;
  do {
    if (descriptor_ >= 0) {
      close(descriptor_);
    }
    try {
      CreateFolders(path_.parent_path());
    } catch (const Error&) {
      if (mode == Mode::kExclusive) {
        throw;
      }
    }
    descriptor_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno == ENOENT && ++num_missing < kMaxMissing) {
      continue;  // The holder before has just removed the folder.
    }
    if (descriptor_ < 0 && mode == Mode::kShared) {
      LOG(WARNING) << path_.string() << ": the file cannot be written ("
                   << std::strerror(errno)
                   << "); do not change this workspace while it is read";
      return;
    }
    if (descriptor_ < 0) {
      throw Error::File(
          ErrorCode::kIo,
          path_.string(),
          std::string("cannot be written (") + std::strerror(errno) + ")",
          "check the permissions there");
    }
    if (const int reason = Lock(descriptor_, mode); reason != 0) {
      if (reason == EWOULDBLOCK) {
        close(descriptor_);
        throw Error::File(ErrorCode::kUnsupported,
                          path_.string(),
                          "another program is working on this workspace",
                          "wait until it has ended");
      }
      LOG(WARNING) << path_.string() << ": the file cannot be locked ("
                   << std::strerror(reason)
                   << "); do not start a second program on this workspace";
      return;
    }
  } while (!HasName(descriptor_, path_));
}

WorkspaceLock::~WorkspaceLock() {
  if (descriptor_ < 0) {
    return;
  }
  // The last of those that share it removes the file. Whoever opens it
  // meanwhile finds that it has lost its name.
  if (mode_ == Mode::kExclusive || flock(descriptor_, LOCK_EX | LOCK_NB) == 0) {
    unlink(path_.c_str());
  }
  close(descriptor_);
  // Only goes where nothing else was written.
  rmdir(path_.parent_path().c_str());
}

}  // namespace tsar
