// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/workspace_lock.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/io/map_paths.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tsar {
namespace {

using Mode = WorkspaceLock::Mode;
using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

ContainedPath ShardLockPath(const std::filesystem::path& root, int shard) {
  return GetTsarFolder(root) / "shards" / (std::to_string(shard) + ".lock");
}

File NoFile() { return {nullptr, &std::fclose}; }

// Follows no link, and opens nothing but a file. Null where another program
// has removed its folder meanwhile.
File OpenFile(const ContainedPath& path) {
  CreateFolders(path.Parent());
  const int descriptor =
      open(path.Path().c_str(),
           O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC,
           0666);
  if (descriptor < 0) {
    if (errno == ENOENT) {
      return NoFile();
    }
    ThrowSystemError(path, "cannot be written", errno);
  }
  struct stat state;
  const bool is_file = fstat(descriptor, &state) == 0 && S_ISREG(state.st_mode);
  File file = {is_file ? fdopen(descriptor, "r+") : nullptr, &std::fclose};
  if (!file) {
    const int error = is_file ? errno : EINVAL;
    close(descriptor);
    ThrowSystemError(path, "cannot be opened as a file", error);
  }
  return file;
}

// Whether the file still has its name, which the former holder may have removed
// after it was opened.
bool HasName(const File& file) {
  struct stat state;
  return fstat(fileno(file.get()), &state) == 0 && state.st_nlink > 0;
}

// Returns the locked file, or null where another program holds the lock. On
// file systems without locks it only warns.
File Lock(const ContainedPath& path, int operation) {
  // A program that ends holds the lock alone for a moment, and may remove the
  // file and its folders while others create them.
  constexpr int kMaxAttempts = 20;
  for (int i = 1;; ++i) {
    File file = NoFile();
    try {
      file = OpenFile(path);
    } catch (const Error&) {
      if (i == kMaxAttempts) {
        throw;
      }
    }
    const bool is_locked =
        file && flock(fileno(file.get()), operation | LOCK_NB) == 0;
    const int reason = errno;
    if (is_locked && HasName(file)) {
      return file;
    }
    if (file && !is_locked && reason != EWOULDBLOCK) {
      Warn(path.string() + ": the file cannot be locked (" +
           std::strerror(reason) +
           "); do not start a second program on this workspace");
      return file;
    }
    if (i == kMaxAttempts || (file && !is_locked && operation == LOCK_EX)) {
      return NoFile();
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
    : root_(root), shard_(shard), lock_(NoFile()), shard_lock_(NoFile()) {
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
  try {
    lock_ = Lock(path, mode == Mode::kExclusive ? LOCK_EX : LOCK_SH);
  } catch (const Error& failure) {
    if (mode != Mode::kShared) {
      throw;
    }
    Warn(std::string(failure.what()) +
         "; do not change this workspace while it is read");
    return;
  }
  if (!lock_) {
    throw InUse(path, "this workspace");
  }
  if (mode == Mode::kShard) {
    shard_lock_ = Lock(ShardLockPath(root, shard), LOCK_EX);
    if (!shard_lock_) {
      throw InUse(ShardLockPath(root, shard),
                  "shard " + std::to_string(shard) + " of this workspace");
    }
  }
}

WorkspaceLock::~WorkspaceLock() {
  const ContainedPath tsar = GetTsarFolder(root_);
  // The files stay where this fails; the next program takes them over.
  try {
    if (shard_lock_) {
      RemoveFile(ShardLockPath(root_, shard_));
      RemoveFolderIfEmpty(tsar / "shards");
    }
    if (lock_ && flock(fileno(lock_.get()), LOCK_EX | LOCK_NB) == 0) {
      RemoveFile(tsar / kFileName);
      RemoveFolderIfEmpty(tsar);
    }
  } catch (const std::exception&) {
  }
}

void RequireFoldersInside(const std::filesystem::path& root) {
  const ContainedPath stereo(root, "stereo");
  for (const FolderEntry& entry : ListTree(stereo)) {
    std::error_code error;
    if (!entry.is_link ||
        !std::filesystem::is_directory(entry.path.Path(), error)) {
      continue;
    }
    const std::filesystem::path name =
        entry.path.Path().lexically_relative(stereo.Path());
    if (name != "consistency_graphs") {
      RequireInside(entry.path);
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
