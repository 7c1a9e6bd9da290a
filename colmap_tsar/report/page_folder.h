// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/workspace/contained_path.h"

#include <filesystem>

namespace tsar {

// The folder of a page while it is written: everything goes to a temporary
// folder beside it, which takes its name when all is there. Without Commit()
// the temporary is removed and nothing has changed.
class PageFolder {
 public:
  // Throws Error: kUnsupported (the folder holds an earlier page and overwrite
  // is false, or anything that is not of a page, which is never touched), kIo.
  PageFolder(const std::filesystem::path& path, bool overwrite);
  ~PageFolder();
  PageFolder(const PageFolder&) = delete;
  PageFolder& operator=(const PageFolder&) = delete;

  // Where to write.
  const std::filesystem::path& Temporary() const { return temporary_; }

  void Commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_;
};

// By this file inside it a folder is known to be a page of this program.
inline constexpr const char* kPageDataFile = "data/report.js";

}  // namespace tsar
