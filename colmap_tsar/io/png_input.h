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

// The texts of messages about a PNG file, unabridged, so that a search finds
// them.
struct PngWords {
  std::string noun;     // A noun such as "mask".
  std::string no_png;   // For another format.
  std::string damaged;  // Precedes the defect.
  std::string advice;   // How to write one.
};

// An open PNG file; see PictureInput.
class PngInput {
 public:
  PngInput(const std::filesystem::path& path, const PngWords& words);

  const std::string& Name() const { return file_.Name(); }

  // Throws Error kCorrupt if it is no PNG file or its header is incomplete.
  PngHeader ReadHeader();

  // Whether the end of the file is that of a complete one.
  bool EndsAsWhole();

  std::vector<uint8_t> ReadAll() { return file_.ReadAll(); }

  // The error kCorrupt for a damaged file. how: the defect.
  Error Damaged(const std::string& how) const;

 private:
  PngWords words_;
  PictureInput file_;
};

}  // namespace tsar
