// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/folder.h"

#include <filesystem>
#include <memory>

namespace tsar {

// The folder of a page while it is written: everything goes to a temporary
// folder beside it (*.tsar_tmp), which takes its name when all is there.
// Without Commit() the temporary is removed and nothing has changed.
//
// A page lists its files (kPageListFile) and is replaced only where nothing
// else is in its folder. What is removed on the way holds a marker
// (kUnfinishedPageFile) as long as anything is in it, by which the next call
// knows what a killed program has left; without the marker a folder is never
// touched. A page that stands under its name may hold the marker, too, where
// the program was killed between replacing a page and its end.
class PageFolder {
 public:
  // Throws Error: kUnsupported (the folder holds an earlier page and overwrite
  // is false, a page without its list, or anything that is not of a page; it is
  // a link; beside it stands, under the name of the temporary, what is no
  // unfinished page; another program is writing it), kIo.
  PageFolder(const std::filesystem::path& path, bool overwrite);
  ~PageFolder();
  PageFolder(const PageFolder&) = delete;
  PageFolder& operator=(const PageFolder&) = delete;

  // Where to write.
  const std::filesystem::path& Temporary() const { return temporary_; }

  // Lists what was written, puts it into the place of the former page, in one
  // step where the file system can, and removes that. Throws what the
  // constructor does, since files may have come meanwhile.
  void Commit();

 private:
  // Where the file system cannot exchange two folders.
  void ReplaceInTwoSteps();

  std::filesystem::path path_;
  std::filesystem::path temporary_;
  bool overwrite_;
  std::unique_ptr<Folder> lock_;  // The temporary, by which it is locked.
};

// By this file inside it a folder is known to be a page of this program.
inline constexpr const char* kPageDataFile = "data/report.js";
// The files of a page, by their paths in it, a line each; itself is the last.
inline constexpr const char* kPageListFile = "data/files.txt";
inline constexpr const char* kUnfinishedPageFile = "unfinished_page";

}  // namespace tsar
