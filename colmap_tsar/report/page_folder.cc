// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/page_folder.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/report/page_files.h"
#include "colmap_tsar/workspace/atomic_file.h"

#include <algorithm>
#include <string>
#include <system_error>
#include <vector>

namespace tsar {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormerSuffix = ".tsar_old";

// Without the separator that a user may write at the end.
fs::path Normal(const fs::path& path) {
  const fs::path normal = fs::absolute(path).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

// Whether the folder holds what a page consists of and nothing else.
bool HoldsPageAlone(const fs::path& path) {
  std::error_code error;
  fs::directory_iterator it(path, error);
  for (const fs::directory_iterator end; !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    const std::vector<PageFile>& files = PageFiles();
    if (name != "data" && name != "images" &&
        std::none_of(files.begin(), files.end(), [&](const PageFile& file) {
          return file.name == name;
        })) {
      return false;
    }
  }
  return !error;
}

void CheckPlace(const fs::path& path, bool overwrite) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(path, error)) ||
      (fs::is_directory(path, error) && fs::is_empty(path, error))) {
    return;
  }
  if (!fs::is_regular_file(path / kPageDataFile, error)) {
    throw Error::File(ErrorCode::kUnsupported,
                      path.string(),
                      "is there already and is no report",
                      "give another folder as --report_path");
  }
  if (!overwrite) {
    throw Error::File(ErrorCode::kUnsupported,
                      path.string(),
                      "holds a report already",
                      "give --overwrite 1 to replace it, or another folder as "
                      "--report_path");
  }
  if (!HoldsPageAlone(path)) {
    throw Error::File(ErrorCode::kUnsupported,
                      path.string(),
                      "holds other files beside a report",
                      "move them, or give another folder as --report_path");
  }
}

void RemoveFolder(const fs::path& path) { RemoveTree(UserPath(path)); }

}  // namespace

PageFolder::PageFolder(const fs::path& path, bool overwrite)
    : path_(Normal(path)),
      temporary_(path_.string() + AtomicFile::kTemporarySuffix) {
  CheckPlace(path_, overwrite);
  RemoveFolder(temporary_);  // Of a program that was killed.
  CreateFolders(UserPath(temporary_));
}

PageFolder::~PageFolder() {
  try {
    RemoveFolder(temporary_);
  } catch (const std::exception&) {
    // The next page in its place removes it.
  }
}

void PageFolder::Commit() {
  const fs::path former = path_.string() + kFormerSuffix;
  RemoveFolder(former);
  std::error_code error;
  if (fs::exists(path_, error)) {
    RenameFile(UserPath(path_), UserPath(former));
  }
  RenameFile(UserPath(temporary_), UserPath(path_));
  RemoveFolder(former);
}

}  // namespace tsar
