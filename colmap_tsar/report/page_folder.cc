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

void RemoveFolder(const fs::path& path) {
  std::error_code error;
  fs::remove_all(path, error);
  if (error) {
    throw Error::File(ErrorCode::kIo,
                      path.string(),
                      "the folder cannot be removed (" + error.message() + ")",
                      "remove it");
  }
}

}  // namespace

PageFolder::PageFolder(const fs::path& path, bool overwrite)
    : path_(Normal(path)),
      temporary_(path_.string() + AtomicFile::kTemporarySuffix) {
  CheckPlace(path_, overwrite);
  RemoveFolder(temporary_);  // Of a program that was killed.
  CreateFolders(temporary_);
}

PageFolder::~PageFolder() {
  std::error_code error;
  fs::remove_all(temporary_, error);
}

void PageFolder::Commit() {
  const fs::path former = path_.string() + kFormerSuffix;
  RemoveFolder(former);
  std::error_code error;
  if (fs::exists(path_, error)) {
    RenameFile(path_, former);
  }
  RenameFile(temporary_, path_);
  RemoveFolder(former);
}

}  // namespace tsar
