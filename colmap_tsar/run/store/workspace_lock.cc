// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/workspace_lock.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/store/links.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tsar {
namespace {

// Whether the open file still has the name: the former holder may have removed
// it between open() and the lock.
bool HasName(int descriptor, const ContainedPath& path) {
  struct stat opened;
  struct stat named;
  const std::optional<Folder> folder = Folder::OpenIfThere(path.Parent());
  return folder && fstat(descriptor, &opened) == 0 &&
         fstatat(folder->Descriptor(),
                 path.Filename().c_str(),
                 &named,
                 AT_SYMLINK_NOFOLLOW) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

using Mode = WorkspaceLock::Mode;

// Bytes of the file represent the locks: one for each shared mode, then one for
// each shard. The file itself stays empty.
constexpr off_t kFirstShard = 16;

struct Range {
  off_t begin;
  off_t size;  // 0: to the end of all files.
};

constexpr Range kEverything = {0, 0};

Range KindOf(Mode mode) { return {static_cast<off_t>(mode), 1}; }

// Locks that the open file itself holds do not count.
int Control(int descriptor, int command, short type, Range range) {
  struct flock lock = {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  lock.l_start = range.begin;
  lock.l_len = range.size;
  if (fcntl(descriptor, command, &lock) != 0) {
    return errno == EACCES ? EAGAIN : errno;
  }
  return command == F_OFD_GETLK && lock.l_type != F_UNLCK ? EAGAIN : 0;
}

// Looks for locks of other modes. A program sets its own lock before it looks
// for others, so that of two that come at once at least one sees the other.
int FindOthers(int descriptor, Mode mode) {
  for (const Mode other : {Mode::kShared, Mode::kObserve, Mode::kCompose}) {
    const int reason =
        other == mode
            ? 0
            : Control(descriptor, F_OFD_GETLK, F_WRLCK, KindOf(other));
    if (reason != 0) {
      return reason;
    }
  }
  return 0;
}

// Returns 0, EAGAIN where another program is in the way, or another error
// number of the system.
int LockOnce(int descriptor, Mode mode) {
  if (mode == Mode::kExclusive) {
    return Control(descriptor, F_OFD_SETLK, F_WRLCK, kEverything);
  }
  int reason = Control(descriptor, F_OFD_SETLK, F_RDLCK, KindOf(mode));
  if (reason == 0) {
    reason = FindOthers(descriptor, mode);
  }
  if (reason != 0) {
    Control(descriptor, F_OFD_SETLK, F_UNLCK, kEverything);
  }
  return reason;
}

int LockMode(int descriptor, Mode mode) {
  // A program that leaves holds the lock exclusively for a moment, and two that
  // come at once may both give way.
  constexpr int kMaxAttempts = 20;
  for (int i = 1;; ++i) {
    const int reason = LockOnce(descriptor, mode);
    if (reason != EAGAIN || i == kMaxAttempts || mode == Mode::kExclusive) {
      return reason;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

Error InUse(const ContainedPath& path, Mode mode) {
  return Error::File(
      ErrorCode::kUnsupported,
      path.string(),
      mode == Mode::kObserve || mode == Mode::kCompose
          ? "another program, or a shard in the other pass, is working on this "
            "workspace"
          : "another program is working on this workspace",
      "wait until it has ended");
}

// Whether nothing but the lock lies in the folder.
bool IsAlone(const ContainedPath& path) {
  const std::optional<Folder> folder = Folder::OpenIfThere(path.Parent());
  return !folder || folder->List().size() <= 1;
}

// The file, or -1 with the system's error number.
struct Opened {
  int descriptor = -1;
  int error = 0;
};

// Does not follow a link, and opens nothing but a file.
Opened OpenFile(const ContainedPath& path, bool creates) {
  Opened opened;
  const std::optional<Folder> folder = creates
                                           ? Folder::Create(path.Parent())
                                           : Folder::OpenIfThere(path.Parent());
  if (!folder) {
    opened.error = ENOENT;
    return opened;
  }
  opened.descriptor = openat(folder->Descriptor(),
                             path.Filename().c_str(),
                             O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY |
                                 O_CLOEXEC | (creates ? O_CREAT : 0),
                             0666);
  struct stat state;
  if (opened.descriptor < 0) {
    opened.error = errno;
  } else if (fstat(opened.descriptor, &state) != 0 || !S_ISREG(state.st_mode)) {
    close(opened.descriptor);
    opened = {-1, EINVAL};
  }
  return opened;
}

std::string ReasonText(int error) {
  return error == ELOOP    ? "it is a link"
         : error == EINVAL ? "it is no file"
                           : std::strerror(error);
}

bool IsReader(Mode mode) {
  return mode == Mode::kShared || mode == Mode::kSharedIfThere;
}

// For locks, all reading modes are one.
Mode ForLocks(Mode mode) { return IsReader(mode) ? Mode::kShared : mode; }

}  // namespace

WorkspaceLock::WorkspaceLock(const std::filesystem::path& root,
                             Mode mode,
                             std::optional<int> shard)
    : path_(GetTsarFolder(root) / kFileName), mode_(mode) {
  std::error_code error;
  if (!std::filesystem::is_directory(root / "stereo", error)) {
    throw Error::File(ErrorCode::kNotFound,
                      (root / "stereo").string(),
                      "no such folder, so this is not a dense workspace",
                      "check " + OptionName("workspace_path"));
  }
  if (!IsReader(mode)) {
    RequireFoldersInside(root);
  }
  do {
    if (descriptor_ >= 0) {
      close(std::exchange(descriptor_, -1));
    }
  } while (Open() && Lock(shard) && !StillHasName());
}

bool WorkspaceLock::Open() {
  // Some folders can never be made.
  constexpr int kMaxMissing = 100;
  Opened opened;
  try {
    // A former holder may have just removed the folder.
    for (int i = 0; i < kMaxMissing; ++i) {
      opened = OpenFile(path_, mode_ != Mode::kSharedIfThere);
      if (opened.error != ENOENT || mode_ == Mode::kSharedIfThere) {
        break;
      }
    }
  } catch (const Error& failure) {
    if (!IsReader(mode_)) {
      throw;
    }
    Warn(std::string(failure.what()) +
         "; do not change this workspace while it is read");
    return false;
  }
  descriptor_ = opened.descriptor;
  if (opened.error == ENOENT && mode_ == Mode::kSharedIfThere) {
    return false;
  }
  if (opened.error != 0 && IsReader(mode_)) {
    Warn(path_.string() + ": the file cannot be written (" +
         ReasonText(opened.error) +
         "); do not change this workspace while it is read");
    return false;
  }
  if (opened.error != 0) {
    throw Error::File(
        ErrorCode::kIo,
        path_.string(),
        "cannot be written (" + ReasonText(opened.error) + ")",
        "check the permissions there, and remove what is no file");
  }
  return true;
}

bool WorkspaceLock::Lock(std::optional<int> shard) {
  int reason = LockMode(descriptor_, ForLocks(mode_));
  if (reason == EAGAIN) {
    close(descriptor_);
    throw InUse(path_, mode_);
  }
  if (reason == 0 && shard) {
    reason =
        Control(descriptor_, F_OFD_SETLK, F_WRLCK, {kFirstShard + *shard, 1});
  }
  if (reason == EAGAIN) {
    close(descriptor_);
    throw Error::File(ErrorCode::kUnsupported,
                      path_.string(),
                      "another program is working on shard " +
                          std::to_string(*shard) + " of this workspace",
                      "wait until it has ended");
  }
  if (reason != 0) {
    Warn(path_.string() + ": the file cannot be locked (" +
         std::strerror(reason) +
         "); do not start a second program on this workspace");
  }
  return reason == 0;
}

bool WorkspaceLock::StillHasName() {
  try {
    return HasName(descriptor_, path_);
  } catch (const Error&) {
    close(std::exchange(descriptor_, -1));
    throw;
  }
}

WorkspaceLock::~WorkspaceLock() {
  if (descriptor_ < 0) {
    return;
  }
  try {
    Release();
  } catch (const std::exception&) {
    // The file stays; the next program takes it over.
  }
  close(descriptor_);
}

void WorkspaceLock::Release() {
  // The last holder of a shared lock removes the file. A program that opens it
  // meanwhile finds that its name is gone; on another machine that can go
  // unnoticed, so that shards leave it to the program that ends the work.
  const bool is_shard = mode_ == Mode::kObserve || mode_ == Mode::kCompose;
  if (mode_ == Mode::kExclusive ||
      ((!is_shard || IsAlone(path_)) &&
       Control(descriptor_, F_OFD_SETLK, F_WRLCK, kEverything) == 0)) {
    RemoveFile(path_);
  }
  // The folder goes only if it holds no other files.
  RemoveFolderIfEmpty(path_.Parent());
}

}  // namespace tsar
