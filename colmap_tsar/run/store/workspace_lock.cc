// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/workspace_lock.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/io/map_paths.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

namespace tsar {
namespace {

using Mode = WorkspaceLock::Mode;

ContainedPath ShardLockPath(const std::filesystem::path& root, int shard) {
  return GetTsarFolder(root) / "shards" / (std::to_string(shard) + ".lock");
}

// Follows no link, and opens nothing but a file.
OwnedDescriptor OpenFile(const ContainedPath& path) {
  const Folder folder = Folder::Create(path.Parent());
  OwnedDescriptor file(openat(
      folder.Descriptor(),
      path.Filename().c_str(),
      O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC,
      0666));
  struct stat state;
  if (file.Get() < 0 && errno != ENOENT) {
    ThrowSystemError(path, "cannot be written", errno);
  }
  if (file.Get() >= 0 &&
      (fstat(file.Get(), &state) != 0 || !S_ISREG(state.st_mode))) {
    ThrowSystemError(path, "is no file", EINVAL);
  }
  return file;
}

// Whether the file still has its name, which the former holder may have removed
// after it was opened.
bool HasName(const OwnedDescriptor& file) {
  struct stat state;
  return fstat(file.Get(), &state) == 0 && state.st_nlink > 0;
}

// Returns the locked file, or nothing where another program holds the lock. On
// file systems without locks it only warns.
std::optional<OwnedDescriptor> Lock(const ContainedPath& path, int operation) {
  // A program that leaves holds the lock alone for a moment, and may remove the
  // file and its folders while others make them.
  constexpr int kMaxAttempts = 20;
  for (int i = 1;; ++i) {
    OwnedDescriptor file{-1};
    try {
      file = OpenFile(path);
    } catch (const Error&) {
      if (i == kMaxAttempts) {
        throw;
      }
    }
    const bool is_open = file.Get() >= 0;
    const bool is_locked =
        is_open && flock(file.Get(), operation | LOCK_NB) == 0;
    const int reason = errno;
    if (is_locked && HasName(file)) {
      return file;
    }
    if (is_open && !is_locked && reason != EWOULDBLOCK) {
      Warn(path.string() + ": the file cannot be locked (" +
           std::strerror(reason) +
           "); do not start a second program on this workspace");
      return file;
    }
    if (i == kMaxAttempts || (is_open && !is_locked && operation == LOCK_EX)) {
      return std::nullopt;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

Error InUse(const ContainedPath& path, const std::string& what) {
  return Error::File(ErrorCode::kUnsupported,
                     path.string(),
                     "another program is working on " + what,
                     "wait until it has ended");
}

}  // namespace

WorkspaceLock::WorkspaceLock(const std::filesystem::path& root,
                             Mode mode,
                             int shard)
    : root_(root), shard_(shard) {
  std::error_code error;
  if (!std::filesystem::is_directory(root / "stereo", error)) {
    throw Error::File(ErrorCode::kNotFound,
                      (root / "stereo").string(),
                      "no such folder, so this is not a dense workspace",
                      "check " + OptionName("workspace_path"));
  }
  if (mode != Mode::kShared) {
    RequireFoldersInside(root);
  }
  const ContainedPath path = GetTsarFolder(root) / kFileName;
  std::optional<OwnedDescriptor> lock;
  try {
    lock = Lock(path, mode == Mode::kExclusive ? LOCK_EX : LOCK_SH);
  } catch (const Error& failure) {
    if (mode != Mode::kShared) {
      throw;
    }
    Warn(std::string(failure.what()) +
         "; do not change this workspace while it is read");
    return;
  }
  if (!lock) {
    throw InUse(path, "this workspace");
  }
  lock_ = std::move(*lock);
  if (mode == Mode::kShard) {
    lock = Lock(ShardLockPath(root, shard), LOCK_EX);
    if (!lock) {
      throw InUse(ShardLockPath(root, shard),
                  "shard " + std::to_string(shard) + " of this workspace");
    }
    shard_lock_ = std::move(*lock);
  }
}

WorkspaceLock::~WorkspaceLock() {
  const ContainedPath tsar = GetTsarFolder(root_);
  // The files stay where this fails; the next program takes them over.
  try {
    if (shard_lock_.Get() >= 0) {
      RemoveFile(ShardLockPath(root_, shard_));
      RemoveFolderIfEmpty(tsar / "shards");
    }
    if (lock_.Get() >= 0 && flock(lock_.Get(), LOCK_EX | LOCK_NB) == 0) {
      RemoveFile(tsar / kFileName);
      RemoveFolderIfEmpty(tsar);
    }
  } catch (const std::exception&) {
  }
}

void RequireFoldersInside(const std::filesystem::path& root) {
  const ContainedPath stereo(root, "stereo");
  for (const TreeEntry& entry : ListTree(stereo)) {
    std::error_code error;
    if (!entry.is_link ||
        !std::filesystem::is_directory(entry.path.Path(), error)) {
      continue;
    }
    const std::filesystem::path name =
        entry.path.Path().lexically_relative(stereo.Path());
    if (name != "consistency_graphs") {
      Folder::OpenIfThere(entry.path);  // Throws where it leads out.
    }
    // Files stored there must not be those stored elsewhere.
    const std::string first = name.begin()->string();
    if (first == "tsar" || first == "tsar_import") {
      throw Error::File(ErrorCode::kUnsupported,
                        entry.path.string(),
                        "is a link to a folder among those of this program",
                        "put a folder in its place");
    }
  }
}

}  // namespace tsar
