// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/io/picture_input.h"
#include "colmap_tsar/io/png.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// What messages about a PNG file say. Whole, so that a search for a message
// finds it.
struct PngWords {
  std::string noun;     // Such as "mask".
  std::string no_png;   // Where it is something else.
  std::string damaged;  // Before how.
  std::string advice;   // How to write one.
};

// An open file that has to be a PNG file; see PictureInput.
class PngInput {
 public:
  PngInput(const std::filesystem::path& path, const PngWords& words);

  const std::string& Name() const { return file_.Name(); }

  // Throws Error kCorrupt where it is no PNG file or its header is not whole.
  PngHeader ReadHeader();

  // Whether the end of the file is that of a whole one.
  bool EndsAsWhole();

  std::vector<uint8_t> ReadAll() { return file_.ReadAll(); }

  // kCorrupt: that the file is damaged, and how.
  Error Damaged(const std::string& how) const;

 private:
  PngWords words_;
  PictureInput file_;
};

}  // namespace tsar
