// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string_view>
#include <vector>

namespace tsar {

// One of the files of page/, which the build embeds in the program.
struct PageFile {
  std::string_view name;
  std::string_view content;
};

// All embedded files.
const std::vector<PageFile>& PageFiles();

}  // namespace tsar
