// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/workspace/picture_input.h"
#include "colmap_tsar/workspace/png.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// An open file that has to be a PNG file; see PictureInput.
class PngInput {
 public:
  // noun: such as "mask"; advice: how to write one.
  PngInput(const std::filesystem::path& path,
           const std::string& noun,
           const std::string& advice);

  const std::string& Name() const { return file_.Name(); }

  // Throws Error kCorrupt where it is no PNG file or its header is not whole.
  PngHeader ReadHeader();

  // Whether the end of the file is that of a whole one.
  bool EndsAsWhole();

  std::vector<uint8_t> ReadAll() { return file_.ReadAll(); }

  // kCorrupt: that the file is damaged, and how.
  Error Damaged(const std::string& how) const;

 private:
  std::string noun_;
  std::string advice_;
  PictureInput file_;
};

}  // namespace tsar
