// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/input_file.h"

#include "colmap_tsar/base/error.h"

#include <cerrno>
#include <cstring>

#include <ext/stdio_filebuf.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tsar {
namespace {

const char* KindText(mode_t mode) {
  return S_ISDIR(mode)    ? "it is a folder, not a file"
         : S_ISFIFO(mode) ? "it is a FIFO, not a file"
         : S_ISSOCK(mode) ? "it is a socket, not a file"
                          : "it is a device, not a file";
}

// Calls a function of the library's, whose exceptions name no file.
template <typename Function>
auto Reading(const std::filesystem::path& path, const Function& function) {
  try {
    return function();
  } catch (const std::ios_base::failure& error) {
    throw Error::File(ErrorCode::kIo,
                      path.string(),
                      "cannot be read (" + error.code().message() + ")",
                      "check the disk");
  }
}

class FileBuffer : public __gnu_cxx::stdio_filebuf<char> {
 public:
  FileBuffer(const std::filesystem::path& path, int descriptor)
      : stdio_filebuf(descriptor, std::ios::in | std::ios::binary),
        path_(path) {}

 protected:
  int_type underflow() override {
    return Reading(path_, [&] { return stdio_filebuf::underflow(); });
  }
  std::streamsize xsgetn(char* data, std::streamsize size) override {
    return Reading(path_, [&] { return stdio_filebuf::xsgetn(data, size); });
  }

 private:
  const std::filesystem::path path_;
};

}  // namespace

InputFile::InputFile() : std::istream(nullptr) {}

InputFile::InputFile(const std::filesystem::path& path) : InputFile() {
  Open(path);
}

InputFile::~InputFile() = default;

void InputFile::Open(const std::filesystem::path& path) {
  exceptions(std::ios::goodbit);
  rdbuf(nullptr);
  buffer_.reset();
  size_ = 0;
  reason_.clear();
  is_missing_ = false;
  // A terminal must not become that of this program, either.
  const int descriptor =
      open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  struct stat state = {};
  if (descriptor < 0 || fstat(descriptor, &state) != 0) {
    is_missing_ = errno == ENOENT || errno == ENOTDIR;
    reason_ = std::strerror(errno);
  } else if (!S_ISREG(state.st_mode)) {
    reason_ = KindText(state.st_mode);
  }
  if (!reason_.empty()) {
    if (descriptor >= 0) {
      close(descriptor);
    }
    setstate(std::ios::failbit);
    return;
  }
  size_ = static_cast<uintmax_t>(state.st_size);
  buffer_ = std::make_unique<FileBuffer>(path, descriptor);
  rdbuf(buffer_.get());  // Clears the state, too.
  exceptions(std::ios::badbit);
}

}  // namespace tsar
