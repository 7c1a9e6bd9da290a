// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/atomic_file.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/input_file.h"

#include <algorithm>
#include <cerrno>
#include <mutex>
#include <optional>
#include <system_error>
#include <tuple>
#include <vector>

#include <ext/stdio_filebuf.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tsar {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kPermissions = 0777;

ContainedPath TemporaryOf(const ContainedPath& path) {
  return path.Parent() /
         (path.Filename().string() + AtomicFile::kTemporarySuffix);
}

// Locks a temporary until all duplicates of the descriptor are closed. Refuses
// one that another program writes, or has removed meanwhile.
void LockTemporary(int descriptor, const ContainedPath& path) {
  struct stat state;
  // Some file systems have no locks.
  const bool is_taken =
      flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (is_taken || (fstat(descriptor, &state) == 0 && state.st_nlink == 0)) {
    close(descriptor);
    throw Error::File(ErrorCode::kUnsupported,
                      path.string(),
                      "another program is writing this file",
                      "wait until it has ended, or choose another name");
  }
}

// The mark of a temporary file if the user named the file itself, since any
// file may have that name: the sticky bit, which has no effect on files.
mode_t SignOf(const ContainedPath& path) {
  return path.Relative().has_parent_path() ? 0 : S_ISVTX;
}

// The temporary of a killed program may be a link to a file that must not
// change. What another program makes meanwhile stays.
void RemoveOldTemporary(const ContainedPath& path) {
  RequireNoFolder(path.Path());
  const fs::path temporary = TemporaryOf(path).Path();
  RequireNoFolder(temporary);
  const int descriptor =
      open(temporary.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0 && errno == ENOENT) {
    return;
  }
  if (descriptor >= 0) {
    LockTemporary(descriptor, path);
  }
  struct stat state;
  if (lstat(temporary.c_str(), &state) == 0 && S_ISREG(state.st_mode) &&
      state.st_size > 0 && (~state.st_mode & SignOf(path)) != 0) {
    close(descriptor);
    throw Error::File(ErrorCode::kUnsupported,
                      temporary.string(),
                      "is there already, and its name is needed for a file "
                      "that is being written",
                      "move it away, or choose another name");
  }
  unlink(temporary.c_str());
  close(descriptor);
}

// Reports the system's error, which streams do not.
class OutputBuffer : public __gnu_cxx::stdio_filebuf<char> {
 public:
  OutputBuffer(const fs::path& path, int descriptor)
      : stdio_filebuf(descriptor, std::ios::out | std::ios::binary),
        path_(path) {}

 protected:
  int_type overflow(int_type character) override {
    const int_type result = stdio_filebuf::overflow(character);
    Require(result != traits_type::eof());
    return result;
  }
  std::streamsize xsputn(const char* data, std::streamsize size) override {
    const std::streamsize written = stdio_filebuf::xsputn(data, size);
    Require(written == size);
    return written;
  }

 private:
  void Require(bool succeeded) const {
    if (!succeeded) {
      ThrowSystemError(path_, "writing failed", errno);
    }
  }

  const fs::path path_;
};

}  // namespace

struct AtomicFile::State {
  explicit State(const ContainedPath& file_path)
      : path(file_path),
        temporary(TemporaryOf(file_path).Path()),
        buffer(file_path, Open()),
        stream(&buffer) {
    stream.exceptions(std::ios::badbit);
  }
  ~State() {
    if (!committed) {
      unlink(temporary.c_str());
    }
    close(lock);
  }

  int Open() {
    RequireInside(path.Parent());
    struct stat state;
    if (stat(path.Path().c_str(), &state) == 0 && S_ISREG(state.st_mode)) {
      replaced = state;
    }
    RemoveOldTemporary(path);
    const int opened = open(
        temporary.c_str(),
        O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC,
        (replaced ? replaced->st_mode & kPermissions : 0666) | SignOf(path));
    if (opened < 0) {
      ThrowSystemError(path.Path(), "cannot be written", errno);
    }
    LockTemporary(opened, path);
    // Still locked between the end of writing and the renaming.
    lock = fcntl(opened, F_DUPFD_CLOEXEC, 0);
    return opened;
  }

  // Failures are ignored: not all file systems have owners and permissions, and
  // only the superuser may give files away.
  void SetAttributes() {
    const int descriptor = buffer.fd();
    if (replaced) {
      std::ignore = fchown(descriptor, replaced->st_uid, replaced->st_gid);
      fchmod(descriptor, (replaced->st_mode & kPermissions) | SignOf(path));
    }
    if (time) {
      const timespec times[] = {{0, UTIME_OMIT}, *time};
      futimens(descriptor, times);
    }
  }

  ContainedPath path;
  fs::path temporary;
  std::optional<struct stat> replaced;  // Source of the attributes.
  std::optional<timespec> time;         // Modification time, if not now.
  bool committed = false;
  int lock = -1;
  OutputBuffer buffer;
  std::ostream stream;
};

AtomicFile::AtomicFile(const ContainedPath& path)
    : state_(std::make_unique<State>(path)) {}

AtomicFile::~AtomicFile() = default;
AtomicFile::AtomicFile(AtomicFile&&) noexcept = default;

std::ostream& AtomicFile::Stream() { return state_->stream; }

void AtomicFile::Prepare() {
  if (!state_->buffer.is_open()) {
    return;
  }
  state_->stream.flush();
  state_->SetAttributes();
  if (fsync(state_->buffer.fd()) != 0 || state_->buffer.close() == nullptr) {
    ThrowSystemError(state_->path.Path(), "writing failed", errno);
  }
}

void AtomicFile::Commit() {
  Prepare();
  const ContainedPath& path = state_->path;
  if (rename(state_->temporary.c_str(), path.Path().c_str()) != 0) {
    ThrowSystemError(path.Path(), "cannot be replaced", errno);
  }
  state_->committed = true;
  struct stat state;
  if (SignOf(path) != 0 && fstat(state_->lock, &state) == 0) {
    fchmod(state_->lock, state.st_mode & kPermissions);
  }
  FlushToDisk(path.Parent());
}

void CreateFolders(const ContainedPath& path) {
  RequireInside(path);
  // A folder just created by another thread may not be on the disk yet.
  static std::mutex mutex;
  const std::lock_guard<std::mutex> lock(mutex);
  std::error_code error;
  std::vector<fs::path> created;
  for (fs::path folder = fs::absolute(path.Path());
       !fs::exists(folder, error) && folder.has_relative_path();
       folder = folder.parent_path()) {
    created.push_back(folder);
  }
  fs::create_directories(path.Path(), error);
  if (error) {
    ThrowSystemError(
        path.Path(), "the folder cannot be created", error.value());
  }
  std::for_each(created.rbegin(), created.rend(), [](const fs::path& folder) {
    FlushToDisk(folder.parent_path());
  });
}

void LinkOrCopyFile(const fs::path& source, const ContainedPath& path) {
  CreateFolders(path.Parent());
  RemoveOldTemporary(path);
  const ContainedPath temporary = TemporaryOf(path);
  std::error_code error;
  fs::create_hard_link(fs::canonical(source, error), temporary.Path(), error);
  if (error) {
    CopyFile(source, path, true);
    return;
  }
  // Another program may have left the file in the system's cache.
  FlushToDisk(temporary);
  RenameFile(temporary, path);
}

void CopyFile(const fs::path& source,
              const ContainedPath& path,
              bool keeps_time) {
  InputFile input(source);
  input.RequireOpened("file", "check that it exists");
  struct stat state;
  if (stat(source.c_str(), &state) != 0) {
    ThrowSystemError(source, "cannot be looked at", errno);
  }
  AtomicFile copy(path);
  copy.state_->replaced = state;
  if (keeps_time) {
    copy.state_->time = state.st_mtim;
  }
  // With operator<<, a failing disk would look like the end of the file.
  std::vector<char> block(size_t{1} << 16);
  do {
    input.read(block.data(), static_cast<std::streamsize>(block.size()));
    copy.Stream().write(block.data(), input.gcount());
  } while (input);
  copy.Commit();
}

void RenameFile(const ContainedPath& from, const ContainedPath& to) {
  RequireInside(from.Parent());
  RequireInside(to.Parent());
  if (from.Filename() == to.Filename() &&
      fs::equivalent(from.Parent().Path(), to.Parent().Path())) {
    throw Error::File(ErrorCode::kUnsupported,
                      to.string(),
                      "is the same file as " + from.string(),
                      "remove the links among the folders of the workspace");
  }
  if (rename(from.Path().c_str(), to.Path().c_str()) != 0) {
    if (errno != EXDEV) {
      ThrowSystemError(to.Path(),
                       "cannot be replaced by " + from.Filename().string(),
                       errno);
    }
    // The copy is complete and flushed to the disk before the source is
    // removed.
    CopyFile(from.Path(), to, true);
  }
  // rename() does nothing if both names are links to one file.
  unlink(from.Path().c_str());
  FlushToDisk(to.Parent());
}

}  // namespace tsar
