// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/input_file.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// What messages about a picture say.
struct PictureWords {
  std::string noun;                 // Such as "mask".
  std::string advice;               // Where it is missing or empty.
  std::string advice_if_too_large;  // Where its file is.
};

// An open file of a picture, of at least one byte. All functions throw Error,
// naming the file: kNotFound (no such file), kIo (it cannot be read, or is no
// regular file), kCorrupt (empty), kUnsupported (2 GB or more).
class PictureInput {
 public:
  PictureInput(const std::filesystem::path& path, PictureWords words);

  const std::string& Name() const { return name_; }
  uint64_t Size() const { return file_.Size(); }

  // The first bytes, or the last ones; fewer where there are no more.
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
