// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/input_file.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/path.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <sstream>

#include <ext/stdio_filebuf.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tsar {
namespace {

const char* KindText(mode_t mode) {
  return S_ISDIR(mode)    ? "it is a folder, not a regular file"
         : S_ISFIFO(mode) ? "it is a FIFO, not a regular file"
         : S_ISSOCK(mode) ? "it is a socket, not a regular file"
                          : "it is a device, not a regular file";
}

Error CannotRead(const std::filesystem::path& path,
                 const std::string& reason,
                 const std::string& advice) {
  return Error::File(
      ErrorCode::kIo, path.string(), "cannot be read (" + reason + ")", advice);
}

// Names the file where the standard library's exceptions do not.
class FileBuffer : public __gnu_cxx::stdio_filebuf<char> {
 public:
  FileBuffer(const std::filesystem::path& path, int descriptor)
      : stdio_filebuf(descriptor, std::ios::in | std::ios::binary),
        path_(path) {}

 protected:
  int_type underflow() override {
    return Reading([&] { return stdio_filebuf::underflow(); });
  }
  std::streamsize xsgetn(char* data, std::streamsize size) override {
    return Reading([&] { return stdio_filebuf::xsgetn(data, size); });
  }

 private:
  template <typename Function>
  auto Reading(const Function& function) -> decltype(function()) {
    try {
      return function();
    } catch (const std::ios_base::failure& error) {
      throw CannotRead(path_, error.code().message(), "check the disk");
    }
  }

  const std::filesystem::path path_;
};

}  // namespace

// A buffer is always set, since some readers access that of a failed stream.
InputFile::InputFile(const std::filesystem::path& path)
    : std::istream(nullptr),
      path_(path),
      buffer_(std::make_unique<std::stringbuf>()) {
  // O_NOCTTY: a terminal must not become the controlling one.
  const int descriptor =
      open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  const int error = descriptor < 0 ? errno : 0;
  struct stat state = {};
  // Sockets and absent devices cannot be opened.
  const bool has_state = descriptor < 0 ? stat(path.c_str(), &state) == 0
                                        : fstat(descriptor, &state) == 0;
  is_missing_ = error == ENOENT || error == ENOTDIR;
  is_no_file_ = has_state && !S_ISREG(state.st_mode);
  if (is_no_file_) {
    reason_ = KindText(state.st_mode);
  } else if (error != 0) {
    reason_ = std::strerror(error);
  }
  if (reason_.empty()) {
    size_ = static_cast<uintmax_t>(state.st_size);
    buffer_ = std::make_unique<FileBuffer>(path, descriptor);
  } else if (descriptor >= 0) {
    close(descriptor);
  }
  rdbuf(buffer_.get());  // Also clears the state.
  if (!reason_.empty()) {
    setstate(std::ios::failbit);
  }
  exceptions(std::ios::badbit);
}

InputFile::~InputFile() = default;

void InputFile::RequireOpened(const std::string& noun,
                              const std::string& advice) const {
  if (is_missing_) {
    throw Error::File(ErrorCode::kNotFound,
                      path_.string(),
                      "no such " + noun,
                      AdviceForMissing(path_, advice));
  }
  if (!reason_.empty()) {
    throw CannotRead(
        path_, reason_, "check that it is a file and that you may read it");
  }
}

std::vector<uint8_t> InputFile::ReadBytes(uintmax_t begin, uintmax_t count) {
  begin = std::min(begin, size_);
  std::vector<uint8_t> bytes(std::min(count, size_ - begin));
  seekg(static_cast<std::streamoff>(begin));
  read(reinterpret_cast<char*>(bytes.data()),
       static_cast<std::streamsize>(bytes.size()));
  if (!*this) {
    throw CannotRead(path_, "the file has become shorter", "check the disk");
  }
  return bytes;
}

bool ReadLine(std::istream& text, bool is_first, std::string* line) {
  if (!std::getline(text, *line)) {
    return false;
  }
  if (is_first && line->starts_with("\xEF\xBB\xBF")) {
    line->erase(0, 3);
  }
  if (line->ends_with('\r')) {
    line->pop_back();
  }
  return true;
}

}  // namespace tsar
