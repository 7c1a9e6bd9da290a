// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <filesystem>
#include <istream>
#include <memory>
#include <string>
#include <vector>

namespace tsar {

// A regular file open for binary reading. Unlike std::ifstream it never blocks:
// the name of a model, map or photo may be that of a FIFO or a device, which
// could hang when opened, and a device has no end.
//
// As with std::ifstream, a file that cannot be opened leaves the stream in a
// failed state; Reason() then says why. A disk error while reading and
// exhausted memory throw (kIo, std::bad_alloc); other streams would report both
// as the end of the file.
class InputFile : public std::istream {
 public:
  // Links are followed.
  explicit InputFile(const std::filesystem::path& path);
  ~InputFile() override;

  // Throws Error, naming the file, unless it was opened: kNotFound (there is
  // none), kIo. noun: such as "map"; advice: for a missing file.
  void RequireOpened(const std::string& noun, const std::string& advice) const;

  // The size in bytes when the file was opened.
  uintmax_t Size() const { return size_; }
  // `count` bytes from an offset on, or fewer if the file ends before. Throws
  // Error kIo where it has become shorter.
  std::vector<uint8_t> ReadBytes(uintmax_t begin, uintmax_t count);

  // Why the file could not be opened, such as "Permission denied" or "it is a
  // FIFO, not a regular file"; empty if it was opened.
  const std::string& Reason() const { return reason_; }
  // Whether the reason is that there is no such file, or that it is not a
  // regular file.
  bool IsMissing() const { return is_missing_; }
  bool IsNoFile() const { return is_no_file_; }

 private:
  const std::filesystem::path path_;
  std::unique_ptr<std::streambuf> buffer_;
  uintmax_t size_ = 0;
  std::string reason_;
  bool is_missing_ = false;
  bool is_no_file_ = false;
};

// Reads the next line of a text from other programs or people, without a
// carriage return at its end, and without a byte order mark if it is the first.
bool ReadLine(std::istream& text, bool is_first, std::string* line);

}  // namespace tsar
