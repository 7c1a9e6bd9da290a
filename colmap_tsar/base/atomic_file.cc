// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/atomic_file.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/path.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>
#include <optional>
#include <streambuf>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tsar {
namespace {

std::string TemporaryOf(const std::string& name) {
  return name + AtomicFile::kTemporarySuffix;
}

constexpr mode_t kPermissions = 0777;

// Flushes a file that another program may have left in the system's cache.
void FlushFile(const Folder& folder, const std::string& name) {
  const OwnedDescriptor file(
      openat(folder.Descriptor(),
             name.c_str(),
             O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (file.Get() >= 0) {
    fsync(file.Get());
  }
}

bool AreSame(const Folder& a, const Folder& b) {
  struct stat state_a;
  struct stat state_b;
  return fstat(a.Descriptor(), &state_a) == 0 &&
         fstat(b.Descriptor(), &state_b) == 0 &&
         state_a.st_dev == state_b.st_dev && state_a.st_ino == state_b.st_ino;
}

// Buffered writing to a file descriptor that remembers the system's error.
class DescriptorBuffer : public std::streambuf {
 public:
  explicit DescriptorBuffer(int descriptor)
      : descriptor_(descriptor), buffer_(size_t{1} << 16) {
    setp(buffer_.data(), buffer_.data() + buffer_.size());
  }

  int SystemErrorNumber() const { return error_; }

 protected:
  int_type overflow(int_type character) override {
    if (!Flush()) {
      return traits_type::eof();
    }
    if (!traits_type::eq_int_type(character, traits_type::eof())) {
      *pptr() = traits_type::to_char_type(character);
      pbump(1);
    }
    return traits_type::not_eof(character);
  }

  std::streamsize xsputn(const char* data, std::streamsize size) override {
    if (size <= 0) {
      return 0;  // The data of an empty vector may be a null pointer.
    }
    if (size <= epptr() - pptr()) {
      std::memcpy(pptr(), data, static_cast<size_t>(size));
      pbump(static_cast<int>(size));
      return size;
    }
    return Flush() && WriteAll(data, static_cast<size_t>(size)) ? size : 0;
  }

  int sync() override { return Flush() ? 0 : -1; }

  // Seeking lets a value that is only known at the end be written at the
  // beginning.
  pos_type seekpos(pos_type position, std::ios_base::openmode) override {
    if (!Flush()) {
      return pos_type(off_type(-1));
    }
    if (lseek(descriptor_, position, SEEK_SET) < 0) {
      error_ = errno;
      return pos_type(off_type(-1));
    }
    return position;
  }

 private:
  bool Flush() {
    const bool written =
        WriteAll(pbase(), static_cast<size_t>(pptr() - pbase()));
    setp(buffer_.data(), buffer_.data() + buffer_.size());
    return written;
  }

  bool WriteAll(const char* data, size_t size) {
    while (size > 0 && error_ == 0) {
      const ssize_t written = write(descriptor_, data, size);
      if (written >= 0) {
        data += written;
        size -= static_cast<size_t>(written);
      } else if (errno != EINTR) {
        error_ = errno;
      }
    }
    return error_ == 0;
  }

  int descriptor_;
  int error_ = 0;
  std::vector<char> buffer_;
};

}  // namespace

struct AtomicFile::State {
  State(const ContainedPath& file_path)
      : path(file_path),
        folder(file_path.Parent()),
        name(file_path.Filename().string()),
        temporary(TemporaryOf(name)),
        descriptor(Open()),
        buffer(descriptor),
        stream(&buffer) {}
  ~State() {
    Close();
    if (!committed) {
      RemoveTemporary();
    }
  }

  int Open() {
    RequireNoFolder(path.Path());
    struct stat state;
    if (fstatat(folder.Descriptor(), name.c_str(), &state, 0) == 0 &&
        S_ISREG(state.st_mode)) {
      replaced = state;
    }
    // The temporary of a killed program may be a link to a file that must not
    // change.
    RemoveTemporary();
    RequireNoFolder((path.Parent() / temporary).Path());
    const int opened =
        openat(folder.Descriptor(),
               temporary.c_str(),
               O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC,
               replaced ? replaced->st_mode & kPermissions : 0666);
    if (opened < 0) {
      ThrowSystemError(path.Path(), "cannot be written", errno);
    }
    return opened;
  }

  // Failures are ignored: not all file systems have owners and permissions.
  void SetAttributes() {
    if (replaced) {
      if (fchown(descriptor, replaced->st_uid, replaced->st_gid) != 0) {
        // Only the superuser may give files away.
        errno = 0;
      }
      fchmod(descriptor, replaced->st_mode & kPermissions);
    }
    if (time) {
      const timespec times[] = {{0, UTIME_OMIT}, *time};
      futimens(descriptor, times);
    }
  }

  bool Close() {
    const int closing = std::exchange(descriptor, -1);
    return closing < 0 || close(closing) == 0;
  }

  void RemoveTemporary() {
    unlinkat(folder.Descriptor(), temporary.c_str(), 0);
  }

  ContainedPath path;
  Folder folder;
  std::string name;
  std::string temporary;
  std::optional<struct stat> replaced;  // Source of the attributes.
  std::optional<timespec> time;         // Modification time, if not now.
  int descriptor;
  bool committed = false;
  DescriptorBuffer buffer;
  std::ostream stream;
};

AtomicFile::AtomicFile(const ContainedPath& path)
    : state_(std::make_unique<State>(path)) {}

AtomicFile::~AtomicFile() = default;
AtomicFile::AtomicFile(AtomicFile&&) noexcept = default;

std::ostream& AtomicFile::Stream() { return state_->stream; }

void AtomicFile::Prepare() {
  if (state_->descriptor < 0) {
    return;
  }
  state_->stream.flush();
  int error = state_->buffer.SystemErrorNumber();
  if (error == 0 && !state_->stream) {
    // The stream ran out of memory, which it reports by this flag alone.
    throw std::bad_alloc();
  }
  state_->SetAttributes();
  if (error == 0 && fsync(state_->descriptor) != 0) {
    error = errno;
  }
  if (!state_->Close() && error == 0) {
    error = errno;
  }
  if (error != 0) {
    state_->RemoveTemporary();
    ThrowSystemError(state_->path.Path(), "writing failed", error);
  }
}

void AtomicFile::Commit() {
  Prepare();
  const int folder = state_->folder.Descriptor();
  if (renameat(
          folder, state_->temporary.c_str(), folder, state_->name.c_str()) !=
      0) {
    const int error = errno;
    state_->RemoveTemporary();
    ThrowSystemError(state_->path.Path(), "cannot be replaced", error);
  }
  state_->committed = true;
  state_->folder.Flush();
}

void CreateFolders(const ContainedPath& path) { Folder::Create(path); }

void LinkOrCopyFile(const std::filesystem::path& source,
                    const ContainedPath& path) {
  const Folder folder = Folder::Create(path.Parent());
  RequireNoFolder(path.Path());
  const std::string name = path.Filename().string();
  const std::string temporary = TemporaryOf(name);
  unlinkat(folder.Descriptor(), temporary.c_str(), 0);
  if (linkat(AT_FDCWD,
             source.c_str(),
             folder.Descriptor(),
             temporary.c_str(),
             AT_SYMLINK_FOLLOW) == 0) {
    FlushFile(folder, temporary);
    RenameFile(path.Parent() / temporary, path);
    return;
  }
  CopyFile(source, path, true);
}

void CopyFile(const std::filesystem::path& source,
              const ContainedPath& path,
              bool keeps_time) {
  InputFile input(source);
  struct stat state;
  if (!input || stat(source.c_str(), &state) != 0) {
    throw Error::File(ErrorCode::kIo,
                      source.string(),
                      "cannot be read (" + input.Reason() + ")",
                      "check the permissions there");
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
  const Folder from_folder(from.Parent());
  const Folder to_folder(to.Parent());
  const std::string from_name = from.Filename().string();
  if (from_name == to.Filename() && AreSame(from_folder, to_folder)) {
    throw Error::File(ErrorCode::kUnsupported,
                      to.string(),
                      "is the same file as " + from.string(),
                      "remove the links among the folders of the workspace");
  }
  if (renameat(from_folder.Descriptor(),
               from_name.c_str(),
               to_folder.Descriptor(),
               to.Filename().c_str()) != 0) {
    if (errno != EXDEV) {
      ThrowSystemError(to.Path(), "cannot be replaced by " + from_name, errno);
    }
    // The copy is complete and flushed to the disk before the source is
    // removed.
    CopyFile(from.Path(), to, true);
  }
  // rename() does nothing if both names are links to one file.
  unlinkat(from_folder.Descriptor(), from_name.c_str(), 0);
  to_folder.Flush();
}

bool ExchangeFiles(const ContainedPath& first, const ContainedPath& second) {
  const Folder first_folder(first.Parent());
  const Folder second_folder(second.Parent());
  if (renameat2(first_folder.Descriptor(),
                first.Filename().c_str(),
                second_folder.Descriptor(),
                second.Filename().c_str(),
                RENAME_EXCHANGE) != 0) {
    if (errno == EINVAL || errno == ENOSYS || errno == ENOTSUP) {
      return false;
    }
    ThrowSystemError(second.Path(),
                     "cannot be exchanged with " + first.Filename().string(),
                     errno);
  }
  first_folder.Flush();
  second_folder.Flush();
  return true;
}

}  // namespace tsar
