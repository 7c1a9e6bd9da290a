// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/atomic_file.h"

#include "colmap_tsar/base/error.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <streambuf>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

namespace tsar {
namespace {

Error SystemError(const std::filesystem::path& path,
                  const std::string& what,
                  int error) {
  return Error::File(ErrorCode::kIo,
                     path.string(),
                     what + " (" + std::strerror(error) + ")",
                     "check the free space and the permissions there");
}

std::filesystem::path TemporaryOf(const std::filesystem::path& path) {
  std::filesystem::path temporary = path;
  temporary += AtomicFile::kTemporarySuffix;
  return temporary;
}

// Makes a rename durable. Not all file systems can; those that cannot have
// nothing to flush.
void FlushFolderOf(const std::filesystem::path& path) {
  const std::filesystem::path folder =
      path.has_parent_path() ? path.parent_path() : ".";
  const int descriptor =
      open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor >= 0) {
    fsync(descriptor);
    close(descriptor);
  }
}

// Other programs may leave what they write to the system's memory.
void FlushFile(const std::filesystem::path& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor >= 0) {
    fsync(descriptor);
    close(descriptor);
  }
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
    if (size <= epptr() - pptr()) {
      std::memcpy(pptr(), data, static_cast<size_t>(size));
      pbump(static_cast<int>(size));
      return size;
    }
    return Flush() && WriteAll(data, static_cast<size_t>(size)) ? size : 0;
  }

  int sync() override { return Flush() ? 0 : -1; }

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
  State(const std::filesystem::path& file_path, int file_descriptor)
      : path(file_path),
        temporary(TemporaryOf(file_path)),
        descriptor(file_descriptor),
        buffer(file_descriptor),
        stream(&buffer) {}
  ~State() {
    Close();
    if (!committed) {
      unlink(temporary.c_str());
    }
  }
  bool Close() {
    const int closing = std::exchange(descriptor, -1);
    return closing < 0 || close(closing) == 0;
  }

  std::filesystem::path path;
  std::filesystem::path temporary;
  int descriptor;
  bool committed = false;
  DescriptorBuffer buffer;
  std::ostream stream;
};

AtomicFile::AtomicFile(const std::filesystem::path& path) {
  const std::filesystem::path temporary = TemporaryOf(path);
  // What a killed program left may be a link to a file that must not change.
  unlink(temporary.c_str());
  const int descriptor =
      open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    throw SystemError(path, "cannot be written", errno);
  }
  state_ = std::make_unique<State>(path, descriptor);
}

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
    error = EIO;
  }
  if (error == 0 && fsync(state_->descriptor) != 0) {
    error = errno;
  }
  if (!state_->Close() && error == 0) {
    error = errno;
  }
  if (error != 0) {
    unlink(state_->temporary.c_str());
    throw SystemError(state_->path, "writing failed", error);
  }
}

void AtomicFile::Commit() {
  Prepare();
  if (rename(state_->temporary.c_str(), state_->path.c_str()) != 0) {
    const int error = errno;
    unlink(state_->temporary.c_str());
    throw SystemError(state_->path, "cannot be replaced", error);
  }
  state_->committed = true;
  FlushFolderOf(state_->path);
}

void CreateFolders(const std::filesystem::path& path) {
  std::error_code error;
  std::vector<std::filesystem::path> missing;
  for (std::filesystem::path folder = path;
       !folder.empty() && !std::filesystem::exists(folder, error);
       folder = folder.parent_path()) {
    missing.push_back(folder);
  }
  std::filesystem::create_directories(path, error);
  if (error) {
    throw SystemError(path, "the folder cannot be created", error.value());
  }
  // From the outermost on, so that what is on the disk is always to be found.
  for (auto folder = missing.rbegin(); folder != missing.rend(); ++folder) {
    FlushFolderOf(*folder);
  }
}

void LinkOrCopyFile(const std::filesystem::path& source,
                    const std::filesystem::path& path) {
  CreateFolders(path.parent_path());
  const std::filesystem::path temporary = TemporaryOf(path);
  unlink(temporary.c_str());
  if (linkat(AT_FDCWD,
             source.c_str(),
             AT_FDCWD,
             temporary.c_str(),
             AT_SYMLINK_FOLLOW) == 0) {
    FlushFile(temporary);
    RenameFile(temporary, path);
    return;
  }
  CopyFile(source, path, true);
}

void CopyFile(const std::filesystem::path& source,
              const std::filesystem::path& path,
              bool keeps_time) {
  std::ifstream input(source, std::ios::binary);
  if (!input) {
    throw SystemError(source, "cannot be read", errno);
  }
  AtomicFile copy(path);
  // An empty file has no characters to insert, which operator<< takes for a
  // failure.
  if (input.peek() != std::ifstream::traits_type::eof()) {
    copy.Stream() << input.rdbuf();
  }
  copy.Prepare();
  std::error_code error;
  const auto time = std::filesystem::last_write_time(source, error);
  if (keeps_time && !error) {
    std::filesystem::last_write_time(TemporaryOf(path), time, error);
  }
  copy.Commit();
}

void RemoveFile(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::remove(path, error);
  if (error) {
    throw SystemError(path, "cannot be removed", error.value());
  }
}

void RemoveTemporaries(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> temporaries;
  std::error_code error;
  for (std::filesystem::recursive_directory_iterator it(folder, error), end;
       !error && it != end;
       it.increment(error)) {
    std::error_code ignored;
    if (!std::filesystem::is_directory(it->symlink_status(ignored)) &&
        it->path().string().ends_with(AtomicFile::kTemporarySuffix)) {
      temporaries.push_back(it->path());
    }
  }
  std::for_each(temporaries.begin(), temporaries.end(), &RemoveFile);
}

void RenameFile(const std::filesystem::path& from,
                const std::filesystem::path& to) {
  if (rename(from.c_str(), to.c_str()) != 0) {
    throw SystemError(
        to, "cannot be replaced by " + from.filename().string(), errno);
  }
  // Between two names of one file, rename() does nothing.
  unlink(from.c_str());
  FlushFolderOf(to);
}

}  // namespace tsar
