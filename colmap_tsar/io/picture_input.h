// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/input_file.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// The texts of messages about a picture.
struct PictureWords {
  std::string noun;                 // A noun such as "mask".
  std::string advice;               // For a missing or empty file.
  std::string advice_if_too_large;  // For a too large file.
};

// An open file of a picture, of at least one byte. All functions throw Error,
// naming the file: kNotFound (no such file), kIo (it cannot be read, or is no
// regular file), kCorrupt (empty), kUnsupported (2 GB or more).
class PictureInput {
 public:
  PictureInput(const std::filesystem::path& path, PictureWords words);

  const std::string& Name() const { return name_; }
  uint64_t Size() const { return file_.Size(); }

  // Read the first or the last `count` bytes, or fewer if the file is shorter.
  std::vector<uint8_t> ReadHead(uint64_t count);
  std::vector<uint8_t> ReadTail(uint64_t count);
  std::vector<uint8_t> ReadAll();

 private:
  std::vector<uint8_t> Read(uint64_t begin, uint64_t count);

  std::string name_;
  PictureWords words_;
  InputFile file_;
};

}  // namespace tsar
