// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/process_setup.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/printable.h"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iostream>
#include <mutex>
#include <new>
#include <string>
#include <string_view>
#include <utility>

#include <ext/stdio_sync_filebuf.h>
#include <fcntl.h>
#include <opencv2/imgcodecs.hpp>
#include <sys/mman.h>
#include <unistd.h>

namespace tsar {
namespace {

// Writes all of these bytes unchanged to standard error, without memory or
// anything else that a program must set up first. Returns whether it succeeded.
bool WriteToStandardError(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(STDERR_FILENO, bytes.data(), bytes.size());
    if (written >= 0) {
      bytes.remove_prefix(static_cast<size_t>(written));
    } else if (errno != EINTR) {
      return false;
    }
  }
  return true;
}

// A write function for fopencookie(). Allocates no memory, since the message
// may be that it has run out.
ssize_t WritePrintable(void* /*cookie*/, const char* data, size_t size) {
  char buffer[1024];
  size_t length = 0;
  std::string_view text(data, size);
  while (!text.empty()) {
    // A line ends, or Progress begins its line on a terminal again.
    const bool is_ours =
        text[0] == '\n' || (text[0] == '\r' && text.size() == size);
    std::string_view printable = text.substr(0, 1);
    if (is_ours) {
      text.remove_prefix(1);
    } else {
      printable = TakePrintable(&text);
    }
    std::memcpy(buffer + length, printable.data(), printable.size());
    length += printable.size();
    constexpr size_t kMaxCharacter = 4;
    if ((text.empty() || length + kMaxCharacter > sizeof(buffer)) &&
        !WriteToStandardError({buffer, std::exchange(length, 0)})) {
      return 0;
    }
  }
  return static_cast<ssize_t>(size);
}

// One line is enough for the user: failures while the program ends, such as
// when libraries clean up, follow from the reported one.
std::atomic_flag has_reported;

[[noreturn]] void EndProgram() {
  static std::atomic_flag is_ending;
  while (is_ending.test_and_set()) {
    pause();  // Another thread ends the program.
  }
  if (!has_reported.test()) {
    ReportFailure();
  }
  std::_Exit(EXIT_FAILURE);
}

// An exception that passes through C code makes the C library load the stack
// unwinder, and end the program where it cannot.
void LoadUnwinder() {
  std::once_flag flag;
  try {
    std::call_once(flag, [] { throw 0; });
  } catch (int) {
    // As intended.
  }
}

}  // namespace

void OpenClosedStandardStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) >= 0 || errno != EBADF) {
      continue;
    }
    // The lowest free number is this one. A folder, which cannot be written to,
    // serves where there are no devices.
    if (open("/dev/null", O_RDWR) < 0) {
      open("/", O_RDONLY | O_DIRECTORY);
    }
  }
}

void KeepStandardErrorPrintable() {
  cookie_io_functions_t functions = {};
  functions.write = &WritePrintable;
  std::FILE* const file = fopencookie(nullptr, "w", functions);
  if (file == nullptr) {
    return;
  }
  setvbuf(file, nullptr, _IOLBF, BUFSIZ);
  stderr = file;
  // Never destroyed: destructors of others may still print.
  static auto* const buffer = new __gnu_cxx::stdio_sync_filebuf<char>(file);
  std::cerr.rdbuf(buffer);
  std::clog.rdbuf(buffer);
}

void FlushStandardOutput() {
  errno = 0;
  std::cout.flush();
  if (std::fflush(stdout) != 0 || !std::cout) {
    // The reason is unknown where an earlier write failed.
    const std::string reason =
        errno == 0 ? "" : std::string(" (") + std::strerror(errno) + ")";
    std::cout.clear();
    throw Error(ErrorCode::kIo,
                "standard output: what was printed is lost" + reason +
                    "; check where it leads to");
  }
}

void ReportOutOfMemory() noexcept {
  WriteToStandardError("ERROR: ");
  WriteToStandardError(kOutOfMemory);
  WriteToStandardError("\n");
}

void ReportFailure() noexcept {
  has_reported.test_and_set();
  try {
    const std::exception_ptr failure = std::current_exception();
    // An exception that left a function that must not throw, such as a
    // destructor, is not accessible: little but memory can fail there.
    const std::string text = failure ? FailureText(failure)
                             : std::uncaught_exceptions() > 0
                                 ? kOutOfMemory
                                 : "unexpected failure";
    WriteToStandardError("ERROR: " + Printable(text) + "\n");
  } catch (...) {
    ReportOutOfMemory();
  }
}

void ReportUncaughtFailures() { std::set_terminate(&EndProgram); }

bool HasMemoryToStart() {
  // Twice the memory that the libraries of OpenCV and CUDA were seen to take.
  constexpr size_t kNumBytes = size_t{32} << 20;
  void* const memory = mmap(nullptr,
                            kNumBytes,
                            PROT_READ | PROT_WRITE,
                            MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE,
                            -1,
                            0);
  if (memory == MAP_FAILED) {
    return false;
  }
  munmap(memory, kNumBytes);
  return true;
}

void PrepareForLowMemory() {
  if (!HasMemoryToStart()) {
    throw std::bad_alloc();
  }
  LoadUnwinder();
  // The first query about an image format registers all formats, for which some
  // builds of OpenCV load another library.
  cv::haveImageWriter(".png");
}

}  // namespace tsar
