// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <exception>
#include <stdexcept>
#include <string>

namespace tsar {

// The kind of an error, for callers that react to it. The command line prints
// the message and exits with code 1 for every kind.
enum class ErrorCode {
  kNotFound,     // A file, folder or named thing does not exist.
  kCorrupt,      // A file's content breaks its format.
  kMismatch,     // Two inputs contradict each other (sizes, names, counts).
  kUnsupported,  // Valid, but not supported by this program.
  kIo,           // Reading or writing failed (permissions, full disk).
  kBadOption,    // A command-line option or its value is wrong.
  kDevice,       // The GPU or its driver failed.
  kOutOfMemory,  // Not enough host or GPU memory, or threads.
  kInterrupted,  // The user asked to stop.
};

// The one exception type of this project. The message is a single line for the
// user: it names the file, what is wrong, and what to do about it.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message)
      : std::runtime_error(message), code_(code) {}

  // The common form of errors about a file: "PATH: WHAT; ADVICE".
  static Error File(ErrorCode code,
                    const std::string& path,
                    const std::string& what,
                    const std::string& advice) {
    return Error(code, path + ": " + what + "; " + advice);
  }

  ErrorCode Code() const { return code_; }

 private:
  ErrorCode code_;
};

// The user's message for exhausted memory; it needs no allocation.
inline constexpr char kOutOfMemory[] =
    "out of memory; close other programs or work on smaller images";

// Whether an exception, including those of OpenCV, reports exhausted memory.
bool IsOutOfMemory(const std::exception_ptr& failure);

// The message of an exception (not null) as one line for the user: an Error's
// unchanged, others with an explanation. Throws std::bad_alloc if
// there is no memory for the text.
std::string FailureText(const std::exception_ptr& failure);

}  // namespace tsar
